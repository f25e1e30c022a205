//! The time loop of a run: steps, records, checkpoints, early ends.

use std::path::PathBuf;
use std::time::Instant;

use super::failure::RunFailure;
use super::run::Run;
use crate::driver::checkpoint::schedule::Stop;
use crate::driver::checkpoint::{CheckpointError, CheckpointSchedule, StateColumn, folder};
use crate::driver::output::OutputError;
use crate::driver::output::folder::checkpoint_folder;
use crate::driver::output::shared_file::agree;
use crate::driver::progress::{Progress, ProgressChoice};
use crate::driver::recorder::Mark;
use crate::simulation::Compiled;
use crate::solver::Stepper;
use crate::solver::clock::Activity;

impl<const D: usize> Run<'_, D>
where
    Stepper<D>: Compiled<D>,
{
    /// Steps to the end time, recording and writing checkpoints. Returns the bytes that this rank has
    /// received for these outputs. Collective.
    pub(super) fn step_to_end(&mut self) -> Result<u64, RunFailure> {
        let end = self.scene.scene.time.end;
        let first = self.comm.rank() == 0;
        let shown = if first && !self.options.quiet {
            self.options.progress
        } else {
            ProgressChoice::Never
        };
        let mut progress = Progress::new([self.simulation.time(), end], shown);
        // the start and the restart state need no checkpoint
        let mut fresh = true;
        let mut mark = self.recorder.mark();
        let mut bytes_received = 0;
        loop {
            let time = self.simulation.time();
            let (start, before) = (Instant::now(), self.comm.traffic());
            // a checkpoint already contains the records of its own step
            let resumed = fresh && self.simulation.steps() > 0;
            if !resumed {
                self.recorder.record(&self.simulation, first);
                self.recorder.record_fields(&self.simulation, self.comm, &self.unfinished)?;
            }
            if self.simulation.held_at().1 == self.simulation.steps() {
                mark = self.recorder.mark();
            }
            let asked = self.simulation.asked();
            if !fresh && self.schedule.is_due(time, self.simulation.steps(), asked) {
                self.write_checkpoint()?;
            }
            fresh = false;
            let traffic = self.comm.traffic();
            bytes_received += traffic.bytes_received - before.bytes_received;
            let waited = traffic.waited - before.waited;
            self.simulation.clock().add(Activity::Wait, waited);
            self.simulation.clock().add_since(Activity::Output, Some(start), waited);
            if time >= end {
                return Ok(bytes_received);
            }
            if let Some(stop) = CheckpointSchedule::stops(asked) {
                drop(progress);
                return Err(self.stopped(stop));
            }
            self.simulation.ask(self.schedule.asks(first));
            if let Err(error) = self.simulation.advance(self.recorder.next_profile()) {
                drop(progress);
                if !error.is_known_to_all() {
                    return Err(error.into());
                }
                let next = self.save_last_good(&mark);
                return Err(RunFailure::Alarm { error: Box::new(error), next });
            }
            progress.show(self.simulation.time(), self.simulation.steps());
        }
    }

    /// Writes the last state that has passed the monitor, with the records up to `mark`; returns how
    /// to restart from it. Collective.
    fn save_last_good(&self, mark: &Mark) -> String {
        let (time, step) = self.simulation.held_at();
        if step == 0 {
            return "no state but the start has passed the monitor".into();
        }
        if self.schedule.keep == 0 {
            return "no state was written, for output.checkpoint.keep is 0".into();
        }
        let saved = self.simulation.last_good();
        let text = serde_json::to_string(&self.scene.scene).expect("a scene is plain data");
        let columns = self.state_columns();
        let histories = self.recorder.histories_at(mark);
        let contents = self.recorder.contents_at(mark, histories.as_ref(), &text, &saved, &columns);
        let folder = self.checkpoints().map_err(CheckpointError::from);
        let keep = self.schedule.keep;
        match folder.and_then(|folder| folder::write(self.comm, &folder, keep, &contents)) {
            Ok(path) => format!(
                "the last good state, time {time:.6e} s, step {step}, is in {}: continue with \
                 --restart, and --set time or monitor",
                path.display()
            ),
            Err(error) => format!("the last good state could not be written: {error}"),
        }
    }

    /// The columns of the particles in a checkpoint.
    fn state_columns(&self) -> Vec<StateColumn> {
        let all = self.simulation.columns();
        let of = |k: &usize| StateColumn {
            name: all.specs[*k].name.into(),
            unit: all.specs[*k].unit.into(),
        };
        all.state().iter().map(of).collect()
    }

    /// Writes a checkpoint. Collective.
    fn write_checkpoint(&mut self) -> Result<(), RunFailure> {
        let start = Instant::now();
        let saved = self.simulation.save();
        let text = serde_json::to_string(&self.scene.scene).expect("a scene is plain data");
        let columns = self.state_columns();
        let contents = self.recorder.contents(&text, &saved, &columns);
        let folder = self.checkpoints()?;
        folder::write(self.comm, &folder, self.schedule.keep, &contents)?;
        self.schedule.written(start.elapsed());
        Ok(())
    }

    /// The folder of the checkpoints, which rank 0 knows. Collective.
    fn checkpoints(&self) -> Result<PathBuf, OutputError> {
        let first = self.comm.rank() == 0;
        let folder =
            if first { checkpoint_folder(&self.options.output) } else { Ok(PathBuf::new()) };
        agree(self.comm, folder)
    }

    /// The failure that describes an early end.
    fn stopped(&self, stop: Stop) -> RunFailure {
        let why = match stop {
            Stop::WallLimit => "time.wall_limit is over".to_string(),
            Stop::Signal(signal) => format!("signal {signal} came"),
        };
        let next = match checkpoint_folder(&self.options.output) {
            Ok(folder) if self.schedule.keep > 0 => {
                format!("continue with --restart {}", folder.display())
            }
            _ => "no checkpoint was written, for output.checkpoint.keep is 0".to_string(),
        };
        let (time, step) = (self.simulation.time(), self.simulation.steps());
        RunFailure::Stopped { why, time, step, next }
    }
}
