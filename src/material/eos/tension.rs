//! Tension cutoff: the lowest pressure of an equation of state.
//!
//! p = max(p_eos(J, e), -cutoff). Where the cutoff acts, the pressure does not depend on the
//! volume, and the work is that of the limited pressure. The sound speed there only sets the time
//! step. It is the one at rest: recompressed material regains stiffness no sooner than there.

use super::general::{EosPoint, GeneralEos};
use super::linear::{EquationOfState, LinearPressure};

/// Equation of state with a lowest pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cutoff<E> {
    /// Equation of state without the cutoff.
    pub eos: E,
    /// Greatest tension that the material carries [Pa]; the lowest pressure is minus this value.
    pub tension: f64,
}

impl<E: EquationOfState> EquationOfState for Cutoff<E> {
    fn reference_density(&self) -> f64 {
        EquationOfState::reference_density(&self.eos)
    }

    #[inline(always)]
    fn linear(&self, jacobian: f64) -> LinearPressure {
        self.eos.linear(jacobian)
    }

    #[inline(always)]
    fn sound_speed_squared(&self, jacobian: f64, pressure: f64) -> f64 {
        if pressure <= -self.tension {
            self.eos.sound_speed_squared(1.0, 0.0)
        } else {
            self.eos.sound_speed_squared(jacobian, pressure)
        }
    }

    #[inline(always)]
    fn least_pressure(&self) -> f64 {
        // both bounds hold; max() would discard a NaN, but neither is one
        self.eos.least_pressure().max(-self.tension)
    }

    #[inline(always)]
    fn clamp_tension(&self, pressure: f64) -> f64 {
        let pressure = self.eos.clamp_tension(pressure);
        // max() would discard NaN
        if pressure < -self.tension { -self.tension } else { pressure }
    }

    #[inline(always)]
    fn pressure(&self, jacobian: f64, energy: f64) -> f64 {
        self.clamp_tension(self.eos.pressure(jacobian, energy))
    }

    #[inline(always)]
    fn energy_at(&self, jacobian: f64, pressure: f64) -> f64 {
        EquationOfState::energy_at(&self.eos, jacobian, pressure)
    }

    #[inline(always)]
    fn check_validity(&self, jacobian: f64, pressure: f64) -> Option<&'static str> {
        // the cutoff makes any tension valid, but not any volume
        let pressure = if pressure <= -self.tension { 0.0 } else { pressure };
        EquationOfState::check_validity(&self.eos, jacobian, pressure)
    }
}

/// Equation of state of any form with a lowest pressure.
pub struct GeneralCutoff<E> {
    /// Equation of state without the cutoff.
    pub eos: E,
    /// Greatest tension that the material carries [Pa].
    pub tension: f64,
    /// Square of the sound speed at rest [m2/s2].
    pub rest: f64,
}

impl<E: GeneralEos> GeneralCutoff<E> {
    /// Adds a limit of the `tension` [Pa] to `eos`.
    pub fn new(eos: E, tension: f64) -> Self {
        let rest = eos.at(1.0, eos.energy_at(0.0)).sound_speed_squared;
        GeneralCutoff { eos, tension, rest }
    }
}

impl<E: GeneralEos> GeneralEos for GeneralCutoff<E> {
    fn reference_density(&self) -> f64 {
        self.eos.reference_density()
    }

    #[inline(always)]
    fn at(&self, jacobian: f64, energy: f64) -> EosPoint {
        let point = self.eos.at(jacobian, energy);
        // a comparison with NaN is false
        if point.pressure <= -self.tension {
            let (pressure, sound_speed_squared) = (-self.tension, self.rest);
            EosPoint { pressure, energy_slope: 0.0, sound_speed_squared }
        } else {
            point
        }
    }

    fn check_validity(&self, jacobian: f64, energy: f64, pressure: f64) -> Option<&'static str> {
        let pressure = if pressure <= -self.tension { 0.0 } else { pressure };
        self.eos.check_validity(jacobian, energy, pressure)
    }

    fn energy_at(&self, pressure: f64) -> f64 {
        self.eos.energy_at(pressure)
    }
}

#[cfg(test)]
mod tests {
    use super::super::MieGruneisen;
    use super::*;

    #[test]
    fn tension_stops_at_the_cutoff() {
        let eos = MieGruneisen { rho0: 8930.0, c0: 3940.0, s: 1.489, gamma0: 1.96 };
        let limited = Cutoff { eos, tension: 1e9 };
        for j in [0.8, 0.999, 1.005] {
            assert_eq!(limited.pressure(j, 1e3), eos.pressure(j, 1e3));
        }
        let point = GeneralEos::at(&limited, 1.5, 1e3);
        assert_eq!((point.pressure, point.energy_slope), (-1e9, 0.0));
        assert!((point.sound_speed_squared.sqrt() - 3940.0).abs() < 1e-9);
        assert_eq!(GeneralEos::check_validity(&limited, 5.0, 0.0, -1e9), None);
        assert!(
            GeneralEos::check_validity(&limited, 0.2, 0.0, -1e9).is_some(),
            "past the limit 1/s"
        );
    }
}
