//! The time until which a flyer of finite width strikes like an infinitely wide one.
//!
//! At contact the edge of the flyer starts to release the material that the shock has compressed.
//! In material that has moved only along the axis, the head of this release is a circle around the
//! edge on the interface. It grows at the sound speed c2 of state 2. With a the half width:
//!
//! ```text
//! centre line:   t = a/c2                          first reached on the interface
//! shock front:   t = a/sqrt(c2^2 - (Us - u2)^2)    its centre, in a target
//! ```
//!
//! Source of the second: Al'tshuler, Kormer, Brazhnik, Vladimirov, Speranskaya & Funtikov (1960),
//! Sov. Phys. JETP 11, 766. Release lowers the sound speed, so no sound speed exceeds c2. Before
//! a/c2, with the larger c2 of the two bodies, the centre line is therefore exactly
//! one-dimensional, independent of the release from the flyer's rear. This holds for plane strain
//! and for a disk of radius a. It neglects strength, with which the head runs at the longitudinal
//! elastic speed.

use crate::exact::{ExactError, Impact, Plate, positive};
use crate::material::{EquationOfState, MieGruneisen};

/// The release from the edge of a flyer of finite width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeRelease {
    /// Half width, or radius, of the flyer [m].
    pub half_width: f64,
    /// Time of contact [s].
    pub contact_time: f64,
    /// Sound speed of state 2 in the flyer [m/s].
    pub flyer_sound_speed: f64,
    /// Sound speed of state 2 in the target [m/s].
    pub target_sound_speed: f64,
    /// Speed Us - u2 of the target's shock relative to the material behind it [m/s].
    pub shock_gain: f64,
}

/// Eulerian sound speed [m/s] of `material` behind a shock, at density `rho` [kg/m3] and pressure
/// `p` [Pa].
pub fn sound_speed_behind(material: &MieGruneisen, rho: f64, p: f64) -> f64 {
    material.sound_speed_squared(material.rho0 / rho, p).sqrt()
}

impl EdgeRelease {
    /// The edge release of a flyer of `half_width` [m] that strikes a target at least as wide.
    ///
    /// # Errors
    ///
    /// If the half width is not positive and finite, or if a material cannot reach a state.
    pub fn new(impact: &Impact, half_width: f64) -> Result<EdgeRelease, ExactError> {
        positive("the flyer's half width", half_width)?;
        let release = impact.release(4)?;
        let (p2, u2) = (release.states[0].p, release.states[0].u);
        let speed = |plate| {
            let (rho, _) = release.plateau(plate);
            let body = if plate == Plate::Flyer { &impact.flyer } else { &impact.target };
            sound_speed_behind(&body.material, rho, p2)
        };
        Ok(EdgeRelease {
            half_width,
            contact_time: impact.contact_time,
            flyer_sound_speed: speed(Plate::Flyer),
            target_sound_speed: speed(Plate::Target),
            shock_gain: release.target_shock - u2,
        })
    }

    /// The larger of the two sound speeds [m/s].
    fn fastest(&self) -> f64 {
        self.flyer_sound_speed.max(self.target_sound_speed)
    }

    /// Time at which the release reaches the centre line, on the interface [s]; until then the
    /// whole centre line is as in one dimension.
    pub fn centre_time(&self) -> f64 {
        self.contact_time + self.half_width / self.fastest()
    }

    /// Time at which the release in the target reaches the centre of the shock front [s].
    pub fn shock_centre_time(&self) -> f64 {
        self.contact_time + self.half_width / self.along_front()
    }

    /// Speed of the release along the target's shock front [m/s].
    pub fn along_front(&self) -> f64 {
        let (c, w) = (self.target_sound_speed, self.shock_gain);
        (c * c - w * w).sqrt()
    }

    /// Half width of the part that is as in one dimension at `t`, at any depth [m].
    pub fn untouched_half_width(&self, t: f64) -> f64 {
        (self.half_width - self.fastest() * (t - self.contact_time).max(0.0)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::ImpactBody;
    use crate::exact::isentrope::to_compression;
    use crate::exact::samples::{ALUMINIUM, COPPER};
    use crate::exact::wave::{density, shocked};

    fn close(a: f64, b: f64, by: f64) {
        assert!((a - b).abs() <= by, "{a} {b}");
    }

    fn standard(gap: f64) -> Impact {
        let body =
            |material, lower, upper, velocity| ImpactBody { material, lower, upper, velocity };
        let flyer = body(COPPER, -0.5e-3 - gap, -gap, 1000.0);
        Impact::new(flyer, body(ALUMINIUM, 0.0, 8e-3, 0.0)).unwrap()
    }

    #[test]
    fn sound_speeds_of_the_standard_problem() {
        let edge = EdgeRelease::new(&standard(0.0), 2e-3).unwrap();
        close(edge.target_sound_speed, 6418.0, 0.05);
        // the Lagrangian speeds of the head of the fan, times rho0/rho2
        close(edge.target_sound_speed, 7207.040 * 2785.0 / 3127.380, 2e-3);
        close(edge.flyer_sound_speed, 4855.239 * 8930.0 / 9604.616, 2e-3);
        close(edge.centre_time(), 2e-3 / edge.target_sound_speed, 1e-18);
        close(edge.shock_gain, 6311.163 - 690.936, 1e-3);
    }

    #[test]
    fn sound_speed_is_the_slope_of_the_isentrope() {
        let top = shocked(&ALUMINIUM, 690.935777);
        let near = |d: f64| {
            let q = to_compression(&ALUMINIUM, top, 1.0, top.chi + d).unwrap();
            (q.p, density(&ALUMINIUM, &q))
        };
        let ((p, rho), (q, sigma)) = (near(1e-4), near(-1e-4));
        let c = sound_speed_behind(&ALUMINIUM, density(&ALUMINIUM, &top), top.p);
        close(c * c / ((p - q) / (rho - sigma)), 1.0, 1e-6);
    }

    #[test]
    fn the_circle_meets_the_front_when_it_says() {
        // in the frame of the shocked target the front is at (Us - u2) t, and the intersection of
        // the circle with it is a - along_front t off the axis
        let edge = EdgeRelease::new(&standard(0.0), 2e-3).unwrap();
        let t = edge.shock_centre_time();
        let radius = (edge.shock_gain * t).hypot(edge.half_width);
        close(radius, edge.target_sound_speed * t, 1e-12);
        // the release reaches the front's centre later than the interface's
        assert!(t > edge.centre_time());
    }

    #[test]
    fn a_gap_delays_and_the_width_shrinks() {
        let (a, b) = (
            EdgeRelease::new(&standard(0.0), 2e-3).unwrap(),
            EdgeRelease::new(&standard(0.1e-3), 2e-3).unwrap(),
        );
        close(b.centre_time() - a.centre_time(), 0.1e-6, 1e-15);
        close(b.untouched_half_width(0.05e-6), 2e-3, 0.0);
        close(a.untouched_half_width(0.5 * a.centre_time()), 1e-3, 1e-15);
        assert_eq!(a.untouched_half_width(1.0), 0.0);
        assert!(EdgeRelease::new(&standard(0.0), 0.0).is_err());
    }
}
