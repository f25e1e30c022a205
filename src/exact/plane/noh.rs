//! Noh's problem: a cold gas flows towards a plane, an axis or a point, and a shock runs outward.
//!
//! With n = 1, 2, 3 converging dimensions, and gas at rho0 and e = 0 that flows inward at v:
//!
//! ```text
//! shock:   r_s = D t,  D = (gamma - 1) v/2
//! r < r_s: rho = rho0 ((gamma + 1)/(gamma - 1))^n, u = 0, e = v^2/2, p = (gamma - 1) rho e
//! r > r_s: rho = rho0 (1 + v t/r)^(n-1),           u = -v, e = 0, p = 0
//! ```
//!
//! Source: Noh (1987), J. Comput. Phys. 72, 78. Velocities are radial, positive outward; r is the
//! distance from the centre. A run in a finite domain follows the solution until the signal from
//! the outer boundary arrives, or throughout if that boundary prescribes the state ahead.

use super::{Vector, length};
use crate::exact::{ExactError, Profile, ProfilePoint, positive};

/// Geometry of the implosion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symmetry {
    /// A plane: one dimension.
    Planar,
    /// An axis: two dimensions.
    Cylindrical,
    /// A point: three dimensions.
    Spherical,
}

impl Symmetry {
    /// The number n of converging dimensions.
    pub fn dimensions(self) -> i32 {
        match self {
            Symmetry::Planar => 1,
            Symmetry::Cylindrical => 2,
            Symmetry::Spherical => 3,
        }
    }
}

/// Noh's problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noh {
    /// Geometry of the implosion.
    pub symmetry: Symmetry,
    /// Ratio of specific heats [-].
    pub gamma: f64,
    /// Density at t = 0 [kg/m3].
    pub density: f64,
    /// Inward speed v [m/s].
    pub speed: f64,
}

/// Number of straight pieces that represent the density ahead of the shock.
const PIECES: usize = 512;

impl Noh {
    /// Noh's problem for a gas with the ratio of specific heats `gamma` [-], the initial `density`
    /// [kg/m3] and the initial `speed` towards the centre [m/s]. Refuses constants that do not
    /// describe a gas.
    ///
    /// # Errors
    ///
    /// The first constant that is out of range.
    pub fn new(
        symmetry: Symmetry,
        gamma: f64,
        density: f64,
        speed: f64,
    ) -> Result<Noh, ExactError> {
        positive("the gas's density", density)?;
        positive("the gas's speed", speed)?;
        if !(gamma > 1.0 && gamma.is_finite()) {
            return Err(ExactError::Number { name: "gamma", value: gamma, allowed: "above 1" });
        }
        Ok(Noh { symmetry, gamma, density, speed })
    }

    /// Speed D of the shock [m/s].
    pub fn shock_speed(&self) -> f64 {
        0.5 * (self.gamma - 1.0) * self.speed
    }

    /// Distance of the shock from the centre at time `t` [m].
    pub fn shock_position(&self, t: f64) -> f64 {
        self.shock_speed() * t
    }

    /// Density behind the shock [kg/m3].
    pub fn density_behind(&self) -> f64 {
        let jump = (self.gamma + 1.0) / (self.gamma - 1.0);
        self.density * jump.powi(self.symmetry.dimensions())
    }

    /// Pressure behind the shock [Pa].
    pub fn pressure_behind(&self) -> f64 {
        0.5 * (self.gamma - 1.0) * self.density_behind() * self.speed * self.speed
    }

    /// The gas at the distance `r` >= 0 [m] and time `t` >= 0 [s]; `x` of the point is r, `u` the
    /// radial velocity. At the shock itself the state is the one behind it.
    pub fn at(&self, r: f64, t: f64) -> ProfilePoint {
        if t > 0.0 && r <= self.shock_position(t) { self.behind(r) } else { self.ahead(r, t) }
    }

    fn behind(&self, r: f64) -> ProfilePoint {
        ProfilePoint {
            x: r,
            p: self.pressure_behind(),
            u: 0.0,
            rho: self.density_behind(),
            e: 0.5 * self.speed * self.speed,
        }
    }

    fn ahead(&self, r: f64, t: f64) -> ProfilePoint {
        // the shock leaves the centre at once, so there is no gas ahead at r = 0 for t > 0
        let gathered = if t > 0.0 { self.speed * t / r } else { 0.0 };
        let rho = self.density * (1.0 + gathered).powi(self.symmetry.dimensions() - 1);
        ProfilePoint { x: r, p: 0.0, u: -self.speed, rho, e: 0.0 }
    }

    /// Velocity at `place`, relative to the centre, in the plane normal to the axis [m/s].
    pub fn velocity(&self, place: Vector, t: f64) -> Vector {
        let r = length(place);
        if r > 0.0 { place.map(|c| self.at(r, t).u * c / r) } else { [0.0, 0.0] }
    }

    /// Mass within the distance `r` at time `t`, divided by 1, 2 pi or 4 pi: plane (per area of one
    /// side) [kg/m2], cylinder (per length) [kg/m], sphere [kg].
    pub fn mass_within(&self, r: f64, t: f64) -> f64 {
        let n = self.symmetry.dimensions();
        let scale = 1.0 / f64::from(n);
        if r <= self.shock_position(t) {
            self.density_behind() * r.powi(n) * scale
        } else {
            // the gas within r was within r + v t at t = 0
            self.density * (r + self.speed * t).powi(n) * scale
        }
    }

    /// Volume-averaged density between the distances `from` < `to` [kg/m3].
    pub fn mean_density(&self, from: f64, to: f64, t: f64) -> f64 {
        let n = self.symmetry.dimensions();
        let volume = (to.powi(n) - from.powi(n)) / f64::from(n);
        (self.mass_within(to, t) - self.mass_within(from, t)) / volume
    }

    /// The gas from the centre to the distance `outer` [m] at `t` > 0 [s]: straight lines between
    /// points that are closer together near the shock.
    pub fn profile(&self, t: f64, outer: f64) -> Profile {
        let shock = self.shock_position(t);
        if !(shock > 0.0 && shock < outer) {
            return Profile { points: vec![self.at(0.0, t), self.at(outer, t)] };
        }
        let mut points = vec![self.behind(0.0), self.behind(shock)];
        let growth = (outer / shock).ln() / PIECES as f64;
        points.extend((0..PIECES).map(|k| self.ahead(shock * (growth * k as f64).exp(), t)));
        points.push(self.ahead(outer, t));
        Profile { points }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::{WallImpactSolution, WallMaterial};

    const ALL: [Symmetry; 3] = [Symmetry::Planar, Symmetry::Cylindrical, Symmetry::Spherical];

    fn noh(symmetry: Symmetry) -> Noh {
        Noh::new(symmetry, 5.0 / 3.0, 1.0, 1.0).unwrap()
    }

    fn close(a: f64, b: f64, by: f64) {
        assert!((a - b).abs() <= by, "{a} {b}");
    }

    #[test]
    fn nohs_own_numbers() {
        for (symmetry, rho) in ALL.into_iter().zip([4.0, 16.0, 64.0]) {
            let gas = noh(symmetry);
            close(gas.density_behind(), rho, 1e-12 * rho);
            close(gas.pressure_behind(), rho / 3.0, 1e-12 * rho);
            close(gas.shock_position(0.6), 0.2, 1e-15);
            // density directly ahead: 1, 4, 16
            close(gas.at(0.2 * (1.0 + 1e-12), 0.6).rho, rho / 4.0, 1e-9);
        }
    }

    #[test]
    fn planar_is_the_wall() {
        let gas = Noh::new(Symmetry::Planar, 1.4, 2.0, 3.0).unwrap();
        let material = WallMaterial::IdealGas { gamma: 1.4, rho: 2.0, e: 0.0 };
        let wall = WallImpactSolution::new(material, 0.0, 1.0, -3.0, true, 0.0).unwrap();
        close(gas.pressure_behind(), wall.p, 1e-12 * wall.p);
        close(gas.density_behind(), wall.rho, 1e-12 * wall.rho);
        close(gas.shock_speed(), wall.shock_speed - 3.0, 1e-14);
    }

    #[test]
    fn shock_keeps_the_jump_conditions() {
        for symmetry in ALL {
            let gas = Noh::new(symmetry, 1.4, 2.0, 3.0).unwrap();
            let (t, d) = (0.7, gas.shock_speed());
            let r = gas.shock_position(t);
            let (behind, ahead) = (gas.at(r, t), gas.at(r * (1.0 + 1e-14), t));
            let total = |q: &ProfilePoint| q.rho * (q.e + 0.5 * q.u * q.u);
            let fluxes = |q: &ProfilePoint| {
                let w = q.u - d;
                [q.rho * w, q.rho * q.u * w + q.p, total(q) * w + q.p * q.u]
            };
            for (a, b) in fluxes(&behind).into_iter().zip(fluxes(&ahead)) {
                close(a, b, 1e-10 * b.abs());
            }
        }
    }

    #[test]
    fn keeps_mass_ahead_of_the_shock() {
        // d rho/dt + r^(1-n) d(r^(n-1) rho u)/dr = 0
        for symmetry in ALL {
            let (gas, n, h) = (noh(symmetry), symmetry.dimensions(), 1e-4);
            for (r, t) in [(0.5, 0.6), (0.3, 0.1), (2.0, 0.9)] {
                let rate = (gas.at(r, t + h).rho - gas.at(r, t - h).rho) / (2.0 * h);
                let flux = |r: f64| r.powi(n - 1) * gas.at(r, t).rho * gas.at(r, t).u;
                let slope = (flux(r + h) - flux(r - h)) / (2.0 * h) / r.powi(n - 1);
                close(rate + slope, 0.0, 1e-6);
            }
        }
    }

    #[test]
    fn mean_density_is_the_integral_of_the_profile() {
        for symmetry in ALL {
            let (gas, n, t) = (noh(symmetry), symmetry.dimensions(), 0.6);
            for (from, to) in [(0.05, 0.16), (0.1, 0.4), (0.3, 0.9)] {
                let cells = 20_000;
                let width = (to - from) / f64::from(cells);
                let (mut mass, mut volume) = (0.0, 0.0);
                for k in 0..cells {
                    let r = from + width * (f64::from(k) + 0.5);
                    mass += gas.at(r, t).rho * r.powi(n - 1);
                    volume += r.powi(n - 1);
                }
                close(gas.mean_density(from, to, t) / (mass / volume), 1.0, 1e-4);
            }
            let profile = gas.profile(t, 1.0);
            assert_eq!(profile.span(), Some((0.0, 1.0)));
            for r in [0.1, 0.21, 0.5, 0.99] {
                close(profile.at(r).unwrap().rho, gas.at(r, t).rho, 1e-4);
            }
        }
        // before any shock the density is the initial one
        close(noh(Symmetry::Spherical).mean_density(0.0, 0.5, 0.0), 1.0, 1e-14);
    }

    #[test]
    fn velocity_points_inward() {
        let gas = noh(Symmetry::Cylindrical);
        let [x, y] = gas.velocity([0.3, -0.4], 0.3);
        close(x, -0.6, 1e-15);
        close(y, 0.8, 1e-15);
        assert_eq!(gas.velocity([0.05, 0.0], 0.6), [0.0, 0.0]);
        assert!(Noh::new(Symmetry::Planar, 1.0, 1.0, 1.0).is_err());
        assert!(Noh::new(Symmetry::Planar, 1.4, 1.0, -1.0).is_err());
    }
}
