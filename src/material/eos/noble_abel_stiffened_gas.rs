//! Noble-Abel stiffened gas: a stiffened gas whose molecules have a volume of their own.
//!
//! With v = 1/rho,
//!
//! ```text
//! p = ((gamma - 1) e + gamma p_inf (v0 - v))/(v - b)
//! c^2 = gamma v^2 (p + p_inf)/(v - b)
//! ```
//!
//! Source: Le Metayer & Saurel (2016), The Noble-Abel stiffened-gas equation of state, Phys. Fluids
//! 28, 046102, eqs. 3 and 16. Theirs is p = (gamma - 1)(e' - q)/(v - b) - gamma p_inf; here the
//! energy is counted from rest, where p = e = 0. Valid for v > b and p > -p_inf. Without b it is
//! the [stiffened gas](super::StiffenedGas).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

use super::{EosContext, EosParameters, EquationOfState, LinearPressure, Made, PlainEosVisitor};
use crate::material::ParameterError;

/// Noble-Abel stiffened gas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NobleAbelStiffenedGas {
    /// Density at rest [kg/m3].
    pub rho0: f64,
    /// Ratio of specific heats gamma [-].
    pub gamma: f64,
    /// Cohesion p_inf [Pa].
    pub p_inf: f64,
    /// Volume b of the molecules over the volume of the material at rest [-].
    pub covolume: f64,
}

impl EquationOfState for NobleAbelStiffenedGas {
    fn reference_density(&self) -> f64 {
        self.rho0
    }

    #[inline(always)]
    fn linear(&self, jacobian: f64) -> LinearPressure {
        let free = jacobian - self.covolume;
        LinearPressure {
            reference_pressure: self.gamma * self.p_inf * (1.0 - jacobian) / free,
            gruneisen_rho: (self.gamma - 1.0) * self.rho0 / free,
        }
    }

    #[inline(always)]
    fn sound_speed_squared(&self, jacobian: f64, pressure: f64) -> f64 {
        let free = jacobian - self.covolume;
        self.gamma * jacobian * jacobian * (pressure + self.p_inf) / (self.rho0 * free)
    }

    #[inline(always)]
    fn check_validity(&self, jacobian: f64, pressure: f64) -> Option<&'static str> {
        if jacobian <= self.covolume {
            Some("compressed to the covolume of a Noble-Abel gas")
        } else if pressure <= -self.p_inf {
            Some("stretched past the tension p_inf that a stiffened gas can bear")
        } else {
            None
        }
    }
}

/// Noble-Abel stiffened gas, p = ((gamma - 1) e + gamma p_inf (v0 - v))/(v - covolume).
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NobleAbelStiffenedGasParameters {
    /// Constant gamma, the ratio of specific heats of the gas without cohesion [-]. With a larger
    /// value the stiffness grows faster with pressure.
    #[schemars(extend("exclusiveMinimum" = 1.0))]
    pub gamma: f64,
    /// Cohesion p_inf [Pa]; no tension above it is possible. A larger value makes the material
    /// stiffer.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub p_inf: f64,
    /// Covolume b, the specific volume of the molecules [m3/kg], below 1/density; the specific
    /// volume of the material is always larger. A larger value makes compressed material stiffer.
    #[schemars(extend("minimum" = 0.0))]
    pub covolume: f64,
    /// Greatest tension that the material carries [Pa]; absent: up to p_inf.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0.0))]
    pub tension_cutoff: Option<f64>,
}

impl EosParameters for NobleAbelStiffenedGasParameters {
    fn check(&self, at: &EosContext) -> Result<(), ParameterError> {
        if self.covolume * at.density >= 1.0 {
            let density = json!(at.density);
            let reason = format!("allowed: below 1/density, with density = {density}");
            return Err(ParameterError::new("covolume", self.covolume, reason));
        }
        match self.tension_cutoff {
            Some(cutoff) if cutoff >= self.p_inf => {
                let reason =
                    format!("allowed: below p_inf = {}, where it breaks", json!(self.p_inf));
                Err(ParameterError::new("tension_cutoff", cutoff, reason))
            }
            _ => Ok(()),
        }
    }

    fn check_initial_pressure(&self, _density: f64, pressure: f64) -> Result<(), String> {
        super::within_cutoff(pressure, self.tension_cutoff)
    }

    fn gas_gamma(&self) -> Option<f64> {
        Some(self.gamma)
    }

    fn visit_plain<V: PlainEosVisitor>(&self, rho0: f64, visitor: V) -> Made<V> {
        let (gamma, p_inf, covolume) = (self.gamma, self.p_inf, self.covolume * rho0);
        let eos = NobleAbelStiffenedGas { rho0, gamma, p_inf, covolume };
        Ok(Some(super::limited(visitor, eos, self.tension_cutoff)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::general::tests::check_derivatives;
    use super::super::{GeneralEos, StiffenedGas};
    use super::*;

    /// Liquid water, table 1 of the paper, at 1057 kg/m3.
    const WATER: NobleAbelStiffenedGas = NobleAbelStiffenedGas {
        rho0: 1057.0,
        gamma: 1.19,
        p_inf: 7028e5,
        covolume: 6.61e-4 * 1057.0,
    };

    #[test]
    fn derivatives() {
        let states = [[0.9, 1e6, 0.0], [0.98, 1e4, 0.0], [1.0, 0.0, 0.0], [1.05, 1e5, 0.0]];
        check_derivatives(&WATER, &states, 1e-6);
    }

    /// Comparison with p = (gamma - 1)(e' - q)/(v - b) - gamma p_inf of the paper.
    #[test]
    fn pressure_is_that_of_the_paper() {
        let (v0, b) = (1.0 / 1057.0, 6.61e-4);
        let at_rest = 1.19 * 7028e5 * (v0 - b) / 0.19;
        for (j, e) in [(0.9, 1e6), (1.0, 0.0), (1.2, 3e5)] {
            let want = 0.19 * (at_rest + e) / (j * v0 - b) - 1.19 * 7028e5;
            let p = GeneralEos::at(&WATER, j, e).pressure;
            assert!((p - want).abs() < 1e-11 * want.abs().max(7e8), "{p} {want}");
        }
    }

    #[test]
    fn without_a_covolume_it_is_the_stiffened_gas() {
        let free = NobleAbelStiffenedGas { covolume: 0.0, ..WATER };
        let stiffened = StiffenedGas { rho0: 1057.0, gamma: 1.19, p_inf: 7028e5 };
        for (j, e) in [(0.7, 1e6), (1.1, 2e5)] {
            let [a, b] = [GeneralEos::at(&free, j, e), GeneralEos::at(&stiffened, j, e)];
            assert!((a.pressure / b.pressure - 1.0).abs() < 1e-13);
            assert!((a.sound_speed_squared / b.sound_speed_squared - 1.0).abs() < 1e-13);
        }
        assert!(EquationOfState::check_validity(&WATER, 0.69, 1e9).is_some());
        assert!(EquationOfState::check_validity(&WATER, 1.1, -8e8).is_some());
    }
}
