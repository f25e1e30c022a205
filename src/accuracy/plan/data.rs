//! Errors of the schemes, measured on random impacts by `scripts/calibrate_estimates.sh`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::accuracy::estimate::QuantityLaws;
use crate::accuracy::estimate::indicators::{Evidence, of_compressions};

/// Distribution of an error: median and a high quantile \[-\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Size {
    /// Median: half of the runs have a smaller error \[-\].
    pub median: f64,
    /// High quantile: at least 19 of 20 runs have a smaller error \[-\].
    pub most: f64,
}

/// Error of a quantity, as a function of the indicators of [`ShockStrength::evidence`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ErrorLaws {
    /// Median.
    pub median: QuantityLaws,
    /// High quantile, with a margin over the 95 % that a plan promises.
    pub most: QuantityLaws,
}

/// Indicator: length that scales the error, in cells \[-\].
pub const CELLS: &str = "cells";
/// Indicator: pressure behind the shock over the density times the square of the sound speed \[-\].
pub const STRENGTH: &str = "strength";

/// Strength of the shock of an impact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShockStrength {
    /// Pressure behind the shock over the density times the square of the sound speed \[-\].
    pub strength: f64,
    /// Exact compressions of the struck and of the striking body \[-\], if the waves are known.
    pub compressions: Option<[f64; 2]>,
}

impl ShockStrength {
    /// Indicators of the error at a length in cells.
    pub fn evidence(&self, cells: f64) -> Evidence {
        let mut all = self.compressions.map(of_compressions).unwrap_or_default();
        all.extend([(CELLS.to_string(), cells), (STRENGTH.to_string(), self.strength)]);
        all
    }
}

impl ErrorLaws {
    /// The error at a length in cells and a strength of the shock \[-\].
    pub fn at(&self, cells: f64, shock: &ShockStrength) -> Option<Size> {
        let evidence = shock.evidence(cells);
        let median = self.median.half_width(&evidence)?;
        Some(Size { median, most: self.most.half_width(&evidence)?.max(median) })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_every_scheme_fall_with_more_cells() {
        let waves = ShockStrength { strength: 0.03, compressions: Some([0.1, 0.15]) };
        let unknown = ShockStrength { compressions: None, ..waves };
        for (name, measured) in &Data::shipped().schemes {
            for laws in [&measured.l1, &measured.plateau, &measured.arrival] {
                for shock in [&waves, &unknown] {
                    let [coarse, fine] = [20.0, 80.0].map(|cells| laws.at(cells, shock).unwrap());
                    assert!(0.0 < fine.most && fine.most < coarse.most, "{name}: {fine:?}");
                    assert!(fine.median <= fine.most, "{name}: {fine:?}");
                }
            }
        }
    }

    #[test]
    fn the_law_with_the_compressions_comes_first() {
        let shock = ShockStrength { strength: 0.03, compressions: Some([0.1, 0.2]) };
        let evidence = shock.evidence(40.0);
        assert_eq!((evidence[CELLS], evidence[STRENGTH]), (40.0, 0.03));
        assert_eq!((evidence["compression"], evidence["other_compression"]), (0.1, 0.2));
        let without = ShockStrength { compressions: None, ..shock }.evidence(40.0);
        assert_eq!(without.len(), 2);
        for measured in Data::shipped().schemes.values() {
            let first = &measured.arrival.most.0[0].evidence;
            assert!(first.iter().any(|name| name == "other_compression"), "{first:?}");
            // a stronger shock has a greater error
            let weak = ShockStrength { compressions: Some([0.01, 0.01]), ..shock };
            let at = |shock: &ShockStrength| measured.arrival.at(40.0, shock).unwrap().most;
            assert!(at(&weak) < at(&shock));
        }
    }
}
