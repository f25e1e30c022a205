//! A scaling study: its configurations, and their runs in turn.

use std::fs;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::configuration::{configurations, turns};
use super::error::ScalingError;
use super::kind::ScalingKind;
use super::launch::{ScalingRun, possible_binding};
use super::measured_run::MeasuredRun;
use super::row::ScalingRow;
use super::row_prediction::RowPrediction;
use crate::driver::output::lock::Lock;
use crate::driver::output::origin::{Origin, claim};
use crate::input;
use crate::perf_model::Machine;
use crate::perf_model::calibrate::processor;
use crate::scene::CheckedScene;

/// Folder of the results of one run, within that of the study.
const RUN_FOLDER: &str = "run";

/// Options of a scaling study.
#[derive(Clone, Debug)]
pub struct ScalingOptions {
    /// The quantity that is held fixed.
    pub kind: ScalingKind,
    /// Path of the program.
    pub program: PathBuf,
    /// The file of the scene.
    pub scene: PathBuf,
    /// Overrides of the scene.
    pub sets: Vec<String>,
    /// Numbers of ranks.
    pub ranks: Vec<usize>,
    /// Numbers of threads per rank.
    pub threads: Vec<usize>,
    /// Runs of each configuration.
    pub repeats: usize,
    /// Physical cores of the machine; `None`: those that this process may use.
    pub cores: Option<usize>,
    /// Constants of a machine, from which times are predicted beside the measured ones, and the name
    /// of their file.
    pub machine: Option<(Machine, PathBuf)>,
    /// Folder of the results; `None`: `output/<kind>_scaling_<name of the scene>`.
    pub output: Option<PathBuf>,
}

/// Files that no run writes, because they are not measured.
const WITHOUT: [&str; 4] = [
    "output.pictures=false",
    "output.hdf5=false",
    "output.histories=null",
    "output.checkpoint=null",
];

/// The runs of a scaling study.
pub struct ScalingPlan {
    options: ScalingOptions,
    title: String,
    cores: usize,
    runs: Vec<ScalingRun>,
    /// Predictions for each of the runs.
    predicted: Vec<RowPrediction>,
    /// Folder of the results.
    pub output: PathBuf,
}

/// Results of a scaling study.
#[derive(Debug, Serialize)]
pub struct ScalingStudy {
    /// The quantity that is held fixed.
    pub kind: ScalingKind,
    /// Title of the scene.
    pub title: String,
    /// The scene's file.
    pub scene: PathBuf,
    /// The user's overrides of the scene.
    pub sets: Vec<String>,
    /// Runs of each row.
    pub repeats: usize,
    /// Physical cores of the machine.
    pub cores: usize,
    /// The machine's processor.
    pub processor: String,
    /// Two rows per configuration, without and with skipping of patches at rest.
    pub rows: Vec<ScalingRow>,
}

impl ScalingPlan {
    /// Checks the scene of every configuration, so that none fails after hours of others.
    ///
    /// # Errors
    ///
    /// If the scene is not valid for a configuration, or if mpirun cannot be started.
    pub fn new(options: ScalingOptions) -> Result<ScalingPlan, ScalingError> {
        let invalid = |e: &dyn std::fmt::Display| ScalingError::Scene(e.to_string());
        let bytes = input::read(&options.scene).map_err(|e| invalid(&e))?;
        let file = options.scene.display().to_string();
        let parse = |sets: &[String]| input::parse(&bytes, &file, sets).map_err(|e| invalid(&e));
        let unchanged = parse(&options.sets)?;
        let cores = options.cores.unwrap_or_else(|| {
            std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
        });
        if let Some((machine, file)) = &options.machine {
            machine.fits(&unchanged, file).map_err(|e| invalid(&e))?;
        }
        let machine = options.machine.as_ref().map(|(machine, _)| machine);
        let (mut runs, mut predicted) = (Vec::new(), Vec::new());
        for configuration in configurations(&options.ranks, &options.threads) {
            let workers = configuration.workers();
            let grown = match options.kind {
                ScalingKind::Strong => Vec::new(),
                ScalingKind::Weak => grown(&unchanged, workers),
            };
            let all = [&options.sets, &WITHOUT.map(String::from)[..], &grown].concat();
            parse(&all)?;
            let binding = possible_binding(configuration, cores)?;
            for skip_quiescent in [false, true] {
                let mut sets = all.clone();
                sets.push(format!("decomposition.skip_quiescent={skip_quiescent}"));
                predicted.push(RowPrediction::new(&parse(&sets)?, configuration, machine));
                let scene = options.scene.clone();
                runs.push(ScalingRun { configuration, binding, skip_quiescent, scene, sets });
            }
        }
        let output = options.output.clone().unwrap_or_else(|| {
            let name = options.scene.file_stem().unwrap_or_default().to_string_lossy();
            Path::new("output").join(format!("{}_{name}", options.kind.name()))
        });
        Ok(ScalingPlan { title: unchanged.scene.title, cores, runs, predicted, output, options })
    }

    /// Runs all configurations in rounds. `report` gets a line at the start of each round.
    ///
    /// # Errors
    ///
    /// If the folder of the results cannot be used, or if a run fails.
    pub fn measure(&self, report: impl Fn(&str)) -> Result<ScalingStudy, ScalingError> {
        let ScalingOptions { kind, program, scene, sets, repeats, .. } = &self.options;
        let _lock = Lock::take(&self.output)?;
        claim(&self.output, &Origin::new(kind.name(), scene))?;
        let folder = self.output.join(RUN_FOLDER);
        let mut measured: Vec<Vec<MeasuredRun>> = vec![Vec::new(); self.runs.len()];
        let all_rounds = || -> Result<(), ScalingError> {
            for round in 0..*repeats {
                report(&format!("round {} of {repeats}: {} runs", round + 1, self.runs.len()));
                for turn in turns(self.runs.len(), round) {
                    measured[turn].push(self.runs[turn].run(program, &folder)?);
                }
            }
            Ok(())
        };
        let ended = { all_rounds }();
        // the results of a single run are of no use, those of a failed one neither
        let removed = fs::remove_dir_all(&folder).map_err(ScalingError::io(&folder));
        ended.and(removed)?;
        Ok(ScalingStudy {
            kind: *kind,
            title: self.title.clone(),
            scene: scene.clone(),
            sets: sets.clone(),
            repeats: *repeats,
            cores: self.cores,
            processor: processor(),
            rows: rows(&self.runs, &self.predicted, &measured),
        })
    }
}

/// The rows of all runs, each compared with 1 x 1 with the same skipping.
fn rows(
    runs: &[ScalingRun],
    predicted: &[RowPrediction],
    measured: &[Vec<MeasuredRun>],
) -> Vec<ScalingRow> {
    let mut rows: Vec<ScalingRow> = Vec::new();
    for ((run, predicted), measured) in runs.iter().zip(predicted).zip(measured) {
        let base = |row: &&ScalingRow| row.workers == 1 && row.skip_quiescent == run.skip_quiescent;
        let row = ScalingRow::new(run, measured, predicted, rows.iter().find(base));
        rows.push(row);
    }
    rows
}

/// The overrides that multiply the particles by about `workers` and keep the number of steps. The time
/// step shrinks with the cells, so the end time does too, and the waves cover the same number of
/// cells. There is a profile at the end only, because other profile times may be later. In a plane the
/// numbers of cells are whole along both edges, and particles per worker are equal for 1, 4, 16, 64.
fn grown(scene: &CheckedScene, workers: usize) -> Vec<String> {
    let finer = (workers as f64).powf(1.0 / scene.dimension as f64);
    let cells = scene.cells.iter().map(|&cells| (cells as f64 * finer).round());
    let edges = scene.cell_size.iter().zip(&scene.cells).map(|(size, &n)| size * n as f64);
    let sizes: Vec<String> = edges.zip(cells).map(|(edge, n)| format!("{:e}", edge / n)).collect();
    let size = match &sizes[..] {
        [size] => size.clone(),
        _ => format!("[{}]", sizes.join(",")),
    };
    vec![
        format!("domain.cell_size={size}"),
        format!("time.end={:e}", scene.scene.time.end / finer),
        "output.profiles.times=[]".into(),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::row::tests::measured;
    use super::*;

    #[test]
    fn rows_are_held_against_the_base_of_the_same_skipping() {
        let (mut jobs, mut runs) = (Vec::new(), Vec::new());
        for (ranks, skip_quiescent, wall) in
            [(1, false, 4.0), (1, true, 2.0), (2, false, 2.0), (2, true, 1.25)]
        {
            let (job, run) = measured(ranks, &[wall], false);
            jobs.push(ScalingRun { skip_quiescent, ..job });
            runs.push(run);
        }
        let speed_ups: Vec<f64> = rows(&jobs, &[RowPrediction::default(); 4], &runs)
            .iter()
            .map(|row| row.speed_up)
            .collect();
        for (got, wanted) in speed_ups.iter().zip([1.0, 1.0, 2.0, 1.6]) {
            assert!((got - wanted).abs() < 1e-12, "{speed_ups:?}");
        }
    }

    #[test]
    fn weak_scaling_keeps_steps_and_particles_a_worker() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/inputs/flyer.json");
        let bytes = input::read(path.as_ref()).unwrap();
        let parse = |sets: &[String]| input::parse(&bytes, "flyer", sets).unwrap();
        let one = parse(&[]);
        let three = parse(&grown(&one, 3));
        assert_eq!(three.particles, 3 * one.particles);
        let cells = |scene: &CheckedScene| scene.scene.time.end / scene.cell_size[0];
        assert!((cells(&three) / cells(&one) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn weak_scaling_in_a_plane_refines_both_edges() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/inputs/flyer_2d.json");
        let bytes = input::read(path.as_ref()).unwrap();
        let parse = |sets: &[String]| {
            let sets = [&["domain.cell_size=4e-5".to_string()], sets].concat();
            input::parse(&bytes, "flyer_2d", &sets).unwrap()
        };
        let one = parse(&[]);
        let four = parse(&grown(&one, 4));
        assert_eq!((four.particles, &four.cells[..]), (4 * one.particles, &[300, 180][..]));
        assert_eq!(four.scene.time.end, 0.5 * one.scene.time.end);
    }
}
