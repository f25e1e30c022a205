//! Estimated errors of runs, on impacts to which no law was fitted.

use super::estimates::{QUANTITIES, gather, judge};
use super::random_impacts::HELD_OUT;
use crate::bounds::accuracy as bounds;
use crate::table::Table;

/// Impacts; none is one of the calibration's.
const IMPACTS: usize = 1040;
/// Their seed.
const SEED: u64 = 20_260_303;
/// Runs at once.
const THREADS: usize = 2;

/// Coverage and tightness of the intervals.
pub fn check(table: &mut Table) {
    let samples = gather(SEED, &HELD_OUT, IMPACTS, THREADS);
    for (name, samples) in QUANTITIES.iter().zip(&samples) {
        let (cases, held, median) = judge(samples);
        table.check(&format!("{name}: cases"), Some(cases as f64), bounds::estimate::CASES);
        table.check(&format!("{name}: truth within"), Some(held), bounds::estimate::TRUTH_WITHIN);
        let figure = format!("{name}: median of half-width over error");
        table.check(&figure, Some(median), bounds::estimate::HALF_WIDTH_OVER_ERROR);
    }
}
