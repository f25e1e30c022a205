//! Isentropes of a Mie-Grueneisen material, accurate to rounding.
//!
//! ```text
//! de/dchi = (f(chi) + gamma0 rho0 e)/rho0      (de = -p dv)
//! du/dchi = +- C,  C = sqrt((f' + gamma0 p)/rho0)   the Lagrangian sound speed, rho c/rho0
//! ```
//!
//! The classical Runge-Kutta rule integrates them with steps of at most 1/256 in chi. A step ends
//! at chi = 0, where f'' jumps.

use super::ExactError;
use super::wave::{WaveState, sound_speed};
use crate::material::{EquationOfState, MieGruneisen};

/// Greatest step in compression chi [-].
const STEP: f64 = 1.0 / 256.0;

/// Follows the isentrope through `state` to the compression `chi`. `side` is +1 for a wave that
/// runs to the right (du = C dchi), -1 for one that runs to the left.
pub(super) fn to_compression(
    m: &MieGruneisen,
    state: WaveState,
    side: f64,
    chi: f64,
) -> Result<WaveState, ExactError> {
    if state.chi * chi < 0.0 {
        let middle = to_compression(m, state, side, 0.0)?;
        return to_compression(m, middle, side, chi);
    }
    let steps = ((chi - state.chi).abs() / STEP).ceil().max(1.0);
    let h = (chi - state.chi) / steps;
    // chi = -0 would select the tension branch; both branches agree at 0
    let slope = |chi: f64, e: f64| {
        let p = m.pressure(1.0 - chi, e);
        (p / m.rho0, ((m.cold_slope(chi) + m.gamma0 * p) / m.rho0).sqrt())
    };
    let (mut e, mut u) = (state.e, state.u);
    for k in 0..steps as usize {
        let at = state.chi + h * k as f64;
        let (a, ua) = slope(at, e);
        let (b, ub) = slope(at + 0.5 * h, e + 0.5 * h * a);
        let (c, uc) = slope(at + 0.5 * h, e + 0.5 * h * b);
        let (d, ud) = slope(at + h, e + h * c);
        e += h / 6.0 * (a + 2.0 * (b + c) + d);
        u += side * h / 6.0 * (ua + 2.0 * (ub + uc) + ud);
    }
    let end = WaveState { chi, p: m.pressure(1.0 - chi, e), u, e };
    if end.p.is_finite() && u.is_finite() {
        Ok(end)
    } else {
        Err(ExactError::State {
            what: "an isentrope left what the equation of state can bear",
            chi,
        })
    }
}

/// Lower bound of the pressure on every isentrope [Pa]: -rho0 c0^2/gamma0, which the pressure
/// approaches as the density falls to 0, since dp/dchi = rho0 c0^2 + gamma0 p in tension.
pub(super) fn least_pressure(m: &MieGruneisen) -> f64 {
    if m.gamma0 > 0.0 { -m.rho0 * m.c0 * m.c0 / m.gamma0 } else { f64::NEG_INFINITY }
}

/// Follows the isentrope through `state` to the pressure `p` [Pa].
///
/// # Errors
///
/// [`ExactError::State`] if no state of the isentrope has this pressure, or if the sound speed
/// becomes imaginary on the way.
pub(super) fn to_pressure(
    m: &MieGruneisen,
    state: WaveState,
    side: f64,
    p: f64,
) -> Result<WaveState, ExactError> {
    if p <= least_pressure(m) {
        return Err(ExactError::State {
            what: "no isentrope reaches a tension of rho0 c0^2/gamma0 or more",
            chi: state.chi,
        });
    }
    let remaining = |state: &WaveState| {
        let c = sound_speed(m, state);
        // tolerance: a change of chi that is lost in rounding
        ((p - state.p) / (m.rho0 * c * c), 2e-16)
    };
    let end = search(m, state, side, "an isentrope does not reach its pressure", remaining)?;
    Ok(WaveState { p, ..end })
}

/// Follows the isentrope through `state` to the velocity `u` [m/s].
///
/// # Errors
///
/// [`ExactError::State`] if no state of the isentrope has this velocity, or if the sound speed
/// becomes imaginary on the way.
pub(super) fn to_velocity(
    m: &MieGruneisen,
    state: WaveState,
    side: f64,
    u: f64,
) -> Result<WaveState, ExactError> {
    let remaining = |state: &WaveState| {
        let c = sound_speed(m, state);
        // tolerance: a change that is lost in the rounding of chi or of the velocity
        (side * (u - state.u) / c, 1e-15 * (1.0 + u.abs() / c))
    };
    let end = search(m, state, side, "an isentrope does not reach its velocity", remaining)?;
    Ok(WaveState { u, ..end })
}

/// Greatest number of Newton steps in one search.
const ROUNDS: usize = 200;

/// Newton's method along the isentrope through `state`, kept within a bracket. `remaining` returns
/// Newton's change of compression at a state, and the change below which the state is accepted.
fn search(
    m: &MieGruneisen,
    mut state: WaveState,
    side: f64,
    what: &'static str,
    remaining: impl Fn(&WaveState) -> (f64, f64),
) -> Result<WaveState, ExactError> {
    // pressure and velocity rise with chi wherever the sound speed is real
    let (mut low, mut high) = (f64::NEG_INFINITY, m.limiting_compression());
    let mut nearest = (f64::INFINITY, state);
    for _ in 0..ROUNDS {
        let (d, enough) = remaining(&state);
        if d.abs() <= enough {
            return Ok(state);
        }
        if d.is_nan() {
            return Err(ExactError::State {
                what: "the sound speed becomes imaginary on an isentrope",
                chi: state.chi,
            });
        }
        if d.abs() < nearest.0 {
            nearest = (d.abs(), state);
        }
        if d > 0.0 {
            low = state.chi
        } else {
            high = high.min(state.chi)
        }
        let d = d.clamp(-0.2, 0.2 * (1.0 - m.s * state.chi).min(1.0));
        let mut chi = state.chi + d;
        // rounding may put the root just outside of a bracket that has closed on it
        let slack = 1e-12 * (1.0 + chi.abs());
        if chi < low - slack || chi > high + slack {
            chi = 0.5 * (low + high);
        }
        state = to_compression(m, state, side, chi)?;
    }
    // far from rest, the rounding error of the pressure exceeds that of chi
    let (d, state) = nearest;
    if d <= 1e-13 * (1.0 + state.chi.abs()) {
        return Ok(state);
    }
    Err(ExactError::State { what, chi: state.chi })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::samples::{ALUMINIUM, COPPER};
    use crate::exact::wave::{shocked, wave};

    #[test]
    fn goes_down_and_comes_back() {
        let top = shocked(&COPPER, 309.064223);
        let down = to_pressure(&COPPER, top, 1.0, 0.0).unwrap();
        assert!(down.p == 0.0 && down.chi < 0.0);
        let back = to_compression(&COPPER, down, 1.0, top.chi).unwrap();
        assert!((back.p / top.p - 1.0).abs() < 1e-10 && (back.u - top.u).abs() < 1e-8);
        assert!((back.e / top.e - 1.0).abs() < 1e-10);
    }

    #[test]
    fn a_velocity_is_reached_from_both_sides() {
        let rest = WaveState { u: 7.0, ..WaveState::default() };
        for (side, u) in [(1.0, 300.0), (-1.0, 300.0), (1.0, -100.0)] {
            let there = to_velocity(&COPPER, rest, side, u).unwrap();
            assert!((there.p > 0.0) == (side * u > 0.0), "{there:?}");
            let back = to_compression(&COPPER, there, side, 0.0).unwrap();
            assert!((back.u - 7.0).abs() < 1e-8 && back.p.abs() < 1.0, "{back:?}");
        }
    }

    #[test]
    fn is_the_limit_of_many_weak_fronts() {
        let top = shocked(&ALUMINIUM, 1500.0);
        let want = to_compression(&ALUMINIUM, top, 1.0, 0.02).unwrap();
        let error = |n| (wave(&ALUMINIUM, &top, 0.02 - top.chi, 1.0, n).behind.u - want.u).abs();
        assert!(error(100) < 3e-3, "{}", error(100));
        assert!((error(100) / error(200) - 4.0).abs() < 0.05);
    }
}
