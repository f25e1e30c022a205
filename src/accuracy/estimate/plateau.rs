//! Finds the plateau behind a shock in a pressure profile.

use super::polyline::Polyline;

/// A pressure plateau.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plateau {
    /// Mean pressure over the middle 40 % \[Pa\].
    pub pressure: f64,
    /// Rms deviation from a straight line there, over the pressure \[-\].
    pub noise: f64,
    /// Length \[cells\].
    pub cells: f64,
    /// Difference of the means of the two halves of the averaged part, over the pressure \[-\].
    pub halves: f64,
    /// Difference of the mean over the middle 80 %, over the pressure \[-\].
    pub wide: f64,
    /// Middle \[m\].
    pub centre: f64,
    /// Half of the length of the averaged part \[m\].
    pub reach: f64,
}

/// Cells behind the half height of the shock that belong to its rise and overshoot.
const BEHIND: usize = 3;
/// Cells of the window that gives the level behind the shock, and is then moved away from it.
const WINDOW: usize = 6;
/// Tolerance for the mean of a window: a fraction of the level, plus twice the noise of the level.
const TOLERANCE: f64 = 0.02;

/// Means of the particles over cells of size `h`: position, pressure.
fn cells(line: &Polyline, h: f64) -> Polyline {
    let cell = |x: f64| (x / h).floor();
    line.chunk_by(|a, b| cell(a.0) == cell(b.0))
        .map(|group| {
            let n = group.len() as f64;
            (group.iter().map(|q| q.0).sum::<f64>() / n, group.iter().map(|q| q.1).sum::<f64>() / n)
        })
        .collect()
}

/// The cells from the material ahead of the shock backwards; the shock is the steepest fall.
fn from_ahead(mut cells: Polyline) -> Polyline {
    let fall = |from: usize, to: usize| cells[from].1 - cells[to].1;
    let steps = || 0..cells.len().saturating_sub(3);
    let right = steps().map(|k| fall(k, k + 3)).fold(0.0, f64::max);
    let left = steps().map(|k| fall(k + 3, k)).fold(0.0, f64::max);
    if right >= left {
        cells.reverse();
    }
    cells
}

/// Index of the first of the cells from ahead of the shock in which the pressure has half of its
/// greatest value. `None` if no undisturbed material is ahead, so that no shock is visible.
fn half_height(ahead: &Polyline) -> Option<usize> {
    let peak = ahead.iter().map(|c| c.1).fold(0.0, f64::max);
    ahead.iter().position(|c| c.1 >= 0.5 * peak).filter(|&half| half > 0)
}

/// The plateau behind the shock in the profile of a body; cells of size `h` \[m\]. `None` if the
/// pressure is not level over `least` cells.
pub fn find(line: &Polyline, h: f64, least: usize) -> Option<Plateau> {
    let ahead = from_ahead(cells(line, h));
    let half = half_height(&ahead)?;
    let first = half + BEHIND;
    let mean = |from: usize| -> Option<f64> {
        let window = ahead.get(from..from + WINDOW)?;
        Some(window.iter().map(|c| c.1).sum::<f64>() / WINDOW as f64)
    };
    let level = mean(first)?;
    let spread = ahead[first..first + WINDOW].iter().map(|c| (c.1 - level).powi(2)).sum::<f64>();
    let spread = (spread / WINDOW as f64).sqrt();
    let near = |m: f64| (m - level).abs() <= TOLERANCE * level.abs() + 2.0 * spread;
    let mut last = first;
    while mean(last + 1).is_some_and(near) {
        last += 1;
    }
    let (from, to) = (half, last + WINDOW - 1);
    if to - from < least {
        return None;
    }
    between(line, [ahead[from].0, ahead[to].0], (to - from) as f64)
}

/// The plateau of a known `length` \[m\] behind the shock in the profile of a body; cells of size `h`
/// \[m\]. `None` without a shock.
pub fn of_length(line: &Polyline, h: f64, length: f64) -> Option<Plateau> {
    let ahead = from_ahead(cells(line, h));
    let shock = ahead[half_height(&ahead)?].0;
    let direction = (ahead.last()?.0 - ahead.first()?.0).signum();
    between(line, [shock, shock + direction * length], length / h)
}

/// The plateau between two positions \[m\].
fn between(line: &Polyline, [a, b]: [f64; 2], cells: f64) -> Option<Plateau> {
    let (centre, reach) = (0.5 * (a + b), 0.2 * (b - a).abs());
    let inside: Vec<(f64, f64)> =
        line.iter().copied().filter(|q| (q.0 - centre).abs() <= reach).collect();
    let (pressure, rest) = about_line(&inside)?;
    let noise = rest / pressure.abs();
    let mean_of = |keep: &dyn Fn(f64) -> bool| {
        let kept = line.iter().filter(|q| keep(q.0 - centre));
        let (count, sum) = kept.fold((0.0, 0.0), |(n, sum), q| (n + 1.0, sum + q.1));
        sum / count
    };
    let left = mean_of(&|d| d < 0.0 && d >= -reach);
    let right = mean_of(&|d| d >= 0.0 && d <= reach);
    let halves = (left - right).abs() / pressure.abs();
    let wide = (mean_of(&|d| d.abs() <= 2.0 * reach) / pressure - 1.0).abs();
    let found = Plateau { pressure, noise, cells, centre, reach, halves, wide };
    Some(found).filter(|p| p.pressure > 0.0)
}

/// Mean, and rms deviation from the least-squares line.
fn about_line(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    if points.len() < 3 {
        return None;
    }
    let n = points.len() as f64;
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / n;
    let (x, p) = (mean(&|q| q.0), mean(&|q| q.1));
    let xx = mean(&|q| (q.0 - x).powi(2));
    let slope = if xx > 0.0 { mean(&|q| (q.0 - x) * (q.1 - p)) / xx } else { 0.0 };
    Some((p, mean(&|q| (q.1 - p - slope * (q.0 - x)).powi(2)).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pulse: a fan from 20 to 40, a plateau at 5 up to 70, a rise over two cells.
    fn pulse(x: f64) -> f64 {
        match x {
            _ if x < 20.0 => 2.0,
            _ if x < 40.0 => 2.0 + 3.0 * (x - 20.0) / 20.0,
            _ if x < 69.0 => 5.0,
            _ if x < 71.0 => 5.0 * (71.0 - x) / 2.0,
            _ => 0.0,
        }
    }

    #[test]
    fn a_plateau_is_found_from_either_side() {
        let line: Polyline =
            (0..200).map(|k| 0.25 + 0.5 * k as f64).map(|x| (x, pulse(x))).collect();
        let found = find(&line, 1.0, 20).unwrap();
        assert!((found.pressure - 5.0).abs() < 1e-12 && found.noise < 1e-12, "{found:?}");
        assert!((found.cells - 30.0).abs() < 4.0, "{found:?}");
        let turned: Polyline = line.iter().rev().map(|q| (-q.0, q.1)).collect();
        assert!((find(&turned, 1.0, 20).unwrap().pressure - 5.0).abs() < 1e-12);
    }

    #[test]
    fn a_plateau_of_known_length_is_measured_behind_the_shock() {
        let line: Polyline =
            (0..200).map(|k| 0.25 + 0.5 * k as f64).map(|x| (x, pulse(x))).collect();
        let known = of_length(&line, 1.0, 30.0).unwrap();
        assert!((known.pressure - 5.0).abs() < 1e-12 && known.cells == 30.0, "{known:?}");
        assert!(
            (known.centre - 55.0).abs() < 1.0 && (known.reach - 6.0).abs() < 1e-12,
            "{known:?}"
        );
        let turned: Polyline = line.iter().rev().map(|q| (-q.0, q.1)).collect();
        assert!((of_length(&turned, 1.0, 30.0).unwrap().centre + 55.0).abs() < 1.0);
        assert_eq!(of_length(&Polyline::new(), 1.0, 30.0), None);
    }

    #[test]
    fn a_spike_has_no_plateau() {
        let line: Polyline =
            (0..100).map(|k| (k as f64, (5.0 - (k as f64 - 50.0).abs()).max(0.0))).collect();
        assert_eq!(find(&line, 1.0, 20), None);
        assert_eq!(find(&Polyline::new(), 1.0, 20), None);
    }

    #[test]
    fn a_level_body_without_a_shock_has_no_plateau() {
        let level: Polyline = (0..100).map(|k| (k as f64, 1e5)).collect();
        assert_eq!(find(&level, 1.0, 20), None);
    }
}
