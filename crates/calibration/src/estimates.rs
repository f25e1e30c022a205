//! Runs random impacts and compares their estimated errors with the true ones.

use std::path::Path;

use decomp::Serial;
use flyer_mpm::accuracy::estimate::indicators::Evidence;
use flyer_mpm::accuracy::estimate::{
    EstimateBasis, ImpactWaves, LEAST_PLATEAU, PlateauLeft, SchemeFamily, other_cells,
};
use flyer_mpm::driver::output::summary::Summary;
use flyer_mpm::driver::{Beginning, Options, run};
use rayon::ThreadPoolBuilder;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use serde::{Deserialize, Serialize};

use crate::random::Random;
use crate::random_impacts::{Draw, RandomImpact, impact};

/// Names of the estimated quantities.
pub const QUANTITIES: [&str; 3] = ["plateau pressure", "arrival time", "L1"];

/// The estimate of one quantity in one impact, with its true error.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CheckedEstimate {
    /// The impact, in words.
    pub name: String,
    /// Speed of the flyer \[m/s\].
    pub speed: f64,
    /// Family of the scheme.
    pub family: SchemeFamily,
    /// Basis of the estimate.
    pub basis: EstimateBasis,
    /// The evidence.
    pub evidence: Evidence,
    /// True size of the error, in the unit of the half-width.
    pub error: f64,
    /// Half of the interval's width, by the shipped laws.
    pub half_width: Option<f64>,
    /// What sizes are fractions of.
    pub unit: f64,
    /// Error relative to the exact value.
    pub relative: f64,
    /// Length that scales the error \[cells\]: of the plateau, of the way to the position, of the
    /// pulse.
    pub cells: f64,
    /// Thickness of the flyer over the length that scales the error.
    pub other_thickness: Option<f64>,
    /// Exact pressure behind the shock over density times the square of the sound speed [-].
    pub strength: f64,
    /// Exact compressions of the struck and of the striking body.
    pub compressions: Option<[f64; 2]>,
}

/// Estimates of some impacts.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Gathered {
    /// One list per quantity.
    pub estimates: [Vec<CheckedEstimate>; 3],
    /// Profiles with a plateau of at least the least reported length.
    pub plateaus: usize,
    /// Those of them of which no plateau was reported.
    pub abstained: usize,
    /// Profiles in which a plateau was reported that is not there.
    pub false_plateaus: usize,
    /// Impacts that could not be run to their end.
    pub failed: usize,
}

/// Runs `count` impacts of `draw` on `threads` threads. Impacts that cannot be run to their end are
/// reported and left out.
///
/// # Panics
///
/// If no temporary folder can be created, or no threads can be started.
pub fn gather(seed: u64, draw: &Draw<'_>, count: usize, threads: usize) -> Gathered {
    let mut random = Random::new(seed);
    let impacts: Vec<RandomImpact> = (0..count).map(|_| impact(&mut random, draw)).collect();
    let home = tempfile::tempdir().expect("a folder for the runs");
    let run = |(k, impact): (usize, &RandomImpact)| {
        let summary = once(impact, &home.path().join(k.to_string()));
        summary.inspect_err(|reason| eprintln!("{}: {reason}", impact.name)).ok()
    };
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can start");
    let runs = || impacts.par_iter().enumerate().map(run).collect::<Vec<_>>();
    let summaries = pool.install(runs);
    let mut all = Gathered::default();
    for (impact, summary) in impacts.iter().zip(summaries) {
        match summary {
            Some(summary) => add(&mut all, impact, &summary),
            None => all.failed += 1,
        }
    }
    all
}

fn once(impact: &RandomImpact, folder: &Path) -> Result<Summary, String> {
    let scene = impact.checked()?;
    let options = Options::quiet(folder.to_path_buf());
    run(&Serial, &scene, &options, Beginning::Scene).map_err(|e| e.to_string())?;
    let summary = Summary::read(folder).map_err(|e| e.to_string());
    let _ = std::fs::remove_dir_all(folder);
    summary
}

/// Adds the estimates of a run.
fn add(all: &mut Gathered, impact: &RandomImpact, summary: &Summary) {
    let Some(estimate) = &summary.error_estimate else { return };
    let scene = impact.checked().expect("it has been run");
    let body = scene.estimated_body().expect("it has been estimated");
    let waves = ImpactWaves::new(&scene, body).expect("a plain impact");
    let h = scene.cell_size[0];
    let cell_time = scene.scene.time.end / summary.steps as f64 / scene.scene.time.courant;
    let stiffness = scene.material_of(body).density * (h / cell_time).powi(2);
    let thickness = other_cells(&scene, body);
    let one = |basis, evidence: &Evidence, error, half_width, unit, cells: f64| CheckedEstimate {
        name: impact.name.clone(),
        speed: impact.speed,
        family: SchemeFamily::of(&scene.scene.method),
        basis,
        evidence: evidence.clone(),
        error,
        half_width,
        unit,
        relative: error,
        cells,
        other_thickness: thickness.map(|other| other / cells),
        strength: waves.release.states[0].p / stiffness,
        compressions: waves.compressions(),
    };
    for (profile, scored) in estimate.profiles.iter().zip(&summary.profiles) {
        let length = match waves.plateau(profile.time) {
            PlateauLeft::Length(length) => length / h,
            _ => 0.0,
        };
        let is_long = length >= LEAST_PLATEAU;
        let reported = profile.plateau_pressure.as_ref();
        all.plateaus += usize::from(is_long);
        all.abstained += usize::from(is_long && reported.is_none());
        all.false_plateaus += usize::from(!is_long && reported.is_some());
        if let Some(bounded) = reported
            && let Some(exact) = bounded.exact
        {
            let error = (bounded.value - exact).abs();
            let (width, unit) = (bounded.half_width, bounded.value);
            let checked = one(profile.basis, &bounded.evidence, error, width, unit, length);
            all.estimates[0].push(CheckedEstimate { relative: error / exact, ..checked });
        }
        if let Some(exact) = profile.l1.exact {
            let l1 = &profile.l1;
            let pulse = scored.error("e1_cells").unwrap_or(f64::NAN) / exact;
            all.estimates[2].push(one(
                profile.basis,
                &l1.evidence,
                exact,
                l1.half_width,
                1.0,
                pulse,
            ));
        }
    }
    for arrival in &estimate.arrivals {
        if let Some(bounded) = &arrival.time
            && let Some(exact) = bounded.exact
        {
            let error = (bounded.value - exact).abs();
            let (width, way) = (bounded.half_width, arrival.at / h);
            let checked = one(arrival.basis, &bounded.evidence, error, width, cell_time, way);
            all.estimates[1].push(CheckedEstimate { relative: error / exact, ..checked });
        }
    }
}

/// How often intervals contained the true error, and how wide they were.
#[derive(Clone, Copy, Debug)]
pub struct Judgement {
    /// Number of estimates.
    pub cases: usize,
    /// Share of intervals that contain the true error.
    pub held: f64,
    /// Lower end of the 95 % confidence interval of this share (Wilson 1927).
    pub held_at_least: f64,
    /// Median of half-width over error [-].
    pub ratio: f64,
}

/// Judges the estimates that have an interval.
pub fn judge<'a>(all: impl IntoIterator<Item = &'a CheckedEstimate>) -> Judgement {
    judge_intervals(all.into_iter().filter_map(|t| Some((t.half_width?, t.error))))
}

/// Judges intervals of these half-widths and true errors.
pub fn judge_intervals(all: impl Iterator<Item = (f64, f64)>) -> Judgement {
    let estimates: Vec<(f64, f64)> = all.collect();
    let held = estimates.iter().filter(|(width, error)| error <= width).count();
    let mut ratios: Vec<f64> = estimates.iter().map(|(width, error)| width / error).collect();
    ratios.sort_by(f64::total_cmp);
    let ratio = ratios.get(ratios.len() / 2).copied().unwrap_or(f64::NAN);
    let n = estimates.len().max(1) as f64;
    let share = held as f64 / n;
    Judgement { cases: estimates.len(), held: share, held_at_least: lower_end(share, n), ratio }
}

/// Lower end of the 95 % confidence interval of a share of `n` cases (Wilson 1927).
fn lower_end(share: f64, n: f64) -> f64 {
    let z = 1.96;
    let middle = share + z * z / (2.0 * n);
    let half = z * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
    (middle - half) / (1.0 + z * z / n)
}
