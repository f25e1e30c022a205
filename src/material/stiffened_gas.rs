//! Stiffened gas: a gas upon a constant cohesion.
//!
//! ```text
//! p = (gamma - 1) rho e + gamma p_inf (rho/rho0 - 1)
//! c^2 = gamma (p + p_inf)/rho
//! ```
//!
//! Source: Harlow & Amsden (1971), Fluid Dynamics, LA-4700; Menikoff & Plohr (1989). Their
//! p = (gamma - 1) rho e' - gamma p_inf with the energy counted from rest, where p = e = 0:
//! e' = e + gamma p_inf/((gamma - 1) rho0). At rest c0^2 = gamma p_inf/rho0. Holds for p > -p_inf.

use super::{EquationOfState, Linear};

/// Stiffened gas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StiffenedGas {
    /// Density at rest [kg/m3].
    pub rho0: f64,
    /// Its gamma [-].
    pub gamma: f64,
    /// Its cohesion p_inf [Pa].
    pub stiffness: f64,
}

impl EquationOfState for StiffenedGas {
    fn reference_density(&self) -> f64 {
        self.rho0
    }

    #[inline(always)]
    fn linear(&self, jacobian: f64) -> Linear {
        let chi = 1.0 - jacobian;
        Linear {
            cold: self.gamma * self.stiffness * chi / jacobian,
            energy_factor: (self.gamma - 1.0) * self.rho0 / jacobian,
        }
    }

    #[inline(always)]
    fn sound_speed_squared(&self, jacobian: f64, pressure: f64) -> f64 {
        self.gamma * (pressure + self.stiffness) * jacobian / self.rho0
    }

    #[inline(always)]
    fn fault(&self, _jacobian: f64, pressure: f64) -> Option<&'static str> {
        (pressure <= -self.stiffness)
            .then_some("stretched past the tension p_inf that a stiffened gas can bear")
    }
}

#[cfg(test)]
mod tests {
    use super::super::general::tests::check_derivatives;
    use super::*;

    const WATER: StiffenedGas = StiffenedGas { rho0: 1000.0, gamma: 4.4, stiffness: 6e8 };

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
        assert_eq!(WATER.fault(1.1, -5.9e8), None);
        assert!(WATER.fault(1.1, -6e8).unwrap().contains("p_inf"));
    }
}
