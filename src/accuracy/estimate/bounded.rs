//! A value with an interval for its error.

use serde::{Deserialize, Serialize};

use super::indicators::Evidence;

/// A value with an interval that contains the exact value in 95 of 100 cases, if the estimate is
/// calibrated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounded {
    /// Value computed by the run, in the SI unit of its quantity: \[Pa\], \[s\] or \[-\].
    pub value: f64,
    /// Half-width of the interval, in the unit of `value`; `None` if indicators are missing.
    pub half_width: Option<f64>,
    /// Indicators from which the half-width follows, by name \[-\].
    pub evidence: Evidence,
    /// Exact value in the unit of `value`, if the scene has an exact solution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exact: Option<f64>,
}
