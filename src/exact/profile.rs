//! Piecewise-linear profiles in space and histories in time, and what stands out in them.
//!
//! Knows no materials.

/// The state at one place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Place, Eulerian [m].
    pub x: f64,
    /// Pressure [Pa].
    pub p: f64,
    /// Velocity [m/s].
    pub u: f64,
    /// Density [kg/m3].
    pub rho: f64,
    /// Specific internal energy [J/kg].
    pub e: f64,
}

impl Point {
    /// The state at `x` on the straight line from `self` to `other`.
    fn towards(&self, other: &Point, x: f64) -> Point {
        let width = other.x - self.x;
        let w = if width > 0.0 { ((x - self.x) / width).clamp(0.0, 1.0) } else { 0.5 };
        let mix = |a: f64, b: f64| a + w * (b - a);
        Point {
            x,
            p: mix(self.p, other.p),
            u: mix(self.u, other.u),
            rho: mix(self.rho, other.rho),
            e: mix(self.e, other.e),
        }
    }
}

/// States along x joined by straight lines; x does not decrease, and is doubled where the
/// solution jumps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Profile {
    /// The corners, by x.
    pub points: Vec<Point>,
}

impl Profile {
    /// The state at `x`, the mean of both sides where it jumps; `None` outside.
    pub fn at(&self, x: f64) -> Option<Point> {
        let (first, last) = self.span()?;
        if !(first..=last).contains(&x) {
            return None;
        }
        let after = self.points.partition_point(|q| q.x <= x);
        let from = self.points.partition_point(|q| q.x < x);
        if after > from {
            // x stands on corners: the mean of the first and the last of them
            let (a, b) = (self.points[from], self.points[after - 1]);
            let mean = |f: fn(&Point) -> f64| 0.5 * (f(&a) + f(&b));
            return Some(Point {
                x,
                p: mean(|q| q.p),
                u: mean(|q| q.u),
                rho: mean(|q| q.rho),
                e: mean(|q| q.e),
            });
        }
        Some(self.points[after - 1].towards(&self.points[after], x))
    }

    /// The part between `lower` and `upper`; its ends are cut on the straight lines.
    pub fn between(&self, lower: f64, upper: f64) -> Profile {
        let mut points = Vec::new();
        for pair in self.points.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            if b.x < lower || a.x > upper || (a.x == b.x && (a.x <= lower || a.x >= upper)) {
                continue;
            }
            let from = if a.x < lower { a.towards(&b, lower) } else { a };
            let to = if b.x > upper { a.towards(&b, upper) } else { b };
            if from.x == to.x && a.x != b.x {
                continue; // touches the range in one point only
            }
            if points.last() != Some(&from) {
                points.push(from);
            }
            points.push(to);
        }
        Profile { points }
    }

    /// First and last x [m]; `None` if there are no points.
    pub fn span(&self) -> Option<(f64, f64)> {
        Some((self.points.first()?.x, self.points.last()?.x))
    }
}

/// What stands out in an exact profile: the zones and levels that scoring looks at. All x are
/// in the coordinates of the profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landmarks {
    /// +1 where the shock runs towards +x, -1 where it runs towards -x.
    pub direction: f64,
    /// The struck face of the scored body [m].
    pub interface: f64,
    /// The scored body's other end [m].
    pub far_end: f64,
    /// The shock [m].
    pub shock: Option<f64>,
    /// Lower and upper x of the first plateau: from the head of the fan (from the interface,
    /// while there is no fan in the body) to the shock [m].
    pub plateau: Option<[f64; 2]>,
    /// Pressure of the first plateau [Pa].
    pub p2: f64,
    /// Density of the first plateau in the scored body [kg/m3].
    pub rho2: f64,
    /// Specific internal energy of the first plateau in the scored body [J/kg].
    pub e2: f64,
    /// Density behind the shock in the striking body [kg/m3]; NaN if there is none.
    pub rho2_flyer: f64,
    /// Specific internal energy behind the shock in the striking body [J/kg]; NaN if none.
    pub e2_flyer: f64,
    /// Lower and upper x where the pressure is within 0.3 % of P2 of the second plateau's [m].
    pub plateau_4: Option<[f64; 2]>,
    /// Pressure of the second plateau [Pa].
    pub p4: Option<f64>,
    /// Pressure directly behind the shock [Pa].
    pub behind_shock: f64,
}

/// The state of one place at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HistoryPoint {
    /// Time [s].
    pub t: f64,
    /// Place [m].
    pub x: f64,
    /// Velocity [m/s].
    pub u: f64,
    /// Pressure [Pa].
    pub p: f64,
}

/// States of one material point joined by straight lines in time; t is doubled at jumps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// The corners, by t.
    pub points: Vec<HistoryPoint>,
}

impl History {
    /// The state at `t`, the mean of both sides where it jumps; `None` outside.
    pub fn at(&self, t: f64) -> Option<HistoryPoint> {
        let as_profile = |h: &HistoryPoint| Point { x: h.t, p: h.p, u: h.u, rho: h.x, e: 0.0 };
        let from = self.points.partition_point(|h| h.t < t).saturating_sub(1);
        let after = (self.points.partition_point(|h| h.t <= t) + 1).min(self.points.len());
        let near = Profile { points: self.points[from..after].iter().map(as_profile).collect() };
        let q = near.at(t)?;
        Some(HistoryPoint { t, x: q.rho, u: q.u, p: q.p })
    }
}

/// What a path in the x-t diagram is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathKind {
    /// A shock.
    Shock,
    /// The head of a rarefaction fan, or of the wave that it was turned into.
    FanHead,
    /// The tail of a rarefaction fan, or of the wave that it was turned into.
    FanTail,
    /// The face of a plate on the other plate.
    Interface,
    /// A free surface.
    FreeSurface,
}

/// A line in the x-t diagram.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Whose plate it runs in.
    pub plate: super::Plate,
    /// What it is.
    pub kind: PathKind,
    /// The corners: time [s], place [m].
    pub points: Vec<[f64; 2]>,
    /// Whether it ends, as the edge of a fan, within its own wave, which has steepened.
    pub steepened: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f64, p: f64) -> Point {
        Point { x, p, ..Point::default() }
    }

    fn step() -> Profile {
        Profile { points: vec![point(0.0, 2.0), point(1.0, 4.0), point(1.0, 0.0), point(3.0, 0.0)] }
    }

    #[test]
    fn reads_lines_and_jumps() {
        let p = |x| step().at(x).map(|q| q.p);
        assert_eq!(p(0.0), Some(2.0));
        assert_eq!(p(0.5), Some(3.0));
        assert_eq!(p(1.0), Some(2.0));
        assert_eq!(p(3.0), Some(0.0));
        assert_eq!(p(3.1), None);
    }

    #[test]
    fn cuts_at_both_ends() {
        let cut = step().between(0.5, 2.0);
        let want = [point(0.5, 3.0), point(1.0, 4.0), point(1.0, 0.0), point(2.0, 0.0)];
        assert_eq!(cut.points, want);
        assert_eq!(step().between(1.0, 2.0).points, [point(1.0, 0.0), point(2.0, 0.0)]);
    }
}
