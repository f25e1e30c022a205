//! Shocks and isentropes of any equation of state.
//!
//! From a state ahead (v1, p1, e1, u1) across a shock at speed Us relative to the material ahead:
//!
//! ```text
//! e - e1 = (p + p1)/2 (v1 - v)          (Hugoniot's energy; solved together with p(v, e))
//! (u - u1)^2 = (p - p1)(v1 - v),  Us = v1 (u - u1)/(v1 - v)
//! ```
//!
//! Source: Meyers (1994), Dynamic Behavior of Materials, section 4.2. In a material with a history,
//! such as a porous one, a single jump leads from the history ahead to the history behind; if an
//! elastic precursor outruns the shock ([`piston`]), there are two jumps.

use super::ExactError;
use crate::material::{EosPoint, HistoryEos, energy_of_work};

/// Thermodynamic state and velocity of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HugoniotState {
    /// Volume ratio J [-].
    pub jacobian: f64,
    /// Pressure [Pa].
    pub p: f64,
    /// Specific internal energy [J/kg].
    pub e: f64,
    /// Velocity [m/s].
    pub u: f64,
    /// History variable of the material, in its own unit (p-alpha: the distension [-]); 0 without
    /// one.
    pub history: f64,
    /// Sound speed [m/s].
    pub sound_speed: f64,
}

/// A shock and the state behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShockFront {
    /// State behind the shock.
    pub behind: HugoniotState,
    /// Speed relative to the material ahead [m/s].
    pub speed: f64,
}

impl HugoniotState {
    /// The state at the reference density, with `pressure` [Pa] and velocity `u` [m/s].
    pub fn at_rest(eos: &dyn HistoryEos, pressure: f64, u: f64) -> HugoniotState {
        let history = eos.first_history().unwrap_or(0.0);
        Self::of(eos, 1.0, eos.energy_at(pressure), u, history)
    }

    fn of(eos: &dyn HistoryEos, jacobian: f64, e: f64, u: f64, before: f64) -> HugoniotState {
        let (point, history) = eos.at(jacobian, e, before);
        let sound_speed = point.sound_speed_squared.sqrt();
        HugoniotState { jacobian, p: point.pressure, e, u, history, sound_speed }
    }

    /// Density [kg/m3].
    pub fn density(&self, eos: &dyn HistoryEos) -> f64 {
        eos.reference_density() / self.jacobian
    }
}

/// The shock towards +x from `ahead` to the volume ratio `jacobian` [-]; `None` if there is no such
/// shock.
pub fn shock_to(eos: &dyn HistoryEos, ahead: &HugoniotState, jacobian: f64) -> Option<ShockFront> {
    let rho0 = eos.reference_density();
    let dv = (ahead.jacobian - jacobian) / rho0;
    let at = |e: f64| eos.at(jacobian, e, ahead.history);
    let known = ahead.e + 0.5 * ahead.p * dv;
    let (e, point, history): (f64, EosPoint, f64) = energy_of_work(at, known, -0.5 * dv, ahead.e);
    let p = point.pressure;
    // beyond the greatest compression the energy would have to decrease
    let holds = 1.0 - 0.5 * dv * point.energy_slope > 0.0;
    let valid = holds && eos.check_validity(jacobian, e, history, p).is_none();
    let jump = ((p - ahead.p) * dv).sqrt();
    if !(valid && p > ahead.p && jump.is_finite()) {
        return None;
    }
    let sound_speed = point.sound_speed_squared.sqrt();
    let behind = HugoniotState { jacobian, p, e, u: ahead.u + jump, history, sound_speed };
    Some(ShockFront { behind, speed: ahead.jacobian / rho0 * jump / dv })
}

/// The shock towards +x that raises the particle velocity of `ahead` by `up` [m/s].
///
/// # Errors
///
/// If `up` is not positive, or if no shock in the material reaches it.
pub fn shock(
    eos: &dyn HistoryEos,
    ahead: &HugoniotState,
    up: f64,
) -> Result<ShockFront, ExactError> {
    super::positive("the jump of velocity", up)?;
    let jump = |chi: f64| {
        let front = shock_to(eos, ahead, ahead.jacobian * (1.0 - chi))?;
        Some((front.behind.u - ahead.u, front))
    };
    let (mut low, mut high) = (0.0, f64::NAN);
    let mut chi = 1e-4;
    // scan from weak shocks to the first that is too strong
    while chi < 1.0 {
        match jump(chi) {
            Some((u, _)) if u < up => low = chi,
            Some(_) => {
                high = chi;
                break;
            }
            // no shock to this compression: too strong, if weaker ones exist
            None if low > 0.0 => {
                high = chi;
                break;
            }
            None => {}
        }
        chi += 0.004;
    }
    let mut best = None;
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if !(middle > low && middle < high) {
            break;
        }
        match jump(middle) {
            Some((u, front)) if u < up => (low, best) = (middle, Some((u, front))),
            Some((u, front)) => (high, best) = (middle, Some((u, front))),
            None => high = middle,
        }
    }
    match best {
        Some((u, front)) if (u / up - 1.0).abs() < 1e-9 => Ok(front),
        _ => Err(ExactError::State {
            what: "no shock of the equation of state gives the velocity asked for",
            chi: low,
        }),
    }
}

/// The fronts that a piston of velocity `up` [m/s] sends into material at rest, foremost first: one
/// shock, or, in a material that crushes, an elastic precursor followed by a shock.
///
/// # Errors
///
/// As for [`shock`].
pub fn piston(
    eos: &dyn HistoryEos,
    ahead: &HugoniotState,
    up: f64,
) -> Result<Vec<ShockFront>, ExactError> {
    let whole = shock(eos, ahead, up)?;
    if whole.behind.history == ahead.history {
        return Ok(vec![whole]);
    }
    // the strongest jump that does not change the history
    let keeps = |chi: f64| {
        let front = shock_to(eos, ahead, ahead.jacobian * (1.0 - chi))?;
        (front.behind.history == ahead.history).then_some(front)
    };
    let (mut low, mut high) = (0.0, 1.0 - whole.behind.jacobian / ahead.jacobian);
    let mut precursor = None;
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if !(middle > low && middle < high) {
            break;
        }
        match keeps(middle) {
            Some(front) => (low, precursor) = (middle, Some(front)),
            None => high = middle,
        }
    }
    match precursor {
        // a single front that is faster would overtake the precursor
        Some(front) if low > 1e-12 && whole.speed < front.speed => {
            let rest = shock(eos, &front.behind, up - (front.behind.u - ahead.u))?;
            Ok(vec![front, rest])
        }
        _ => Ok(vec![whole]),
    }
}

/// The end of the isentrope from `state` to the volume ratio `jacobian` [-], integrated by the
/// classical Runge-Kutta rule in `steps` steps. The velocity changes as in a simple wave towards
/// +x: du = -C dJ with C = c/J.
pub fn isentrope(
    eos: &dyn HistoryEos,
    state: HugoniotState,
    jacobian: f64,
    steps: usize,
) -> HugoniotState {
    let rho0 = eos.reference_density();
    let h = (jacobian - state.jacobian) / steps as f64;
    let (mut e, mut u, mut history) = (state.e, state.u, state.history);
    for k in 0..steps {
        let j = state.jacobian + h * k as f64;
        let slope = |j: f64, e: f64| {
            let (point, _) = eos.at(j, e, history);
            [-point.pressure / rho0, -point.sound_speed_squared.max(0.0).sqrt() / j]
        };
        let a = slope(j, e);
        let b = slope(j + 0.5 * h, e + 0.5 * h * a[0]);
        let c = slope(j + 0.5 * h, e + 0.5 * h * b[0]);
        let d = slope(j + h, e + h * c[0]);
        let sum = |k: usize| h / 6.0 * (a[k] + 2.0 * (b[k] + c[k]) + d[k]);
        (e, u) = (e + sum(0), u + sum(1));
        (_, history) = eos.at(j + h, e, history);
    }
    HugoniotState::of(eos, jacobian, e, u, history)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::samples::COPPER;
    use crate::material::{EquationOfState, IdealGas, Jwl, Porous, Tait, Tillotson};

    #[test]
    fn copper_is_on_its_us_up_line() {
        let rest = HugoniotState::at_rest(&COPPER, 0.0, 3.0);
        for up in [1.0, 300.0, 2000.0] {
            let front = shock(&COPPER, &rest, up).unwrap();
            assert!((front.speed / (3940.0 + 1.489 * up) - 1.0).abs() < 1e-7, "{front:?}");
            assert!((front.behind.u - 3.0 - up).abs() < 1e-7 * up);
            assert!((front.behind.p / (8930.0 * front.speed * up) - 1.0).abs() < 1e-8);
        }
        assert!(shock(&COPPER, &rest, f64::NAN).is_err() && shock(&COPPER, &rest, -1.0).is_err());
    }

    #[test]
    fn a_gas_with_pressure_has_its_closed_shock() {
        let gas = IdealGas { rho0: 1.2, gamma: 1.4 };
        let rest = HugoniotState::at_rest(&gas, 1e5, 0.0);
        let front = shock(&gas, &rest, 290.0).unwrap();
        let k = 0.25 * 2.4 * 290.0;
        let us = k + (k * k + 1.4 * 1e5 / 1.2f64).sqrt();
        assert!((front.speed / us - 1.0).abs() < 1e-9, "{front:?} {us}");
    }

    #[test]
    fn the_jump_conditions_hold_for_each_equation() {
        let check = |eos: &dyn HistoryEos, up: f64| {
            let rest = HugoniotState::at_rest(eos, 0.0, 0.0);
            let mut ahead = rest;
            for front in piston(eos, &rest, up).unwrap() {
                let rho1 = ahead.density(eos);
                let (b, du) = (front.behind, front.behind.u - ahead.u);
                let rho = b.density(eos);
                assert!((rho * (front.speed - du) / (rho1 * front.speed) - 1.0).abs() < 1e-12);
                assert!(((b.p - ahead.p) / (rho1 * front.speed * du) - 1.0).abs() < 1e-9);
                let work = 0.5 * (b.p + ahead.p) * (1.0 / rho1 - 1.0 / rho);
                assert!(((b.e - ahead.e) / work - 1.0).abs() < 1e-8, "{front:?}");
                let (point, _) = eos.at(b.jacobian, b.e, ahead.history);
                assert!((point.pressure / b.p - 1.0).abs() < 1e-12);
                ahead = b;
            }
            assert!((ahead.u / up - 1.0).abs() < 1e-8);
        };
        check(&Tait { rho0: 1000.0, bulk_modulus: 2.1e9, exponent: 7.0 }, 500.0);
        check(
            &Tillotson {
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
            },
            3000.0,
        );
        check(&POROUS, 500.0);
        check(&POROUS, 1500.0);
    }

    const POROUS: Porous<crate::material::MieGruneisen> = Porous {
        solid: COPPER,
        distension: 1.25,
        elastic_pressure: 0.1e9,
        full_compaction_pressure: 1.6e9,
    };

    #[test]
    fn a_slow_crush_has_a_precursor() {
        let rest = HugoniotState::at_rest(&POROUS, 0.0, 0.0);
        let fronts = piston(&POROUS, &rest, 300.0).unwrap();
        assert_eq!(fronts.len(), 2);
        assert!((fronts[0].behind.p / 0.1e9 - 1.0).abs() < 1e-6, "{fronts:?}");
        assert!(fronts[0].speed > 3900.0 && fronts[1].speed < 3900.0);
        // fully crushed: the Hugoniot of the solid, as if from the porous volume
        let end = fronts[1].behind;
        assert!(end.history == 1.0 && end.p > 1.6e9);
        assert_eq!(end.p, EquationOfState::pressure(&COPPER, end.jacobian * 1.25, end.e));
        assert_eq!(piston(&POROUS, &rest, 2.0).unwrap().len(), 1, "elastic");
    }

    #[test]
    fn products_expand_along_their_closed_isentrope() {
        let tnt = Jwl {
            rho0: 1630.0,
            a: 371.2e9,
            b: 3.231e9,
            r1: 4.15,
            r2: 0.95,
            omega: 0.30,
            energy: 7.0e9,
        };
        let start = HugoniotState::at_rest(&tnt, 0.0, 0.0);
        let form = |c: f64, v: f64| {
            tnt.a * (-4.15 * v).exp() + tnt.b * (-0.95 * v).exp() + c * v.powf(-1.3)
        };
        let c = start.p - form(0.0, 1.0);
        let end = isentrope(&tnt, start, 6.0, 2000);
        assert!((end.p / form(c, 6.0) - 1.0).abs() < 1e-8, "{end:?}");
    }
}
