//! Ideal gas, p = (gamma - 1) rho e, c^2 = gamma p/rho.
//!
//! An ideal gas carries no tension. If errors of the scheme (rounding, or the exchange by a filter)
//! leave a cold gas with a slightly negative energy, p = 0 and c = 0 until work or viscosity have
//! restored it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{EosParameters, EquationOfState, LinearPressure, Made, PlainEosVisitor};

/// Ideal gas with a constant ratio of specific heats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IdealGas {
    /// Density at J = 1 [kg/m3].
    pub rho0: f64,
    /// Ratio of specific heats gamma [-].
    pub gamma: f64,
}

impl EquationOfState for IdealGas {
    fn reference_density(&self) -> f64 {
        self.rho0
    }

    #[inline(always)]
    fn linear(&self, jacobian: f64) -> LinearPressure {
        LinearPressure {
            reference_pressure: 0.0,
            gruneisen_rho: (self.gamma - 1.0) * self.rho0 / jacobian,
        }
    }

    #[inline(always)]
    fn sound_speed_squared(&self, jacobian: f64, pressure: f64) -> f64 {
        self.gamma * pressure * jacobian / self.rho0
    }

    #[inline(always)]
    fn least_pressure(&self) -> f64 {
        0.0
    }

    #[inline(always)]
    fn check_validity(&self, _jacobian: f64, _pressure: f64) -> Option<&'static str> {
        None
    }
}

/// Ideal gas, p = (gamma - 1) rho e.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IdealGasParameters {
    /// Ratio of specific heats gamma [-]: 5/3 for atoms, 1.4 for molecules of two atoms. A larger
    /// value gives more pressure per energy and a smaller compression in a shock.
    #[schemars(extend("exclusiveMinimum" = 1.0))]
    pub gamma: f64,
}

impl EosParameters for IdealGasParameters {
    fn is_gas(&self) -> bool {
        true
    }

    fn gas_gamma(&self) -> Option<f64> {
        Some(self.gamma)
    }

    fn check_initial_pressure(&self, _density: f64, pressure: f64) -> Result<(), String> {
        super::at_least(pressure, 0.0, "since an ideal gas supports no tension")
    }

    fn visit_plain<V: PlainEosVisitor>(&self, rho0: f64, visitor: V) -> Made<V> {
        Ok(Some(visitor.linear(IdealGas { rho0, gamma: self.gamma })))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sound_speed_is_the_isentropic_derivative_of_pressure() {
        let gas = IdealGas { rho0: 1.3, gamma: 1.4 };
        let (jacobian, energy) = (0.6, 2.5);
        let p = gas.pressure(jacobian, energy);
        // p rho^-gamma is constant
        let at = |j: f64| p * (jacobian / j).powf(1.4);
        let h = 1e-6;
        let slope =
            (at(jacobian - h) - at(jacobian + h)) / (1.3 / (jacobian - h) - 1.3 / (jacobian + h));
        assert!((gas.sound_speed_squared(jacobian, p) / slope - 1.0).abs() < 1e-8);
    }
}
