//! From tracked fronts to a piecewise-linear solution of second order.
//!
//! Front tracking leaves a staircase: each small front carries a jump that stands for a stretch
//! of a smooth wave. The true wave passes half-way up each jump, where the front is. Between two
//! neighbours of one family the staircase is therefore turned into a ramp; waves of different
//! families that run through each other are superposed, which is right to second order in their
//! jumps. Strong fronts (shocks, interfaces) stay jumps and end the ramps. The axis may be a
//! place (profiles) or time (histories).

/// Families of fronts, in the order of their index.
pub(super) const FAMILIES: usize = 3;

/// A front on the axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step<const N: usize> {
    /// Where it stands on the axis.
    pub at: f64,
    /// 0 left-going, 1 contact, 2 right-going.
    pub family: usize,
    /// Stays a jump.
    pub strong: bool,
    /// Ends a wave: beyond it there is nothing to lean on.
    pub edge: bool,
    /// Values after it.
    pub after: [f64; N],
}

/// Corner of a correction: place, its value just before and just after.
type Corner<const N: usize> = (f64, [f64; N], [f64; N]);

/// The smooth solution from `start` (values `first`) to `end`: corners, doubled where it jumps.
pub(super) fn smooth<const N: usize>(
    start: f64,
    end: f64,
    first: [f64; N],
    steps: &[Step<N>],
) -> Vec<(f64, [f64; N])> {
    let mut out = Vec::with_capacity(2 * steps.len() + 4);
    let (mut from, mut before) = (start, first);
    let mut rest = steps;
    loop {
        let length = rest.iter().position(|s| s.strong).unwrap_or(rest.len());
        let to = rest.get(length).map_or(end, |s| s.at);
        segment(from, to, before, &rest[..length], &mut out);
        match rest.get(length) {
            Some(strong) => (from, before, rest) = (strong.at, strong.after, &rest[length + 1..]),
            None => return out,
        }
    }
}

fn combine<const N: usize>(a: &[f64; N], wa: f64, b: &[f64; N], wb: f64) -> [f64; N] {
    std::array::from_fn(|k| wa * a[k] + wb * b[k])
}

/// One stretch without strong fronts.
fn segment<const N: usize>(
    from: f64,
    to: f64,
    first: [f64; N],
    steps: &[Step<N>],
    out: &mut Vec<(f64, [f64; N])>,
) {
    let jumps: Vec<[f64; N]> = steps
        .iter()
        .enumerate()
        .map(|(i, s)| {
            let before = if i == 0 { &first } else { &steps[i - 1].after };
            combine(&s.after, 1.0, before, -1.0)
        })
        .collect();
    let corrections: [Vec<Corner<N>>; FAMILIES] =
        std::array::from_fn(|family| correction(from, to, steps, &jumps, family));
    let mut places: Vec<f64> = corrections.iter().flatten().map(|c| c.0).collect();
    places.extend(steps.iter().map(|s| s.at));
    places.extend([from, to]);
    places.retain(|x| (from..=to).contains(x));
    places.sort_by(f64::total_cmp);
    places.dedup();
    let mut passed = 0;
    let mut stair = first;
    for x in places {
        let side = |after: bool, stair: &[f64; N]| {
            let mut value = *stair;
            for c in &corrections {
                let add = value_of(c, x, after);
                for k in 0..N {
                    value[k] += add[k];
                }
            }
            value
        };
        let left = side(false, &stair);
        while passed < steps.len() && steps[passed].at <= x {
            stair = steps[passed].after;
            passed += 1;
        }
        let right = side(true, &stair);
        let scale: f64 = (0..N).map(|k| left[k].abs().max(right[k].abs())).fold(0.0, f64::max);
        let jumps = (0..N).any(|k| {
            (left[k] - right[k]).abs() > 1e-11 * scale.min(left[k].abs().max(right[k].abs()))
        });
        if x > from || x == to {
            out.push((x, left));
        }
        if (x < to && jumps) || x == from {
            out.push((x, right));
        }
    }
}

/// A front is a jump of its own, not a part of a smooth wave, if it is this many times greater
/// than both of its neighbours; two neighbours are of different waves if they are this many
/// times further apart than each is from its other neighbour.
const APART: f64 = 5.0;

/// What turns the staircase of one family into ramps, as a function with corners.
fn correction<const N: usize>(
    from: f64,
    to: f64,
    steps: &[Step<N>],
    jumps: &[[f64; N]],
    family: usize,
) -> Vec<Corner<N>> {
    let of_family = |i: &usize| steps[*i].family == family;
    let all: Vec<usize> = (0..steps.len()).filter(of_family).collect();
    let size = |k: usize| all.get(k).map_or(0.0, |&i| jumps[i][0].abs().max(tiny(&jumps[i])));
    let sharp = |k: usize| {
        let neighbours = size(k.wrapping_sub(1)).max(size(k + 1));
        !steps[all[k]].edge && size(k) > APART * neighbours
    };
    let own: Vec<usize> = (0..all.len()).filter(|&k| !sharp(k)).map(|k| all[k]).collect();
    let gap = |k: usize| match (own.get(k), own.get(k + 1)) {
        (Some(&a), Some(&b)) => Some(steps[b].at - steps[a].at),
        _ => None,
    };
    let mut corners = Vec::with_capacity(own.len() + 2);
    let mut start = 0;
    for k in 0..own.len() {
        let last = k + 1 == own.len();
        let around = [k.checked_sub(1).and_then(&gap), gap(k + 1)];
        let near = around.into_iter().flatten().fold(0.0, f64::max);
        if last || gap(k).is_some_and(|g| g > APART * near) {
            let limits =
                [if start == 0 { from } else { f64::NAN }, if last { to } else { f64::NAN }];
            let c0 = corners.len();
            wave(limits, steps, jumps, &own[start..=k], &mut corners);
            let area: f64 = corners[c0..].windows(2).map(|w| 0.5 * (w[0].2[1] + w[1].1[1]) * (w[1].0 - w[0].0)).sum();
            let full: f64 = jumps[own[start]..=own[k]].iter().map(|j| j[1].abs()).sum();
            if area.abs() > 1e-5 { println!("wave family {family} from {:.6e} to {:.6e} n {} area {:.3e} sum {:.3e} first {:.2e} {:.2e} last {:.2e} {:.2e}, at {:?}", steps[own[start]].at, steps[own[k]].at, k - start + 1, area, full, jumps[own[start]][1], jumps[own[(start+1).min(k)]][1], jumps[own[k]][1], jumps[own[k.max(1)-1]][1], own[start..=k].iter().take(4).map(|&i| steps[i].at).collect::<Vec<_>>()); }
            start = k + 1;
        }
    }
    corners
}

/// A size for jumps without pressure (contacts), too small to stand beside those with it.
fn tiny<const N: usize>(jump: &[f64; N]) -> f64 {
    1e-30 * jump.iter().fold(0.0, |a: f64, b| a.max(b.abs()))
}

/// The corners of one wave, the fronts `own`; its limits are where a strong front or the end of
/// the axis is, if there is nothing between.
fn wave<const N: usize>(
    limits: [f64; 2],
    steps: &[Step<N>],
    jumps: &[[f64; N]],
    own: &[usize],
    corners: &mut Vec<Corner<N>>,
) {
    let zero = [0.0; N];
    let [first, second, before, last] = match own {
        [] | [_] => return,
        [a, b] => [*a, *b, *a, *b],
        [a, b, .., c, d] => [*a, *b, *c, *d],
        [a, b, c] => [*a, *b, *b, *c],
    };
    let half = |i: usize, sign: f64| combine(&jumps[i], 0.5 * sign, &zero, 0.0);
    if let Some((x, value)) =
        beyond(&steps[first], &steps[second], &jumps[first], &jumps[second], limits[0], -1.0)
    {
        corners.push((x, zero, value));
    }
    for &i in own {
        let left = if i == first && steps[i].edge { zero } else { half(i, 1.0) };
        let right = if i == last && steps[i].edge { zero } else { half(i, -1.0) };
        corners.push((steps[i].at, left, right));
    }
    if let Some((x, value)) =
        beyond(&steps[last], &steps[before], &jumps[last], &jumps[before], limits[1], 1.0)
    {
        corners.push((x, combine(&value, -1.0, &zero, 0.0), zero));
    }
}

/// Where the line through an outermost front and its neighbour ends on the side `towards`, and
/// its value there (as on the side of the first front). A wave that reaches `limit` goes on to
/// it; one that does not (weak reflections, which begin without an edge) falls to nothing
/// within one spacing.
fn beyond<const N: usize>(
    outer: &Step<N>,
    inner: &Step<N>,
    jump: &[f64; N],
    inner_jump: &[f64; N],
    limit: f64,
    towards: f64,
) -> Option<(f64, [f64; N])> {
    let spacing = (inner.at - outer.at).abs();
    if outer.edge || spacing <= 0.0 {
        return None;
    }
    let w = (outer.at - limit).abs() / spacing;
    if w <= 1.5 {
        let w = w.min(1.0);
        return Some((limit, combine(jump, 0.5 - 0.5 * w, inner_jump, -0.5 * w)));
    }
    Some((outer.at + towards * spacing, [0.0; N]))
}

/// The correction at `x`, just before it or just after.
fn value_of<const N: usize>(corners: &[Corner<N>], x: f64, after: bool) -> [f64; N] {
    let next = if after {
        corners.partition_point(|c| c.0 <= x)
    } else {
        corners.partition_point(|c| c.0 < x)
    };
    match (next.checked_sub(1).map(|i| &corners[i]), corners.get(next)) {
        (Some(a), Some(b)) if b.0 > a.0 => {
            let w = (x - a.0) / (b.0 - a.0);
            combine(&a.2, 1.0 - w, &b.1, w)
        }
        // on the outermost corner itself
        (None, Some(b)) if b.0 == x => b.1,
        (Some(a), None) if a.0 == x => a.2,
        _ => [0.0; N],
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
        let out = smooth(0.0, 3.0, [0.0], &build(parts));
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
        let out = smooth(0.0, 2.0, [0.0], &steps);
        for x in [0.5, 1.01, 1.2, 1.41999] {
            assert!((value(&out, x) - f64::max(x - 1.0, 0.0)).abs() < 1e-4, "{x}");
        }
        assert_eq!(value(&out, 1.7), 5.0);
        assert!(out.windows(2).all(|w| w[0].0 <= w[1].0));
    }
}
