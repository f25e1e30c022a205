//! Piecewise-linear profiles in space and histories in time, and the features of profiles.
//!
//! This module knows no materials.

/// State at one position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProfilePoint {
    /// Eulerian position [m].
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

impl ProfilePoint {
    /// The state at `x`, interpolated linearly between `self` and `other`.
    fn towards(&self, other: &ProfilePoint, x: f64) -> ProfilePoint {
        let width = other.x - self.x;
        let w = if width > 0.0 { ((x - self.x) / width).clamp(0.0, 1.0) } else { 0.5 };
        let mix = |a: f64, b: f64| a + w * (b - a);
        ProfilePoint {
            x,
            p: mix(self.p, other.p),
            u: mix(self.u, other.u),
            rho: mix(self.rho, other.rho),
            e: mix(self.e, other.e),
        }
    }
}

/// Piecewise-linear states along x. x does not decrease; where the solution jumps, two points have
/// the same x.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Profile {
    /// Corner points, sorted by x.
    pub points: Vec<ProfilePoint>,
}

impl Profile {
    /// The state at `x` [m]; at a jump the mean of both sides; `None` outside of the profile.
    pub fn at(&self, x: f64) -> Option<ProfilePoint> {
        let (first, last) = self.span()?;
        if !(first..=last).contains(&x) {
            return None;
        }
        let after = self.points.partition_point(|q| q.x <= x);
        let from = self.points.partition_point(|q| q.x < x);
        if after > from {
            // x coincides with corners: the mean of the first and the last of them
            let (a, b) = (self.points[from], self.points[after - 1]);
            let mean = |f: fn(&ProfilePoint) -> f64| 0.5 * (f(&a) + f(&b));
            return Some(ProfilePoint {
                x,
                p: mean(|q| q.p),
                u: mean(|q| q.u),
                rho: mean(|q| q.rho),
                e: mean(|q| q.e),
            });
        }
        Some(self.points[after - 1].towards(&self.points[after], x))
    }

    /// The part between `lower` and `upper` [m]; its end points are interpolated linearly.
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

/// Features of an exact profile: the zones and levels that the scoring uses. All x are in the
/// coordinates of the profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landmarks {
    /// Direction of the shock [-]: +1 if it runs towards +x, -1 if it runs towards -x.
    pub direction: f64,
    /// Impact face of the scored body [m].
    pub interface: f64,
    /// Opposite end of the scored body [m].
    pub far_end: f64,
    /// Position of the shock [m].
    pub shock: Option<f64>,
    /// Lower and upper x of the first plateau [m]: from the head of the fan (from the interface,
    /// while the body has no fan) to the shock.
    pub plateau: Option<[f64; 2]>,
    /// Pressure of the first plateau [Pa].
    pub p2: f64,
    /// Density of the first plateau in the scored body [kg/m3].
    pub rho2: f64,
    /// Specific internal energy of the first plateau in the scored body [J/kg].
    pub e2: f64,
    /// Density behind the shock in the flyer [kg/m3]; NaN if there is none.
    pub rho2_flyer: f64,
    /// Specific internal energy behind the shock in the flyer [J/kg]; NaN if there is none.
    pub e2_flyer: f64,
    /// Lower and upper x of the range where the pressure differs from `p4` by at most 0.3 % of `p2`
    /// [m].
    pub second_plateau: Option<[f64; 2]>,
    /// Pressure of the second plateau [Pa].
    pub p4: Option<f64>,
    /// Pressure directly behind the shock [Pa].
    pub behind_shock: f64,
}

/// State of one material point at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HistoryPoint {
    /// Time [s].
    pub t: f64,
    /// Position [m].
    pub x: f64,
    /// Velocity [m/s].
    pub u: f64,
    /// Pressure [Pa].
    pub p: f64,
}

/// History of one material point, piecewise linear in time; at a jump, two points have the same t.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// Corner points, sorted by t.
    pub points: Vec<HistoryPoint>,
}

impl History {
    /// The state at `t` [s]; at a jump the mean of both sides; `None` outside of the history.
    pub fn at(&self, t: f64) -> Option<HistoryPoint> {
        let as_profile =
            |h: &HistoryPoint| ProfilePoint { x: h.t, p: h.p, u: h.u, rho: h.x, e: 0.0 };
        let from = self.points.partition_point(|h| h.t < t).saturating_sub(1);
        let after = (self.points.partition_point(|h| h.t <= t) + 1).min(self.points.len());
        let near = Profile { points: self.points[from..after].iter().map(as_profile).collect() };
        let q = near.at(t)?;
        Some(HistoryPoint { t, x: q.rho, u: q.u, p: q.p })
    }
}

/// One of the two plates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plate {
    /// The striking body.
    Flyer,
    /// The struck body, which is scored.
    Target,
}

/// Kind of a path in the x-t diagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathKind {
    /// A shock.
    Shock,
    /// The head of a rarefaction fan, or of the wave into which the fan was transformed.
    FanHead,
    /// The tail of a rarefaction fan, or of the wave into which the fan was transformed.
    FanTail,
    /// The contact face between the two plates.
    Interface,
    /// A free surface.
    FreeSurface,
}

/// A path in the x-t diagram.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Plate in which the path runs.
    pub plate: Plate,
    /// Kind of the path.
    pub kind: PathKind,
    /// Corner points: time [s], position [m].
    pub points: Vec<[f64; 2]>,
    /// Whether the path is an edge of a fan that ends inside its own wave, because the wave has
    /// steepened.
    pub steepened: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f64, p: f64) -> ProfilePoint {
        ProfilePoint { x, p, ..ProfilePoint::default() }
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
