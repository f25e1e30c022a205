//! A price before the run: the scheme, cell size, particles per cell and Courant number that reach
//! a wanted error for the least time, and what that time will be.
//!
//! How wrong a scheme is was measured on random impacts ([`data`]); what a scene's waves measure
//! and what its steps cost here is measured by pilots ([`pilot`]): the same scene on few cells,
//! timed. [`choose`] puts the two together. On a line, for the body of `error_estimate` or of the
//! reference. Knows no MPI.

pub mod choose;
pub mod data;
pub mod pilot;
pub mod plan_result;
pub mod schemes;

pub use choose::{Plan, PlanError, Wish, plan};
pub use data::Data;
pub use plan_result::{Verdict, verdict};
pub use schemes::{Scheme, schemes, standard};
