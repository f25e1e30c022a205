//! Error estimate of a run.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Estimate of the run's own errors from coarse runs with cells two and four times as large, which
/// take about a third of the time of the run on a line, and about a seventh in a plane. All histories
/// of `output.histories` and the values that are read from them get an estimate.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ErrorEstimate {
    /// Name of the body whose plateau pressure, arrivals and profiles of pressure are estimated, on a
    /// line only; absent: the body that the reference compares, else the only body, else the only body
    /// at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub body: Option<String>,
    /// Initial positions in the body at which the arrival time of the wave is reported [m], on a line
    /// only; default: none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub arrivals: Vec<f64>,
    /// Quantities of the particles, such as `pressure` or `velocity`, whose errors are estimated in each
    /// profile, over all bodies. Each gets a column such as `pressure_difference` in the profiles and in
    /// `results.hdf5`: its difference from the run with cells twice as large. Absent: `pressure` in a
    /// plane, none on a line.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fields: Option<Vec<String>>,
}
