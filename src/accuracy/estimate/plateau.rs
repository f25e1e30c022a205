//! The plateau behind a shock, found in a profile alone.

use super::Line;

/// A plateau.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plateau {
    /// Mean pressure over its middle 40 % \[Pa\].
    pub pressure: f64,
    /// Rms about a straight line there, over the pressure \[-\].
    pub noise: f64,
    /// Its length \[cells\].
    pub cells: f64,
    /// What the means of the averaged part's two halves differ by, over the pressure \[-\].
    pub halves: f64,
    /// What the mean over its middle 80 % differs by, over the pressure \[-\].
    pub wide: f64,
    /// Middle of it \[m\].
    pub centre: f64,
    /// How far the part that is averaged reaches from there \[m\].
    pub reach: f64,
}

/// A plateau shorter than this is none to tell errors of: there the fan's foot is in it \[cells\].
const LEAST: usize = 20;
/// Cells behind the shock's half height that belong to its rise and overshoot.
const BEHIND: usize = 3;
/// Cells over which the level behind the shock is taken, and compared on the way back.
const WINDOW: usize = 6;
/// A window's mean may differ from the level by this fraction, and by twice the level's noise.
const TOLERANCE: f64 = 0.02;

/// Means of the particles over cells of size `h`: place, pressure.
fn cells(line: &Line, h: f64) -> Line {
    let cell = |x: f64| (x / h).floor();
    line.chunk_by(|a, b| cell(a.0) == cell(b.0))
        .map(|group| {
            let n = group.len() as f64;
            (group.iter().map(|q| q.0).sum::<f64>() / n, group.iter().map(|q| q.1).sum::<f64>() / n)
        })
        .collect()
}

/// The pressures seen from the material ahead of the shock: from its steepest fall backwards.
fn from_ahead(mut cells: Line) -> Line {
    let fall = |from: usize, to: usize| cells[from].1 - cells[to].1;
    let steps = || 0..cells.len().saturating_sub(3);
    let right = steps().map(|k| fall(k, k + 3)).fold(0.0, f64::max);
    let left = steps().map(|k| fall(k + 3, k)).fold(0.0, f64::max);
    if right >= left {
        cells.reverse();
    }
    cells
}

/// The plateau behind the shock of a body's profile on cells of size `h` \[m\]; none where the
/// pressure is not level over 20 cells.
pub fn find(line: &Line, h: f64) -> Option<Plateau> {
    find_over(line, h, LEAST)
}

/// The same over at least so many cells.
pub fn find_over(line: &Line, h: f64, least: usize) -> Option<Plateau> {
    let ahead = from_ahead(cells(line, h));
    let peak = ahead.iter().map(|c| c.1).fold(0.0, f64::max);
    // without material ahead that it has not reached there is no shock to see
    let half = ahead.iter().position(|c| c.1 >= 0.5 * peak).filter(|&half| half > 0)?;
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
    let (a, b) = (ahead[from].0, ahead[to].0);
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
    let found = Plateau { pressure, noise, cells: (to - from) as f64, centre, reach, halves, wide };
    Some(found).filter(|p| p.pressure > 0.0)
}

/// Mean, and rms about the straight line of least squares.
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

    /// A pulse: a fan from 20 to 40, a plateau of 5 to 70, a rise of two cells.
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
        let line: Line = (0..200).map(|k| 0.25 + 0.5 * k as f64).map(|x| (x, pulse(x))).collect();
        let found = find(&line, 1.0).unwrap();
        assert!((found.pressure - 5.0).abs() < 1e-12 && found.noise < 1e-12, "{found:?}");
        assert!((found.cells - 30.0).abs() < 4.0, "{found:?}");
        let turned: Line = line.iter().rev().map(|q| (-q.0, q.1)).collect();
        assert!((find(&turned, 1.0).unwrap().pressure - 5.0).abs() < 1e-12);
    }

    #[test]
    fn a_spike_has_no_plateau() {
        let line: Line =
            (0..100).map(|k| (k as f64, (5.0 - (k as f64 - 50.0).abs()).max(0.0))).collect();
        assert_eq!(find(&line, 1.0), None);
        assert_eq!(find(&Line::new(), 1.0), None);
    }

    #[test]
    fn a_level_body_without_a_shock_has_no_plateau() {
        let level: Line = (0..100).map(|k| (k as f64, 1e5)).collect();
        assert_eq!(find(&level, 1.0), None);
    }
}
