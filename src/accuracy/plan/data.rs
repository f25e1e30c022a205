//! Errors of the schemes, measured on random impacts by `scripts/calibrate_estimates.sh`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Distribution of an error: median and 95 % quantile, in the unit that each field of
/// [`SchemeAccuracy`] names.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Size {
    /// Median: half of the runs have a smaller error \[- or cells\].
    pub median: f64,
    /// 95 % quantile: 19 of 20 runs have a smaller error \[- or cells\].
    pub most: f64,
}

impl Size {
    /// Both values times a factor \[-\].
    pub fn times(self, factor: f64) -> Size {
        Size { median: self.median * factor, most: self.most * factor }
    }
}

/// Measured errors of one scheme.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SchemeAccuracy {
    /// int |p - p_exact| dx / (P2 dx) \[cells\].
    pub e1_cells: Size,
    /// Relative error of the plateau pressure, times the plateau length in cells to the power
    /// `plateau_order` \[-\].
    pub plateau: Size,
    /// Order at which this error decreases with the plateau length in cells \[-\].
    pub plateau_order: f64,
    /// Error of an arrival time over the transit time of the shock through a cell \[cells\].
    pub arrival_cells: Size,
    /// Number of runs.
    pub runs: usize,
}

/// Measured errors of all schemes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Data {
    /// Origin of the data.
    pub source: String,
    /// Additional wall time of a step on several ranks, beyond the share of the work \[s\].
    pub rank_step_seconds: f64,
    /// Measured errors by the name of the scheme.
    pub schemes: BTreeMap<String, SchemeAccuracy>,
}

impl Data {
    /// The shipped data.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn shipped() -> Data {
        serde_json::from_str(include_str!("data.json")).expect("the shipped data are whole")
    }
}
