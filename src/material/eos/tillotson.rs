//! Tillotson's equation of state, from cold compression to vapour.
//!
//! With eta = rho/rho0 = 1/J, mu = eta - 1 and w = e/(e0 eta^2) + 1:
//!
//! ```text
//! compressed, or e <= e_iv:   p_c = (a + b/w) rho e + A mu + B mu^2
//! eta < 1 and e >= e_cv:      p_e = a rho e + (b rho e/w + A mu exp(-beta z)) exp(-alpha z^2),
//!                             z = 1/eta - 1
//! eta < 1, between:           p = ((e - e_iv) p_e + (e_cv - e) p_c)/(e_cv - e_iv)
//! ```
//!
//! Source: Tillotson (1962), GA-3216; Melosh (1989), Impact Cratering, appendix II, eqs. AII.3.1
//! to 5. Not linear in e. The sound speed of strongly expanded cold material becomes imaginary
//! (without energy, beyond mu = -A/(2 B)): that state is a fault.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use serde_json::json;

use super::{EosContext, EosParameters, EosPoint, GeneralEos, Made, PlainEosVisitor};
use crate::material::ParameterError;

/// Tillotson's equation of state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tillotson {
    /// Density at rest [kg/m3].
    pub rho0: f64,
    /// a [-].
    pub a: f64,
    /// b [-].
    pub b: f64,
    /// A, the bulk modulus at rest [Pa].
    pub bulk_modulus: f64,
    /// B [Pa].
    pub second_modulus: f64,
    /// alpha [-].
    pub alpha: f64,
    /// beta [-].
    pub beta: f64,
    /// e0 [J/kg].
    pub e0: f64,
    /// Energy of incipient vaporization e_iv [J/kg].
    pub e_iv: f64,
    /// Energy of complete vaporization e_cv [J/kg].
    pub e_cv: f64,
}

/// p, dp/dJ and dp/de.
#[derive(Clone, Copy)]
struct Slopes([f64; 3]);

impl Tillotson {
    /// rho e, and b rho e/w, each with its derivatives by J and e.
    #[inline(always)]
    fn thermal(&self, j: f64, e: f64) -> ([f64; 3], [f64; 3]) {
        let rho = self.rho0 / j;
        let plain = [rho * e, -rho * e / j, rho];
        let w = e * j * j / self.e0 + 1.0;
        let [wj, we] = [2.0 * e * j / self.e0, j * j / self.e0];
        let share = self.b / w;
        let with = [
            share * plain[0],
            share * (plain[1] - plain[0] * wj / w),
            share * (plain[2] - plain[0] * we / w),
        ];
        (plain, with)
    }

    #[inline(always)]
    fn condensed(&self, j: f64, e: f64) -> Slopes {
        let (plain, with) = self.thermal(j, e);
        let (mu, slope) = (1.0 / j - 1.0, -1.0 / (j * j));
        let (a, b) = (self.bulk_modulus, self.second_modulus);
        Slopes([
            self.a * plain[0] + with[0] + mu * (a + b * mu),
            self.a * plain[1] + with[1] + slope * (a + 2.0 * b * mu),
            self.a * plain[2] + with[2],
        ])
    }

    #[inline(always)]
    fn expanded(&self, j: f64, e: f64) -> Slopes {
        let (plain, with) = self.thermal(j, e);
        let (mu, z) = (1.0 / j - 1.0, j - 1.0);
        let strength = self.bulk_modulus * (-self.beta * z).exp();
        let fading = (-self.alpha * z * z).exp();
        let inner = with[0] + strength * mu;
        let inner_slope = with[1] + strength * (-1.0 / (j * j) - self.beta * mu);
        Slopes([
            self.a * plain[0] + inner * fading,
            self.a * plain[1] + (inner_slope - 2.0 * self.alpha * z * inner) * fading,
            self.a * plain[2] + with[2] * fading,
        ])
    }
}

impl GeneralEos for Tillotson {
    fn reference_density(&self) -> f64 {
        self.rho0
    }

    #[inline(always)]
    fn at(&self, jacobian: f64, energy: f64) -> EosPoint {
        let Slopes([p, by_volume, by_energy]) = if jacobian <= 1.0 || energy <= self.e_iv {
            self.condensed(jacobian, energy)
        } else if energy >= self.e_cv {
            self.expanded(jacobian, energy)
        } else {
            let (Slopes(cold), Slopes(hot)) =
                (self.condensed(jacobian, energy), self.expanded(jacobian, energy));
            let width = self.e_cv - self.e_iv;
            let share = (energy - self.e_iv) / width;
            let mix = |k: usize| share * hot[k] + (1.0 - share) * cold[k];
            Slopes([mix(0), mix(1), mix(2) + (hot[0] - cold[0]) / width])
        };
        EosPoint::new(self.rho0, jacobian, p, by_volume, by_energy)
    }

    fn check_validity(&self, jacobian: f64, energy: f64, _pressure: f64) -> Option<&'static str> {
        // w changes its sign: the thermal part has a pole
        (energy * jacobian * jacobian <= -self.e0)
            .then_some("of so little energy that Tillotson's equation has a pole")
    }
}

/// Tillotson's equation of state, from cold compression to vapour. With eta = rho/rho0, mu = eta -
/// 1 and z = 1/eta - 1, the condensed state has p = (a + b/(e/(e0 eta^2) + 1)) rho e + A mu + B
/// mu^2, the vapour p = a rho e + (b rho e/(e/(e0 eta^2) + 1) + A mu exp(-beta z)) exp(-alpha z^2);
/// between e_iv and e_cv the pressure changes linearly with e from one to the other.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TillotsonParameters {
    /// Constant a of the thermal pressure a rho e [-]: the Grueneisen coefficient of the hot
    /// vapour. A larger value gives more pressure per energy.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub a: f64,
    /// Constant b of the thermal pressure [-]: at low energy the Grueneisen coefficient is a + b. A
    /// larger value gives cold material more pressure per energy.
    #[schemars(extend("minimum" = 0.0))]
    pub b: f64,
    /// Bulk modulus A of the material at rest [Pa]. A larger value makes the material stiffer.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub bulk_modulus: f64,
    /// Coefficient B of the pressure that is quadratic in the compression [Pa]. A larger value
    /// makes strongly compressed material stiffer.
    #[schemars(extend("minimum" = 0.0))]
    pub second_modulus: f64,
    /// Exponent alpha in the expanded state [-]. With a larger value the energy-dependent pressure
    /// above a rho e fades faster in expansion.
    #[schemars(extend("minimum" = 0.0))]
    pub alpha: f64,
    /// Exponent beta in the expanded state [-]. With a larger value the cohesion, the term with A,
    /// fades faster in expansion.
    #[schemars(extend("minimum" = 0.0))]
    pub beta: f64,
    /// Specific energy e0 at which the Grueneisen coefficient of material at rest density has
    /// fallen to a + b/2 [J/kg]. A larger value keeps it at a + b up to higher energies.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub e0: f64,
    /// Specific internal energy at which expanded material begins to vaporize, e_iv [J/kg].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub e_iv: f64,
    /// Specific internal energy at which expanded material is completely vaporized, e_cv [J/kg];
    /// above `e_iv`.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub e_cv: f64,
    /// Greatest tension that the material carries [Pa]; absent: no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0.0))]
    pub tension_cutoff: Option<f64>,
}

impl EosParameters for TillotsonParameters {
    fn check(&self, _: &EosContext) -> Result<(), ParameterError> {
        if self.e_cv <= self.e_iv {
            let reason = format!("allowed: above e_iv = {}", json!(self.e_iv));
            return Err(ParameterError::new("e_cv", self.e_cv, reason));
        }
        Ok(())
    }

    fn check_initial_pressure(&self, _density: f64, pressure: f64) -> Result<(), String> {
        super::within_cutoff(pressure, self.tension_cutoff)
    }

    fn visit_plain<V: PlainEosVisitor>(&self, rho0: f64, visitor: V) -> Made<V> {
        let &TillotsonParameters { a, b, bulk_modulus, second_modulus, alpha, beta, .. } = self;
        let &TillotsonParameters { e0, e_iv, e_cv, tension_cutoff, .. } = self;
        let eos =
            Tillotson { rho0, a, b, bulk_modulus, second_modulus, alpha, beta, e0, e_iv, e_cv };
        Ok(Some(super::limited_general(visitor, eos, tension_cutoff)))
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::general::tests::check_derivatives;
    use super::*;

    /// Aluminium: Melosh (1989), table AII.3.
    pub const ALUMINIUM: Tillotson = Tillotson {
        rho0: 2700.0,
        a: 0.5,
        b: 1.63,
        bulk_modulus: 75.2e9,
        second_modulus: 65e9,
        alpha: 5.0,
        beta: 5.0,
        e0: 5e6,
        e_iv: 3e6,
        e_cv: 13.9e6,
    };

    #[test]
    fn derivatives() {
        let states = [
            [0.6, 1e7, 0.0],
            [0.9, 1e5, 0.0],
            [1.02, 1e6, 0.0],
            [1.3, 8e6, 0.0],
            [1.5, 2e7, 0.0],
            [4.0, 2e7, 0.0],
        ];
        check_derivatives(&ALUMINIUM, &states, 1e-6);
    }

    #[test]
    fn the_branches_meet() {
        let p = |j: f64, e: f64| ALUMINIUM.at(j, e).pressure;
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-6 * a.abs().max(1e9), "{a} {b}");
        for e in [1e6, 8e6, 2e7] {
            near(p(1.0 - 1e-9, e), p(1.0 + 1e-9, e));
        }
        for e in [3e6, 13.9e6] {
            near(p(1.4, e * (1.0 - 1e-9)), p(1.4, e * (1.0 + 1e-9)));
        }
    }

    #[test]
    fn far_expanded_it_is_a_gas_and_cold_it_has_its_modulus() {
        let hot = ALUMINIUM.at(50.0, 3e7).pressure;
        assert!((hot / (0.5 * 2700.0 / 50.0 * 3e7) - 1.0).abs() < 1e-12);
        let rest = ALUMINIUM.at(1.0, 0.0);
        assert!(
            rest.pressure == 0.0
                && (rest.sound_speed_squared * 2700.0 / 75.2e9 - 1.0).abs() < 1e-14
        );
    }
}
