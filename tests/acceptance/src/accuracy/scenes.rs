//! Estimated errors of scenes without an exact solution, beside runs with much smaller cells.

use calibration::against_fine_runs::{EstimatedQuantity, Outcome, outcomes};
use calibration::estimates::judge_pairs;
use calibration::random_scenes::Kind;

use crate::bounds::{Unit, accuracy as bounds};
use crate::table::Table;

/// Seed, drawn after the factors of safety were chosen.
const SEED: u64 = 1_593_738_271;
/// Scenes of each kind, on a line and in a plane.
const COUNTS: [usize; 2] = [40, 20];
/// Cells of the fine runs over those of the scenes, on a line and in a plane.
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
        let ran = format!("{}: scenes that could be run", kind.name());
        table.beside(&ran, Some(scenes.len() as f64), &format!("of {count}"), Unit::One);
        let all: Vec<&Outcome> = scenes.iter().flatten().collect();
        for (quantity, name) in EstimatedQuantity::ALL {
            let own = all.iter().filter(|outcome| outcome.quantity == quantity);
            let of = judge_pairs(own.map(|outcome| (outcome.half_width, outcome.error)));
            if of.cases == 0 {
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
