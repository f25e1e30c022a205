//! Conduction of heat along a rod.

use crate::bounds::{Unit, effects as bounds};
use crate::runs::Job;
use crate::table::Table;

/// The error function's complement, by its continued fraction or series, to rounding.
fn erfc(x: f64) -> f64 {
    if x < 2.0 {
        let (mut term, mut sum, mut n) = (x, x, 0.0);
        while f64::abs(term) > 1e-18 {
            n += 1.0;
            term *= -x * x / n;
            sum += term / (2.0 * n + 1.0);
        }
        return 1.0 - 2.0 / std::f64::consts::PI.sqrt() * sum;
    }
    let fraction = (1..=60).rev().fold(0.0, |f, k| 0.5 * f64::from(k) / (x + f));
    (-x * x).exp() / (std::f64::consts::PI.sqrt() * (x + fraction))
}

/// Error and order of the temperature.
pub fn check(table: &mut Table) {
    let mut before = None;
    for (cell, name) in [("1e-3", "1 mm"), ("5e-4", "0.5 mm"), ("2.5e-4", "0.25 mm")] {
        let job = Job::new("heat_rod").set(format!("domain.cell_size={cell}"));
        let Some(run) = table.take(&format!("heat_rod, {name}"), job.run()) else { return };
        let Some(mut profiles) = table.take("profiles", run.tables()) else { return };
        let error = profiles.pop().and_then(|last| {
            let (x, t) = (last.numbers("x")?, last.numbers("temperature")?);
            let exact = |x: f64| 300.0 + 100.0 * erfc(x / (2.0 * (1e-4f64 * 0.1).sqrt()));
            let squares = x.iter().zip(t).map(|(x, t)| ((t - exact(*x)) / 100.0).powi(2));
            Some((squares.sum::<f64>() / x.len() as f64).sqrt())
        });
        table.beside(&format!("heat_rod, {name}: rms, of the rise"), error, "", Unit::One);
        if let (Some(before), Some(error)) = (before, error) {
            let order: f64 = f64::log2(before / error);
            table.check(&format!("heat_rod, {name}: order"), Some(order), bounds::heat::ORDER);
        }
        before = error;
        table.check("  energy drift", run.summary.energy.drift, bounds::heat::ENERGY_DRIFT);
    }
}
