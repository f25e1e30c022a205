//! Estimated errors of random scenes without an exact solution, beside their differences from runs
//! with much smaller cells.

use std::path::Path;

use decomp::Serial;
use flyer_mpm::accuracy::estimate::gauge_records::{GaugeHistory, Reading};
use flyer_mpm::accuracy::estimate::{CoarseRun, EstimatedErrors, fields, indicators, plateau};
use flyer_mpm::driver::coarse_runs::run_with_cells;
use flyer_mpm::driver::output::summary::Summary;
use flyer_mpm::driver::{Beginning, Options, run};
use flyer_mpm::scene::CheckedScene;
use flyer_mpm::simulation::ParticleTable;
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

use crate::random::Random;
use crate::random_scenes::{Kind, RandomScene};

/// Half-width of an estimate, and the difference from the fine run.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Scene and quantity, in words.
    pub name: String,
    /// Quantity.
    pub quantity: EstimatedQuantity,
    /// Half-width of the interval, in the unit of the error.
    pub half_width: f64,
    /// Difference from the fine run.
    pub error: f64,
}

/// What is estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EstimatedQuantity {
    /// Pressure of the plateau of a body on a line.
    PlateauPressure,
    /// Arrival time of a wave at a position in a body on a line.
    ArrivalTime,
    /// L1 of the pressure of a body on a line.
    L1,
    /// L1 of a field of all bodies.
    Field,
    /// L1 of a history.
    History,
    /// Value read from a history.
    Reading,
}

impl EstimatedQuantity {
    /// All quantities, with their names.
    pub const ALL: [(EstimatedQuantity, &'static str); 6] = [
        (EstimatedQuantity::PlateauPressure, "plateau pressure"),
        (EstimatedQuantity::ArrivalTime, "arrival time"),
        (EstimatedQuantity::L1, "L1 of a body"),
        (EstimatedQuantity::Field, "L1 of fields"),
        (EstimatedQuantity::History, "L1 of histories"),
        (EstimatedQuantity::Reading, "values from histories"),
    ];
}

/// Runs `count` scenes of a kind, and each with cells smaller by `factor` (below 1); scenes that
/// cannot be run are reported and left out.
///
/// # Panics
///
/// If no temporary folder can be created, or no threads can be started.
pub fn outcomes(
    seed: u64,
    kind: Kind,
    count: usize,
    factor: f64,
    threads: usize,
) -> Vec<Vec<Outcome>> {
    let mut random = Random::new(seed);
    let scenes: Vec<RandomScene> =
        (0..count).map(|_| RandomScene::draw(&mut random, kind)).collect();
    let home = tempfile::tempdir().expect("a folder for the runs");
    let one = |(k, scene): (usize, &RandomScene)| {
        let found = compare(scene, factor, &home.path().join(k.to_string()));
        found.inspect_err(|reason| eprintln!("{}: {reason}", scene.name)).ok()
    };
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can start");
    pool.install(|| scenes.par_iter().enumerate().filter_map(one).collect())
}

/// The estimates of a scene beside its differences from a run on cells smaller by `factor`.
fn compare(drawn: &RandomScene, factor: f64, folder: &Path) -> Result<Vec<Outcome>, String> {
    let scene = drawn.checked()?;
    let options = Options::quiet(folder.to_path_buf());
    run(&Serial, &scene, &options, Beginning::Scene).map_err(|e| e.to_string())?;
    let summary = Summary::read(folder).map_err(|e| e.to_string())?;
    let _ = std::fs::remove_dir_all(folder);
    let estimate = summary.error_estimate.ok_or("the run has no estimate")?;
    let [own, fine] = [1.0, factor].map(|factor| run_with_cells(&Serial, &scene, factor, 1));
    let (own, fine) = (own?, fine?);
    let mut all = Outcomes { scene: &drawn.name, found: Vec::new() };
    all.body(&scene, &estimate, &own, &fine);
    all.fields(&estimate, &own, &fine);
    all.gauges(&estimate, &own, &fine);
    Ok(all.found)
}

struct Outcomes<'a> {
    scene: &'a str,
    found: Vec<Outcome>,
}

impl Outcomes<'_> {
    fn add(
        &mut self,
        what: &str,
        quantity: EstimatedQuantity,
        half_width: Option<f64>,
        error: Option<f64>,
    ) {
        if let (Some(half_width), Some(error)) = (half_width, error.filter(|e| e.is_finite())) {
            let name = format!("{}: {what}", self.scene);
            self.found.push(Outcome { name, quantity, half_width, error });
        }
    }

    /// Plateaus, profiles and arrivals of the body on a line.
    fn body(
        &mut self,
        scene: &CheckedScene,
        estimate: &EstimatedErrors,
        own: &CoarseRun,
        fine: &CoarseRun,
    ) {
        let Some(body) = scene.estimated_body() else { return };
        let start = scene.scene.bodies[body].pressure;
        for ((profile, own), fine) in
            estimate.profiles.iter().zip(&own.profiles).zip(&fine.profiles)
        {
            let apart = indicators::distance(own, fine);
            self.add("L1", EstimatedQuantity::L1, profile.l1.half_width, Some(apart));
            if let Some(reported) = &profile.plateau_pressure {
                let near = own.iter().map(|q| (q.0, q.1 - start)).collect();
                let found = plateau::find(&near, scene.cell_size[0], 0);
                let error = found.and_then(|found| {
                    let inside = fine.iter().filter(|q| (q.0 - found.centre).abs() <= found.reach);
                    let (n, sum) = inside.fold((0.0, 0.0), |(n, sum), q| (n + 1.0, sum + q.1));
                    (n > 0.0).then(|| (sum / n - reported.value).abs())
                });
                let quantity = EstimatedQuantity::PlateauPressure;
                self.add("plateau", quantity, reported.half_width, error);
            }
        }
        for (arrival, fine) in estimate.arrivals.iter().zip(&fine.arrivals) {
            let reported = arrival.time.as_ref();
            let error = reported.zip(*fine).map(|(time, fine)| (time.value - fine).abs());
            let half_width = reported.and_then(|time| time.half_width);
            self.add("arrival", EstimatedQuantity::ArrivalTime, half_width, error);
        }
    }

    fn fields(&mut self, estimate: &EstimatedErrors, own: &CoarseRun, fine: &CoarseRun) {
        for field in &estimate.fields {
            let at = |table: &&ParticleTable| table.time == field.time;
            let both = own.tables.iter().find(at).zip(fine.tables.iter().find(at));
            let error = both.and_then(|(own, fine)| fields::difference(own, fine, &field.quantity));
            let what = format!("{} at {:.2e} s", field.quantity, field.time);
            self.add(&what, EstimatedQuantity::Field, field.l1.half_width, error);
        }
    }

    fn gauges(&mut self, estimate: &EstimatedErrors, own: &CoarseRun, fine: &CoarseRun) {
        for history in &estimate.histories {
            let is =
                |h: &&GaugeHistory| (&h.gauge, &h.quantity) == (&history.gauge, &history.quantity);
            let both =
                own.gauges.histories.iter().find(is).zip(fine.gauges.histories.iter().find(is));
            let error = both.and_then(|(own, fine)| own.difference(fine));
            let what = format!("{} {}", history.gauge, history.quantity);
            self.add(&what, EstimatedQuantity::History, history.l1.half_width, error);
        }
        for reading in &estimate.readings {
            let is = |r: &&Reading| (&r.gauge, &r.quantity) == (&reading.gauge, &reading.quantity);
            let found = fine.gauges.readings.iter().find(is);
            let error = found.map(|fine| (fine.value - reading.value.value).abs());
            let what = format!("{} {}", reading.gauge, reading.quantity);
            self.add(&what, EstimatedQuantity::Reading, reading.value.half_width, error);
        }
    }
}
