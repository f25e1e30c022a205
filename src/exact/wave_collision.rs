//! Outgoing waves of a collision of two fronts: the Riemann problem between two states, of one or
//! two materials, and at a free surface.
//!
//! The left-going wave has the strength a, the right-going wave the strength b; pressure and
//! velocity are equal between them. Newton's method starts from the strengths of the incoming
//! fronts. If it fails, as in strong impacts of compressible materials, the pressure is found by
//! bisection.

use super::isentrope::least_pressure;
use super::wave::{Jump, WaveState, wave};
use crate::material::MieGruneisen;

/// The two waves that leave a collision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outgoing {
    /// Strength (change of the compression chi) [-] and number of steps of the left-going wave.
    pub left: (f64, usize),
    /// Strength [-] and number of steps of the right-going wave.
    pub right: (f64, usize),
    /// State behind the left-going wave.
    pub left_star: WaveState,
    /// State behind the right-going wave.
    pub right_star: WaveState,
}

/// A material and the state ahead of a wave.
pub(super) type CollidingState<'a> = (&'a MieGruneisen, &'a WaveState);

/// Number of steps of a wave with the change of pressure `dp` [Pa]; shocks are never split.
fn steps(dp: f64, quantum: f64) -> usize {
    if dp < -1.5 * quantum { (-dp / quantum).round() as usize } else { 1 }
}

/// Limits a strength to the range in which the material can be compressed or stretched.
fn bounded(m: &MieGruneisen, state: &WaveState, d: f64) -> f64 {
    let room = (1.0f64.min(1.0 / m.s) - state.chi).max(1e-3);
    d.clamp(-3.0, 0.9 * room)
}

/// A wave whose number of steps follows its strength, unless it is `fixed`.
fn stepped(
    (m, state): CollidingState,
    d: f64,
    side: f64,
    quantum: f64,
    count: &mut usize,
    fixed: bool,
) -> Jump {
    let mut out = wave(m, state, d, side, *count);
    if !fixed {
        let wanted = steps(out.behind.p - state.p, quantum);
        if wanted != *count {
            *count = wanted;
            out = wave(m, state, d, side, wanted);
        }
    }
    out
}

/// Solves the Riemann problem between `left` and `right`. `guess` holds the initial strengths,
/// `quantum` is the pressure of one step of a fan [Pa], and `tolerance` the allowed difference of
/// the pressures [Pa].
pub(super) fn collide(
    left: CollidingState,
    right: CollidingState,
    guess: (f64, f64),
    quantum: f64,
    tolerance: f64,
) -> Option<Outgoing> {
    let (mut a, mut b) = guess;
    let (mut na, mut nb) = (1, 1);
    let impedance = left.0.rho0 * left.0.c0;
    for round in 0..60 {
        let fixed = round > 4;
        let l = stepped(left, a, -1.0, quantum, &mut na, fixed);
        let r = stepped(right, b, 1.0, quantum, &mut nb, fixed);
        let dp = l.behind.p - r.behind.p;
        let du = l.behind.u - r.behind.u;
        if !(dp.is_finite() && du.is_finite()) {
            break;
        }
        if dp.abs() <= tolerance && du.abs() * impedance <= tolerance {
            return Some(Outgoing {
                left: (a, na),
                right: (b, nb),
                left_star: l.behind,
                right_star: r.behind,
            });
        }
        // l.dp da - r.dp db = -dp;  -l.du da - r.du db = -du
        let determinant = l.dp * r.du + r.dp * l.du;
        a = bounded(left.0, left.1, a + (r.dp * du - r.du * dp) / determinant);
        b = bounded(right.0, right.1, b + (l.dp * du + l.du * dp) / determinant);
    }
    collide_by_bisection(left, right, quantum)
}

/// Same as [`collide`], by bisection for the pressure between the waves. `None` if the two sides
/// separate faster than tension can stretch them.
fn collide_by_bisection(
    left: CollidingState,
    right: CollidingState,
    quantum: f64,
) -> Option<Outgoing> {
    let at = |p: f64| {
        let l = reach(left.0, left.1, p, -1.0, quantum)?;
        let r = reach(right.0, right.1, p, 1.0, quantum)?;
        Some((l, r))
    };
    // the left side's velocity decreases with the pressure, the right side's increases
    let rises = |p: f64| at(p).is_some_and(|(l, r)| l.2.u > r.2.u);
    let scale = left.1.p.abs().max(right.1.p.abs()).max(left.0.rho0 * left.0.c0 * left.0.c0);
    let least = least_pressure(left.0).max(least_pressure(right.0));
    let (mut low, mut high) = (0.0, scale);
    if rises(0.0) {
        while rises(high) {
            (low, high) = (high, 2.0 * high);
        }
    } else {
        (low, high) = if least.is_finite() { (least, 0.0) } else { (-scale, 0.0) };
        // a Mie-Grueneisen material without gamma0 has no lower bound of the pressure
        while !least.is_finite() && !rises(low) {
            (low, high) = (2.0 * low, low);
            if low < -1e3 * scale {
                return None;
            }
        }
    }
    loop {
        let middle = 0.5 * (low + high);
        if !(middle > low && middle < high) {
            break;
        }
        if rises(middle) { low = middle } else { high = middle }
    }
    let ((a, na, left_star), (b, nb, right_star)) = at(high)?;
    // without a root the search ends at the lowest pressure, where the velocities still differ
    let speed = left.0.c0.max(right.0.c0);
    let meets = (left_star.u - right_star.u).abs() <= 1e-9 * speed;
    meets.then_some(Outgoing { left: (a, na), right: (b, nb), left_star, right_star })
}

/// The wave that brings `state` to the pressure `p`: strength, number of steps, state behind. Found
/// by bisection.
fn reach(
    m: &MieGruneisen,
    state: &WaveState,
    p: f64,
    side: f64,
    quantum: f64,
) -> Option<(f64, usize, WaveState)> {
    if p == state.p {
        return Some((0.0, 1, *state));
    }
    let count = steps(p - state.p, quantum);
    let too_much = |d: f64| {
        let there = wave(m, state, d, side, count).behind.p;
        // beyond its limit density a material has no state
        there >= p || !there.is_finite()
    };
    let (mut low, mut high);
    if p > state.p {
        let limit = 1.0f64.min(m.limiting_compression()) - state.chi;
        let shock = if m.gamma0 > 0.0 { 2.0 / m.gamma0 } else { f64::INFINITY };
        (low, high) = (0.0, limit.min(shock));
    } else {
        (low, high) = (-0.1, 0.0);
        while too_much(low) {
            (low, high) = (2.0 * low, low);
            if low < -100.0 {
                return None;
            }
        }
    }
    loop {
        let middle = 0.5 * (low + high);
        if !(middle > low && middle < high) {
            break;
        }
        if too_much(middle) { high = middle } else { low = middle }
    }
    // both ends differ by rounding; the lower one is within the limit density
    let behind = wave(m, state, low, side, count).behind;
    let close = (behind.p - p).abs() <= 1e-9 * (p.abs() + state.p.abs());
    (close && behind.u.is_finite()).then_some((low, count, WaveState { p, ..behind }))
}

/// The wave that brings `state` to the pressure 0 of a free surface: strength, number of steps,
/// state behind.
pub(super) fn set_free(
    m: &MieGruneisen,
    state: &WaveState,
    side: f64,
    quantum: f64,
    tolerance: f64,
) -> Option<(f64, usize, WaveState)> {
    let (mut d, mut count) = (0.0, 1);
    for round in 0..60 {
        let out = stepped((m, state), d, side, quantum, &mut count, round > 4);
        if !out.behind.p.is_finite() {
            break;
        }
        if out.behind.p.abs() <= tolerance {
            return Some((d, count, WaveState { p: 0.0, ..out.behind }));
        }
        d = bounded(m, state, d - out.behind.p / out.dp);
    }
    reach(m, state, 0.0, side, quantum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::samples::{ALUMINIUM, COPPER};
    use crate::exact::wave::{at_rest, shocked};
    use crate::exact::wave_interactions::impedance_match;

    #[test]
    fn two_plates_meet_at_the_impedance_match() {
        for speed in [10.0, 1000.0, 5000.0] {
            let (l, r) = (at_rest(speed), at_rest(0.0));
            let out = collide((&COPPER, &l), (&ALUMINIUM, &r), (0.0, 0.0), 1e8, 1.0).unwrap();
            let want = impedance_match(&COPPER, &ALUMINIUM, speed);
            assert!(
                (out.left_star.u - want).abs() < 1e-6 && (out.right_star.u - want).abs() < 1e-6
            );
        }
    }

    #[test]
    fn a_free_surface_gives_a_fan() {
        let top = shocked(&COPPER, 309.064223);
        let (d, n, free) = set_free(&COPPER, &top, 1.0, top.p / 100.0, 1.0).unwrap();
        assert!(d < 0.0 && n == 100 && free.p == 0.0);
        // state 3 of the true solution, in the frame where the target is at rest
        let u3 = 690.935777 + (free.u - top.u);
        assert!((u3 - 381.582123).abs() < 1e-4, "{u3}");
    }
}
