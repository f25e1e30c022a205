//! An elastic-perfectly plastic body that strikes a rigid wall: an elastic precursor at the
//! Hugoniot elastic limit, followed by a plastic shock.
//!
//! In uniaxial strain a hypoelastic material has the deviator s = 4/3 G ln J until |s| = 2/3 Y, at
//! J = exp(-Y/2G); beyond that the deviator is constant. Both fronts satisfy the jump conditions
//! with the axial stress sigma = p(J, e) + |s|, positive in compression:
//!
//! ```text
//! e' - e = (sigma + sigma')/2 (v - v'),  (u' - u)^2 = (sigma' - sigma)(v - v')
//! W^2 = (sigma' - sigma)/(v - v')                 W: mass that a front runs through
//! ```
//!
//! Source: Wood (1952), On longitudinal plane waves of elastic-plastic strain in solids; all of the
//! energy goes to the equation of state (Wilkins 1964). If the plastic shock is faster than the
//! elastic front, there is no precursor.

use super::{ExactError, positive};
use crate::material::EquationOfState;

/// An elastic-perfectly plastic material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plastic<E> {
    /// Equation of state.
    pub eos: E,
    /// Shear modulus G [Pa].
    pub shear_modulus: f64,
    /// Yield stress Y [Pa].
    pub yield_stress: f64,
}

/// State behind a front, and the speed of the front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Behind {
    /// Speed of the front relative to the undisturbed material ahead of all fronts [m/s].
    pub speed: f64,
    /// Velocity relative to the undisturbed material [m/s].
    pub u: f64,
    /// Axial stress, positive in compression [Pa].
    pub stress: f64,
    /// Pressure [Pa].
    pub p: f64,
    /// Density [kg/m3].
    pub rho: f64,
    /// Specific internal energy [J/kg].
    pub e: f64,
}

/// The fronts that run from the wall into the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticPlastic {
    /// Elastic precursor; `None` if the plastic shock outruns it.
    pub precursor: Option<Behind>,
    /// Plastic shock; below the elastic limit, the elastic front.
    pub last: Behind,
}

/// A state between the fronts.
#[derive(Clone, Copy)]
struct At {
    jacobian: f64,
    u: f64,
    stress: f64,
    e: f64,
}

impl<E: EquationOfState> Plastic<E> {
    /// Magnitude of the axial deviator at J [Pa].
    fn deviator(&self, jacobian: f64) -> f64 {
        let elastic = -4.0 / 3.0 * self.shear_modulus * jacobian.ln();
        elastic.min(2.0 / 3.0 * self.yield_stress)
    }

    /// The state at J behind a single front that runs into `ahead`.
    fn jump(&self, ahead: &At, jacobian: f64) -> Option<At> {
        let dv = (ahead.jacobian - jacobian) / self.eos.reference_density();
        let shear = self.deviator(jacobian);
        let mut e = ahead.e;
        // the pressure is linear in the energy or nearly so: a few rounds converge to rounding
        for _ in 0..200 {
            let stress = self.eos.pressure(jacobian, e) + shear;
            let next = ahead.e + 0.5 * (ahead.stress + stress) * dv;
            if (next - e).abs() <= f64::EPSILON * next.abs() {
                break;
            }
            e = next;
        }
        let stress = self.eos.pressure(jacobian, e) + shear;
        let square = (stress - ahead.stress) * dv;
        (square >= 0.0 && e.is_finite()).then(|| At {
            jacobian,
            u: ahead.u + square.sqrt(),
            stress,
            e,
        })
    }

    /// The state at the velocity `u` [m/s] behind a single front that runs into `ahead`.
    fn reach(&self, ahead: &At, u: f64) -> Option<At> {
        let (mut low, mut high) = (0.05 * ahead.jacobian, ahead.jacobian);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            match self.jump(ahead, middle) {
                Some(at) if at.u < u => high = middle,
                _ => low = middle,
            }
        }
        let at = self.jump(ahead, high)?;
        ((at.u - u).abs() <= 1e-6 * u).then_some(at)
    }
}

impl ElasticPlastic {
    /// The fronts in a body of `material` at rest that meets a wall at `speed` [m/s].
    ///
    /// # Errors
    ///
    /// If a constant is not positive and finite, or if the material has no state at this speed.
    pub fn new<E: EquationOfState>(
        material: &Plastic<E>,
        speed: f64,
    ) -> Result<ElasticPlastic, ExactError> {
        positive("the closing speed", speed)?;
        positive("the shear modulus", material.shear_modulus)?;
        positive("the yield stress", material.yield_stress)?;
        let rho0 = material.eos.reference_density();
        let none = |jacobian: f64| ExactError::State {
            what: "no state of the material moves with the wall",
            chi: 1.0 - jacobian,
        };
        let rest = At { jacobian: 1.0, u: 0.0, stress: 0.0, e: 0.0 };
        // mass flux through the front over rho0: its speed in the undisturbed material
        let lagrangian = |from: &At, to: &At| {
            ((to.stress - from.stress) * rho0 / (from.jacobian - to.jacobian)).sqrt() / rho0
        };
        let behind = |from: &At, to: &At| Behind {
            speed: from.u + from.jacobian * lagrangian(from, to),
            u: to.u,
            stress: to.stress,
            p: to.stress - material.deviator(to.jacobian),
            rho: rho0 / to.jacobian,
            e: to.e,
        };
        let limit = (-material.yield_stress / (2.0 * material.shear_modulus)).exp();
        let elastic = material.jump(&rest, limit).ok_or(none(limit))?;
        if elastic.u >= speed {
            let at = material.reach(&rest, speed).ok_or(none(1.0))?;
            return Ok(ElasticPlastic { precursor: None, last: behind(&rest, &at) });
        }
        let plastic = material.reach(&elastic, speed).ok_or(none(limit))?;
        if lagrangian(&elastic, &plastic) < lagrangian(&rest, &elastic) {
            let precursor = Some(behind(&rest, &elastic));
            return Ok(ElasticPlastic { precursor, last: behind(&elastic, &plastic) });
        }
        let at = material.reach(&rest, speed).ok_or(none(limit))?;
        Ok(ElasticPlastic { precursor: None, last: behind(&rest, &at) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::MieGruneisen;

    const ALUMINIUM: Plastic<MieGruneisen> = Plastic {
        eos: MieGruneisen { rho0: 2790.0, c0: 5330.0, s: 1.34, gamma0: 2.0 },
        shear_modulus: 28.6e9,
        yield_stress: 0.26e9,
    };

    #[test]
    fn the_two_waves_of_a_weak_impact() {
        let two = ElasticPlastic::new(&ALUMINIUM, 100.0).unwrap();
        let first = two.precursor.unwrap();
        let near = |value: f64, wanted: f64, part: f64| {
            assert!((value / wanted - 1.0).abs() < part, "{value} {wanted}");
        };
        near(first.speed, 6520.66, 1e-5);
        near(first.u, 29.572, 1e-5);
        near(first.stress, 0.53799e9, 1e-5);
        near(two.last.speed, 5505.53, 1e-4);
        near(two.last.stress, 1.61889e9, 1e-4);
        near(two.last.p, 1.44556e9, 1e-4);
        near(two.last.rho, 2839.227, 1e-6);
        near(two.last.u, 100.0, 1e-9);
    }

    #[test]
    fn below_the_limit_and_overdriven_there_is_one_front() {
        let weak = ElasticPlastic::new(&ALUMINIUM, 10.0).unwrap();
        assert_eq!(weak.precursor, None);
        // the longitudinal sound speed is sqrt(c0^2 + 4 G/(3 rho0)) = 6487.5 m/s
        assert!((6487.0..6530.0).contains(&weak.last.speed), "{}", weak.last.speed);
        let strong = ElasticPlastic::new(&ALUMINIUM, 3000.0).unwrap();
        assert_eq!(strong.precursor, None);
        assert!(strong.last.speed > 9300.0);
        // with negligible strength the front is on the Hugoniot
        let soft = Plastic { yield_stress: 1.0, ..ALUMINIUM };
        let fluid = ElasticPlastic::new(&soft, 3000.0).unwrap().last;
        assert!((fluid.speed / (5330.0 + 1.34 * 3000.0) - 1.0).abs() < 1e-7);
        assert!(ElasticPlastic::new(&ALUMINIUM, 0.0).is_err());
    }
}
