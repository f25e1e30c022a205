//! A body that strikes a rigid wall, or that a piston strikes: one steady shock.
//!
//! With v the closing speed, relative to the material ahead (at rho0, p0, e0):
//!
//! ```text
//! Mie-Grueneisen at rest:  Us = c0 + s v
//! ideal gas:               Us = (gamma+1)/4 v + sqrt(((gamma+1)/4 v)^2 + c^2)
//! P = p0 + rho0 Us v,  rho = rho0 Us/(Us - v),  e = e0 + (P + p0)/2 (1/rho0 - 1/rho)
//! ```
//!
//! (Rankine-Hugoniot; Noh's planar problem is the gas with e0 = 0.) The body's other face is
//! assumed to stay in the state ahead: free at p0 = 0, otherwise held. The solution holds until the
//! first front reaches that face.

use super::{ExactError, Landmarks, Profile, ProfilePoint, finite, positive};
use crate::material::MieGruneisen;

/// Material of the body that strikes the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WallMaterial {
    /// A solid at the reference density and zero pressure.
    MieGruneisen(MieGruneisen),
    /// A gas.
    IdealGas {
        /// Ratio of specific heats [-].
        gamma: f64,
        /// Density [kg/m3].
        rho: f64,
        /// Specific internal energy [J/kg].
        e: f64,
    },
    /// Any other material whose fronts are known ([`super::hugoniot::piston`]).
    Fronts {
        /// State ahead, with the body's velocity.
        ahead: ProfilePoint,
        /// State behind an elastic precursor, and its speed relative to the material ahead of it
        /// [m/s]. The velocity is the one that a piston towards +x gives to material at rest.
        precursor: Option<(ProfilePoint, f64)>,
        /// Speed of the shock relative to the material ahead of it [m/s].
        speed: f64,
    },
}

/// The steady shock from a wall or a piston.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallImpactSolution {
    /// Pressure behind the shock [Pa].
    pub p: f64,
    /// Density behind the shock [kg/m3].
    pub rho: f64,
    /// Specific internal energy behind the shock [J/kg].
    pub e: f64,
    /// Closing speed of body and wall [m/s].
    pub closing_speed: f64,
    /// Speed of the shock relative to the material ahead [m/s].
    pub shock_speed: f64,
    /// Time at which the first front reaches the body's other face [s].
    pub valid_until: f64,
    /// State ahead of the shock.
    ahead: ProfilePoint,
    /// Elastic precursor; the state behind it is `ahead`.
    precursor: Option<ReflectedFront>,
    /// Undisturbed state, ahead of all fronts.
    far: ProfilePoint,
    /// +1 if the shock runs towards +x.
    direction: f64,
    /// Struck face and opposite face at time 0 [m].
    faces: [f64; 2],
    wall_velocity: f64,
}

/// A front ahead of the shock.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ReflectedFront {
    behind: ProfilePoint,
    /// Speed relative to the material ahead [m/s].
    speed: f64,
}

impl WallImpactSolution {
    /// A body from `lower` to `upper` [m] with `velocity` [m/s]. At t = 0 a wall that moves at
    /// `wall_velocity` [m/s] strikes its lower or its upper face.
    ///
    /// # Errors
    ///
    /// If a number is out of range, if body and wall do not approach each other, or if the material
    /// cannot reach the state behind the shock.
    pub fn new(
        material: WallMaterial,
        lower: f64,
        upper: f64,
        velocity: f64,
        wall_on_lower_side: bool,
        wall_velocity: f64,
    ) -> Result<WallImpactSolution, ExactError> {
        finite("the body's velocity", velocity)?;
        finite("the wall's velocity", wall_velocity)?;
        finite("the body's lower face", lower)?;
        let thickness = positive("the body's thickness", upper - lower)?;
        let direction = if wall_on_lower_side { 1.0 } else { -1.0 };
        let v = direction * (wall_velocity - velocity);
        if v <= 0.0 {
            return Err(ExactError::NoImpact("body and wall do not approach each other"));
        }
        let mut first = None;
        let (shock_speed, far) = match material {
            WallMaterial::MieGruneisen(m) => {
                for (name, value) in [("rho0", m.rho0), ("c0", m.c0), ("s", m.s)] {
                    positive(name, value)?;
                }
                let us = m.c0 + m.s * v;
                let chi = v / us;
                if !(chi < 0.95 && chi * m.s < 0.95) {
                    return Err(ExactError::State {
                        what: "the wall compresses the body past 0.95 or 0.95/s",
                        chi,
                    });
                }
                (us, ProfilePoint { rho: m.rho0, u: velocity, ..ProfilePoint::default() })
            }
            WallMaterial::IdealGas { gamma, rho, e } => {
                positive("a gas's density", rho)?;
                if gamma <= 1.0 || !gamma.is_finite() {
                    return Err(ExactError::Number {
                        name: "gamma",
                        value: gamma,
                        allowed: "above 1",
                    });
                }
                if e < 0.0 || !e.is_finite() {
                    let allowed = "not negative, and finite";
                    return Err(ExactError::Number { name: "a gas's energy", value: e, allowed });
                }
                let k = 0.25 * (gamma + 1.0) * v;
                let us = k + (k * k + gamma * (gamma - 1.0) * e).sqrt();
                (us, ProfilePoint { x: 0.0, p: (gamma - 1.0) * rho * e, u: velocity, rho, e })
            }
            WallMaterial::Fronts { ahead, precursor, speed } => {
                first = precursor.map(|(behind, speed)| ReflectedFront {
                    behind: ProfilePoint { u: velocity + direction * behind.u, ..behind },
                    speed,
                });
                (speed, ProfilePoint { u: velocity, ..ahead })
            }
        };
        // the shock runs into the state behind the precursor
        let ahead = first.map_or(far, |f: ReflectedFront| f.behind);
        let v = direction * (wall_velocity - ahead.u);
        let p = ahead.p + ahead.rho * shock_speed * v;
        let rho = ahead.rho * shock_speed / (shock_speed - v);
        Ok(WallImpactSolution {
            p,
            rho,
            e: ahead.e + 0.5 * (p + ahead.p) * (1.0 / ahead.rho - 1.0 / rho),
            closing_speed: direction * (wall_velocity - far.u),
            shock_speed,
            valid_until: thickness / first.map_or(shock_speed, |f| f.speed),
            ahead,
            precursor: first,
            far,
            direction,
            faces: if wall_on_lower_side { [lower, upper] } else { [upper, lower] },
            wall_velocity,
        })
    }

    /// Positions of the wall, the shock and the body's other face at `t` [m].
    fn places(&self, t: f64) -> [f64; 3] {
        let [struck, other] = self.faces;
        let shock = self.ahead.u + self.direction * self.shock_speed;
        [struck + self.wall_velocity * t, struck + shock * t, other + self.far.u * t]
    }

    /// The whole body at time `t` [s]; `None` before 0 and after
    /// [`WallImpactSolution::valid_until`].
    pub fn profile(&self, t: f64) -> Option<Profile> {
        if !(0.0..=self.valid_until).contains(&t) {
            return None;
        }
        let [wall, shock, other] = self.places(t);
        let behind =
            |x| ProfilePoint { x, p: self.p, u: self.wall_velocity, rho: self.rho, e: self.e };
        let ahead = |x| ProfilePoint { x, ..self.ahead };
        let far = |x| ProfilePoint { x, ..self.far };
        let mut points = vec![behind(wall), behind(shock), ahead(shock)];
        if let Some(front) = &self.precursor {
            let place = self.faces[0] + (self.far.u + self.direction * front.speed) * t;
            points.extend([ahead(place), far(place)]);
        }
        points.push(far(other));
        if self.direction < 0.0 {
            points.reverse();
        }
        Some(Profile { points })
    }

    /// Features for the scoring at time `t` [s]; `None` where the profile is `None`, and at t = 0.
    pub fn landmarks(&self, t: f64) -> Option<Landmarks> {
        if !(t > 0.0 && t <= self.valid_until) {
            return None;
        }
        let [wall, shock, other] = self.places(t);
        Some(Landmarks {
            direction: self.direction,
            interface: wall,
            far_end: other,
            shock: Some(shock),
            plateau: Some([wall.min(shock), wall.max(shock)]),
            p2: self.p,
            rho2: self.rho,
            e2: self.e,
            rho2_flyer: f64::NAN,
            e2_flyer: f64::NAN,
            second_plateau: None,
            p4: None,
            behind_shock: self.p,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::samples::COPPER;

    #[test]
    fn a_wall_is_a_mirror() {
        // half of the symmetric impact at 1 km/s
        let solid = WallMaterial::MieGruneisen(COPPER);
        let wall = WallImpactSolution::new(solid, 0.0, 1e-3, -500.0, true, 0.0).unwrap();
        assert!((wall.p - 20.916e9).abs() < 5e5 && (wall.shock_speed - 4684.5).abs() < 1e-9);
        let points = wall.profile(0.1e-6).unwrap().points;
        let mass: f64 = points.windows(2).map(|w| w[0].rho * (w[1].x - w[0].x)).sum();
        assert!((mass / (8930.0 * 1e-3) - 1.0).abs() < 1e-12);
        let other = WallImpactSolution::new(solid, 0.0, 1e-3, 500.0, false, 0.0).unwrap();
        let mirrored = other.profile(0.1e-6).unwrap().points;
        for (a, b) in points.iter().zip(mirrored.iter().rev()) {
            assert!((a.x + b.x - 1e-3).abs() < 1e-15 && a.u == -b.u && a.p == b.p);
        }
    }

    #[test]
    fn noh_in_the_plane() {
        let gas = WallMaterial::IdealGas { gamma: 5.0 / 3.0, rho: 1.0, e: 0.0 };
        let noh = WallImpactSolution::new(gas, 0.0, 1.0, -1.0, true, 0.0).unwrap();
        assert!((noh.rho - 4.0).abs() < 1e-12 && (noh.e - 0.5).abs() < 1e-12);
        assert!((noh.p - 4.0 / 3.0).abs() < 1e-12);
        assert!((noh.landmarks(0.6).unwrap().shock.unwrap() - 0.2).abs() < 1e-12);
    }

    #[test]
    fn a_piston_in_gas_agrees_with_the_riemann_problem() {
        use crate::exact::{GasState, RiemannSolution};
        let g = |u| GasState { rho: 1.2, u, p: 1e5, gamma: 1.4 };
        let riemann = RiemannSolution::solve(g(300.0), g(-300.0)).unwrap();
        let gas = WallMaterial::IdealGas { gamma: 1.4, rho: 1.2, e: 1e5 / (0.4 * 1.2) };
        let piston = WallImpactSolution::new(gas, 0.0, 1.0, -10.0, true, 290.0).unwrap();
        assert!((piston.p / riemann.p_star - 1.0).abs() < 1e-12);
        assert!((piston.rho / riemann.rho_star_left - 1.0).abs() < 1e-12);
    }

    #[test]
    fn refuses_what_cannot_be() {
        let solid = WallMaterial::MieGruneisen(COPPER);
        assert!(WallImpactSolution::new(solid, 0.0, 1e-3, 500.0, true, 0.0).is_err());
        assert!(WallImpactSolution::new(solid, 0.0, 1e-3, -1e6, true, 0.0).is_err());
        assert!(WallImpactSolution::new(solid, 0.0, 0.0, -1e2, true, 0.0).is_err());
    }
}
