//! The curves that bound a piece: graphs y(x), either straight lines or arcs of ellipses.

use super::Point;
use super::ellipse::EllipseCurve;
use super::line::{Line, Places};
use super::moments::Moments;

/// A curve as a graph y(x).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Curve {
    Line(Line),
    Arc(Arc),
}

/// The upper or lower half of an ellipse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arc {
    /// The ellipse.
    pub ellipse: EllipseCurve,
    /// Sign of the half [-]: 1 for the upper, -1 for the lower.
    pub side: f64,
}

/// Nodes and weights of the 8-point Gauss-Legendre rule on [-1, 1]; the positive nodes only
/// (Abramowitz and Stegun 1964, table 25.4).
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// Longest section of an arc for one Gauss rule [rad]. The integrands are products of at most three
/// sines and cosines, for which the error of the rule stays below 1e-15.
const STRETCH: f64 = 1.0;

impl Curve {
    /// Ordinate at `x` [m].
    pub fn y(&self, x: f64) -> f64 {
        match self {
            Curve::Line(line) => line.y(x),
            Curve::Arc(arc) => {
                let e = &arc.ellipse;
                let (dx, u) = (x - e.centre[0], e.share(x));
                let root = ((1.0 - u) * (1.0 + u)).sqrt();
                e.centre[1] + e.skew * dx + arc.side * e.half_height * root
            }
        }
    }

    /// Positions x [m] at which the curve crosses a line; they may include crossings of the
    /// ellipse's other half.
    pub fn meet(&self, line: &Line) -> Places {
        match self {
            Curve::Line(own) => own.meet(line).into_iter().collect(),
            Curve::Arc(arc) => arc.ellipse.meet_line(line),
        }
    }

    /// Area and moments between the curve and the level of `origin`, from `x0` to `x1` [m], about
    /// `origin`. The area is negative where the curve is below that level.
    pub fn under(&self, x0: f64, x1: f64, origin: Point) -> Moments {
        let mut sum = Moments::default();
        let mut add = |x: f64, y: f64, dx: f64| {
            let (x, y) = (x - origin[0], y - origin[1]);
            let area = y * dx;
            sum += Moments { area, first: [x * area, 0.5 * y * area] };
        };
        match self {
            Curve::Line(line) => {
                // the two-point Gauss rule: exact for cubics, and the integrands are quadratic
                let (middle, half) = (0.5 * (x0 + x1), 0.5 * (x1 - x0));
                let node = half / 3.0_f64.sqrt();
                for x in [middle - node, middle + node] {
                    add(x, line.y(x), half);
                }
            }
            Curve::Arc(arc) => {
                let e = &arc.ellipse;
                let (from, to) = (e.share(x0).asin(), e.share(x1).asin());
                let stretches = ((to - from) / STRETCH).ceil().max(1.0);
                let half = 0.5 * (to - from) / stretches;
                for k in 0..stretches as usize {
                    let middle = from + (2 * k + 1) as f64 * half;
                    for (node, weight) in GAUSS {
                        for node in [-node, node] {
                            let (sin, cos) = (middle + half * node).sin_cos();
                            let dx = e.half_width * sin;
                            let dy = e.skew * dx + arc.side * e.half_height * cos;
                            let width = half * weight * e.half_width * cos;
                            add(e.centre[0] + dx, e.centre[1] + dy, width);
                        }
                    }
                }
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gauss_rule_is_exact_to_degree_15() {
        for degree in (0..16).step_by(2) {
            let sum: f64 = GAUSS.iter().map(|(x, w)| 2.0 * w * x.powi(degree)).sum();
            let exact = 2.0 / f64::from(degree + 1);
            assert!((sum - exact).abs() < 1e-15, "degree {degree}: {sum} {exact}");
        }
    }

    #[test]
    fn a_half_disk_has_its_area_and_moments() {
        let ellipse = EllipseCurve::upright([2.0, 1.0], [3.0, 3.0]);
        let arc = Curve::Arc(Arc { ellipse, side: 1.0 });
        let half = arc.under(-1.0, 5.0, [2.0, 1.0]);
        assert!((half.area - 4.5 * std::f64::consts::PI).abs() < 1e-14);
        assert!(half.first[0].abs() < 1e-13);
        assert!((half.first[1] - 18.0).abs() < 1e-13, "2 r^3/3");
    }
}
