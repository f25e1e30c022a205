//! An ellipse as two graphs over x, and its crossings with lines and other ellipses.
//!
//! With X = x - xc the two halves are y = yc + k X +- h sqrt(1 - (X/w)^2): a tilted ellipse is an
//! upright one under a shear k. If S = R diag(a^2, b^2) R^T for half axes a, b and a rotation R,
//! then w^2 = S_xx, k = S_xy/S_xx and h w = a b. Its points are (w cos t, k w cos t + h sin t)
//! relative to the centre.

use polycool::Quartic;

use super::Point;
use super::line::{Line, Places};

/// An ellipse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EllipseCurve {
    /// Centre [m].
    pub centre: Point,
    /// Half extent in x, w [m].
    pub half_width: f64,
    /// Half height at the centre, h [m].
    pub half_height: f64,
    /// Slope k of the line through the midpoints of the vertical chords [-].
    pub skew: f64,
}

/// Margin beyond [-1, 1] in which roots of the half-angle are searched, so that none is lost
/// between the two halves of the circle.
const BEYOND: f64 = 1e-3;

/// Number of Newton steps to the nearest point; a few are enough for points near the ellipse.
const NEWTON_STEPS: usize = 12;

impl EllipseCurve {
    /// The ellipse with half axes `radii` [m] along x and y.
    pub fn upright(centre: Point, radii: [f64; 2]) -> Self {
        EllipseCurve { centre, half_width: radii[0], half_height: radii[1], skew: 0.0 }
    }

    /// The ellipse with half axes `radii` [m], rotated counter-clockwise by the angle of `cos` and
    /// `sin`.
    pub fn tilted(centre: Point, radii: [f64; 2], cos: f64, sin: f64) -> Self {
        let [a, b] = radii;
        if a == b || sin == 0.0 {
            return EllipseCurve::upright(centre, radii);
        }
        if cos == 0.0 {
            return EllipseCurve::upright(centre, [b, a]);
        }
        let half_width = (a * cos).hypot(b * sin);
        let skew = (a - b) * (a + b) * cos * sin / (half_width * half_width);
        EllipseCurve { centre, half_width, half_height: a * b / half_width, skew }
    }

    /// (x - xc)/w, clamped to [-1, 1].
    pub fn share(&self, x: f64) -> f64 {
        ((x - self.centre[0]) / self.half_width).clamp(-1.0, 1.0)
    }

    /// Half extent in y [m].
    pub fn half_extent_y(&self) -> f64 {
        self.half_height.hypot(self.skew * self.half_width)
    }

    /// Point of the ellipse nearest to another point `at` [m], and the unit normal there [-], out
    /// of the ellipse.
    ///
    /// Newton's method for (P(t) - at).P'(t) = 0 with the points P(t) of the ellipse, from the
    /// point in the same direction after the ellipse has been mapped to a circle: exact for circles
    /// and close for points near the ellipse.
    pub fn nearest(&self, at: Point) -> (Point, [f64; 2]) {
        let (w, h, k) = (self.half_width, self.half_height, self.skew);
        let [x, y] = [0, 1].map(|d| at[d] - self.centre[d]);
        let mut t = ((y - k * x) / h).atan2(x / w);
        let point = |t: f64| {
            let (sin, cos) = t.sin_cos();
            let place = [w * cos, k * w * cos + h * sin];
            (place, [-w * sin, -k * w * sin + h * cos])
        };
        for _ in 0..NEWTON_STEPS {
            let (place, along) = point(t);
            let away = [place[0] - x, place[1] - y];
            let slope = away[0] * along[0] + away[1] * along[1];
            // P'' = -P; where the distance is not convex, its convex part gives the step
            let square = along[0] * along[0] + along[1] * along[1];
            let curvature = square - (away[0] * place[0] + away[1] * place[1]);
            t -= slope / if curvature > 0.0 { curvature } else { square };
        }
        let (place, [dx, dy]) = point(t);
        let length = dx.hypot(dy);
        ([0, 1].map(|d| self.centre[d] + place[d]), [dy / length, -dx / length])
    }

    /// Positions x [m] of the least and the greatest x and y.
    pub fn extremes(&self) -> [f64; 4] {
        let [w, top] =
            [self.half_width, self.skew * self.half_width.powi(2) / self.half_extent_y()];
        [-w, w, -top, top].map(|dx| self.centre[0] + dx)
    }

    /// Positions x [m] of the crossings with a line. With y = yc + L + m X on the line:
    /// (L + (m - k) X)^2 = h^2 (1 - X^2/w^2).
    pub fn meet_line(&self, line: &Line) -> Places {
        let (w, h) = (self.half_width, self.half_height);
        let slope = line.slope - self.skew;
        let offset = line.at[1] + line.slope * (self.centre[0] - line.at[0]) - self.centre[1];
        // a quarter of the discriminant over h^2, without squaring a large offset
        let discriminant = slope * slope + (h - offset) * (h + offset) / (w * w);
        if discriminant < 0.0 {
            return Places::new();
        }
        let (root, scale) = (h * discriminant.sqrt(), slope * slope + (h / w).powi(2));
        let middle = -slope * offset;
        [-root, root].map(|r| self.centre[0] + (middle + r) / scale).into_iter().collect()
    }

    /// Positions x [m] of the crossings with another ellipse. The points of this ellipse in the
    /// equation of the other give a polynomial in cos t and sin t, which is a quartic in tan(t/2).
    pub fn meet(&self, other: &EllipseCurve) -> Places {
        let (w, h, k) = (self.half_width, self.half_height, self.skew);
        let dx = self.centre[0] - other.centre[0];
        let dy = self.centre[1] - other.centre[1] - other.skew * dx;
        // the other's equation: (a0 + a1 c)^2 + (b0 + b1 c + b2 s)^2 = 1
        let [a0, a1] = [dx / other.half_width, w / other.half_width];
        let [b0, b1, b2] = [dy, (k - other.skew) * w, h].map(|v| v / other.half_height);
        let constant = a0 * a0 + b0 * b0 + b2 * b2 - 1.0;
        let (cosine, sine) = (2.0 * (a0 * a1 + b0 * b1), 2.0 * b0 * b2);
        let (cosine2, product) = (a1 * a1 + b1 * b1 - b2 * b2, 2.0 * b1 * b2);
        let mut places = Places::new();
        // t around 0, then around pi, where sine and cosine change sign
        for sign in [1.0, -1.0] {
            let (c, s) = (sign * cosine, sign * sine);
            let quartic = Quartic::new([
                constant + c + cosine2,
                2.0 * (s + product),
                2.0 * (constant - cosine2),
                2.0 * (s - product),
                constant - c + cosine2,
            ]);
            for t in quartic.roots_between(-1.0 - BEYOND, 1.0 + BEYOND, 1e-15) {
                let cos = sign * (1.0 - t) * (1.0 + t) / (1.0 + t * t);
                places.push(self.centre[0] + w * cos);
            }
        }
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(mut places: Places) -> Vec<f64> {
        places.sort_by(f64::total_cmp);
        places.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
        places.to_vec()
    }

    #[test]
    fn circles_cross_where_they_must() {
        let unit = EllipseCurve::upright([0.0, 0.0], [1.0, 1.0]);
        let at = |x, y, r| EllipseCurve::upright([x, y], [r, r]);
        // both crossings at one x; both at one y; one ellipse inside the other; separate
        let places = sorted(unit.meet(&at(1.0, 0.0, 1.0)));
        assert!(places.iter().all(|x| (x - 0.5).abs() < 1e-14) && !places.is_empty());
        let places = sorted(unit.meet(&at(0.0, 1.0, 1.0)));
        let x = 0.75_f64.sqrt();
        assert!(places.len() == 2, "{places:?}");
        assert!((places[0] + x).abs() < 1e-14 && (places[1] - x).abs() < 1e-14);
        assert!(unit.meet(&at(0.1, 0.0, 0.5)).is_empty());
        assert!(unit.meet(&at(3.0, 0.1, 1.0)).is_empty());
    }

    #[test]
    fn ellipses_cross_in_four_points_of_both() {
        let a = EllipseCurve::tilted([0.1, -0.2], [2.0, 0.7], 0.8, 0.6);
        let b = EllipseCurve::tilted([0.0, 0.1], [1.8, 0.6], 0.6, -0.8);
        let places = sorted(a.meet(&b));
        assert_eq!(places.len(), 4, "{places:?}");
        for x in places {
            let on = |e: &EllipseCurve, side: f64| {
                let u = e.share(x);
                e.centre[1]
                    + e.skew * (x - e.centre[0])
                    + side * e.half_height * (1.0 - u * u).sqrt()
            };
            let least = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)]
                .map(|(s, t)| (on(&a, s) - on(&b, t)).abs())
                .into_iter()
                .fold(f64::INFINITY, f64::min);
            assert!(least < 1e-13, "{x}: {least:e}");
        }
    }

    #[test]
    fn a_line_crosses_a_tilted_ellipse_on_its_border() {
        let e = EllipseCurve::tilted([1.0, 2.0], [3.0, 0.5], 0.6, 0.8);
        let line = Line::through([0.0, 1.5], [2.0, 2.25]).unwrap();
        let places = e.meet_line(&line);
        assert_eq!(places.len(), 2);
        for x in places {
            let dx = x - 1.0;
            let (u, y) = (dx / e.half_width, 1.5 + 0.375 * x - 2.0 - e.skew * dx);
            assert!((u * u + (y / e.half_height).powi(2) - 1.0).abs() < 1e-13);
        }
        assert!(e.meet_line(&Line::level(9.0)).is_empty());
    }

    #[test]
    fn extremes_are_those_of_the_axes() {
        // half axes 2 and 1 at 30 degrees: extents^2 a^2 c^2 + b^2 s^2 and a^2 s^2 + b^2 c^2
        let (sin, cos) = std::f64::consts::FRAC_PI_6.sin_cos();
        let e = EllipseCurve::tilted([0.0, 0.0], [2.0, 1.0], cos, sin);
        assert!((e.half_width - 3.25_f64.sqrt()).abs() < 1e-15);
        assert!((e.half_extent_y() - 1.75_f64.sqrt()).abs() < 1e-15);
    }
}
