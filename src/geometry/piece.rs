//! A piece of a region: the area between two graphs over an interval of x.

use smallvec::SmallVec;

use super::Point;
use super::curve::Curve;
use super::line::Line;
use super::moments::Moments;

/// The area between two curves over an interval of x. The curves do not cross within the interval,
/// and each is monotonic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    /// Interval of x [m].
    pub x: [f64; 2],
    /// Lower border.
    pub lower: Curve,
    /// Upper border.
    pub upper: Curve,
}

/// A piece between straight lines: a trapezium with vertical sides.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trapezium {
    /// Interval of x [m].
    pub x: [f64; 2],
    /// Lower border.
    pub lower: Line,
    /// Upper border.
    pub upper: Line,
}

fn ordered([a, b]: [f64; 2]) -> [f64; 2] {
    [a.min(b), a.max(b)]
}

impl Piece {
    /// Least and greatest y [m] over the interval `x`.
    pub fn range_y(&self, x: [f64; 2]) -> [f64; 2] {
        let lower = ordered(x.map(|x| self.lower.y(x)));
        let upper = ordered(x.map(|x| self.upper.y(x)));
        [lower[0], upper[1]]
    }

    /// Greatest y of the lower curve and least y of the upper one over the interval `x` [m]; the
    /// first is above the second if no level lies between the curves.
    pub fn inner_range_y(&self, x: [f64; 2]) -> [f64; 2] {
        let lower = ordered(x.map(|x| self.lower.y(x)));
        let upper = ordered(x.map(|x| self.upper.y(x)));
        [lower[1], upper[0]]
    }

    /// Area and moments about `origin`.
    pub fn moments(&self, origin: Point) -> Moments {
        let [x0, x1] = self.x;
        self.upper.under(x0, x1, origin) - self.lower.under(x0, x1, origin)
    }

    /// Area and moments, about `origin`, of the intersection of the piece with `other`.
    pub fn overlap(&self, other: &Trapezium, origin: Point) -> Moments {
        let x = [self.x[0].max(other.x[0]), self.x[1].min(other.x[1])];
        if x[0] >= x[1] {
            return Moments::default();
        }
        let floors = [self.lower, Curve::Line(other.lower)];
        let ceilings = [self.upper, Curve::Line(other.upper)];
        let low = floors.map(|c| ordered(x.map(|x| c.y(x))));
        let high = ceilings.map(|c| ordered(x.map(|x| c.y(x))));
        if high[0][1] <= low[1][0] || high[1][1] <= low[0][0] {
            return Moments::default();
        }
        let between = |floor: &Curve, ceiling: &Curve, from: f64, to: f64| {
            ceiling.under(from, to, origin) - floor.under(from, to, origin)
        };
        if low[0][1] <= low[1][0] && high[0][0] >= high[1][1] {
            return between(&floors[1], &ceilings[1], x[0], x[1]);
        }
        let mut cuts: SmallVec<[f64; 10]> = SmallVec::from_slice(&x);
        for (curve, range) in [(&self.lower, low[0]), (&self.upper, high[0])] {
            for (line, reach) in [(&other.lower, low[1]), (&other.upper, high[1])] {
                if range[0] < reach[1] && reach[0] < range[1] {
                    cuts.extend(curve.meet(line).into_iter().filter(|c| x[0] < *c && *c < x[1]));
                }
            }
        }
        cuts.sort_unstable_by(f64::total_cmp);
        let mut sum = Moments::default();
        for cut in cuts.windows(2) {
            let middle = 0.5 * (cut[0] + cut[1]);
            let floor = floors.map(|c| c.y(middle));
            let ceiling = ceilings.map(|c| c.y(middle));
            let (f, c) = (usize::from(floor[1] > floor[0]), usize::from(ceiling[1] < ceiling[0]));
            if ceiling[c] > floor[f] {
                sum += between(&floors[f], &ceilings[c], cut[0], cut[1]);
            }
        }
        sum
    }
}

impl Trapezium {
    /// The box from `lower` to `upper` [m].
    pub fn upright(lower: Point, upper: Point) -> Self {
        let [floor, ceiling] = [Line::level(lower[1]), Line::level(upper[1])];
        Trapezium { x: [lower[0], upper[0]], lower: floor, upper: ceiling }
    }
}
