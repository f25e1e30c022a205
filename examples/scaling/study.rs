//! A study: which jobs there are, and their runs in turn.

use std::path::PathBuf;

use flyer_mpm::driver::output::folder::default_folder;
use flyer_mpm::driver::output::origin::{Origin, claim};
use flyer_mpm::input;
use flyer_mpm::scene::{CellSize, CheckedScene};
use serde::Serialize;

use crate::arguments::{Kind, Options};
use crate::configuration::{configurations, turns};
use crate::launch::{Job, possible_binding};
use crate::row::Row;
use crate::summary::RunSummary;

/// What every run leaves out: files are not what is measured.
const WITHOUT: [&str; 3] = ["output.pictures=false", "output.hdf5=false", "output.histories=null"];

/// What is to be measured.
pub struct Plan {
    kind: Kind,
    title: String,
    scene: PathBuf,
    sets: Vec<String>,
    repeats: usize,
    cores: usize,
    jobs: Vec<Job>,
    /// Folder of the results.
    pub output: PathBuf,
}

/// What was measured.
#[derive(Debug, Serialize)]
pub struct Study {
    /// What is held fixed.
    pub kind: Kind,
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
    /// One row a configuration, without and with skipping.
    pub rows: Vec<Row>,
}

impl Plan {
    /// Checks the scene of every configuration, so that none fails after hours of others.
    pub fn new(kind: Kind, options: &Options) -> Result<Plan, String> {
        let bytes = input::read(&options.scene).map_err(|e| e.to_string())?;
        let file = options.scene.display().to_string();
        let parse = |sets: &[String]| input::parse(&bytes, &file, sets).map_err(|e| e.to_string());
        let unchanged = parse(&options.set)?;
        let cores = options.cores.unwrap_or_else(|| {
            std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
        });
        let mut jobs = Vec::new();
        for configuration in configurations(&options.ranks, &options.threads) {
            let binding = possible_binding(configuration, cores)?;
            for &skip_quiescent in skipping() {
                let mut sets = options.set.clone();
                sets.extend(WITHOUT.map(String::from));
                if skipping().len() > 1 {
                    sets.push(format!("decomposition.skip_quiescent={skip_quiescent}"));
                }
                if kind == Kind::Weak {
                    sets.extend(grown(&unchanged, configuration.workers())?);
                }
                parse(&sets)?;
                let scene = options.scene.clone();
                jobs.push(Job { configuration, binding, skip_quiescent, scene, sets });
            }
        }
        let output = options.output.clone().unwrap_or_else(|| {
            let stem = options.scene.file_stem().unwrap_or_default().to_string_lossy();
            default_folder(format!("{}_{stem}.json", kind.name()).as_ref())
        });
        Ok(Plan {
            kind,
            title: unchanged.scene.title,
            scene: options.scene.clone(),
            sets: options.set.clone(),
            repeats: options.repeats,
            cores,
            jobs,
            output,
        })
    }

    /// Runs all jobs in rounds.
    pub fn measure(&self) -> Result<Study, String> {
        let origin = Origin::new(self.kind.name(), &self.scene);
        claim(&self.output, &origin).map_err(|e| e.to_string())?;
        let scratch = tempfile::tempdir_in(&self.output).map_err(|e| e.to_string())?;
        let mut runs: Vec<Vec<RunSummary>> = vec![Vec::new(); self.jobs.len()];
        for round in 0..self.repeats {
            eprintln!("round {} of {}: {} runs", round + 1, self.repeats, self.jobs.len());
            for turn in turns(self.jobs.len(), round) {
                runs[turn].push(self.jobs[turn].run(&scratch.path().join("run"))?);
            }
        }
        Ok(Study {
            kind: self.kind,
            title: self.title.clone(),
            scene: self.scene.clone(),
            sets: self.sets.clone(),
            repeats: self.repeats,
            cores: self.cores,
            processor: processor(),
            rows: rows(&self.jobs, &runs),
        })
    }
}

/// The rows of all jobs, each held against 1 x 1 with the same skipping.
fn rows(jobs: &[Job], runs: &[Vec<RunSummary>]) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    for (job, runs) in jobs.iter().zip(runs) {
        let base = |row: &&Row| row.workers == 1 && row.skip_quiescent == job.skip_quiescent;
        let row = Row::new(job, runs, rows.iter().find(base));
        rows.push(row);
    }
    rows
}

/// Each configuration runs without and with skipping, where scenes know of it.
fn skipping() -> &'static [bool] {
    let schema = input::schema();
    match schema.pointer("/$defs/Decomposition/properties/skip_quiescent") {
        Some(_) => &[false, true],
        None => &[false],
    }
}

/// The overrides that give `workers` as many times the particles over the same number of steps:
/// the time step shrinks with the cells, so the end does too, and with it the waves cover the same
/// number of cells. Profile times are left to the end alone, the others lie beyond it.
fn grown(scene: &CheckedScene, workers: usize) -> Result<Vec<String>, String> {
    let size = match &scene.scene.domain.cell_size {
        CellSize::Uniform(size) => *size,
        CellSize::PerDirection(sizes) if sizes.len() == 1 => sizes[0],
        CellSize::PerDirection(_) => {
            return Err("weak scaling divides cells in one dimension; allowed: a 1-D scene".into());
        }
    };
    if scene.scene.domain.lower.len() != 1 {
        return Err("weak scaling divides cells in one dimension; allowed: a 1-D scene".into());
    }
    let workers = workers as f64;
    Ok(vec![
        format!("domain.cell_size={:e}", size / workers),
        format!("time.end={:e}", scene.scene.time.end / workers),
        "output.profiles.times=[]".into(),
    ])
}

/// The processor's name, as Linux tells it.
fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    name.map_or("unknown", |(_, name)| name.trim()).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::row::tests::measured;

    #[test]
    fn rows_are_held_against_the_base_of_the_same_skipping() {
        let (mut jobs, mut runs) = (Vec::new(), Vec::new());
        for (ranks, skip_quiescent, wall) in
            [(1, false, 4.0), (1, true, 2.0), (2, false, 2.0), (2, true, 1.25)]
        {
            let (job, run) = measured(ranks, &[wall], false);
            jobs.push(Job { skip_quiescent, ..job });
            runs.push(run);
        }
        let speed_ups: Vec<f64> = rows(&jobs, &runs).iter().map(|row| row.speed_up).collect();
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
        let three = parse(&grown(&one, 3).unwrap());
        assert_eq!(three.particles, 3 * one.particles);
        let cells = |scene: &CheckedScene| scene.scene.time.end / scene.cell_size[0];
        assert!((cells(&three) / cells(&one) - 1.0).abs() < 1e-12);
    }
}
