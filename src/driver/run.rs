//! A run and its records, from its beginning to the files that an early end leaves.

use std::path::PathBuf;

use decomp::{Comm, StoredParticles};

use super::coarse_runs::{arrival_recorder, run_coarse};
use super::failure::RunFailure;
use super::options::{Beginning, Options};
use super::profiles::{draw, write_profiles};
use crate::accuracy::estimate::CoarseRuns;
use crate::driver::checkpoint::CheckpointSchedule;
use crate::driver::output::histories::HISTORIES_FILE;
use crate::driver::output::shared_file::agree;
use crate::driver::output::unfinished;
use crate::driver::recorder::Recorder;
use crate::perf_model::calibrate::{cores, processor};
use crate::scene::CheckedScene;
use crate::simulation::{Compiled, Simulation, Totals};
use crate::solver::Stepper;

/// A run on one rank.
pub(super) struct Run<'a, const D: usize> {
    /// Messages between ranks.
    pub comm: &'a dyn Comm,
    /// The scene.
    pub scene: &'a CheckedScene,
    /// Options of the run.
    pub options: &'a Options,
    /// Processor, and the cores that the process may use.
    pub machine: String,
    /// The coarse runs from which errors are estimated, if the scene asks for it.
    pub coarse_runs: Option<CoarseRuns>,
    /// State of the run.
    pub simulation: Simulation<'a, D>,
    /// Totals at the start of the run, before any restart.
    pub start: Totals<D>,
    /// Profiles, histories and frames so far.
    pub recorder: Recorder<'a>,
    /// Times of the checkpoints.
    pub schedule: CheckpointSchedule,
    /// Folder of what is written during the run; empty if there is none, and on other ranks.
    pub unfinished: PathBuf,
}

impl<'a, const D: usize> Run<'a, D>
where
    Stepper<D>: Compiled<D>,
{
    /// A run at its beginning, after the coarse runs from which its errors are estimated. Collective.
    ///
    /// # Errors
    ///
    /// If the scene cannot be simulated, or if a coarse run fails.
    pub fn begin(
        comm: &'a dyn Comm,
        scene: &'a CheckedScene,
        options: &'a Options,
        beginning: Beginning,
    ) -> Result<Self, RunFailure> {
        // before threads are bound to cores
        let machine = format!("{}, {} cores", processor(), cores());
        let coarse_runs = match scene.scene.error_estimate {
            Some(_) => Some(run_coarse::<D>(comm, scene, options.threads)?),
            None => None,
        };
        let mut simulation = Simulation::<D>::new(scene, comm, options.threads)?;
        let start = simulation.totals();
        if let Some((_, steps)) = &options.trace {
            simulation.trace(steps.clone());
        }
        let mut recorder = Recorder::new(scene, &simulation);
        if let Some((body, coarse_runs)) = scene.estimated_body().zip(coarse_runs.as_ref()) {
            recorder.arrivals = arrival_recorder(comm, scene, body, coarse_runs);
        }
        let continues = matches!(beginning, Beginning::Checkpoint(_));
        if let Beginning::Checkpoint(mut checkpoint) = beginning {
            agree(comm, checkpoint.fit_share(scene))?;
            simulation.restore(&checkpoint.saved)?;
            checkpoint.saved.particles = StoredParticles::default();
            recorder.resume(*checkpoint, simulation.time());
        }
        let unfinished = match recorder.fields.is_some() && comm.rank() == 0 {
            true => unfinished::begin(&options.output, &recorder.origin, continues),
            false => Ok(PathBuf::new()),
        };
        let unfinished = agree(comm, unfinished)?;
        let now = simulation.time();
        recorder.open_fields(comm, &unfinished, continues.then_some(now))?;
        let signal = options.signal.clone();
        let schedule = CheckpointSchedule::new(scene, now, options.started, signal);
        Ok(Run {
            comm,
            scene,
            options,
            machine,
            coarse_runs,
            simulation,
            start,
            recorder,
            schedule,
            unfinished,
        })
    }

    /// Leaves the profiles and histories of a run that has failed or was stopped, with a picture of
    /// its last profile, in the folder of the unfinished run; a run that was stopped adds its last
    /// state. The failure names the folder. Collective.
    pub fn leave_records(&mut self, failure: RunFailure) -> RunFailure {
        match &failure {
            RunFailure::Stopped { .. } => self.recorder.add_profile(&self.simulation),
            RunFailure::Alarm { .. } => {}
            _ => return failure,
        }
        if self.comm.rank() != 0 || self.recorder.tables.is_empty() {
            return failure;
        }
        let left = match self.write_records() {
            Ok(folder) => format!("; its records are in {}", folder.display()),
            Err(error) => format!("; its profiles could not be written: {error}"),
        };
        match failure {
            RunFailure::Stopped { why, time, step, next } => {
                RunFailure::Stopped { why, time, step, next: next + &left }
            }
            RunFailure::Alarm { error, next } => RunFailure::Alarm { error, next: next + &left },
            other => other,
        }
    }

    /// Writes the records into the folder of the unfinished run, and returns that folder.
    fn write_records(&self) -> Result<PathBuf, RunFailure> {
        let (scene, recorder) = (self.scene, &self.recorder);
        let folder = unfinished::begin(&self.options.output, &recorder.origin, true)?;
        let profiles = write_profiles(self.comm, scene, None, recorder, &folder)?;
        if let Some(histories) = recorder.histories() {
            histories.write(&folder.join(HISTORIES_FILE))?;
        }
        if scene.scene.output.pictures {
            draw(self.comm, scene, None, recorder, &profiles, &folder)?;
        }
        Ok(folder)
    }
}
