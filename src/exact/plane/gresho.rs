//! Gresho's vortex: a gas that rotates on circles in a steady state, held by its own pressure.
//!
//! With a the radius of the greatest velocity V and xi = r/a:
//!
//! ```text
//! xi < 1: u = V xi,        p = p0 + rho V^2 xi^2/2
//! xi < 2: u = V (2 - xi),  p = p0 + rho V^2 (xi^2/2 + 4 (1 - xi + ln xi))
//! else:   u = 0,           p = p0 + rho V^2 (4 ln 2 - 2)
//! ```
//!
//! These satisfy dp/dr = rho u^2/r. Sources: Gresho & Chan (1990), Int. J. Numer. Meth. Fluids 11,
//! 621; as a test of gas codes Liska & Wendroff (2003), SIAM J. Sci. Comput. 25, 995, with
//! a = 0.2 m, V = 1 m/s, rho = 1 kg/m3, p0 = 5 Pa, gamma = 1.4. The pressure level is a free
//! parameter. Miczek (2013, thesis, Munich) sets it by a reference Mach number,
//! p0 = rho V^2/(gamma Ma^2): [`Gresho::with_mach`].

use std::f64::consts::{LN_2, TAU};

use super::{Vector, difference, length};
use crate::exact::{ExactError, finite, positive};

/// Gresho's vortex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gresho {
    /// Position of the centre [m].
    pub centre: Vector,
    /// Radius a of the greatest velocity [m]; the gas is at rest beyond 2 a.
    pub radius: f64,
    /// Greatest velocity V, counter-clockwise [m/s].
    pub speed: f64,
    /// Uniform density [kg/m3].
    pub density: f64,
    /// Pressure p0 at the centre [Pa].
    pub centre_pressure: f64,
    /// Ratio of specific heats [-].
    pub gamma: f64,
}

impl Default for Gresho {
    /// The vortex of Liska & Wendroff (2003).
    fn default() -> Gresho {
        Gresho {
            centre: [0.0, 0.0],
            radius: 0.2,
            speed: 1.0,
            density: 1.0,
            centre_pressure: 5.0,
            gamma: 1.4,
        }
    }
}

impl Gresho {
    /// Refuses constants that do not describe a gas or a vortex.
    ///
    /// # Errors
    ///
    /// The first constant that is out of range.
    pub fn check(&self) -> Result<(), ExactError> {
        finite("the vortex's centre", self.centre[0])?;
        finite("the vortex's centre", self.centre[1])?;
        positive("the vortex's radius", self.radius)?;
        positive("the vortex's speed", self.speed)?;
        positive("the gas's density", self.density)?;
        positive("the pressure in the centre", self.centre_pressure)?;
        if self.gamma > 1.0 && self.gamma.is_finite() {
            Ok(())
        } else {
            Err(ExactError::Number { name: "gamma", value: self.gamma, allowed: "above 1" })
        }
    }

    /// The same vortex with its pressure level set so that V over the sound speed at the centre is
    /// `mach` [-].
    ///
    /// # Errors
    ///
    /// If the Mach number or a constant of the vortex is out of range.
    pub fn with_mach(self, mach: f64) -> Result<Gresho, ExactError> {
        positive("the Mach number", mach)?;
        let centre_pressure = self.density * self.speed * self.speed / (self.gamma * mach * mach);
        let vortex = Gresho { centre_pressure, ..self };
        vortex.check()?;
        Ok(vortex)
    }

    /// Reference Mach number: V over the sound speed at the centre [-].
    pub fn mach(&self) -> f64 {
        self.speed / (self.gamma * self.centre_pressure / self.density).sqrt()
    }

    /// Velocity along the circle of radius `r`, counter-clockwise [m/s].
    pub fn hoop_velocity(&self, r: f64) -> f64 {
        let xi = r / self.radius;
        self.speed * xi.min(2.0 - xi).max(0.0)
    }

    /// Pressure at the distance `r` from the centre [Pa].
    pub fn pressure(&self, r: f64) -> f64 {
        let xi = (r / self.radius).min(2.0);
        let rise = if xi < 1.0 {
            0.5 * xi * xi
        } else if xi < 2.0 {
            0.5 * xi * xi + 4.0 * (1.0 - xi + xi.ln())
        } else {
            4.0 * LN_2 - 2.0
        };
        self.centre_pressure + self.density * self.speed * self.speed * rise
    }

    /// Specific internal energy at the distance `r`, p/((gamma - 1) rho) [J/kg].
    pub fn energy(&self, r: f64) -> f64 {
        self.pressure(r) / ((self.gamma - 1.0) * self.density)
    }

    /// Velocity at the position `x` [m/s].
    pub fn velocity(&self, x: Vector) -> Vector {
        let [rx, ry] = difference(x, self.centre);
        let omega = self.turn_rate(length([rx, ry]));
        [-omega * ry, omega * rx]
    }

    /// Position at `t` of the material point that started at `reference` [m].
    pub fn position(&self, reference: Vector, t: f64) -> Vector {
        let from = difference(reference, self.centre);
        let [rx, ry] = super::turn(from, self.turn_rate(length(from)) * t);
        [self.centre[0] + rx, self.centre[1] + ry]
    }

    /// Angular velocity u/r at the distance `r` [rad/s].
    fn turn_rate(&self, r: f64) -> f64 {
        // the core rotates as a rigid body, also at its centre
        if r < self.radius { self.speed / self.radius } else { self.hoop_velocity(r) / r }
    }

    /// Time of one revolution of the core, 2 pi a/V [s].
    pub fn turn_time(&self) -> f64 {
        TAU * self.radius / self.speed
    }

    /// Rms error of the velocity over V [-], from particles (position [m], velocity [m/s], volume)
    /// within 2 a of the centre; `None` if there are none.
    pub fn velocity_error(
        &self,
        particles: impl IntoIterator<Item = (Vector, Vector, f64)>,
    ) -> Option<f64> {
        self.rms(particles, |x, v: Vector| super::square(difference(v, self.velocity(x))))
            .map(|rms| rms / self.speed)
    }

    /// Rms error of the pressure over rho V^2/2, its rise from the centre to r = a [-], from
    /// particles (position [m], pressure [Pa], volume) within 2 a of the centre; `None` if there
    /// are none. To compare only the shape, correct the pressure level first.
    pub fn pressure_error(
        &self,
        particles: impl IntoIterator<Item = (Vector, f64, f64)>,
    ) -> Option<f64> {
        let exact = |x| self.pressure(length(difference(x, self.centre)));
        let rise = 0.5 * self.density * self.speed * self.speed;
        self.rms(particles, |x, p: f64| (p - exact(x)).powi(2)).map(|rms| rms / rise)
    }

    fn rms<T>(
        &self,
        particles: impl IntoIterator<Item = (Vector, T, f64)>,
        squared: impl Fn(Vector, T) -> f64,
    ) -> Option<f64> {
        let (mut sum, mut total) = (0.0, 0.0);
        for (x, value, volume) in particles {
            if length(difference(x, self.centre)) < 2.0 * self.radius {
                sum += volume * squared(x, value);
                total += volume;
            }
        }
        (total > 0.0).then(|| (sum / total).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64, by: f64) {
        assert!((a - b).abs() <= by, "{a} {b}");
    }

    fn other() -> Gresho {
        let centre = [0.3, -0.1];
        let g = Gresho { centre, radius: 0.5, speed: 3.0, density: 2.0, ..Gresho::default() };
        g.with_mach(0.1).unwrap()
    }

    #[test]
    fn has_the_papers_form() {
        let g = Gresho::default();
        g.check().unwrap();
        for (r, u, p) in [
            (0.1, 0.5, 5.0 + 12.5 * 0.01),
            (0.3, 0.5, 9.0 + 12.5 * 0.09 - 20.0 * 0.3 + 4.0 * 1.5f64.ln()),
            (0.5, 0.0, 3.0 + 4.0 * LN_2),
        ] {
            close(g.hoop_velocity(r), u, 1e-14);
            close(g.pressure(r), p, 1e-14);
        }
        close(g.turn_time(), 0.4 * std::f64::consts::PI, 1e-15);
    }

    #[test]
    fn pressure_holds_the_gas_on_its_circles() {
        for g in [Gresho::default(), other()] {
            let h = 1e-6;
            for xi in [0.0, 0.3, 0.99, 1.01, 1.4, 1.99, 2.01, 3.0] {
                let r = xi * g.radius + 2.0 * h;
                let slope = (g.pressure(r + h) - g.pressure(r - h)) / (2.0 * h);
                let u = g.hoop_velocity(r);
                close(slope, g.density * u * u / r, 1e-5 * g.density * g.speed.powi(2) / g.radius);
            }
            // no jumps
            for edge in [1.0, 2.0] {
                let (a, b) = (edge * g.radius * (1.0 - 1e-13), edge * g.radius * (1.0 + 1e-13));
                close(g.pressure(a), g.pressure(b), 1e-11 * g.pressure(a));
                close(g.hoop_velocity(a), g.hoop_velocity(b), 1e-11);
            }
        }
    }

    #[test]
    fn mach_number_is_what_was_asked_for() {
        let g = other();
        close(g.mach(), 0.1, 1e-14);
        let c = (1.4 * 0.4 * g.energy(0.0)).sqrt();
        close(g.speed / c, 0.1, 1e-14);
        close(Gresho::default().mach(), (1.0f64 / 7.0).sqrt(), 1e-14);
        assert!(g.with_mach(0.0).is_err());
        assert!(Gresho { gamma: 1.0, ..g }.check().is_err());
    }

    #[test]
    fn particles_move_at_the_velocity() {
        let (g, h) = (other(), 1e-5);
        for x in [[0.3, -0.1], [0.5, 0.1], [0.9, 0.3], [2.0, 2.0]] {
            let at = |t| g.position(x, t);
            for k in 0..2 {
                close((at(0.7 + h)[k] - at(0.7 - h)[k]) / (2.0 * h), g.velocity(at(0.7))[k], 1e-7);
            }
            close(length(difference(at(0.7), g.centre)), length(difference(x, g.centre)), 1e-14);
        }
        // the core returns after one revolution
        let back = g.position([0.5, 0.1], g.turn_time());
        close(back[0], 0.5, 1e-14);
    }

    #[test]
    fn errors_of_known_faults() {
        let g = other();
        let places = (0..400).map(|k| {
            let (r, angle) = (0.004 * f64::from(k), 2.4 * f64::from(k));
            [0.3 + r * angle.cos(), -0.1 + r * angle.sin()]
        });
        let r = |x: Vector| length(difference(x, g.centre));
        let fast = places.clone().map(|x| (x, g.velocity(x).map(|v| v + 0.3), 1.0 + r(x)));
        close(g.velocity_error(fast).unwrap(), 0.1 * 2f64.sqrt(), 1e-13);
        let high = places.map(|x| (x, g.pressure(r(x)) + 0.9, 1.0));
        close(g.pressure_error(high).unwrap(), 0.1, 1e-10);
        assert!(g.pressure_error([([9.0, 9.0], 1.0, 1.0)]).is_none());
    }
}
