//! Predicted against actual, once a planned run has ended.

use serde::{Deserialize, Serialize};

use crate::accuracy::estimate::ErrorEstimate;
use crate::scene::{Planned, PlannedQuantity};

/// What a plan has foretold, and what came.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// The quantity.
    pub quantity: PlannedQuantity,
    /// Its relative error that was wanted \[-\].
    pub wanted: f64,
    /// The error foretold \[-\].
    pub predicted: f64,
    /// Whether that was a guess, for the schemes were not measured on such scenes.
    #[serde(default)]
    pub guess: bool,
    /// The error that came, the greatest of all profiles \[-\]; by the run's own bound where there
    /// is no exact solution; none where it is not known.
    pub actual: Option<f64>,
    /// Whether that is the true error, and not the run's own bound.
    pub is_true: bool,
    /// User CPU time of the time loop foretold \[s\].
    pub predicted_cpu_seconds: f64,
    /// What it was \[s\].
    pub cpu_seconds: f64,
    /// Wall time of the time loop foretold \[s\].
    pub predicted_wall_seconds: f64,
    /// What it was \[s\].
    pub wall_seconds: f64,
}

/// Compares a plan with its run; `exact_l1` has the L1 of each profile against the exact solution
/// [-], where there is one.
pub fn verdict(
    planned: &Planned,
    exact_l1: &[f64],
    estimate: Option<&ErrorEstimate>,
    [cpu_seconds, wall_seconds]: [f64; 2],
) -> Verdict {
    let relative = |b: &crate::accuracy::estimate::Bounded| match (b.exact, b.half_width) {
        (Some(exact), _) => Some(((b.value - exact).abs() / exact.abs(), true)),
        (None, Some(width)) => Some((width / b.value.abs(), false)),
        _ => None,
    };
    let all: Vec<(f64, bool)> = match planned.quantity {
        PlannedQuantity::L1 => {
            let exact: Vec<_> = exact_l1.iter().map(|&l1| (l1, true)).collect();
            let bounds = estimate.iter().flat_map(|e| &e.profiles);
            match exact.is_empty() {
                true => bounds.filter_map(|p| Some((p.l1.half_width?, false))).collect(),
                false => exact,
            }
        }
        PlannedQuantity::PlateauPressure => estimate
            .iter()
            .flat_map(|e| &e.profiles)
            .filter_map(|p| relative(p.plateau_pressure.as_ref()?))
            .collect(),
        PlannedQuantity::ArrivalTime => estimate
            .iter()
            .flat_map(|e| &e.arrivals)
            .filter_map(|a| relative(a.time.as_ref()?))
            .collect(),
    };
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
