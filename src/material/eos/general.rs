//! Equations of state of any form, p(J, e), and of materials with a history.
//!
//! If p is not linear in e, the trapezoidal rule for the energy, e + w p(J, e) = known, has no closed
//! solution; [`energy_of_work`] solves it to rounding by Newton's method within a bracket. Every
//! linear equation of state ([`EquationOfState`]) is also a general one, so that exact solutions
//! treat all of them alike.

use super::bracket::{Bracket, MOST_STEPS};
use super::linear::EquationOfState;

/// Pressure, energy derivative and sound speed of an equation of state at one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EosPoint {
    /// Pressure [Pa].
    pub pressure: f64,
    /// dp/de at fixed volume [kg/m3].
    pub energy_slope: f64,
    /// Square of the isentropic sound speed [m2/s2]; not positive outside the range of the model.
    pub sound_speed_squared: f64,
}

impl EosPoint {
    /// From the derivatives of p(J, e): c^2 = J^2/rho0 (-dp/dJ + p/rho0 dp/de). The arguments are
    /// the density at rest [kg/m3], J [-], p [Pa], dp/dJ at fixed energy [Pa] and dp/de at fixed
    /// volume [kg/m3].
    #[inline(always)]
    pub fn new(rho0: f64, jacobian: f64, p: f64, volume_slope: f64, energy_slope: f64) -> Self {
        EosPoint {
            pressure: p,
            energy_slope,
            sound_speed_squared: jacobian * jacobian / rho0
                * (energy_slope * p / rho0 - volume_slope),
        }
    }

    /// dp/dJ at fixed energy [Pa]: the inverse of [`EosPoint::new`].
    #[inline(always)]
    pub fn volume_slope(&self, rho0: f64, jacobian: f64) -> f64 {
        self.energy_slope * self.pressure / rho0
            - self.sound_speed_squared * rho0 / (jacobian * jacobian)
    }
}

/// Equation of state p(J, e); [`EquationOfState`] defines J, e and p.
pub trait GeneralEos: Send + Sync + 'static {
    /// Density at J = 1 [kg/m3].
    fn reference_density(&self) -> f64;

    /// State at J and e.
    fn at(&self, jacobian: f64, energy: f64) -> EosPoint;

    /// Reason why a state is outside the range of the model, if it is.
    fn check_validity(&self, jacobian: f64, energy: f64, pressure: f64) -> Option<&'static str>;

    /// Specific internal energy at rest density at which the material has `pressure` [J/kg].
    fn energy_at(&self, pressure: f64) -> f64 {
        energy_at_rest(|e| self.at(1.0, e), pressure)
    }
}

impl<E: EquationOfState> GeneralEos for E {
    fn reference_density(&self) -> f64 {
        EquationOfState::reference_density(self)
    }

    #[inline(always)]
    fn at(&self, jacobian: f64, energy: f64) -> EosPoint {
        let linear = self.linear(jacobian);
        let whole = linear.reference_pressure + linear.gruneisen_rho * energy;
        let pressure = self.clamp_tension(whole);
        EosPoint {
            pressure,
            energy_slope: if pressure == whole { linear.gruneisen_rho } else { 0.0 },
            sound_speed_squared: self.sound_speed_squared(jacobian, pressure),
        }
    }

    fn check_validity(&self, jacobian: f64, _energy: f64, pressure: f64) -> Option<&'static str> {
        EquationOfState::check_validity(self, jacobian, pressure)
    }

    fn energy_at(&self, pressure: f64) -> f64 {
        EquationOfState::energy_at(self, 1.0, pressure)
    }
}

/// Equation of state p(J, e, z) with a history variable z, such as a distension or a burnt
/// fraction. An equation of state without such a variable leaves z unchanged.
pub trait HistoryEos: Send + Sync + 'static {
    /// Density at J = 1 [kg/m3].
    fn reference_density(&self) -> f64;

    /// State at J and e of material with the history variable `history`, and the new history
    /// variable.
    fn at(&self, jacobian: f64, energy: f64, history: f64) -> (EosPoint, f64);

    /// Initial history variable; `None` if there is no such variable.
    fn first_history(&self) -> Option<f64>;

    /// Reason why a state is outside the range of the model, if it is.
    fn check_validity(
        &self,
        jacobian: f64,
        energy: f64,
        history: f64,
        pressure: f64,
    ) -> Option<&'static str>;

    /// Specific internal energy at rest density at which the material has `pressure` [J/kg].
    fn energy_at(&self, pressure: f64) -> f64;
}

impl<E: GeneralEos> HistoryEos for E {
    fn reference_density(&self) -> f64 {
        GeneralEos::reference_density(self)
    }

    #[inline(always)]
    fn at(&self, jacobian: f64, energy: f64, history: f64) -> (EosPoint, f64) {
        (GeneralEos::at(self, jacobian, energy), history)
    }

    fn first_history(&self) -> Option<f64> {
        None
    }

    fn check_validity(
        &self,
        jacobian: f64,
        energy: f64,
        _: f64,
        pressure: f64,
    ) -> Option<&'static str> {
        GeneralEos::check_validity(self, jacobian, energy, pressure)
    }

    fn energy_at(&self, pressure: f64) -> f64 {
        GeneralEos::energy_at(self, pressure)
    }
}

/// Solves e + `weight` p(e) = `known` for the energy e [J/kg], starting from `guess` [J/kg], and
/// returns e and the state there. `weight` is a change of specific volume [m3/kg], `known` an
/// energy [J/kg]. `at` gives the state at an energy and the fixed volume.
///
/// Newton's method; a step that would leave the current bracket halves the bracket instead. Ends
/// when a step is below the rounding of the terms. Depends on its arguments only, so that it gives
/// the same bits everywhere.
#[inline]
pub fn energy_of_work<T: Copy>(
    at: impl Fn(f64) -> (EosPoint, T),
    known: f64,
    weight: f64,
    guess: f64,
) -> (f64, EosPoint, T) {
    let mut bracket = Bracket { ends: [f64::NEG_INFINITY, f64::INFINITY] };
    let mut e = guess;
    let mut found = at(e);
    for _ in 0..MOST_STEPS {
        let work = weight * found.0.pressure;
        let rest = (e - known) + work;
        let slope = 1.0 + weight * found.0.energy_slope;
        // NaN also ends the loop: the validity check reports it
        if !(rest.abs() > 0.0 && rest.is_finite()) {
            break;
        }
        let next = bracket.next(e, rest, slope);
        let moved = (next - e).abs();
        let rounding = f64::EPSILON * (known.abs() + work.abs());
        e = next;
        found = at(e);
        if moved <= rounding {
            break;
        }
    }
    (e, found.0, found.1)
}

/// Energy [J/kg] at which p(e) is `pressure` [Pa], by the same method; `at` gives the state at an
/// energy.
pub(super) fn energy_at_rest(at: impl Fn(f64) -> EosPoint, pressure: f64) -> f64 {
    let mut e = 0.0;
    for _ in 0..MOST_STEPS {
        let point = at(e);
        let step = (pressure - point.pressure) / point.energy_slope;
        // keep e if the pressure does not depend on it
        if !step.is_finite() || step.abs() <= f64::EPSILON * e.abs() {
            break;
        }
        e += step;
    }
    e
}

/// Checks that the tests of equations of state share.
#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::material::{IdealGas, MieGruneisen};

    /// Checks c^2 and dp/de against central differences along the isentrope de = -p dv and of p(e).
    #[track_caller]
    pub fn check_derivatives(eos: &impl HistoryEos, states: &[[f64; 3]], tolerance: f64) {
        let rho0 = eos.reference_density();
        for &[j, e, z] in states {
            let (point, _) = eos.at(j, e, z);
            let p = |j: f64, e: f64| eos.at(j, e, z).0.pressure;
            let h = 1e-5 * j;
            // mid-point steps along the isentrope
            let along = |dj: f64| {
                let middle = p(j + 0.5 * dj, e - 0.5 * point.pressure * dj / rho0);
                p(j + dj, e - middle * dj / rho0)
            };
            let c2 = -j * j / rho0 * (along(h) - along(-h)) / (2.0 * h);
            let returned = point.sound_speed_squared;
            assert!(
                (returned - c2).abs() <= tolerance * c2.abs(),
                "J {j}, e {e}: c2 {returned} {c2}"
            );
            let k = 1e-5 * (e.abs() + point.pressure.abs() / rho0).max(1.0);
            let slope = (p(j, e + k) - p(j, e - k)) / (2.0 * k);
            let returned = point.energy_slope;
            assert!(
                (returned - slope).abs() <= tolerance * slope.abs().max(1e-3 * rho0),
                "{returned} {slope}"
            );
        }
    }

    #[test]
    fn a_linear_equation_is_solved_as_in_closed_form() {
        let gas = IdealGas { rho0: 2.0, gamma: 1.4 };
        let (e0, w) = (3.0, -0.05);
        let (e, point, _) = energy_of_work(|e| (GeneralEos::at(&gas, 0.9, e), ()), e0, w, e0);
        let exact = e0 / (1.0 + w * 0.4 * 2.0 / 0.9);
        assert!((e / exact - 1.0).abs() < 1e-15 && point.pressure == gas.pressure(0.9, e));
    }

    #[test]
    fn what_is_not_smooth_is_solved_too() {
        // p has a kink, where Newton's method alone oscillates
        let corner = |e: f64| {
            let (p, slope) = if e < 1.0 { (0.1 * e, 0.1) } else { (0.1 + 9.0 * (e - 1.0), 9.0) };
            (EosPoint { pressure: p, energy_slope: slope, sound_speed_squared: 1.0 }, ())
        };
        for known in [-3.0, 0.5, 1.09, 1.1, 1.11, 4.0] {
            for guess in [-10.0, 0.99, 1.01, 10.0] {
                let (e, point, ()) = energy_of_work(corner, known, 1.0, guess);
                assert!((e + point.pressure - known).abs() < 1e-13, "{known} {guess}: {e}");
            }
        }
    }

    #[test]
    fn the_energy_of_a_pressure_is_found() {
        let copper = MieGruneisen { rho0: 8930.0, c0: 3940.0, s: 1.489, gamma0: 1.96 };
        let e = energy_at_rest(|e| GeneralEos::at(&copper, 1.0, e), 2e9);
        assert!((e / EquationOfState::energy_at(&copper, 1.0, 2e9) - 1.0).abs() < 1e-14);
    }
}
