//! One wave in a Mie-Grueneisen material, as a function of the change of compression across it.
//!
//! With d = chi* - chi (behind minus ahead), the jump conditions of a shock in mass coordinates and
//! the linear energy term of the EOS give all quantities without iteration and without
//! cancellation:
//!
//! ```text
//! p* - p = K d,   K = (F + gamma0 p)/(1 - gamma0 d/2),   F = (f(chi*) - f(chi))/d
//! u* - u = +- W d,   W = sqrt(K/rho0)   the speed of the front in Lagrangian coordinates
//! e* - e = (p + p*)/2 d/rho0
//! ```
//!
//! (Rankine-Hugoniot with v = (1 - chi)/rho0.) At d = 0, K = f' + gamma0 p and W is the Lagrangian
//! sound speed. For d < 0 the same relation, applied in small steps, follows the isentrope with an
//! error of third order per step.

use crate::material::{EquationOfState, MieGruneisen};

/// State of one material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct WaveState {
    /// Compression 1 - rho0/rho [-].
    pub chi: f64,
    /// Pressure [Pa].
    pub p: f64,
    /// Velocity [m/s].
    pub u: f64,
    /// Specific internal energy [J/kg].
    pub e: f64,
}

/// The state behind a wave, with its derivatives by the strength d of the wave.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jump {
    /// State behind the wave; see [`jump`] for the sign of the velocity.
    pub behind: WaveState,
    /// Lagrangian speed of the front [m/s].
    pub speed: f64,
    /// dp*/dd [Pa].
    pub dp: f64,
    /// |du*/dd| [m/s].
    pub du: f64,
}

/// (f(chi + d) - f(chi))/d and its derivative by d [Pa].
fn secant(m: &MieGruneisen, chi: f64, d: f64) -> (f64, f64) {
    let stiffness = m.rho0 * m.c0 * m.c0;
    let to = chi + d;
    if chi <= 0.0 && to <= 0.0 {
        return (stiffness, 0.0);
    }
    // f = stiffness ((r^2 - r)/s - gamma0/2 (r - 1)^2/s^2) with r = 1/(1 - s chi)
    let h = 0.5 * m.gamma0 / m.s;
    let r = 1.0 / (1.0 - m.s * chi.max(0.0));
    let r_to = 1.0 / (1.0 - m.s * to.max(0.0));
    let inner = r + r_to - 1.0 - h * (r + r_to - 2.0);
    let slope = stiffness * r * r_to * inner;
    if chi >= 0.0 && to >= 0.0 {
        let change = stiffness * r * m.s * r_to * r_to * (inner + r_to * (1.0 - h));
        return (slope, change);
    }
    // one end is in tension, where f is a straight line
    let rise = slope * (to.max(0.0) - chi.max(0.0)) + stiffness * (to.min(0.0) - chi.min(0.0));
    let mean = rise / d;
    (mean, (m.cold_slope(to) - mean) / d)
}

/// One front of strength `d` that moves into `ahead`; `side` is +1 if it moves to the right, -1 to
/// the left.
#[inline]
pub(super) fn jump(m: &MieGruneisen, ahead: &WaveState, d: f64, side: f64) -> Jump {
    let (f, f_slope) = secant(m, ahead.chi, d);
    let denominator = 1.0 / (1.0 - 0.5 * m.gamma0 * d);
    let k = (f + m.gamma0 * ahead.p) * denominator;
    let k_slope = (f_slope + 0.5 * m.gamma0 * k) * denominator;
    let speed = (k / m.rho0).sqrt();
    let p = ahead.p + k * d;
    Jump {
        behind: WaveState {
            chi: ahead.chi + d,
            p,
            u: ahead.u + side * speed * d,
            e: ahead.e + 0.5 * (p + ahead.p) * d / m.rho0,
        },
        speed,
        dp: k + k_slope * d,
        du: speed + 0.5 * k_slope * d / (m.rho0 * speed),
    }
}

/// A wave of strength `d`: a single front, or a fan of `steps` equal fronts.
pub(super) fn wave(m: &MieGruneisen, ahead: &WaveState, d: f64, side: f64, steps: usize) -> Jump {
    if steps <= 1 {
        return jump(m, ahead, d, side);
    }
    let part = d / steps as f64;
    let mut state = *ahead;
    for _ in 0..steps {
        state = jump(m, &state, part, side).behind;
    }
    // along an isentrope dp = rho0 C^2 dchi and du = C dchi, C the Lagrangian sound speed
    let c = jump(m, &state, 0.0, side).speed;
    Jump { behind: state, speed: c, dp: m.rho0 * c * c, du: c }
}

/// Lagrangian sound speed, rho c/rho0 [m/s].
pub(super) fn sound_speed(m: &MieGruneisen, state: &WaveState) -> f64 {
    jump(m, state, 0.0, 1.0).speed
}

/// The undisturbed material (pressure 0) at the velocity `u` [m/s].
pub(super) fn at_rest(u: f64) -> WaveState {
    WaveState { u, ..WaveState::default() }
}

/// The state behind a shock with the velocity jump `up` [m/s] into undisturbed material at pressure
/// 0; its `u` is the jump alone.
pub(super) fn shocked(m: &MieGruneisen, up: f64) -> WaveState {
    let us = m.c0 + m.s * up;
    WaveState { chi: up / us, p: m.rho0 * us * up, u: up, e: 0.5 * up * up }
}

/// Density of a state [kg/m3].
pub(super) fn density(m: &MieGruneisen, state: &WaveState) -> f64 {
    m.reference_density() / (1.0 - state.chi)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::samples::{ALUMINIUM, COPPER};

    #[test]
    fn fronts_keep_the_jump_conditions_and_the_equation_of_state() {
        for (chi, d) in
            [(0.0, 0.1), (0.05, 0.1), (-0.02, 0.1), (0.1, -0.12), (0.1, 1e-9), (-0.01, -0.02)]
        {
            let start = WaveState { chi, p: COPPER.pressure(1.0 - chi, 1e4), u: 30.0, e: 1e4 };
            for side in [-1.0, 1.0] {
                let j = jump(&COPPER, &start, d, side);
                let b = j.behind;
                assert!(
                    (COPPER.pressure(1.0 - b.chi, b.e) - b.p).abs()
                        < 1e-15 * 1e11 + 1e-13 * b.p.abs()
                );
                let momentum = COPPER.rho0 * j.speed * side * (b.u - start.u);
                assert!((momentum - (b.p - start.p)).abs() < 1e-3);
                assert!((side * (b.u - start.u) - j.speed * d).abs() < 1e-12 * 1e3);
            }
        }
    }

    #[test]
    fn slopes_are_derivatives() {
        for (chi, d) in [(0.0, 0.1), (0.05, -0.03), (-0.02, 0.1), (0.1, -0.13), (0.1, 0.0)] {
            let start = WaveState { chi, p: ALUMINIUM.pressure(1.0 - chi, 2e4), u: 0.0, e: 2e4 };
            let at = |d| jump(&ALUMINIUM, &start, d, 1.0);
            let h = 1e-6;
            let dp = (at(d + h).behind.p - at(d - h).behind.p) / (2.0 * h);
            let du = (at(d + h).behind.u - at(d - h).behind.u) / (2.0 * h);
            assert!((at(d).dp / dp - 1.0).abs() < 1e-6, "{chi} {d}");
            assert!((at(d).du / du - 1.0).abs() < 1e-6, "{chi} {d}");
        }
    }

    #[test]
    fn a_front_without_strength_runs_at_the_sound_speed() {
        let start = WaveState { chi: 0.1, p: ALUMINIUM.pressure(0.9, 2e5), u: 0.0, e: 2e5 };
        let c = ALUMINIUM.sound_speed_squared(0.9, start.p).sqrt() / 0.9;
        assert!((sound_speed(&ALUMINIUM, &start) / c - 1.0).abs() < 1e-14);
    }

    #[test]
    fn one_front_from_rest_is_the_hugoniot() {
        let want = shocked(&COPPER, 309.064223);
        let got = jump(&COPPER, &at_rest(0.0), want.chi, 1.0).behind;
        assert!((got.p / want.p - 1.0).abs() < 1e-14 && (got.e / want.e - 1.0).abs() < 1e-13);
    }
}
