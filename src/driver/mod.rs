//! A run with its files: steps, checkpoints, profiles, histories, errors, pictures, summary.
//!
//! All ranks compute; rank 0 gathers, evaluates errors and writes.

mod balance;
pub mod checkpoint;
pub mod coarse_runs;
pub mod default_folder;
mod failure;
pub mod fields;
pub mod figures;
mod measured;
pub mod memory;
mod options;
pub mod output;
pub mod probes;
mod profiles;
pub mod progress;
pub mod rank_statistics;
mod readings;
pub mod recorder;
mod results;
mod run;
mod stepping;

pub use failure::RunFailure;
pub use options::{Beginning, Options};

use decomp::Comm;

use crate::scene::CheckedScene;
use crate::simulation::Compiled;
use crate::solver::Stepper;
use rank_statistics::LoopStart;
use run::Run;

/// Runs a scene and writes its results; returns the final table at rank 0. Collective.
///
/// # Errors
///
/// If the simulation fails, if a file cannot be read or written, or if the run is stopped.
pub fn run(
    comm: &dyn Comm,
    scene: &CheckedScene,
    options: &Options,
    beginning: Beginning,
) -> Result<Option<String>, RunFailure> {
    match scene.dimension {
        1 => run_in::<1>(comm, scene, options, beginning),
        _ => run_in::<2>(comm, scene, options, beginning),
    }
}

/// Runs a scene in `D` dimensions.
fn run_in<const D: usize>(
    comm: &dyn Comm,
    scene: &CheckedScene,
    options: &Options,
    beginning: Beginning,
) -> Result<Option<String>, RunFailure>
where
    Stepper<D>: Compiled<D>,
{
    let mut run = Run::<D>::begin(comm, scene, options, beginning)?;
    let start = LoopStart::now(comm);
    match run.step_to_end() {
        Ok(output_bytes) => {
            let used = start.end(comm, output_bytes);
            run.write_results(&used)
        }
        Err(failure) => Err(run.leave_records(failure)),
    }
}
