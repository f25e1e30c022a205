//! Equations of state of any form, p(J, e), and of materials with a history.
//!
//! Where p is not linear in e, the mid-point rule for the energy, e + w p(J, e) = known, has no
//! closed solution; [`energy_of_work`] solves it to rounding by Newton's rule kept within a
//! bracket. Every equation that is linear ([`EquationOfState`]) is one of these too, so that exact
//! solutions look at all of them alike.

use super::EquationOfState;

/// What an equation of state tells of one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EosPoint {
    /// Pressure [Pa].
    pub pressure: f64,
    /// dp/de at fixed volume [kg/m3].
    pub energy_slope: f64,
    /// Square of the isentropic sound speed [m2/s2]; not positive where the model has ceased to
    /// hold.
    pub sound_speed_squared: f64,
}

impl EosPoint {
    /// From the derivatives of p(J, e): c^2 = J^2/rho0 (-dp/dJ + p/rho0 dp/de).
    #[inline(always)]
    pub fn new(rho0: f64, jacobian: f64, p: f64, volume_slope: f64, energy_slope: f64) -> Self {
        EosPoint {
            pressure: p,
            energy_slope,
            sound_speed_squared: jacobian * jacobian / rho0
                * (energy_slope * p / rho0 - volume_slope),
        }
    }

    /// dp/dJ at fixed energy [Pa]: [`EosPoint::new`] turned about.
    #[inline(always)]
    pub fn volume_slope(&self, rho0: f64, jacobian: f64) -> f64 {
        self.energy_slope * self.pressure / rho0
            - self.sound_speed_squared * rho0 / (jacobian * jacobian)
    }
}

/// An equation of state p(J, e); see [`EquationOfState`] for what J, e and p are.
pub trait GeneralEos: Send + Sync + 'static {
    /// Density at J = 1 [kg/m3].
    fn reference_density(&self) -> f64;

    /// The state at J and e.
    fn at(&self, jacobian: f64, energy: f64) -> EosPoint;

    /// Why a state lies outside of the model, if it does.
    fn fault(&self, jacobian: f64, energy: f64, pressure: f64) -> Option<&'static str>;

    /// The specific internal energy at rest density at which the material is at `pressure` [J/kg].
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
        let whole = linear.cold + linear.energy_factor * energy;
        let pressure = self.borne(whole);
        EosPoint {
            pressure,
            energy_slope: if pressure == whole { linear.energy_factor } else { 0.0 },
            sound_speed_squared: self.sound_speed_squared(jacobian, pressure),
        }
    }

    fn fault(&self, jacobian: f64, _energy: f64, pressure: f64) -> Option<&'static str> {
        EquationOfState::fault(self, jacobian, pressure)
    }

    fn energy_at(&self, pressure: f64) -> f64 {
        EquationOfState::energy_at(self, 1.0, pressure)
    }
}

/// An equation of state p(J, e, z) with a variable z that remembers what the material has been
/// through: a distension, a burnt fraction. One without such a variable leaves z as it is.
pub trait HistoryEos: Send + Sync + 'static {
    /// Density at J = 1 [kg/m3].
    fn reference_density(&self) -> f64;

    /// The state at J and e of material that had `history`, and what its history is now.
    fn at(&self, jacobian: f64, energy: f64, history: f64) -> (EosPoint, f64);

    /// The history that the material starts with; none without a variable.
    fn first_history(&self) -> Option<f64>;

    /// Why a state lies outside of the model, if it does.
    fn fault(
        &self,
        jacobian: f64,
        energy: f64,
        history: f64,
        pressure: f64,
    ) -> Option<&'static str>;

    /// The specific internal energy at rest density at which the material is at `pressure` [J/kg].
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

    fn fault(&self, jacobian: f64, energy: f64, _: f64, pressure: f64) -> Option<&'static str> {
        GeneralEos::fault(self, jacobian, energy, pressure)
    }

    fn energy_at(&self, pressure: f64) -> f64 {
        GeneralEos::energy_at(self, pressure)
    }
}

/// Newton's steps before the search is given up to what it has.
const MOST_STEPS: usize = 80;

/// The energy e with e + `weight` p(e) = `known`, from the first guess `guess` on, and the state
/// there; `at` gives the state at an energy and volume that is held.
///
/// Newton's rule; a step that would leave the bracket found so far halves it instead. Ends where a
/// step is below rounding of the terms. Looks at nothing but its arguments, so that it gives the
/// same bits everywhere.
#[inline]
pub fn energy_of_work<T: Copy>(
    at: impl Fn(f64) -> (EosPoint, T),
    known: f64,
    weight: f64,
    guess: f64,
) -> (f64, EosPoint, T) {
    let (mut below, mut above) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut e = guess;
    let mut found = at(e);
    for _ in 0..MOST_STEPS {
        let work = weight * found.0.pressure;
        let rest = (e - known) + work;
        let slope = 1.0 + weight * found.0.energy_slope;
        // NaN ends it too: a fault tells of it
        if !(rest.abs() > 0.0 && rest.is_finite()) {
            break;
        }
        if rest > 0.0 {
            above = e;
        } else {
            below = e;
        }
        let step = e - rest / slope;
        let next = if step > below && step < above {
            step
        } else if below.is_finite() && above.is_finite() {
            0.5 * (below + above)
        } else {
            // the slope has the wrong sign: away from where it is
            e - rest
        };
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

/// The energy at which p(e) is `pressure`, by the same rule; `at` gives the state at an energy.
pub(super) fn energy_at_rest(at: impl Fn(f64) -> EosPoint, pressure: f64) -> f64 {
    let mut e = 0.0;
    for _ in 0..MOST_STEPS {
        let point = at(e);
        let step = (pressure - point.pressure) / point.energy_slope;
        // a pressure that no energy changes is what it is
        if !step.is_finite() || step.abs() <= f64::EPSILON * e.abs() {
            break;
        }
        e += step;
    }
    e
}

/// Checks of equations of state that their tests share.
#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::material::{IdealGas, MieGruneisen};

    /// c^2 and dp/de are those of the isentrope de = -p dv and of p(e), by central differences.
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
            let told = point.sound_speed_squared;
            assert!((told - c2).abs() <= tolerance * c2.abs(), "J {j}, e {e}: c2 {told} {c2}");
            let k = 1e-5 * (e.abs() + point.pressure.abs() / rho0).max(1.0);
            let slope = (p(j, e + k) - p(j, e - k)) / (2.0 * k);
            let told = point.energy_slope;
            assert!(
                (told - slope).abs() <= tolerance * slope.abs().max(1e-3 * rho0),
                "{told} {slope}"
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
        // p has a corner, where Newton's rule alone goes to and fro
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
