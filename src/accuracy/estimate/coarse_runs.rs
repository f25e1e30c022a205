//! Coarse runs (companions): the same scene on larger cells, run before the scene itself.

use decomp::Comm;

use super::arrival::{Arrivals, Between, Levels};
use super::polyline::{Polyline, least_pressure, line};
use crate::input;
use crate::scene::{self, CellSize, CheckedScene};
use crate::simulation::{RunError, Simulation, patch_counts};
use crate::solver::clock::user_cpu_seconds;

/// Cell sizes of the coarse runs over that of the scene \[-\].
pub const FACTORS: [usize; 2] = [4, 2];

/// Patch width of a coarse run on one worker \[cells\]. More patches of so few cells could be quiescent
/// if they were narrower, but their edges cost more than this saves.
const PATCH_CELLS: usize = 128;

/// Results of one coarse run.
#[derive(Clone, Debug, PartialEq)]
pub struct Companion {
    /// Cell size over that of the scene, rounded to a whole number \[-\].
    pub factor: f64,
    /// Cell size \[m\].
    pub cell_size: f64,
    /// Pressures of the body \[Pa\] over x \[m\], one line per profile.
    pub profiles: Vec<Polyline>,
    /// Arrival times of the wave at the given positions \[s\].
    pub arrivals: Vec<Option<f64>>,
}

/// All coarse runs of a scene.
#[derive(Clone, Debug, Default)]
pub struct Companions {
    /// Coarse runs that reached their end; on rank 0 only.
    pub done: Vec<Companion>,
    /// Levels of the wave at each position in the finest coarse run; `None`: no wave came.
    pub levels: Vec<Option<Levels>>,
    /// User CPU time of this process in the coarse runs \[s\].
    pub cpu_seconds: f64,
    /// Reasons why a coarse run has no results.
    pub notes: Vec<String>,
}

/// The scene on cells `factor` times as large, without outputs and other costly options. The domain
/// is extended to whole cells at a free or outflow side. If both sides are fixed, the cell size is
/// the largest that fits, at most `factor` times that of the scene. A body with given particle
/// positions gets its mean number of particles per cell. The error is the message of the scene
/// check.
///
/// # Errors
///
/// The message of the scene check if the coarser scene is not valid.
pub fn coarser(scene: &CheckedScene, factor: usize) -> Result<CheckedScene, String> {
    let mut new = scene.scene.clone();
    let cells = scene.cells[0].div_ceil(factor);
    let size = scene.cell_size[0] * factor as f64;
    let (lower, upper) = (new.domain.lower[0], new.domain.upper[0]);
    // walls, pistons, periodic and loaded sides act at their position, which must not move
    let [stays] = scene.side_properties::<1>().map(|ends| ends.map(|side| side.acts_on_material()));
    let size = match stays {
        [_, false] => {
            new.domain.upper[0] = lower + cells as f64 * size;
            size
        }
        [false, true] => {
            new.domain.lower[0] = upper - cells as f64 * size;
            size
        }
        [true, true] => (upper - lower) / cells as f64,
    };
    new.domain.cell_size = CellSize::Uniform(size);
    new.domain.patches = None;
    for (body, own) in new.bodies.iter_mut().zip(&scene.bodies) {
        if body.positions.take().is_some() {
            let cells = (own.upper[0] - own.lower[0]) / scene.cell_size[0];
            let mean = (own.particles as f64 / cells).round().max(1.0);
            body.particles_per_cell = Some(vec![mean as usize]);
        }
    }
    new.error_estimate = None;
    new.reference = None;
    new.time.wall_limit = None;
    new.output = scene::Output {
        profiles: new.output.profiles.clone(),
        hdf5: false,
        pictures: false,
        ..scene::Output::default()
    };
    input::check(new, &scene.file).map_err(|error| error.to_string())
}

/// Pressure histories at positions, recorded after every step.
struct CoarsePeaks {
    places: Vec<Between>,
    /// Time and pressures of the two particles, one list per position, from the start.
    series: Vec<Vec<(f64, [f64; 2])>>,
    /// A pressure rise up to this value is rounding, not a wave \[Pa\].
    least: f64,
}

impl CoarsePeaks {
    fn look(&mut self, simulation: &Simulation<'_, 1>) {
        for (place, series) in self.places.iter().zip(&mut self.series) {
            if let [Some(a), Some(b)] = simulation.follow(&place.ids)[..] {
                series.push((simulation.time(), [a.pressure, b.pressure]));
            }
        }
    }

    /// Levels of the wave at position `k`; `None` if the pressure rise is at most `least` \[Pa\].
    fn levels(&self, k: usize, least: f64) -> Option<Levels> {
        let series = &self.series[k];
        let start = series.first().map_or(0.0, |s| s.1[0].max(s.1[1]));
        let peak = series.iter().map(|s| s.1[0].min(s.1[1])).fold(start, f64::max);
        (peak - start > least).then(|| Levels::new(start, peak))
    }

    /// Time at which the pressure first passes `level` at position `k` \[s\].
    fn passes(&self, k: usize, level: f64) -> Option<f64> {
        let cross = |side: usize| {
            self.series[k].windows(2).find_map(|w| {
                let ((t0, p0), (t1, p1)) = ((w[0].0, w[0].1[side]), (w[1].0, w[1].1[side]));
                (p0 < level && p1 >= level).then(|| t0 + (t1 - t0) * (level - p0) / (p1 - p0))
            })
        };
        let weights = self.places[k].weights;
        Some(weights[0] * cross(0)? + weights[1] * cross(1)?)
    }
}

/// Runs the coarse runs of a scene on a line. Collective; rank 0 gets the results.
///
/// # Errors
///
/// If a particle of a coarse run moves past the neighbours of its patch. Other failures become
/// notes of the result.
pub fn run(
    comm: &dyn Comm,
    scene: &CheckedScene,
    body: usize,
    threads: usize,
) -> Result<Companions, RunError> {
    let start = user_cpu_seconds();
    let places = scene.scene.error_estimate.as_ref().map_or(Vec::new(), |e| e.arrivals.clone());
    let mut all = Companions::default();
    let mut finished: Vec<(f64, f64, Vec<Polyline>, CoarsePeaks)> = Vec::new();
    let mut least = 0.0;
    for factor in FACTORS {
        let mut coarse = match coarser(scene, factor) {
            Ok(coarse) => coarse,
            Err(reason) => {
                all.notes.push(format!("no companion on cells {factor} times as large: {reason}"));
                continue;
            }
        };
        let workers = comm.size() * threads;
        if workers == 1 {
            let most = (coarse.cells[0] / PATCH_CELLS).max(1);
            coarse.scene.domain.patches = Some(vec![patch_counts(&coarse, 1, 1)[0].min(most)]);
        }
        let between = places.iter().map(|&at| Between::new(&coarse, body, at)).collect();
        let mut peaks =
            CoarsePeaks { places: between, series: vec![Vec::new(); places.len()], least: 0.0 };
        match one(comm, &coarse, body, threads, &mut peaks) {
            Ok(profiles) => {
                least = peaks.least;
                finished.push((factor as f64, coarse.cell_size[0], profiles, peaks));
            }
            // all ranks get these errors alike
            Err(
                error @ (RunError::Particle { .. }
                | RunError::TimeStep { .. }
                | RunError::TooLong { .. }
                | RunError::Lost { .. }),
            ) => all.notes.push(format!("companion on cells {factor} times as large: {error}")),
            Err(error) => return Err(error),
        }
    }
    let finest = finished.last();
    let levels = |k| finest.and_then(|(_, _, _, peaks)| peaks.levels(k, least));
    all.levels = (0..places.len()).map(levels).collect();
    all.done = finished
        .into_iter()
        .map(|(factor, cell_size, profiles, peaks)| Companion {
            factor,
            cell_size,
            profiles,
            arrivals: (0..places.len()).map(|k| peaks.passes(k, all.levels[k]?.half)).collect(),
        })
        .collect();
    all.cpu_seconds = user_cpu_seconds() - start;
    Ok(all)
}

/// Runs one coarse run; returns the profiles of the body.
fn one(
    comm: &dyn Comm,
    scene: &CheckedScene,
    body: usize,
    threads: usize,
    peaks: &mut CoarsePeaks,
) -> Result<Vec<Polyline>, RunError> {
    let mut simulation = Simulation::<1>::new(scene, comm, threads)?;
    simulation.clock().stop();
    let mut profiles = Vec::new();
    let cell_time = simulation.time_step() / scene.scene.time.courant;
    peaks.least = least_pressure(scene, body, cell_time);
    peaks.look(&simulation);
    for &time in &scene.profile_times {
        while simulation.time() < time {
            simulation.advance(time)?;
            peaks.look(&simulation);
        }
        let table = simulation.gather_columns(&|name| ["x", "pressure"].contains(&name));
        profiles.push(table.map_or(Polyline::new(), |table| line(&table, body)));
    }
    while simulation.time() < scene.scene.time.end {
        simulation.advance(scene.scene.time.end)?;
        peaks.look(&simulation);
    }
    Ok(profiles)
}

/// Recorder of the arrivals in the run itself, with the levels of the coarse runs on all ranks.
#[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
pub fn arrivals(
    comm: &dyn Comm,
    scene: &CheckedScene,
    body: usize,
    companions: &Companions,
) -> Arrivals {
    let places = scene.scene.error_estimate.as_ref().map_or(&[][..], |e| &e.arrivals);
    let between = places.iter().map(|&at| Between::new(scene, body, at)).collect();
    let levels = serde_json::to_vec(&companions.levels).expect("levels are plain data");
    let levels = serde_json::from_slice(&comm.broadcast(levels)).expect("rank 0 sends valid JSON");
    Arrivals::new(between, levels)
}
