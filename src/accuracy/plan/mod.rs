//! Plans a run: scheme, cell size, particles per cell and Courant number that reach a target error
//! in the shortest time, and a prediction of that time.
//!
//! The errors of the schemes were measured on random impacts ([`data`]). Pilot runs ([`pilot`]),
//! the same scene on few cells, measure the wave lengths of the scene and the cost of its steps on
//! this machine. [`choose`] combines the two. Only for scenes on a line, for the body of
//! `error_estimate` or of the reference. Does not depend on MPI.

mod cell_counts;
pub mod choose;
pub mod data;
pub mod pilot;
pub mod plan_result;
mod quantities;
mod run_time;
pub mod schemes;

pub use choose::{ErrorTarget, Plan, PlanError, plan};
pub use data::Data;
pub use plan_result::{Verdict, verdict};
pub use schemes::{PlannedScheme, schemes, standard};
