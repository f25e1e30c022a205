//! Errors of the schemes, measured on random impacts by `scripts/calibrate_estimates.sh`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::accuracy::estimate::error_model::Law;

/// Distribution of an error: median and 95 % quantile \[-\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Size {
    /// Median: half of the runs have a smaller error \[-\].
    pub median: f64,
    /// 95 % quantile: 19 of 20 runs have a smaller error \[-\].
    pub most: f64,
}

/// Error of a quantity, as a function of the indicators [`CELLS`] and [`STRENGTH`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ErrorLaws {
    /// Median.
    pub median: Law,
    /// 95 % quantile.
    pub most: Law,
}

/// Indicator: length that scales the error, in cells \[-\].
pub const CELLS: &str = "cells";
/// Indicator: pressure behind the shock over the density times the square of the sound speed \[-\].
pub const STRENGTH: &str = "strength";

impl ErrorLaws {
    /// The error at a length in cells and a strength of the shock \[-\].
    pub fn at(&self, cells: f64, strength: f64) -> Option<Size> {
        let evidence = [(CELLS.to_string(), cells), (STRENGTH.to_string(), strength)].into();
        let size = |law: &Law| Some(law.factor * law.size(&evidence)?);
        let median = size(&self.median)?;
        Some(Size { median, most: size(&self.most)?.max(median) })
    }
}

/// Measured errors of one scheme.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SchemeAccuracy {
    /// Relative L1; the length is that of the pulse, int p dx over the pressure behind the shock.
    pub l1: ErrorLaws,
    /// Relative error of the plateau pressure; the length is that of the plateau.
    pub plateau: ErrorLaws,
    /// Relative error of an arrival time; the length is the distance from the impact.
    pub arrival: ErrorLaws,
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
