//! Indicators of the error of a run: its differences from the coarse runs, and its noise. All are
//! dimensionless, so that the error models hold for any units and sizes.

use std::collections::BTreeMap;

use super::plateau::Plateau;
use super::polyline::{Polyline, interpolate};
use super::shock_state::ShockState;

/// Indicator: thickness of the other of two bodies, in cells \[-\].
pub const OTHER_CELLS: &str = "other_cells";

/// Indicators by name.
pub type Evidence = BTreeMap<String, f64>;

fn named(pairs: impl IntoIterator<Item = (String, f64)>) -> Evidence {
    pairs.into_iter().filter(|(_, v)| v.is_finite()).collect()
}

/// Indicators of the plateau pressure \[-\], relative to it: `difference_2`, `difference_4` from
/// the mean of the coarse runs over the same positions, `noise`, the length in `cells`, the
/// deviations from a level plateau `halves`, `wide`, and `spread`, the sum of all deviations with an
/// eighth of `difference_4`, which no chance agreement of two runs makes small. `others` are the
/// coarse runs with their cell sizes over `h` \[m\], the cell size of the scene.
pub fn of_plateau(found: &Plateau, others: &[(f64, &Polyline)], h: f64) -> Evidence {
    let theirs = others.iter().filter_map(|(factor, line)| {
        let reach = found.reach.max(factor * h);
        let within = line.iter().filter(|q| (q.0 - found.centre).abs() <= reach);
        let (count, sum) = within.fold((0.0, 0.0), |(n, sum), q| (n + 1.0, sum + q.1));
        let other: f64 = if count > 0.0 { sum / count } else { at(line, found.centre)? };
        Some((format!("difference_{factor}"), (other / found.pressure - 1.0).abs()))
    });
    let own = [
        ("noise", found.noise),
        ("cells", found.cells),
        ("halves", found.halves),
        ("wide", found.wide),
    ];
    let mut all =
        named(own.map(|(name, value)| (name.to_string(), value)).into_iter().chain(theirs));
    if let (Some(near), Some(far)) = (all.get("difference_2"), all.get("difference_4")) {
        let spread = near + far / 8.0 + found.noise + found.halves + found.wide;
        all.extend(named([("spread".to_string(), spread)]));
    }
    all
}

/// Indicators of the strength of a shock from the states ahead of and behind it, and the initial state
/// of the body that strikes \[-\]. They hold for any equation of state:
/// - `compression` 1 - v/v0 with the specific volume v, and `other_compression`, that of the other
///   body by the jump condition 1 - v/v0 = rho0 (u - u0)^2/(p - p0);
/// - `exp_compression`, `exp_other_compression`: their exponentials, since errors of strong shocks
///   grow faster than a power of the compression.
pub(super) fn of_shock([ahead, behind, other]: [Option<ShockState>; 3]) -> Evidence {
    let (Some(ahead), Some(behind)) = (ahead, behind) else { return Evidence::new() };
    let compression = 1.0 - ahead.density / behind.density;
    let rise = behind.pressure - ahead.pressure;
    let other =
        other.map(|other| other.density * (other.velocity - behind.velocity).powi(2) / rise);
    // without another body its indicators are left out
    of_compressions([compression, other.unwrap_or(f64::NAN)])
}

/// The indicators of [`of_shock`] from the compressions of the struck and of the striking body \[-\].
pub fn of_compressions([own, other]: [f64; 2]) -> Evidence {
    let all = [
        ("compression", own),
        ("exp_compression", own.exp()),
        ("other_compression", other),
        ("exp_other_compression", if other > 1.0 { 1.0 } else { other }.exp()),
    ];
    named(all.map(|(name, value)| (name.to_string(), value)))
}

/// Indicators of a profile \[-\]: `difference_2`, `difference_4`, the relative L1 to the coarse
/// runs `others`, which are given with their cell sizes over that of the scene.
pub fn of_profile(own: &Polyline, others: &[(f64, &Polyline)]) -> Evidence {
    named(others.iter().map(|(factor, line)| (format!("difference_{factor}"), distance(own, line))))
}

/// Indicators of an arrival, in sound transit times of a cell \[-\]: `difference_2`, `difference_4`
/// from the coarse runs, and `rise`, the time from a tenth to half of the pressure rise. All times
/// are in \[s\]: the arrival `time`, `rise`, those of `others`, and the transit time `cell_time`.
pub fn of_arrival(time: f64, rise: f64, others: &[(f64, f64)], cell_time: f64) -> Evidence {
    let theirs = others
        .iter()
        .map(|(factor, t)| (format!("difference_{factor}"), (t - time).abs() / cell_time));
    named([("rise".to_string(), rise / cell_time)].into_iter().chain(theirs))
}

/// Relative L1 difference of two lines \[-\], int |a - b| dx / int |a| dx over the range of `a`.
/// Lines are constant beyond their ends; NaN if one is empty.
pub fn distance(a: &Polyline, b: &Polyline) -> f64 {
    let (Some(first), Some(last)) = (a.first(), a.last()) else { return f64::NAN };
    let mut places: Vec<f64> = a.iter().chain(b).map(|q| q.0).collect();
    places.retain(|x| (first.0..=last.0).contains(x));
    places.sort_by(f64::total_cmp);
    let (mut difference, mut whole) = (0.0, 0.0);
    let mut before: Option<(f64, f64, f64)> = None;
    for x in places {
        let (Some(pa), Some(pb)) = (at(a, x), at(b, x)) else { return f64::NAN };
        if let Some((x0, d0, a0)) = before {
            difference += (x - x0) * mean_size(d0, pa - pb);
            whole += (x - x0) * mean_size(a0, pa);
        }
        before = Some((x, pa - pb, pa));
    }
    difference / whole
}

/// Linear interpolation of a line at x; constant beyond its ends.
fn at(line: &Polyline, x: f64) -> Option<f64> {
    let (first, last) = (line.first()?.0, line.last()?.0);
    interpolate(line, x.max(first).min(last))
}

/// Mean of |d| on an interval where d is linear from `a` to `b`.
fn mean_size(a: f64, b: f64) -> f64 {
    match a * b >= 0.0 {
        true => 0.5 * (a + b).abs(),
        false => 0.5 * (a * a + b * b) / (a.abs() + b.abs()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compressions_follow_from_the_jump_conditions() {
        // u = 1, shock speed 4, density 1 ahead; the same material strikes with twice the velocity
        let ahead = ShockState { density: 1.0, ..ShockState::default() };
        let behind = ShockState { density: 4.0 / 3.0, velocity: 1.0, pressure: 4.0 };
        let other = ShockState { density: 1.0, velocity: 2.0, pressure: 0.0 };
        let both = of_shock([Some(ahead), Some(behind), Some(other)]);
        for name in ["compression", "other_compression"] {
            assert!((both[name] - 0.25).abs() < 1e-12, "{both:?}");
            assert!((both[&format!("exp_{name}")].ln() - 0.25).abs() < 1e-12, "{both:?}");
        }
        assert_eq!(of_shock([Some(ahead), Some(behind), None]).len(), 2);
        assert!(of_shock([None, Some(behind), Some(other)]).is_empty());
    }

    #[test]
    fn the_spread_is_the_sum_of_all_deviations() {
        let found = Plateau {
            pressure: 2.0,
            noise: 0.01,
            cells: 20.0,
            halves: 0.02,
            wide: 0.03,
            centre: 0.0,
            reach: 4.0,
        };
        let level = |p: f64| -> Polyline { (-9..9).map(|k| (k as f64, p)).collect() };
        let (near, far) = (level(2.2), level(2.8));
        let both = of_plateau(&found, &[(2.0, &near), (4.0, &far)], 1.0);
        assert!((both["spread"] - (0.1 + 0.05 + 0.06)).abs() < 1e-12, "{both:?}");
        assert!(!of_plateau(&found, &[(2.0, &near)], 1.0).contains_key("spread"));
    }

    #[test]
    fn distances_are_areas() {
        let a: Polyline = vec![(0.0, 1.0), (1.0, 1.0), (2.0, 1.0)];
        let b: Polyline = vec![(0.0, 1.0), (1.0, 1.5), (2.0, 1.0)];
        assert!((distance(&a, &b) - 0.25).abs() < 1e-12);
        assert_eq!(distance(&a, &a), 0.0);
        assert!(distance(&Polyline::new(), &a).is_nan());
    }
}
