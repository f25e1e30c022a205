//! Reasons why a run has no result.

use crate::driver::checkpoint::CheckpointError;
use crate::driver::output::OutputError;
use crate::plot::PictureError;
use crate::simulation::RunError;

/// Reason why a run has no result.
#[derive(Debug, thiserror::Error)]
pub enum RunFailure {
    /// Failure of the simulation.
    #[error(transparent)]
    Run(#[from] RunError),
    /// Failure of the simulation after which the last good state was written, if possible. All
    /// ranks know it.
    #[error("{error}; {next}")]
    Alarm {
        /// Reason for the end.
        error: Box<RunError>,
        /// Where to restart from.
        next: String,
    },
    /// Failure to write results.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Failure to write pictures.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// Failure to read or write checkpoints.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// The run was stopped on request and can be restarted; this is no failure. All ranks know it.
    #[error("stopped at time {time:.6e} s, step {step}: {why}; {next}")]
    Stopped {
        /// Source of the request.
        why: String,
        /// Time [s].
        time: f64,
        /// Number of steps.
        step: u64,
        /// How to restart.
        next: String,
    },
}
