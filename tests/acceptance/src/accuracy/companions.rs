//! Cost of the coarse runs from which the errors of a run are estimated.

use crate::bounds::{Unit, accuracy as bounds};
use crate::runs::Job;
use crate::table::Table;

/// Runs of a scene, of which the cheapest counts: other load only adds to a time.
const REPEATS: usize = 3;
/// Seconds of a time loop from which the bound holds.
const LEAST_LOOP: f64 = 0.2;
/// Scenes with a position in the body whose errors are estimated \[m\], if they are on a line, and cell
/// sizes \[m\].
const SCENES: [(&str, Option<f64>, [f64; 2]); 5] = [
    ("flyer", Some(4e-3), [1e-5, 5e-6]),
    ("flyer_best", Some(4e-3), [1e-5, 5e-6]),
    ("soft_flyer", Some(1e-3), [5e-6, 2.5e-6]),
    ("symmetric_impact", Some(1e-3), [5e-6, 2.5e-6]),
    ("flyer_2d", None, [8e-5, 4e-5]),
];

/// CPU time of the coarse runs over that of the time loop.
pub fn check(table: &mut Table) {
    for (scene, place, cells) in SCENES {
        for cell in cells {
            let name = format!("{scene}.json, cells of {:.1} um", 1e6 * cell);
            let places = place.map_or(String::new(), |place| format!("\"arrivals\":[{place:e}]"));
            let estimate = format!("error_estimate={{{places}}}");
            let job = Job::new(scene).set(format!("domain.cell_size={cell:e}")).set(estimate);
            let [mut coarse, mut own] = [f64::INFINITY; 2];
            for _ in 0..REPEATS {
                let Some(run) = table.take(&name, job.run()) else { return };
                let estimate = run.summary.error_estimate.as_ref();
                coarse = coarse.min(estimate.map_or(f64::INFINITY, |e| e.cpu_seconds));
                own = own.min(run.summary.loop_cpu_seconds);
            }
            let share = Some(coarse / own);
            let figure = format!("{name}: coarse runs over the time loop");
            match own >= LEAST_LOOP {
                true if place.is_none() => {
                    table.check(&figure, share, bounds::companions::OVER_LOOP_PLANE);
                }
                true => table.check(&figure, share, bounds::companions::OVER_LOOP),
                false => table.beside(&figure, share, &format!("{own:.3} s"), Unit::Fraction),
            }
        }
    }
}
