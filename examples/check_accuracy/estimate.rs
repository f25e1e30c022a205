//! What runs tell of their own errors, on impacts that no law was fitted on.

use crate::estimates::{QUANTITIES, gather, judge};
use crate::random_impacts::HELD_OUT;
use crate::table::{Show, Table};

/// Impacts; none is one of the calibration's.
const IMPACTS: usize = 1040;
/// Their seed.
const SEED: u64 = 20_260_303;
/// Runs at once.
const THREADS: usize = 2;

/// Coverage and tightness of the intervals.
pub fn check(table: &mut Table) {
    let told = gather(SEED, &HELD_OUT, IMPACTS, THREADS);
    for (name, told) in QUANTITIES.iter().zip(&told) {
        let (cases, held, median) = judge(told);
        table.at_least(&format!("{name}: cases"), Some(cases as f64), 200.0, Show::Number);
        table.at_least(&format!("{name}: truth within"), Some(held), 0.95, Show::Percent);
        let figure = format!("{name}: median of half-width over error");
        table.at_most(&figure, Some(median), 5.0, Show::Number);
    }
}
