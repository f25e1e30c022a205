//! A run's statement of its own errors.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An estimate of the run's own errors, from companion runs on cells two and four times as large,
/// which take 43 % of the run's time. On a line.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ErrorEstimate {
    /// The body that it is about; absent: the one that the reference scores, else the only body, else
    /// the only one at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub body: Option<String>,
    /// Places in the body, at the start, at which the time of the wave's arrival is told [m].
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub arrivals: Vec<f64>,
}
