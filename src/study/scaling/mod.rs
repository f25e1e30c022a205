//! Strong and weak scaling of a scene over ranks and threads.
//!
//! A study ([`ScalingPlan`]) starts the program under mpirun on every combination of ranks and
//! threads. All combinations are run in turn and several times, so that a slow minute of the
//! machine affects all of them alike. The medians are a table ([`table`]), a CSV, `scaling.json` and
//! a picture ([`files`]). Starts processes; knows no particles and no MPI.

pub mod configuration;
pub mod error;
pub mod files;
pub mod kind;
pub mod launch;
pub mod measured_run;
mod picture;
pub mod row;
pub mod row_prediction;
pub mod statistics;
pub mod study;
pub mod table;

pub use error::ScalingError;
pub use kind::ScalingKind;
pub use study::{ScalingOptions, ScalingPlan, ScalingStudy};
