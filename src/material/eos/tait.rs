//! Tait's equation in Murnaghan's form: the pressure depends on the density only.
//!
//! ```text
//! p = (K0/n) ((rho/rho0)^n - 1),   c^2 = K0/rho0 (rho/rho0)^(n - 1)
//! ```
//!
//! Source: Murnaghan (1944), PNAS 30, 244; Cole (1948), Underwater Explosions, eq. 2.12, with n = 7
//! and K0/n = 3 kbar for water. K0 is the bulk modulus at rest, n its derivative by pressure. The
//! energy is integrated (de = -p dv, and the loss in a shock), but does not affect the pressure.
//! Tension is limited to K0/n, where the volume becomes infinite.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use serde_json::json;

use super::{EosContext, EosParameters, EquationOfState, LinearPressure, Made, PlainEosVisitor};
use crate::material::ParameterError;

/// Tait's equation of state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tait {
    /// Density at rest [kg/m3].
    pub rho0: f64,
    /// Bulk modulus at rest K0 [Pa].
    pub bulk_modulus: f64,
    /// Exponent n [-].
    pub exponent: f64,
}

impl EquationOfState for Tait {
    fn reference_density(&self) -> f64 {
        self.rho0
    }

    #[inline(always)]
    fn linear(&self, jacobian: f64) -> LinearPressure {
        // exp_m1 keeps the digits of small strains
        let power = (-self.exponent * jacobian.ln()).exp_m1();
        LinearPressure {
            reference_pressure: self.bulk_modulus / self.exponent * power,
            gruneisen_rho: 0.0,
        }
    }

    #[inline(always)]
    fn sound_speed_squared(&self, jacobian: f64, pressure: f64) -> f64 {
        (self.bulk_modulus + self.exponent * pressure) * jacobian / self.rho0
    }

    #[inline(always)]
    fn check_validity(&self, _jacobian: f64, _pressure: f64) -> Option<&'static str> {
        None
    }

    fn energy_at(&self, _jacobian: f64, _pressure: f64) -> f64 {
        0.0
    }
}

/// Tait's equation in Murnaghan's form, p = K0/n ((rho/rho0)^n - 1).
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TaitParameters {
    /// Bulk modulus K0 of the material at rest [Pa]; the sound speed at rest is (K0/rho0)^(1/2).
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub bulk_modulus: f64,
    /// Exponent n, the derivative of the bulk modulus with respect to pressure [-], about 7 for
    /// water. A larger value makes compressed material stiffer; 1 makes the pressure linear in the
    /// density.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub exponent: f64,
    /// Greatest tension that the material carries [Pa]; absent: up to K0/n.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0.0))]
    pub tension_cutoff: Option<f64>,
}

impl EosParameters for TaitParameters {
    fn check(&self, _: &EosContext) -> Result<(), ParameterError> {
        let most = self.bulk_modulus / self.exponent;
        match self.tension_cutoff {
            Some(cutoff) if cutoff >= most => {
                let most = json!(most);
                let reason =
                    format!("allowed: below bulk_modulus/exponent = {most}, where it breaks");
                Err(ParameterError::new("tension_cutoff", cutoff, reason))
            }
            _ => Ok(()),
        }
    }

    fn no_initial_pressure(&self) -> Option<&'static str> {
        Some("of Tait's equation the pressure at the density is 0")
    }

    fn visit_plain<V: PlainEosVisitor>(&self, rho0: f64, visitor: V) -> Made<V> {
        let eos = Tait { rho0, bulk_modulus: self.bulk_modulus, exponent: self.exponent };
        Ok(Some(super::limited(visitor, eos, self.tension_cutoff)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::general::tests::check_derivatives;
    use super::*;

    const WATER: Tait = Tait { rho0: 1000.0, bulk_modulus: 2.1e9, exponent: 7.0 };

    #[test]
    fn derivatives() {
        let states = [[0.7, 1e6, 0.0], [0.95, 1e4, 0.0], [1.0, 0.0, 0.0], [1.05, 1e4, 0.0]];
        check_derivatives(&WATER, &states, 1e-7);
    }

    #[test]
    fn the_modulus_grows_with_pressure_by_its_exponent() {
        for j in [0.8f64, 0.9, 1.1] {
            let p = WATER.pressure(j, 0.0);
            assert!((p / (3e8 * (j.powf(-7.0) - 1.0)) - 1.0).abs() < 1e-12);
            let modulus = 1000.0 / j * WATER.sound_speed_squared(j, p);
            assert!((modulus / (2.1e9 + 7.0 * p) - 1.0).abs() < 1e-12);
        }
    }
}
