//! What was measured of the schemes on random impacts, by `scripts/calibrate_estimates.sh`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// The typical size of an error, and one that few runs pass.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Size {
    /// Half of the runs have less.
    pub median: f64,
    /// 19 of 20 runs have less.
    pub most: f64,
}

impl Size {
    /// Both times a factor.
    pub fn times(self, factor: f64) -> Size {
        Size { median: self.median * factor, most: self.most * factor }
    }
}

/// What was measured of one scheme.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measured {
    /// int |p - p_exact| dx / (P2 dx) \[cells\].
    pub e1_cells: Size,
    /// Relative error of the plateau's pressure, times its length in cells to the power
    /// `plateau_order` \[-\].
    pub plateau: Size,
    /// How that error falls with the plateau's length in cells \[-\].
    pub plateau_order: f64,
    /// Error of an arrival over the time of the shock's way through a cell \[cells\].
    pub arrival_cells: Size,
    /// Runs.
    pub runs: usize,
}

/// What was measured, by the schemes' names.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Data {
    /// How it was made.
    pub source: String,
    /// Wall time that a step takes longer on several ranks than its share of the work \[s\].
    pub rank_step_seconds: f64,
    /// One entry a scheme.
    pub schemes: BTreeMap<String, Measured>,
}

impl Data {
    /// The shipped data.
    pub fn shipped() -> Data {
        serde_json::from_str(include_str!("data.json")).expect("the shipped data are whole")
    }
}
