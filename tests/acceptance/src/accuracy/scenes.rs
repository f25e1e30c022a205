//! Estimated errors of scenes without an exact solution, beside runs with much smaller cells.

use calibration::against_fine_runs::EstimatedQuantity::{self, ArrivalTime, L1, PlateauPressure};
use calibration::against_fine_runs::{Outcome, outcomes};
use calibration::estimates::judge_intervals;
use calibration::random_scenes::Kind;

use crate::bounds::accuracy as bounds;
use crate::table::Table;

/// Seed, drawn after the factors of safety were chosen.
const SEED: u64 = 1_451_125_867;
/// Scenes of each kind, on a line and in a plane.
const COUNTS: [usize; 2] = [80, 20];
/// Cell size of the fine runs over that of the scenes \[-\], on a line and in a plane.
const FACTORS: [f64; 2] = [0.125, 0.25];
/// Runs at once.
const THREADS: usize = 2;

/// Coverage and tightness of the intervals of each kind of scene.
pub fn check(table: &mut Table) {
    let lines = Kind::LINES.into_iter().map(|kind| (kind, 0));
    let kinds = lines.chain(Kind::PLANES.into_iter().map(|kind| (kind, 1)));
    for ((kind, which), k) in kinds.zip(0..) {
        let (count, factor) = (COUNTS[which], FACTORS[which]);
        let scenes = outcomes(SEED + k, kind, count, factor, THREADS);
        let ran = format!("{}: scenes that could be run, of {count}", kind.name());
        table.check(&ran, Some(scenes.len() as f64 / count as f64), bounds::scenes::RAN);
        let all: Vec<&Outcome> = scenes.iter().flatten().collect();
        for (quantity, name) in EstimatedQuantity::ALL {
            let own = all.iter().filter(|outcome| outcome.quantity == quantity);
            let of = judge_intervals(own.map(|outcome| (outcome.half_width, outcome.error)));
            // a body with a plateau and arrivals is on a line
            let of_body = [PlateauPressure, ArrivalTime, L1].contains(&quantity);
            if of_body && Kind::PLANES.contains(&kind) {
                continue;
            }
            let name = format!("{}, {name}", kind.name());
            let figure = format!("{name}: fine run within, of {}", of.cases);
            table.check(&figure, Some(of.held), bounds::scenes::FINE_WITHIN);
            let figure = format!("{name}: median half-width over error");
            table.check(&figure, Some(of.ratio), bounds::scenes::HALF_WIDTH_OVER_ERROR);
        }
    }
}
