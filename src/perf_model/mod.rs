//! How long a step takes on so many ranks, threads and patches: counts times measured constants.
//!
//! The parallel part is in the manner of LogGP (Alexandrov, Ionescu, Schauser & Scheiman 1995,
//! "LogGP: incorporating long messages into the LogP model"): a message costs its sender and its
//! receiver an overhead o each, comes L later, and G later for each of its bytes. The derivation
//! stands in `docs/performance_model.md`.
//!
//! - [`Schedule`] counts what a step does, [`Work`] and [`Share`] who has how much of it.
//! - [`Machine`] holds the constants, [`Network`] those of a network.
//! - [`predict`] puts them together; [`Against`] holds predictions against a scaling study.
//!
//! Knows no messages and runs no step: what is measured comes from [`crate::perf_model::calibrate`].

pub mod calibrate;
mod cost;
pub mod fit;
mod load;
mod machine;
mod network;
mod particle_density;
mod schedule;
mod table;
mod validation;

pub use cost::{Prediction, predict, predict_with};
pub use load::{PatchWork, RankWork, Share, Work, cold_share};
pub use machine::{
    Busy, COMPUTE, Coefficients, FORMAT, Machine, MachineError, Quality, SERIAL, Scheme,
};
pub use network::{NETWORKS, Network, NetworkError};
pub use particle_density::Terrain;
pub use schedule::{Schedule, method_name};
pub use table::{Forecast, Limits, forecast, machine_table, ranks_to, table};
pub use validation::{Against, Compared, StudyError};
