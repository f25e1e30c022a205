//! Plates that separate: a flyer of lower impedance than its target.
//!
//! The fan from the flyer's rear lowers the pressure on the interface. The flyer's free state has
//! u < 0, below the target's, so the pressure reaches 0 within the fan. Plates that do not stick
//! separate at that time. The rest of the fan then runs into the flyer's face, which is now free,
//! and the target's face moves at the velocity of its own release to P = 0. The waves left in the
//! flyer steepen and return to its face repeatedly, so the gap does not grow linearly. The solution
//! holds until the plates meet again, if they ever do.
//!
//! Source of the states: the release isentropes of [`crate::exact::release`]. All other values are
//! read from front tracking ([`Impact::solve`]), whose snapshots also contain the profiles after
//! separation. Errors against the method of characteristics at the default accuracy: 2e-6 in the
//! time of separation, 2e-5 in the pressure and velocity of the interface (at the fan's head and at
//! separation itself 1e-3, a quarter of a front). Both decrease as the square of the number of
//! fronts. The gap at 0.5 us of aluminium at 1500 m/s on copper (0.5 mm) is accurate to 1 nm.

use crate::exact::{Accuracy, ExactError, History, Impact, Solution};

/// Motion of the faces of two plates that separate.
#[derive(Clone, Debug, PartialEq)]
pub struct Separation {
    /// Time of contact [s].
    pub contact_time: f64,
    /// Pressure P2 after contact [Pa].
    pub peak_pressure: f64,
    /// Time at which the head of the fan returns to the interface [s].
    pub head_time: f64,
    /// Time at which the pressure on the interface reaches 0 and the plates separate [s].
    pub separation_time: f64,
    /// The flyer's face.
    pub flyer_face: History,
    /// The target's face.
    pub target_face: History,
    /// +1 if the target is on the side of +x.
    direction: f64,
}

impl Separation {
    /// Follows `impact` to the time `until` [s]; `None` if the plates do not separate before.
    ///
    /// # Errors
    ///
    /// As [`Impact::solve`].
    pub fn new(
        impact: &Impact,
        until: f64,
        accuracy: Accuracy,
    ) -> Result<Option<Separation>, ExactError> {
        Ok(Separation::from_solution(impact, &impact.solve(&[until], &[], accuracy)?))
    }

    /// The same from an existing solution, up to the end of that solution.
    pub fn from_solution(impact: &Impact, solution: &Solution) -> Option<Separation> {
        Some(Separation {
            contact_time: impact.contact_time,
            peak_pressure: solution.release.states.first()?.p,
            head_time: impact.contact_time + solution.release.head_time,
            separation_time: solution.separation_time?,
            flyer_face: solution.flyer_face.clone(),
            target_face: solution.interface.clone(),
            direction: if impact.mirrored { -1.0 } else { 1.0 },
        })
    }

    /// Pressure between the plates at `t` [Pa]; 0 before contact and after separation. `None` after
    /// the end of the solution.
    pub fn interface_pressure(&self, t: f64) -> Option<f64> {
        let p = self.target_face.at(t)?.p;
        Some(if t < self.contact_time || t >= self.separation_time { 0.0 } else { p })
    }

    /// Time at which the pressure between the plates has fallen to `share` of P2, 0 <= share <= 1
    /// [s]. Compare a run that defines contact as more than 1 % of P2 with `falls_to(0.01)`.
    pub fn falls_to(&self, share: f64) -> f64 {
        let level = share * self.peak_pressure;
        let corners = &self.target_face.points;
        let from = corners.partition_point(|h| h.t < self.head_time);
        let crossing = corners[from..].windows(2).find(|w| w[0].p >= level && w[1].p < level);
        let t = crossing.map_or(self.separation_time, |w| {
            w[0].t + (w[1].t - w[0].t) * (w[0].p - level) / (w[0].p - w[1].p)
        });
        t.min(self.separation_time)
    }

    /// Width of the gap between the faces at `t` [m], also before contact; 0 in contact. `None`
    /// after the end of the solution.
    pub fn gap(&self, t: f64) -> Option<f64> {
        let touch = (self.contact_time..=self.separation_time).contains(&t);
        let width = self.target_face.at(t)?.x - self.flyer_face.at(t)?.x;
        Some(if touch { 0.0 } else { self.direction * width })
    }

    /// Velocities of the flyer's face and of the target's at `t` [m/s].
    pub fn face_velocities(&self, t: f64) -> Option<[f64; 2]> {
        Some([self.flyer_face.at(t)?.u, self.target_face.at(t)?.u])
    }

    /// Error of a computed time of separation, relative to the time since contact [-], signed;
    /// `share` of P2 is the pressure that the run takes as the limit of contact.
    pub fn time_error(&self, computed: f64, share: f64) -> f64 {
        let exact = self.falls_to(share);
        (computed - exact) / (exact - self.contact_time)
    }

    /// Error of a gap computed at `t`, relative to the exact gap [-], signed; `None` while the
    /// plates touch.
    pub fn gap_error(&self, computed: f64, t: f64) -> Option<f64> {
        let exact = self.gap(t)?;
        (exact > 0.0).then(|| computed / exact - 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::ImpactBody;
    use crate::exact::samples::{ALUMINIUM, COPPER};

    fn impact() -> Impact {
        let body =
            |material, lower, upper, velocity| ImpactBody { material, lower, upper, velocity };
        let flyer = body(ALUMINIUM, -0.5e-3, 0.0, 1500.0);
        Impact::new(flyer, body(COPPER, 0.0, 8e-3, 0.0)).unwrap()
    }

    fn parting(until: f64, wavelets: usize) -> Separation {
        Separation::new(&impact(), until, Accuracy { wavelets }).unwrap().unwrap()
    }

    fn close(a: f64, b: f64, by: f64) {
        assert!((a - b).abs() <= by, "{a} {b}");
    }

    #[test]
    fn aluminium_on_copper() {
        let s = parting(0.6e-6, Accuracy::default().wavelets);
        let fine = parting(0.6e-6, 960);
        println!("{:e} {:e} {:e}", s.falls_to(0.01), fine.falls_to(0.01), s.separation_time);
        println!("{:e} {:e}", s.gap(0.5e-6).unwrap(), fine.gap(0.5e-6).unwrap());
        close(s.separation_time, 0.156599e-6, 1e-12);
        // 1 % of P2 is left shortly before separation; the time increases as the level decreases
        assert!(s.falls_to(0.01) < s.separation_time && s.falls_to(0.02) < s.falls_to(0.01));
        close(s.falls_to(0.01), fine.falls_to(0.01), 5e-12);
        assert_eq!(s.falls_to(0.0), s.separation_time);
        close(s.falls_to(1.0), s.head_time, 2e-11);
        close(s.gap(0.5e-6).unwrap(), 181.925e-6, 2e-9);
        close(s.gap(0.5e-6).unwrap(), fine.gap(0.5e-6).unwrap(), 2e-9);
        assert_eq!(s.gap(0.12e-6), Some(0.0));
        close(s.interface_pressure(0.1e-6).unwrap(), s.peak_pressure, 1e-3);
        assert_eq!(s.interface_pressure(0.2e-6), Some(0.0));
        assert!(s.gap(0.7e-6).is_none());
    }

    #[test]
    fn gap_is_the_distance_of_the_profiles() {
        let times = [0.2e-6, 0.3e-6, 0.4e-6, 0.5e-6, 0.6e-6];
        let solution = impact().solve(&times, &[], Accuracy::default()).unwrap();
        let s = Separation::from_solution(&impact(), &solution).unwrap();
        for snapshot in &solution.snapshots {
            let all = &snapshot.profile.as_ref().unwrap().points;
            let target = &snapshot.target.as_ref().unwrap().points;
            let face = all[all.len() - target.len() - 1];
            let gap = target[0].x - face.x;
            close(s.gap(snapshot.time).unwrap(), gap, 5e-9);
            // both faces are free
            close(target[0].p, 0.0, 1.0);
            close(face.p, 0.0, 1.0);
            // the target's face keeps the velocity of its release
            let free = solution.release.state(4).unwrap().u;
            close(s.face_velocities(snapshot.time).unwrap()[1], free, 2e-3);
        }
    }

    #[test]
    fn the_gap_is_the_integral_of_the_velocities() {
        let s = parting(0.6e-6, Accuracy::default().wavelets);
        let (from, to, n) = (0.158e-6, 0.6e-6, 100_000);
        let dt = (to - from) / f64::from(n);
        let opening = |k: i32| {
            let [flyer, target] = s.face_velocities(from + dt * (f64::from(k) + 0.5)).unwrap();
            (target - flyer) * dt
        };
        let opened: f64 = (0..n).map(opening).sum();
        close(opened, s.gap(to).unwrap() - s.gap(from).unwrap(), 5e-10);
    }

    #[test]
    fn errors_are_relative_and_signed() {
        let s = parting(0.6e-6, 60);
        close(s.time_error(1.01 * s.separation_time, 0.0), 0.01, 1e-12);
        close(s.gap_error(0.99 * s.gap(0.5e-6).unwrap(), 0.5e-6).unwrap(), -0.01, 1e-12);
        assert!(s.gap_error(1e-6, 0.1e-6).is_none());
    }

    #[test]
    fn a_harder_flyer_stays() {
        let body =
            |material, lower, upper, velocity| ImpactBody { material, lower, upper, velocity };
        let flyer = body(COPPER, -0.5e-3, 0.0, 1000.0);
        let impact = Impact::new(flyer, body(ALUMINIUM, 0.0, 8e-3, 0.0)).unwrap();
        assert_eq!(Separation::new(&impact, 0.4e-6, Accuracy { wavelets: 60 }), Ok(None));
    }

    #[test]
    fn a_mirrored_impact_after_a_gap_parts_likewise() {
        let here = parting(0.5e-6, 60);
        let distance = 0.15e-3;
        let body =
            |material, lower, upper, velocity| ImpactBody { material, lower, upper, velocity };
        let flyer = body(ALUMINIUM, distance, distance + 0.5e-3, -1450.0);
        let impact = Impact::new(flyer, body(COPPER, -8e-3, 0.0, 50.0)).unwrap();
        let there = Separation::new(&impact, 0.6e-6, Accuracy { wavelets: 60 }).unwrap().unwrap();
        close(there.contact_time, 0.1e-6, 1e-15);
        close(there.separation_time, here.separation_time + 0.1e-6, 1e-15);
        close(there.gap(0.05e-6).unwrap(), 0.5 * distance, 1e-15);
        for t in [0.14e-6, 0.2e-6, 0.35e-6, 0.5e-6] {
            close(there.gap(t + 0.1e-6).unwrap(), here.gap(t).unwrap(), 1e-12);
        }
    }
}
