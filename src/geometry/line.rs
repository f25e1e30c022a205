//! Straight lines as graphs y(x), and the positions at which curves cross.

use smallvec::SmallVec;

use super::Point;

/// Positions x [m] at which curves cross.
pub(super) type Places = SmallVec<[f64; 4]>;

/// A straight line that is not vertical.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    /// A point of the line [m].
    pub at: Point,
    /// dy/dx [-].
    pub slope: f64,
    /// Least and greatest y of an edge [m]; they keep rounding from moving a steep edge beyond its
    /// ends.
    pub range: [f64; 2],
}

impl Line {
    /// The edge from `a` to `b`; `None` if it is vertical.
    pub fn through(a: Point, b: Point) -> Option<Self> {
        let slope = (b[1] - a[1]) / (b[0] - a[0]);
        let range = [a[1].min(b[1]), a[1].max(b[1])];
        slope.is_finite().then_some(Line { at: a, slope, range })
    }

    /// The line at constant `y` [m].
    pub fn level(y: f64) -> Self {
        Line { at: [0.0, y], slope: 0.0, range: [y, y] }
    }

    /// Ordinate at `x`, limited to the range of the line [m].
    pub fn y(&self, x: f64) -> f64 {
        let y = self.at[1] + self.slope * (x - self.at[0]);
        y.max(self.range[0]).min(self.range[1])
    }

    /// Position x [m] at which two lines cross, regardless of their ends.
    pub fn meet(&self, other: &Line) -> Option<f64> {
        // from a point of the steeper line, where rounding of y changes x least
        let (steep, flat) =
            if self.slope.abs() > other.slope.abs() { (self, other) } else { (other, self) };
        let gap = flat.at[1] + flat.slope * (steep.at[0] - flat.at[0]) - steep.at[1];
        let x = steep.at[0] + gap / (steep.slope - flat.slope);
        x.is_finite().then_some(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_cross_where_they_must() {
        let steep = Line::through([1.0, 0.0], [1.0 + 1e-9, 1.0]).unwrap();
        let flat = Line::through([0.0, 0.5], [2.0, 0.5]).unwrap();
        assert!((steep.meet(&flat).unwrap() - (1.0 + 5e-10)).abs() < 1e-15);
        assert_eq!(flat.meet(&Line::level(3.0)), None, "parallel");
    }
}
