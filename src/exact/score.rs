//! Errors of a computed profile against an exact one, as defined in `docs/accuracy.md`.
//!
//! Particles, sorted by x, are joined by straight lines ("raw"); after [`cell_average`] the same is
//! done with the cell means. Beyond the first and the last point their values are held constant.
//! All errors are computed with the shock running to the right; a mirrored impact is reflected
//! first. An error that is not defined is `None`.

use serde::Serialize;

use super::{Landmarks, Profile, ProfilePoint};

/// A particle, or the mean of the particles in a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScoreSample {
    /// Position [m].
    pub x: f64,
    /// Current volume; in one dimension a length [m], in two an area [m2]. Only ratios matter.
    pub volume: f64,
    /// Pressure [Pa].
    pub p: f64,
    /// Density [kg/m3].
    pub rho: f64,
    /// Specific internal energy [J/kg].
    pub e: f64,
}

/// Errors of a profile; all are fractions [-] unless stated otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Relative L1 error of the pressure, int |p - p_exact| dx / int |p_exact| dx [-].
    pub l1: Option<f64>,
    /// Relative L2 error of the pressure: square root of int (p - p_exact)^2 dx / int p_exact^2 dx
    /// [-].
    pub l2: Option<f64>,
    /// int |p - p_exact| dx / P2 [cells].
    pub e1_cells: Option<f64>,
    /// Error of the mean pressure over the middle 40 % of the first plateau, relative to P2, signed
    /// [-].
    pub plateau: Option<f64>,
    /// Rms deviation of the pressure from a straight line over the same range, as a fraction of P2
    /// [-].
    pub noise: Option<f64>,
    /// Position of the shock: the first point, coming from ahead, where the pressure reaches half
    /// of the exact pressure behind the shock. Computed minus exact, positive in the direction of
    /// the shock [cells].
    pub shock_position_cells: Option<f64>,
    /// Distance between 10 % and 90 % of the exact pressure behind the shock [cells].
    pub rise_cells: Option<f64>,
    /// Greatest computed minus greatest exact pressure, as a fraction of P2, signed [-].
    pub overshoot: Option<f64>,
    /// Error of the mean pressure over the middle 60 % of the second plateau, relative to the exact
    /// mean, signed [-].
    pub second_plateau: Option<f64>,
    /// Error of the mean density over the middle 40 % of the first plateau, relative to rho2,
    /// signed [-].
    pub density_plateau: Option<f64>,
    /// Error of the mean specific internal energy over the same range, relative to e2, signed [-].
    pub energy_plateau: Option<f64>,
    /// int |rho - rho_exact| dx [kg/m2], for Riemann problems.
    pub density_l1: Option<f64>,
    /// Greatest error of the density within ten cells of the interface, as a fraction of rho2 [-].
    /// Errors of the energy appear here, not in the pressure.
    pub density_interface: Option<f64>,
    /// Greatest error of the specific internal energy there, as a fraction of e2 [-].
    pub energy_interface: Option<f64>,
    /// L1 split by the regions of the solution.
    pub waves: Option<WaveErrors>,
}

/// L1 split by the regions of the exact solution [-]; the parts add up to the total.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct WaveErrors {
    /// L1 in the region of the shock, ahead of it and up to ten cells behind it [-].
    pub shock: f64,
    /// L1 from there back to the head of the fan, or to the interface while there is no fan [-].
    pub plateau_2: f64,
    /// L1 within the fan, from its head to the start of the second plateau [-].
    pub fan: f64,
    /// L1 on the second plateau and behind it [-].
    pub second_plateau: f64,
}

/// Extent of the shock's region behind the shock [cells]: no scheme smears a shock further.
const SHOCK_REACH: f64 = 10.0;

/// Parts of L1 by region; `None` if there is no shock in the body, or no pressure.
fn wave_errors(
    computed: &[(f64, f64)],
    truth: &[(f64, f64)],
    marks: &Landmarks,
    size: f64,
    h: f64,
) -> Option<WaveErrors> {
    let (lower, upper) = (marks.interface, marks.far_end);
    let shock = (marks.shock? - SHOCK_REACH * h).max(lower);
    let head = marks.plateau.map_or(lower, |zone| zone[0]).clamp(lower, shock);
    // without a second plateau the whole range behind the head counts as the fan
    let tail = marks.second_plateau.map_or(lower, |zone| zone[1]).clamp(lower, head);
    let part = |from: f64, to: f64| match to > from {
        true => integrals(&cut(computed, from, to), &cut(truth, from, to), from, to)[0] / size,
        false => 0.0,
    };
    (size > 0.0).then(|| WaveErrors {
        shock: part(shock, upper),
        plateau_2: part(head, shock),
        fan: part(tail, head),
        second_plateau: part(lower, tail),
    })
}

/// Replaces the particles in each grid cell (cells of size `h` [m], one face at `origin` [m]) by
/// their volume-weighted mean, at their mean position. `samples` must be sorted by x.
pub fn cell_average(samples: &[ScoreSample], h: f64, origin: f64) -> Vec<ScoreSample> {
    let cell = |s: &ScoreSample| ((s.x - origin) / h).floor();
    samples
        .chunk_by(|a, b| cell(a) == cell(b))
        .map(|group| {
            let volume: f64 = group.iter().map(|s| s.volume).sum();
            let mean = |f: fn(&ScoreSample) -> f64| {
                group.iter().map(|s| s.volume * f(s)).sum::<f64>() / volume
            };
            ScoreSample {
                x: mean(|s| s.x),
                volume,
                p: mean(|s| s.p),
                rho: mean(|s| s.rho),
                e: mean(|s| s.e),
            }
        })
        .collect()
}

/// A piecewise-linear function.
type Polyline = Vec<(f64, f64)>;

/// Joins the samples by lines over [`lower`, `upper`]; the outermost values extend to the ends.
fn line(
    samples: &[ScoreSample],
    lower: f64,
    upper: f64,
    value: fn(&ScoreSample) -> f64,
) -> Polyline {
    let mut points: Polyline = samples.iter().map(|s| (s.x, value(s))).collect();
    if let (Some(&first), Some(&last)) = (points.first(), points.last()) {
        if first.0 > lower {
            points.insert(0, (lower, first.1));
        }
        if last.0 < upper {
            points.push((upper, last.1));
        }
    }
    cut(&points, lower, upper)
}

/// The part of a line within [`lower`, `upper`].
fn cut(points: &[(f64, f64)], lower: f64, upper: f64) -> Polyline {
    let as_points =
        points.iter().map(|&(x, p)| ProfilePoint { x, p, ..ProfilePoint::default() }).collect();
    let part = Profile { points: as_points }.between(lower, upper);
    part.points.iter().map(|q| (q.x, q.p)).collect()
}

/// Integrals over [`lower`, `upper`] of |a - b|, (a - b)^2, |b| and b^2, for two lines that cover
/// the range.
fn integrals(a: &[(f64, f64)], b: &[(f64, f64)], lower: f64, upper: f64) -> [f64; 4] {
    let mut places: Vec<f64> = a.iter().chain(b).map(|q| q.0).collect();
    places.extend([lower, upper]);
    places.retain(|x| (lower..=upper).contains(x));
    places.sort_by(f64::total_cmp);
    places.dedup();
    let mut sums = [0.0; 4];
    let (mut ka, mut kb) = (0, 0);
    for pair in places.windows(2) {
        let (x0, x1) = (pair[0], pair[1]);
        let (Some(va), Some(vb)) = (piece(a, &mut ka, x0, x1), piece(b, &mut kb, x0, x1)) else {
            continue;
        };
        let (d0, d1) = (va.0 - vb.0, va.1 - vb.1);
        sums[0] += (x1 - x0) * mean_size(d0, d1);
        sums[1] += (x1 - x0) * (d0 * d0 + d0 * d1 + d1 * d1) / 3.0;
        sums[2] += (x1 - x0) * mean_size(vb.0, vb.1);
        sums[3] += (x1 - x0) * (vb.0 * vb.0 + vb.0 * vb.1 + vb.1 * vb.1) / 3.0;
    }
    sums
}

/// Mean of |d| on a piece where d varies linearly from `d0` to `d1`.
fn mean_size(d0: f64, d1: f64) -> f64 {
    if d0 * d1 >= 0.0 {
        0.5 * (d0 + d1).abs()
    } else {
        0.5 * (d0 * d0 + d1 * d1) / (d0.abs() + d1.abs())
    }
}

/// Values at both ends of [`x0`, `x1`], which lies within one piece of the line; `k` advances to
/// that piece.
fn piece(line: &[(f64, f64)], k: &mut usize, x0: f64, x1: f64) -> Option<(f64, f64)> {
    while *k + 1 < line.len() && (line[*k + 1].0 <= x0) {
        *k += 1;
    }
    let (a, b) = (line.get(*k)?, line.get(*k + 1)?);
    if a.0 > x0 || b.0 < x1 {
        return None;
    }
    let slope = (b.1 - a.1) / (b.0 - a.0);
    Some((a.1 + slope * (x0 - a.0), a.1 + slope * (x1 - a.0)))
}

/// Mean of a line over [`lower`, `upper`].
fn mean_over(points: &[(f64, f64)], lower: f64, upper: f64) -> Option<f64> {
    let part = cut(points, lower, upper);
    let area: f64 = part.windows(2).map(|w| 0.5 * (w[0].1 + w[1].1) * (w[1].0 - w[0].0)).sum();
    let width = part.last()?.0 - part.first()?.0;
    (width > 0.0).then(|| area / width)
}

/// First position where the line reaches `level`, coming from the right.
fn crossing(points: &[(f64, f64)], level: f64) -> Option<f64> {
    let k = points.iter().rposition(|q| q.1 >= level)?;
    let a = points[k];
    let b = *points.get(k + 1)?;
    Some(a.0 + (b.0 - a.0) * (a.1 - level) / (a.1 - b.1))
}

/// The middle part of a zone, with the fraction `share` of its width.
fn middle(zone: [f64; 2], share: f64) -> [f64; 2] {
    let (centre, half) = (0.5 * (zone[0] + zone[1]), 0.5 * share * (zone[1] - zone[0]));
    [centre - half, centre + half]
}

/// Mean pressure, and its rms deviation from the least-squares line.
fn mean_and_noise(samples: &[&ScoreSample]) -> (f64, f64) {
    let n = samples.len() as f64;
    let mean = |f: &dyn Fn(&ScoreSample) -> f64| samples.iter().map(|s| f(s)).sum::<f64>() / n;
    let (x, p) = (mean(&|s| s.x), mean(&|s| s.p));
    let xx = mean(&|s| (s.x - x) * (s.x - x));
    let slope = if xx > 0.0 { mean(&|s| (s.x - x) * (s.p - p)) / xx } else { 0.0 };
    let rest = mean(&|s| (s.p - p - slope * (s.x - x)).powi(2));
    (p, rest.sqrt())
}

/// The samples and the reference, reflected if necessary so that the shock runs to the right.
fn turned(
    samples: &[ScoreSample],
    exact: &Profile,
    marks: &Landmarks,
) -> (Vec<ScoreSample>, Profile, Landmarks) {
    if marks.direction > 0.0 {
        return (samples.to_vec(), exact.clone(), *marks);
    }
    let samples = samples.iter().rev().map(|s| ScoreSample { x: -s.x, ..*s }).collect();
    let points =
        exact.points.iter().rev().map(|q| ProfilePoint { x: -q.x, u: -q.u, ..*q }).collect();
    let zone = |z: [f64; 2]| [-z[1], -z[0]];
    let marks = Landmarks {
        direction: 1.0,
        interface: -marks.interface,
        far_end: -marks.far_end,
        shock: marks.shock.map(|x| -x),
        plateau: marks.plateau.map(zone),
        second_plateau: marks.second_plateau.map(zone),
        ..*marks
    };
    (samples, Profile { points }, marks)
}

/// Relative L1 difference of the pressures of two profiles over their common range [-]; NaN if one
/// is empty.
pub fn difference(profile: &Profile, exact: &Profile) -> f64 {
    let line = |p: &Profile| -> Polyline { p.points.iter().map(|q| (q.x, q.p)).collect() };
    let (Some(a), Some(b)) = (profile.span(), exact.span()) else { return f64::NAN };
    let [d1, _, size, _] = integrals(&line(profile), &line(exact), a.0.max(b.0), a.1.min(b.1));
    d1 / size
}

/// Scores the `samples` of one body, sorted by x, against an exact profile that covers at least
/// that body; `h` is the cell size [m].
pub fn score(samples: &[ScoreSample], exact: &Profile, landmarks: &Landmarks, h: f64) -> Errors {
    if samples.len() < 2 || !samples.iter().all(|s| s.x.is_finite() && s.p.is_finite()) {
        return Errors::default();
    }
    let (samples, exact, marks) = turned(samples, exact, landmarks);
    let (lower, upper) = (marks.interface, marks.far_end);
    let computed = line(&samples, lower, upper, |s| s.p);
    let truth: Polyline = exact.between(lower, upper).points.iter().map(|q| (q.x, q.p)).collect();
    let [d1, d2, size, square] = integrals(&computed, &truth, lower, upper);
    let some_if = |ok: bool, value: f64| (ok && value.is_finite()).then_some(value);
    let p2 = marks.p2;
    let greatest = |line: &Polyline| line.iter().map(|q| q.1).fold(f64::NEG_INFINITY, f64::max);
    let mut errors = Errors {
        l1: some_if(size > 0.0, d1 / size),
        l2: some_if(square > 0.0, (d2 / square).sqrt()),
        e1_cells: some_if(p2 > 0.0, d1 / (p2 * h)),
        overshoot: some_if(p2 > 0.0, (greatest(&computed) - greatest(&truth)) / p2),
        ..Errors::default()
    };
    errors.waves = wave_errors(&computed, &truth, &marks, size, h);
    if let Some(shock) = marks.shock {
        let at = |share: f64| crossing(&computed, share * marks.behind_shock);
        errors.shock_position_cells = at(0.5).map(|x| (x - shock) / h);
        errors.rise_cells = at(0.1).zip(at(0.9)).map(|(toe, top)| (toe - top) / h);
    }
    if let Some(zone) = marks.plateau.filter(|z| z[1] - z[0] >= 8.0 * h * (1.0 - 1e-9)) {
        let [from, to] = middle(zone, 0.4);
        let inside: Vec<&ScoreSample> =
            samples.iter().filter(|s| (from..=to).contains(&s.x)).collect();
        if inside.len() >= 3 {
            let n = inside.len() as f64;
            let mean = |f: fn(&ScoreSample) -> f64| inside.iter().map(|s| f(s)).sum::<f64>() / n;
            let (p, noise) = mean_and_noise(&inside);
            errors.plateau = some_if(p2 > 0.0, p / p2 - 1.0);
            errors.noise = some_if(p2 > 0.0, noise / p2);
            errors.density_plateau = some_if(marks.rho2 > 0.0, mean(|s| s.rho) / marks.rho2 - 1.0);
            errors.energy_plateau = some_if(marks.e2 > 0.0, mean(|s| s.e) / marks.e2 - 1.0);
        }
    }
    if let Some(zone) = marks.second_plateau.filter(|z| z[1] - z[0] >= 5.0 * h * (1.0 - 1e-9)) {
        let [from, to] = middle(zone, 0.6);
        if let (Some(mean), Some(want)) =
            (mean_over(&computed, from, to), mean_over(&truth, from, to))
        {
            errors.second_plateau = some_if(want > 1e-3 * p2, mean / want - 1.0);
        }
    }
    errors
}

/// Scores samples of any bodies, sorted by x, between `lower` and `upper` [m], for problems without
/// a single shock (Riemann problems): l1 and l2 of the pressure, and density_l1.
pub fn score_density(samples: &[ScoreSample], exact: &Profile, lower: f64, upper: f64) -> Errors {
    let finite = |s: &ScoreSample| s.x.is_finite() && s.p.is_finite() && s.rho.is_finite();
    if samples.len() < 2 || !samples.iter().all(finite) {
        return Errors::default();
    }
    let truth = exact.between(lower, upper).points;
    let p: Polyline = truth.iter().map(|q| (q.x, q.p)).collect();
    let rho: Polyline = truth.iter().map(|q| (q.x, q.rho)).collect();
    let [d1, d2, size, square] = integrals(&line(samples, lower, upper, |s| s.p), &p, lower, upper);
    let density = integrals(&line(samples, lower, upper, |s| s.rho), &rho, lower, upper)[0];
    Errors {
        l1: (size > 0.0).then(|| d1 / size),
        l2: (square > 0.0).then(|| (d2 / square).sqrt()),
        density_l1: Some(density),
        ..Errors::default()
    }
}

/// Greatest errors of the density and of the specific internal energy within ten cells of the
/// interface, as fractions of rho2 and e2 [-]; `h` is the cell size [m]. `None` without samples
/// there. Errors of the energy appear here, not in the pressure.
pub fn interface_errors(
    samples: &[ScoreSample],
    exact: &Profile,
    landmarks: &Landmarks,
    h: f64,
) -> Option<(f64, f64)> {
    let near = samples.iter().filter(|s| (s.x - landmarks.interface).abs() <= 10.0 * h);
    near.filter_map(|s| {
        let q = exact.at(s.x)?;
        Some(((s.rho - q.rho).abs() / landmarks.rho2, (s.e - q.e).abs() / landmarks.e2))
    })
    .reduce(|a, b| (a.0.max(b.0), a.1.max(b.1)))
}

#[cfg(test)]
mod tests;
