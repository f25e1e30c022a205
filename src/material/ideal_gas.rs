//! Ideal gas, p = (gamma - 1) rho e, c^2 = gamma p/rho.
//!
//! It bears no tension: where a scheme's error (rounding, or what a filter exchanges) has left a
//! cold gas a little energy below zero, p = 0 and c = 0 until work or viscosity have paid it back.

use super::{EquationOfState, Linear};

/// Ideal gas of constant ratio of specific heats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IdealGas {
    /// Density at which J = 1 [kg/m3].
    pub rho0: f64,
    /// Ratio of specific heats gamma [-].
    pub gamma: f64,
}

impl EquationOfState for IdealGas {
    fn reference_density(&self) -> f64 {
        self.rho0
    }

    #[inline(always)]
    fn linear(&self, jacobian: f64) -> Linear {
        Linear { cold: 0.0, energy_factor: (self.gamma - 1.0) * self.rho0 / jacobian }
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
    fn fault(&self, _jacobian: f64, _pressure: f64) -> Option<&'static str> {
        None
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
