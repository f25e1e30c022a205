//! Runs random impacts and compares their estimated errors with the true ones.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use decomp::Serial;
use flyer_mpm::accuracy::estimate::indicators::Evidence;
use flyer_mpm::driver::output::summary::Summary;
use flyer_mpm::driver::{Beginning, Options, run};

use super::random_impacts::{Random, RandomImpact, impact};

/// Names of the estimated quantities.
pub const QUANTITIES: [&str; 3] = ["plateau pressure", "arrival time", "L1"];

/// The estimate of one quantity in one impact, with its true error.
#[derive(Clone, Debug)]
#[allow(dead_code, reason = "each program uses a part")]
pub struct CheckedEstimate {
    /// The impact, in words.
    pub name: String,
    /// The evidence.
    pub evidence: Evidence,
    /// True size of the error, in the unit of the half-width.
    pub error: f64,
    /// Half of the interval's width, by the shipped laws.
    pub half_width: Option<f64>,
    /// What sizes are fractions of.
    pub unit: f64,
    /// The error in cells, of L1 and arrivals; over the plateau's length in cells, of its pressure.
    pub in_cells: f64,
}

/// Runs `count` impacts on `threads` threads; the estimates by quantity. Impacts
/// that cannot be run to their end are reported and left out.
pub fn gather(
    seed: u64,
    materials: &[&str],
    count: usize,
    threads: usize,
) -> [Vec<CheckedEstimate>; 3] {
    let mut random = Random::new(seed);
    let impacts: Vec<RandomImpact> = (0..count).map(|_| impact(&mut random, materials)).collect();
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let home = tempfile::tempdir().expect("a folder for the runs");
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while let Some((k, impact)) = next_of(&impacts, &next) {
                    match once(impact, &home.path().join(k.to_string())) {
                        Ok(summary) => done.lock().expect("whole").push((k, summary)),
                        Err(reason) => eprintln!("{}: {reason}", impact.name),
                    }
                }
            });
        }
    });
    let mut done = done.into_inner().expect("whole");
    done.sort_by_key(|(k, _)| *k);
    let mut all: [Vec<CheckedEstimate>; 3] = Default::default();
    for (k, summary) in &done {
        for (quantity, one) in checked_estimates(&impacts[*k].name, summary) {
            all[quantity].push(one);
        }
    }
    all
}

fn next_of<'a>(
    impacts: &'a [RandomImpact],
    next: &AtomicUsize,
) -> Option<(usize, &'a RandomImpact)> {
    let k = next.fetch_add(1, Ordering::Relaxed);
    impacts.get(k).map(|impact| (k, impact))
}

fn once(impact: &RandomImpact, folder: &Path) -> Result<Summary, String> {
    let scene = impact.checked()?;
    let options = Options {
        output: folder.to_path_buf(),
        keep: false,
        quiet: true,
        verbose: false,
        progress: Default::default(),
        threads: 1,
        trace: None,
        started: Instant::now(),
        signal: Default::default(),
        commit: None,
    };
    run(&Serial, &scene, &options, Beginning::Scene).map_err(|e| e.to_string())?;
    let summary = Summary::read(folder).map_err(|e| e.to_string());
    let _ = std::fs::remove_dir_all(folder);
    summary
}

/// The estimates of a run, by number of the quantity.
fn checked_estimates(name: &str, summary: &Summary) -> Vec<(usize, CheckedEstimate)> {
    let mut all = Vec::new();
    let Some(estimate) = &summary.error_estimate else { return all };
    let one = |evidence: &Evidence, error, half_width, unit, in_cells| CheckedEstimate {
        name: name.to_string(),
        evidence: evidence.clone(),
        error,
        half_width,
        unit,
        in_cells,
    };
    let h = summary.scene.pointer("/domain/cell_size").and_then(|v| v.as_f64());
    let h = h.unwrap_or(f64::NAN);
    for (profile, scored) in estimate.profiles.iter().zip(&summary.profiles) {
        if let Some(bounded) = &profile.plateau_pressure
            && let Some(exact) = bounded.exact
        {
            let error = (bounded.value - exact).abs();
            let cells = bounded.evidence.get("cells").copied().unwrap_or(f64::NAN);
            let relative = error / bounded.value * cells;
            let width = bounded.half_width;
            all.push((0, one(&bounded.evidence, error, width, bounded.value, relative)));
        }
        if let Some(exact) = profile.l1.exact {
            let cells = scored.error("e1_cells").unwrap_or(f64::NAN);
            all.push((2, one(&profile.l1.evidence, exact, profile.l1.half_width, 1.0, cells)));
        }
    }
    let courant = summary.scene.pointer("/time/courant").and_then(|v| v.as_f64()).unwrap_or(0.4);
    let end = summary.scene.pointer("/time/end").and_then(|v| v.as_f64()).unwrap_or(f64::NAN);
    let cell_time = end / summary.steps as f64 / courant;
    for arrival in &estimate.arrivals {
        if let Some(bounded) = &arrival.time
            && let Some(exact) = bounded.exact
        {
            let error = (bounded.value - exact).abs();
            let cells = error * arrival.at / exact / h;
            let width = bounded.half_width;
            all.push((1, one(&bounded.evidence, error, width, cell_time, cells)));
        }
    }
    all
}

/// Number of estimates, share of intervals that contain the true error, the median of half-width over error.
pub fn judge(all: &[CheckedEstimate]) -> (usize, f64, f64) {
    let estimates: Vec<(f64, f64)> =
        all.iter().filter_map(|t| Some((t.half_width?, t.error))).collect();
    let held = estimates.iter().filter(|(width, error)| error <= width).count();
    let mut ratios: Vec<f64> = estimates.iter().map(|(width, error)| width / error).collect();
    ratios.sort_by(f64::total_cmp);
    let median = ratios.get(ratios.len() / 2).copied().unwrap_or(f64::NAN);
    (estimates.len(), held as f64 / estimates.len().max(1) as f64, median)
}
