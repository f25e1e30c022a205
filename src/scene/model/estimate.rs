//! Error estimate of a run.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Estimate of the run's own errors from companion runs with cells two and four times as large,
/// which take about a third of the time of the run. One dimension only.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ErrorEstimate {
    /// Name of the body whose errors are estimated; absent: the body that the reference compares,
    /// else the only body, else the only body at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub body: Option<String>,
    /// Initial positions in the body at which the arrival time of the wave is reported [m];
    /// default: none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub arrivals: Vec<f64>,
}
