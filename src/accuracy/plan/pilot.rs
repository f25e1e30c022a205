//! Pilot runs: a scene on few cells, to measure its cost and its wave lengths.

use decomp::Serial;
use serde_json::{Value, json};

use super::schemes::PlannedScheme;
use crate::accuracy::estimate::arrival::Between;
use crate::accuracy::estimate::{Polyline, line, plateau};
use crate::input;
use crate::scene::CheckedScene;
use crate::simulation::Simulation;
use crate::solver::clock::user_cpu_seconds;

/// Smallest number of cells of a plateau in a pilot run.
const LEAST: usize = 6;

/// Least number of runs that are timed.
const LEAST_RUNS: usize = 2;
/// Greatest number of runs that are timed.
const MOST_RUNS: usize = 10;
/// CPU time for which short runs are repeated \[s\].
const REPEATED: f64 = 0.02;

/// Results of a pilot run.
#[derive(Clone, Debug)]
pub struct Pilot {
    /// Cell size \[m\].
    pub cell_size: f64,
    /// User CPU time of the steps \[s\].
    pub cpu_seconds: f64,
    /// Wall time of the steps \[s\].
    pub wall_seconds: f64,
    /// Number of steps.
    pub steps: u64,
    /// Courant number \[-\].
    pub courant: f64,
    /// Pressures of the body, one line per profile.
    pub profiles: Vec<Polyline>,
    /// Time at which the pressure at the arrival position first passes half of its maximum \[s\].
    pub arrival: Option<f64>,
}

/// The scene with a scheme on `cells` cells. The error is the message of the scene check.
///
/// # Errors
///
/// If the scene is not on a line, or fails the scene check on these cells.
pub fn with_cells(
    scene: &Value,
    file: &str,
    scheme: &PlannedScheme,
    cells: usize,
) -> Result<(Value, CheckedScene), String> {
    let mut new = scene.clone();
    scheme.apply(&mut new);
    let end = |key: &str| new["domain"][key][0].as_f64().ok_or("domain: allowed: a line");
    let size = (end("upper")? - end("lower")?) / cells.max(1) as f64;
    new["domain"]["cell_size"] = json!(size);
    if let Some(domain) = new["domain"].as_object_mut() {
        domain.remove("patches");
    }
    let checked = input::parse(new.to_string().as_bytes(), file, &[]);
    checked.map(|checked| (new, checked)).map_err(|error| error.to_string())
}

/// Runs a scene without output files and measures its cost; `place` \[m\] is the position of an
/// arrival in the body with the index `body`, if that is planned.
///
/// # Errors
///
/// The message of the first failure of the run.
#[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
pub fn run(scene: &CheckedScene, body: usize, place: Option<f64>) -> Result<Pilot, String> {
    let mut simulation =
        Simulation::<1>::new(scene, &Serial, 1).map_err(|error| error.to_string())?;
    let between = place.map(|at| Between::new(scene, body, at));
    let (mut profiles, mut felt) = (Vec::new(), Vec::new());
    let (cpu, start) = (user_cpu_seconds(), std::time::Instant::now());
    let mut times = scene.profile_times.clone();
    times.push(scene.scene.time.end);
    for (k, &time) in times.iter().enumerate() {
        while simulation.time() < time {
            simulation.advance(time).map_err(|error| error.to_string())?;
            if let Some(between) = &between
                && let [Some(a), Some(b)] = simulation.follow(&between.ids)[..]
            {
                let p = between.weights[0] * a.pressure + between.weights[1] * b.pressure;
                felt.push((simulation.time(), p));
            }
        }
        if k < scene.profile_times.len() {
            profiles.push(line(&simulation.gather().expect("one rank has all").0, body));
        }
    }
    let cpu_seconds = user_cpu_seconds() - cpu;
    let peak = felt.iter().map(|f| f.1).fold(0.0, f64::max);
    let arrival = felt.iter().find(|f| peak > 0.0 && f.1 >= 0.5 * peak).map(|f| f.0);
    Ok(Pilot {
        cell_size: scene.cell_size[0],
        cpu_seconds,
        wall_seconds: start.elapsed().as_secs_f64(),
        steps: simulation.steps(),
        courant: scene.scene.time.courant,
        profiles,
        arrival,
    })
}

/// Runs a scene several times, as [`run`], and returns the run with the median CPU time. Of an even
/// number it is the faster of the two middle runs. Short runs are repeated more often, because their
/// times vary more.
///
/// # Errors
///
/// The message of the first failure of a run.
pub fn typical(scene: &CheckedScene, body: usize, place: Option<f64>) -> Result<Pilot, String> {
    let (mut runs, mut seconds) = (Vec::new(), 0.0);
    while runs.len() < LEAST_RUNS || (seconds < REPEATED && runs.len() < MOST_RUNS) {
        let next = run(scene, body, place)?;
        seconds += next.cpu_seconds;
        runs.push(next);
    }
    runs.sort_by(|a, b| a.cpu_seconds.total_cmp(&b.cpu_seconds));
    Ok(runs.swap_remove((runs.len() - 1) / 2))
}

impl Pilot {
    /// Pulse length of profile `k` \[m\]: int |p| dx over the plateau pressure or, without a
    /// plateau, over the pressure that the greatest tenth of the pressures exceeds.
    pub fn pulse(&self, k: usize) -> Option<f64> {
        let line = &self.profiles[k];
        let area: f64 =
            line.windows(2).map(|w| 0.5 * (w[0].1.abs() + w[1].1.abs()) * (w[1].0 - w[0].0)).sum();
        let level =
            plateau::find(line, self.cell_size, LEAST).map(|p| p.pressure).or_else(|| {
                let mut all: Vec<f64> = line.iter().map(|q| q.1).collect();
                all.sort_by(|a, b| b.total_cmp(a));
                let strong = all.iter().filter(|p| **p > 0.1 * all[0]).count();
                all.get(strong / 10).copied()
            })?;
        (level > 0.0 && area > 0.0).then_some(area / level)
    }

    /// Plateau length of profile `k` \[m\].
    pub fn plateau(&self, k: usize) -> Option<f64> {
        plateau::find(&self.profiles[k], self.cell_size, LEAST).map(|p| p.cells * self.cell_size)
    }
}
