//! Stiffened gas: a gas with a constant cohesion.
//!
//! ```text
//! p = (gamma - 1) rho e + gamma p_inf (rho/rho0 - 1)
//! c^2 = gamma (p + p_inf)/rho
//! ```
//!
//! Source: Harlow & Amsden (1971), Fluid Dynamics, LA-4700; Menikoff & Plohr (1989). Theirs is
//! p = (gamma - 1) rho e' - gamma p_inf; here the energy is counted from rest, where p = e = 0:
//! e' = e + gamma p_inf/((gamma - 1) rho0). At rest c0^2 = gamma p_inf/rho0. Valid for p > -p_inf.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use serde_json::json;

use super::{EosContext, EosParameters, EquationOfState, LinearPressure, Made, PlainEosVisitor};
use crate::material::ParameterError;

/// Stiffened gas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StiffenedGas {
    /// Density at rest [kg/m3].
    pub rho0: f64,
    /// Ratio of specific heats gamma [-].
    pub gamma: f64,
    /// Cohesion p_inf [Pa].
    pub p_inf: f64,
}

impl EquationOfState for StiffenedGas {
    fn reference_density(&self) -> f64 {
        self.rho0
    }

    #[inline(always)]
    fn linear(&self, jacobian: f64) -> LinearPressure {
        let chi = 1.0 - jacobian;
        LinearPressure {
            reference_pressure: self.gamma * self.p_inf * chi / jacobian,
            gruneisen_rho: (self.gamma - 1.0) * self.rho0 / jacobian,
        }
    }

    #[inline(always)]
    fn sound_speed_squared(&self, jacobian: f64, pressure: f64) -> f64 {
        self.gamma * (pressure + self.p_inf) * jacobian / self.rho0
    }

    #[inline(always)]
    fn check_validity(&self, _jacobian: f64, pressure: f64) -> Option<&'static str> {
        (pressure <= -self.p_inf)
            .then_some("stretched past the tension p_inf that a stiffened gas can bear")
    }
}

/// Stiffened gas, p = (gamma - 1) rho e + gamma p_inf (rho/rho0 - 1).
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StiffenedGasParameters {
    /// Constant gamma, the ratio of specific heats of the gas without cohesion [-]. With a larger
    /// value the stiffness grows faster with pressure.
    #[schemars(extend("exclusiveMinimum" = 1.0))]
    pub gamma: f64,
    /// Cohesion p_inf [Pa]: the sound speed at rest is (gamma p_inf/rho0)^(1/2), and no tension
    /// above p_inf is possible. A larger value makes the material stiffer.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub p_inf: f64,
    /// Greatest tension that the material carries [Pa]; absent: up to p_inf.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0.0))]
    pub tension_cutoff: Option<f64>,
}

impl EosParameters for StiffenedGasParameters {
    fn check(&self, _: &EosContext) -> Result<(), ParameterError> {
        match self.tension_cutoff {
            Some(cutoff) if cutoff >= self.p_inf => {
                let most = json!(self.p_inf);
                let reason = format!("allowed: below eos.p_inf = {most}, where it breaks");
                Err(ParameterError::new("tension_cutoff", cutoff, reason))
            }
            _ => Ok(()),
        }
    }

    fn gas_gamma(&self) -> Option<f64> {
        Some(self.gamma)
    }

    fn check_initial_pressure(&self, _density: f64, pressure: f64) -> Result<(), String> {
        super::within_cutoff(pressure, self.tension_cutoff)
    }

    fn visit_plain<V: PlainEosVisitor>(&self, rho0: f64, visitor: V) -> Made<V> {
        let eos = StiffenedGas { rho0, gamma: self.gamma, p_inf: self.p_inf };
        Ok(Some(super::limited(visitor, eos, self.tension_cutoff)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::general::tests::check_derivatives;
    use super::*;

    const WATER: StiffenedGas = StiffenedGas { rho0: 1000.0, gamma: 4.4, p_inf: 6e8 };

    #[test]
    fn derivatives() {
        let states = [[0.7, 1e6, 0.0], [0.95, 1e4, 0.0], [1.0, 10.0, 0.0], [1.05, 1e4, 0.0]];
        check_derivatives(&WATER, &states, 1e-7);
    }

    #[test]
    fn isentropes_are_those_of_a_gas() {
        // (p + p_inf) v^gamma is constant: mid-point steps from rest
        let (mut j, mut e, n) = (1.0, 0.0, 4000);
        for _ in 0..n {
            let dj = -0.3 / f64::from(n);
            let p = WATER.pressure(j, e);
            let middle = WATER.pressure(j + 0.5 * dj, e - 0.5 * p * dj / 1000.0);
            e -= middle * dj / 1000.0;
            j += dj;
        }
        let exact = 6e8 * (0.7f64.powf(-4.4) - 1.0);
        assert!((WATER.pressure(j, e) / exact - 1.0).abs() < 1e-6);
    }

    #[test]
    fn past_its_cohesion_it_is_a_fault() {
        assert_eq!(WATER.check_validity(1.1, -5.9e8), None);
        assert!(WATER.check_validity(1.1, -6e8).unwrap().contains("p_inf"));
    }
}
