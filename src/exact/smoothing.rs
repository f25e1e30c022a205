//! Conversion of tracked fronts to a piecewise-linear solution of second order.
//!
//! Front tracking yields a staircase: each small front carries a jump that stands for a section of
//! a smooth wave. The true wave passes half-way up each jump at the position of the front. Each
//! jump is therefore spread into two ramps: one half back to the neighbour of its family, the other
//! half on to the next one. The ramps join the half-way points by straight lines. Waves of
//! different families that cross each other are superposed, which is correct to second order in
//! their jumps. Strong fronts (shocks, interfaces) remain jumps and end the ramps. The axis is
//! either position (profiles) or time (histories).

/// A front on the axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step<const N: usize> {
    /// Position on the axis [m or s].
    pub at: f64,
    /// 0 left-going, 1 contact, 2 right-going.
    pub family: usize,
    /// Whether the front remains a jump.
    pub strong: bool,
    /// Whether the front is the edge of a wave: it is not spread, and always counts as a neighbour.
    pub edge: bool,
    /// Values after the front, each in its own unit.
    pub after: [f64; N],
}

/// A neighbour that is this many times further away than the neighbour on the other side belongs to
/// another wave. A front that is this many times smaller does not count as a neighbour.
const APART: f64 = 5.0;

/// A bend of the line: position, change of slope, jump.
type Bend<const N: usize> = (f64, [f64; N], [f64; N]);

/// The smooth solution from `start` (values `first`) to `end`: corner points, doubled where it
/// jumps. The value with the index `measure` gives the strength of a wave: every wave must change
/// it.
pub(super) fn smooth<const N: usize>(
    start: f64,
    end: f64,
    first: [f64; N],
    steps: &[Step<N>],
    measure: usize,
) -> Vec<(f64, [f64; N])> {
    let mut out = Vec::with_capacity(2 * steps.len() + 4);
    let (mut from, mut before) = (start, first);
    let mut rest = steps;
    loop {
        let length = rest.iter().position(|s| s.strong).unwrap_or(rest.len());
        let to = rest.get(length).map_or(end, |s| s.at);
        segment([from, to], before, &rest[..length], measure, &mut out);
        match rest.get(length) {
            Some(strong) => (from, before, rest) = (strong.at, strong.after, &rest[length + 1..]),
            None => return out,
        }
    }
}

fn times<const N: usize>(a: &[f64; N], w: f64) -> [f64; N] {
    a.map(|v| v * w)
}

fn add<const N: usize>(to: &mut [f64; N], a: &[f64; N], w: f64) {
    for (t, a) in to.iter_mut().zip(a) {
        *t += w * a;
    }
}

/// Smooths one section without strong fronts.
fn segment<const N: usize>(
    limits: [f64; 2],
    first: [f64; N],
    steps: &[Step<N>],
    measure: usize,
    out: &mut Vec<(f64, [f64; N])>,
) {
    let mut value = first;
    let mut bends: Vec<Bend<N>> = Vec::with_capacity(3 * steps.len());
    for family in 0..3 {
        let own: Vec<(&Step<N>, [f64; N])> = steps
            .iter()
            .enumerate()
            .filter(|(_, s)| s.family == family)
            .map(|(i, s)| {
                let mut jump = s.after;
                add(&mut jump, if i == 0 { &first } else { &steps[i - 1].after }, -1.0);
                (s, jump)
            })
            .collect();
        for i in 0..own.len() {
            spread(&own, i, limits, measure, &mut bends, &mut value);
        }
    }
    bends.retain(|b| b.0 < limits[1]);
    bends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut at, mut slope) = (limits[0], [0.0; N]);
    out.push((at, value));
    for group in bends.chunk_by(|a, b| a.0 == b.0) {
        let place = group[0].0.max(at);
        add(&mut value, &slope, place - at);
        if place > at {
            out.push((place, value));
        }
        at = place;
        let mut jumped = false;
        for (_, change, jump) in group {
            add(&mut slope, change, 1.0);
            add(&mut value, jump, 1.0);
            jumped |= jump.iter().any(|&j| j != 0.0);
        }
        if jumped {
            out.push((at, value));
        }
    }
    add(&mut value, &slope, limits[1] - at);
    out.push((limits[1], value));
}

/// Spreads the jump of front `i` of one family.
fn spread<const N: usize>(
    own: &[(&Step<N>, [f64; N])],
    i: usize,
    limits: [f64; 2],
    measure: usize,
    bends: &mut Vec<Bend<N>>,
    start: &mut [f64; N],
) {
    let (step, jump) = &own[i];
    // contacts have no jump of pressure: the last of the values measures them
    let size = |j: &[f64; N]| if step.family == 1 { j[N - 1].abs() } else { j[measure].abs() };
    if step.edge || jump.iter().all(|&j| j == 0.0) {
        return;
    }
    let x = step.at;
    let counts = |(s, j): &&(&Step<N>, [f64; N])| s.edge || size(j) * APART > size(jump);
    let away = |found: Option<&(&Step<N>, [f64; N])>| {
        found.map(|(s, _)| (s.at - x).abs()).filter(|&d| d > 0.0)
    };
    let mut left = away(own[..i].iter().rev().find(counts));
    let mut right = away(own[i + 1..].iter().find(counts));
    // a wave that a strong front or the end of the axis cuts off extends to the cut
    let cut = [x - limits[0], limits[1] - x];
    let mut attached = [false; 2];
    match (left, right) {
        (None, None) => {
            bends.push((x, [0.0; N], *jump));
            return;
        }
        (Some(l), None) => {
            attached[1] = cut[1] <= 1.5 * l;
            right = Some(l);
        }
        (None, Some(r)) => {
            attached[0] = cut[0] <= 1.5 * r;
            left = Some(r);
        }
        (Some(l), Some(r)) => {
            if l > APART * r {
                left = Some(r);
            } else if r > APART * l {
                right = Some(l);
            }
        }
    }
    let (Some(left), Some(right)) = (left, right) else { return };
    let zero = [0.0; N];
    if attached[0] {
        // the line through the half-way points of this front and of an equal one beyond the limit
        let w = (cut[0] / left).min(1.0);
        add(start, jump, 0.5 - w);
        let width = cut[0].max(f64::MIN_POSITIVE);
        bends.push((limits[0], times(jump, w / width), zero));
        bends.push((x, times(jump, -w / width), zero));
    } else {
        let slope = times(jump, 0.5 / left);
        let from = x - left;
        if from < limits[0] {
            add(start, &slope, limits[0] - from);
        }
        bends.push((from.max(limits[0]), slope, zero));
        bends.push((x, times(&slope, -1.0), zero));
    }
    if attached[1] {
        let w = (cut[1] / right).min(1.0);
        let width = cut[1].max(f64::MIN_POSITIVE);
        bends.push((x, times(jump, w / width), zero));
        bends.push((limits[1], times(jump, -w / width), zero));
    } else {
        let slope = times(jump, 0.5 / right);
        bends.push((x, slope, zero));
        bends.push((x + right, times(&slope, -1.0), zero));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weak(at: f64, family: usize, after: f64) -> Step<1> {
        Step { at, family, strong: false, edge: false, after: [after] }
    }

    fn value(corners: &[(f64, [f64; 1])], x: f64) -> f64 {
        let k = corners.partition_point(|c| c.0 <= x).clamp(1, corners.len() - 1);
        let (a, b) = (corners[k - 1], corners[k]);
        a.1[0] + (b.1[0] - a.1[0]) * (x - a.0) / (b.0 - a.0)
    }

    /// A straight ramp from 0 at x = 1 to 1 at x = 2 in ten fronts with edges.
    fn ramp(family: usize, place: impl Fn(f64) -> f64) -> Vec<(f64, usize, f64, bool)> {
        let mut steps = vec![(place(1.0), family, 0.0, true)];
        steps.extend((0..10).map(|k| (place(1.05 + 0.1 * k as f64), family, 0.1, false)));
        steps.push((place(2.0), family, 0.0, true));
        steps
    }

    fn build(mut parts: Vec<(f64, usize, f64, bool)>) -> Vec<Step<1>> {
        parts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut sum = 0.0;
        let add = |(at, family, jump, edge)| {
            sum += jump;
            Step { at, family, strong: false, edge, after: [sum] }
        };
        parts.into_iter().map(add).collect()
    }

    #[test]
    fn straight_waves_of_two_families_are_exact() {
        let mut parts = ramp(0, |x| x);
        parts.extend(ramp(2, |x| 1.3 + 0.61 * (x - 1.0)));
        let out = smooth(0.0, 3.0, [0.0], &build(parts), 0);
        for k in 0..=60 {
            let x = 0.05 * k as f64;
            let want = (x - 1.0).clamp(0.0, 1.0) + ((x - 1.3) / 0.61).clamp(0.0, 1.0);
            assert!((value(&out, x) - want).abs() < 1e-12, "{x}: {} {want}", value(&out, x));
        }
    }

    #[test]
    fn a_wave_cut_by_a_strong_front_goes_on_to_it() {
        // half a ramp, then a jump to 5 at x = 1.42
        let mut steps: Vec<_> = build(ramp(2, |x| x)).into_iter().filter(|s| s.at < 1.42).collect();
        steps.push(Step { strong: true, ..weak(1.42, 2, 5.0) });
        let out = smooth(0.0, 2.0, [0.0], &steps, 0);
        for x in [0.5, 1.01, 1.2, 1.41999] {
            assert!((value(&out, x) - f64::max(x - 1.0, 0.0)).abs() < 1e-4, "{x}");
        }
        assert!((value(&out, 1.7) - 5.0).abs() < 1e-12);
        assert!(out.windows(2).all(|w| w[0].0 <= w[1].0));
    }
}
