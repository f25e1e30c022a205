//! Runs of the same scene with other cells: with larger ones before the scene itself, and with smaller
//! ones to verify its estimates.

use decomp::Comm;

use super::probes::Probes;
use super::readings::gauge_records;
use super::recorder::most_particles;
use crate::accuracy::estimate::arrival::{Arrivals, Between, Levels};
use crate::accuracy::estimate::{
    CoarseRun, CoarseRuns, GaugeRecords, Polyline, least_pressure, line,
};
use crate::input;
use crate::scene::{self, CellSize, CheckedScene, SideProperties};
use crate::simulation::{Compiled, ParticleTable, RunError, Simulation, patch_counts, quantity_of};
use crate::solver::Stepper;
use crate::solver::clock::user_cpu_seconds;

/// Cell sizes of the coarse runs over that of the scene \[-\].
const FACTORS: [f64; 2] = [4.0, 2.0];

/// Patch width of a coarse run on one worker \[cells\]. More patches of so few cells could be quiescent
/// if they were narrower, but their edges cost more than this saves.
const PATCH_CELLS: usize = 128;

/// The scene on cells `factor` times as large, without outputs and other costly options. In each
/// direction the domain is extended to whole cells at a free or outflow side. If both sides are fixed,
/// the cell size is the largest that fits, at most `factor` times that of the scene. A body with given
/// particle positions gets its mean number of particles per cell.
///
/// # Errors
///
/// The message of the scene check if the new scene is not valid.
fn resized(scene: &CheckedScene, factor: f64) -> Result<CheckedScene, String> {
    let mut new = scene.scene.clone();
    let sides = scene.side_properties::<2>();
    let mut sizes = Vec::new();
    for (axis, ends) in sides.iter().enumerate().take(scene.dimension) {
        let cells = (scene.cells[axis] as f64 / factor).ceil();
        let size = scene.cell_size[axis] * factor;
        let (lower, upper) = (new.domain.lower[axis], new.domain.upper[axis]);
        // walls, pistons, periodic and loaded sides act at their position, which must not move
        sizes.push(match ends.each_ref().map(SideProperties::acts_on_material) {
            [_, false] => {
                new.domain.upper[axis] = lower + cells * size;
                size
            }
            [false, true] => {
                new.domain.lower[axis] = upper - cells * size;
                size
            }
            [true, true] => (upper - lower) / cells,
        });
    }
    new.domain.cell_size = match sizes[..] {
        [size] => CellSize::Uniform(size),
        _ => CellSize::PerDirection(sizes),
    };
    new.domain.patches = None;
    for (body, own) in new.bodies.iter_mut().zip(&scene.bodies) {
        if body.positions.take().is_some() {
            let cells = |axis: usize| (own.upper[axis] - own.lower[axis]) / scene.cell_size[axis];
            let cells: f64 = (0..scene.dimension).map(cells).product();
            let mean = (own.particles as f64 / cells).powf(1.0 / scene.dimension as f64);
            body.particles_per_cell = Some(vec![mean.round().max(1.0) as usize; scene.dimension]);
        }
    }
    new.error_estimate = None;
    new.reference = None;
    new.time.wall_limit = None;
    new.output = scene::Output {
        profiles: new.output.profiles.clone(),
        histories: new.output.histories.clone(),
        hdf5: false,
        pictures: false,
        ..scene::Output::default()
    };
    let mut new = input::check(new, &scene.file).map_err(|error| error.to_string())?;
    // not evaluated, but it gives the probes their names
    new.scene.reference = scene.scene.reference.clone();
    Ok(new)
}

/// Cell size of `other` over that of `scene`, the least over the directions \[-\].
fn cell_ratio(other: &CheckedScene, scene: &CheckedScene) -> f64 {
    let ratios = other.cell_size.iter().zip(&scene.cell_size).map(|(a, b)| a / b);
    ratios.fold(f64::INFINITY, f64::min)
}

/// Pressure histories at positions, recorded after every step.
struct PressureHistories {
    places: Vec<Between>,
    /// Time and pressures of the two particles, one list per position, from the start.
    series: Vec<Vec<(f64, [f64; 2])>>,
    /// A pressure rise up to this value is rounding, not a wave \[Pa\].
    least: f64,
}

impl PressureHistories {
    fn record<const D: usize>(&mut self, simulation: &Simulation<'_, D>) {
        for (place, series) in self.places.iter().zip(&mut self.series) {
            if let [Some(a), Some(b)] = simulation.follow(&place.ids)[..] {
                series.push((simulation.time(), [a.pressure, b.pressure]));
            }
        }
    }

    /// Levels of the wave at position `k`; `None` if the pressure rise is rounding.
    fn levels(&self, k: usize) -> Option<Levels> {
        let series = &self.series[k];
        let start = series.first().map_or(0.0, |s| s.1[0].max(s.1[1]));
        let peak = series.iter().map(|s| s.1[0].min(s.1[1])).fold(start, f64::max);
        (peak - start > self.least).then(|| Levels::new(start, peak))
    }

    /// Time at which the pressure first passes `level` at position `k` \[s\].
    fn arrival_time(&self, k: usize, level: f64) -> Option<f64> {
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

/// Records of one run on other cells; on other ranks than rank 0 without values.
struct Records {
    /// Cell size along x \[m\].
    cell_size: f64,
    /// Cell size over that of the scene \[-\].
    ratio: f64,
    profiles: Vec<Polyline>,
    tables: Vec<ParticleTable>,
    pressures: PressureHistories,
    gauges: GaugeRecords,
}

impl Records {
    /// The records with the arrival times at these levels.
    fn into_coarse_run(self, factor: f64, levels: &[Option<Levels>]) -> CoarseRun {
        let Records { cell_size, ratio, profiles, tables, pressures, gauges } = self;
        let arrival =
            |(k, level): (usize, &Option<Levels>)| pressures.arrival_time(k, level.as_ref()?.half);
        let arrivals = levels.iter().enumerate().map(arrival).collect();
        CoarseRun { factor, ratio, cell_size, profiles, arrivals, tables, gauges }
    }
}

/// The scene with patches that are not narrower than [`PATCH_CELLS`], if it is on a line and one of
/// `workers` runs it alone.
fn with_wide_patches(mut scene: CheckedScene, workers: usize) -> CheckedScene {
    if workers == 1 && scene.dimension == 1 {
        let most = (scene.cells[0] / PATCH_CELLS).max(1);
        scene.scene.domain.patches = Some(vec![patch_counts(&scene, 1, 1)[0].min(most)]);
    }
    scene
}

/// Runs a scene whose errors are estimated with cells `factor` times as large, smaller ones for a
/// factor below 1, without files: its records for comparisons, with arrivals at half of its own
/// greatest pressures. Collective; rank 0 gets the records.
///
/// # Errors
///
/// The message of a check or of the run.
pub fn run_with_cells(
    comm: &dyn Comm,
    scene: &CheckedScene,
    factor: f64,
    threads: usize,
) -> Result<CoarseRun, String> {
    let other = with_wide_patches(resized(scene, factor)?, comm.size() * threads);
    let records = match scene.dimension {
        1 => run_and_record::<1>(comm, scene, &other, threads),
        _ => run_and_record::<2>(comm, scene, &other, threads),
    };
    let records = records.map_err(|error| error.to_string())?;
    let levels: Vec<Option<Levels>> =
        (0..arrival_places(scene).len()).map(|k| records.pressures.levels(k)).collect();
    Ok(records.into_coarse_run(factor, &levels))
}

/// Runs the coarse runs of a scene whose errors are estimated. Collective; rank 0 gets the results.
///
/// # Errors
///
/// If a particle of a coarse run moves past the neighbours of its patch. Other failures become
/// notes of the result.
pub fn run_coarse<const D: usize>(
    comm: &dyn Comm,
    scene: &CheckedScene,
    threads: usize,
) -> Result<CoarseRuns, RunError>
where
    Stepper<D>: Compiled<D>,
{
    let start = user_cpu_seconds();
    let mut all = CoarseRuns::default();
    let mut finished: Vec<(f64, Records)> = Vec::new();
    for factor in FACTORS {
        let coarse = match resized(scene, factor) {
            Ok(coarse) => with_wide_patches(coarse, comm.size() * threads),
            Err(reason) => {
                all.notes.push(format!("no coarse run on cells {factor} times as large: {reason}"));
                continue;
            }
        };
        match run_and_record::<D>(comm, scene, &coarse, threads) {
            Ok(records) => finished.push((factor, records)),
            // all ranks get these errors alike
            Err(
                error @ (RunError::Particle { .. }
                | RunError::TimeStep { .. }
                | RunError::TooLong { .. }
                | RunError::Lost { .. }),
            ) => all.notes.push(format!("coarse run on cells {factor} times as large: {error}")),
            Err(error) => return Err(error),
        }
    }
    let places = arrival_places(scene).len();
    let finest = finished.last().map(|(_, records)| &records.pressures);
    let levels = |k| finest.and_then(|pressures| pressures.levels(k));
    all.levels = (0..places).map(levels).collect();
    let coarse_run =
        |(factor, records): (f64, Records)| records.into_coarse_run(factor, &all.levels);
    all.done = finished.into_iter().map(coarse_run).collect();
    all.cpu_seconds = user_cpu_seconds() - start;
    Ok(all)
}

/// Positions at which arrivals are estimated \[m\].
fn arrival_places(scene: &CheckedScene) -> &[f64] {
    scene.scene.error_estimate.as_ref().map_or(&[], |estimate| &estimate.arrivals)
}

/// Runs `other`, the scene `scene` on other cells, and records what is estimated of `scene`.
fn run_and_record<const D: usize>(
    comm: &dyn Comm,
    scene: &CheckedScene,
    other: &CheckedScene,
    threads: usize,
) -> Result<Records, RunError>
where
    Stepper<D>: Compiled<D>,
{
    let (body, fields) = (scene.estimated_body(), scene.estimated_fields());
    let mut simulation = Simulation::<D>::new(other, comm, threads)?;
    simulation.clock().stop();
    let cell_time = simulation.time_step() / other.scene.time.courant;
    let places = body.map_or(Vec::new(), |body| {
        arrival_places(scene).iter().map(|&at| Between::new(other, body, at)).collect()
    });
    let mut pressures = PressureHistories {
        series: vec![Vec::new(); places.len()],
        places,
        least: body.map_or(0.0, |body| least_pressure(other, body, cell_time)),
    };
    let mut probes = Probes::new(other);
    let mut record = |simulation: &Simulation<'_, D>| {
        pressures.record(simulation);
        probes.iter_mut().for_each(|probes| probes.sample(simulation));
    };
    let wanted = |name: &str| {
        let of_body = body.is_some() && name == "pressure";
        let of_fields = fields.iter().any(|field| *field == quantity_of(name));
        let of_table = ["x", "y", "volume"].contains(&name);
        of_table || of_body || of_fields
    };
    let (mut profiles, mut tables) = (Vec::new(), Vec::new());
    record(&simulation);
    for &time in &other.profile_times {
        while simulation.time() < time {
            simulation.advance(time)?;
            record(&simulation);
        }
        // as many particles as a profile of the scene holds
        let table = match other.particles > most_particles(scene) {
            true => simulation.profile(most_particles(scene)).map(|(table, _)| table),
            false => simulation.gather_columns(&wanted),
        };
        let Some(table) = table else { continue };
        profiles.extend(body.map(|body| line(&table, body)));
        if !fields.is_empty() {
            tables.push(table);
        }
    }
    while simulation.time() < other.scene.time.end {
        simulation.advance(other.scene.time.end)?;
        record(&simulation);
    }
    let gauges =
        probes.map_or(GaugeRecords::default(), |probes| gauge_records(other, &probes, &simulation));
    let (cell_size, ratio) = (other.cell_size[0], cell_ratio(other, scene));
    Ok(Records { cell_size, ratio, profiles, tables, pressures, gauges })
}

/// Recorder of the arrivals in the run itself, with the levels of the coarse runs on all ranks.
#[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
pub fn arrival_recorder(
    comm: &dyn Comm,
    scene: &CheckedScene,
    body: usize,
    coarse_runs: &CoarseRuns,
) -> Arrivals {
    let between = arrival_places(scene).iter().map(|&at| Between::new(scene, body, at)).collect();
    let levels = serde_json::to_vec(&coarse_runs.levels).expect("levels are plain data");
    let levels = serde_json::from_slice(&comm.broadcast(levels)).expect("rank 0 sends valid JSON");
    Arrivals::new(between, levels)
}
