//! Comparison of a plan with its finished run.

use serde::{Deserialize, Serialize};

use crate::accuracy::estimate::EstimatedErrors;
use crate::scene::{Planned, PlannedQuantity};

/// Predicted and actual error and cost of a planned run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// Quantity.
    pub quantity: PlannedQuantity,
    /// Target: relative error \[-\].
    pub wanted: f64,
    /// Predicted error, which 19 of 20 runs do not exceed \[-\].
    pub predicted: f64,
    /// Whether the prediction is a guess, because the schemes were not measured on such scenes.
    #[serde(default)]
    pub guess: bool,
    /// Actual error, the largest of all profiles \[-\]. Without an exact solution, the error
    /// estimate of the run; `None` if neither is known.
    pub actual: Option<f64>,
    /// Whether `actual` is the true error, not the error estimate of the run; true if there is no
    /// `actual`.
    pub is_true: bool,
    /// Predicted user CPU time of the time loop \[s\].
    pub predicted_cpu_seconds: f64,
    /// Actual user CPU time of the time loop \[s\].
    pub cpu_seconds: f64,
    /// Predicted wall time of the time loop \[s\].
    pub predicted_wall_seconds: f64,
    /// Actual wall time of the time loop \[s\].
    pub wall_seconds: f64,
}

/// Compares a plan with its run; `exact_l1` is the L1 of each profile against the exact solution
/// [-], empty if there is none.
pub fn verdict(
    planned: &Planned,
    exact_l1: &[f64],
    estimate: Option<&EstimatedErrors>,
    [cpu_seconds, wall_seconds]: [f64; 2],
) -> Verdict {
    let all = planned.quantity.actual(exact_l1, estimate);
    Verdict {
        quantity: planned.quantity,
        wanted: planned.wanted,
        predicted: planned.error,
        guess: planned.guess,
        actual: all.iter().map(|a| a.0).reduce(f64::max),
        is_true: all.iter().all(|a| a.1),
        predicted_cpu_seconds: planned.cpu_seconds,
        cpu_seconds,
        predicted_wall_seconds: planned.wall_seconds,
        wall_seconds,
    }
}
