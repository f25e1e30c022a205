//! Predicts the time of a step on given ranks, threads and patches: counts times constants.
//!
//! The parallel part follows LogGP (Alexandrov, Ionescu, Schauser & Scheiman 1995, "LogGP:
//! incorporating long messages into the LogP model"): a message costs its sender and its receiver
//! an overhead o each, arrives after a latency L, and takes G per byte. The derivation is in
//! `docs/performance_model.md`.
//!
//! - [`StepCounts`] counts the operations of a step; [`Work`] and [`Share`] distribute them.
//! - [`Machine`] holds the constants of a machine, [`Network`] those of a network.
//! - [`predict`] combines them; [`Against`] compares predictions with a scaling study.
//!
//! Sends no messages and runs no steps: [`crate::perf_model::calibrate`] measures the constants.

pub mod calibrate;
mod cost;
pub mod fit;
mod load;
mod machine;
mod network;
mod schedule;
mod table;
mod validation;

pub use cost::{Prediction, predict, predict_run, predict_with};
pub use load::{RankWork, Sent, Share, Work, cold_share};
pub use machine::{
    Busy, COMPUTE, Coefficients, FORMAT, Machine, MachineError, Quality, SERIAL, SchemeCosts,
};
pub use network::{NETWORKS, Network, NetworkError};
pub use schedule::{StepCounts, method_name};
pub use table::{Forecast, ScalingLimits, forecast, machine_table, ranks_to, table};
pub use validation::{Against, Compared, PredictionError};
