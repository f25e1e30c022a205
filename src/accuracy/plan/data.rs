//! Errors of the schemes, measured on random impacts by `scripts/calibrate_estimates.sh`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::accuracy::estimate::QuantityLaws;
use crate::accuracy::estimate::indicators::{Evidence, OTHER_CELLS, of_compressions};

/// Distribution of an error: median and a high quantile \[-\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Size {
    /// Median: half of the runs have a smaller error \[-\].
    pub median: f64,
    /// High quantile: at least 19 of 20 runs have a smaller error \[-\].
    pub most: f64,
}

/// Error of a quantity, as a function of the indicators of [`ImpactIndicators::evidence`].
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

/// What the error in an impact depends on, besides the length that scales it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImpactIndicators {
    /// Pressure behind the shock over the density times the square of the sound speed \[-\].
    pub strength: f64,
    /// Exact compressions of the struck and of the striking body \[-\], if the waves are known.
    pub compressions: Option<[f64; 2]>,
    /// Thickness of the striking body over the length that scales the error \[-\], if there are two
    /// bodies.
    pub other_thickness: Option<f64>,
}

impl ImpactIndicators {
    /// Indicators of the error at a length in cells.
    pub fn evidence(&self, cells: f64) -> Evidence {
        let mut all = self.compressions.map(of_compressions).unwrap_or_default();
        all.extend([(CELLS.to_string(), cells), (STRENGTH.to_string(), self.strength)]);
        all.extend(self.other_thickness.map(|ratio| (OTHER_CELLS.to_string(), ratio * cells)));
        all
    }
}

impl ErrorLaws {
    /// The error at a length in cells in an impact \[-\].
    pub fn at(&self, cells: f64, impact: &ImpactIndicators) -> Option<Size> {
        let evidence = impact.evidence(cells);
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

    /// An impact whose waves are known, one whose waves are not, and one of a scene without two bodies.
    fn impacts() -> [ImpactIndicators; 3] {
        let (compressions, other_thickness) = (Some([0.1, 0.15]), Some(0.8));
        let known = ImpactIndicators { strength: 0.12, compressions, other_thickness };
        let unknown = ImpactIndicators { compressions: None, ..known };
        [known, unknown, ImpactIndicators { other_thickness: None, ..unknown }]
    }

    #[test]
    fn errors_of_every_scheme_fall_with_more_cells() {
        for (name, measured) in &Data::shipped().schemes {
            for laws in [&measured.l1, &measured.plateau, &measured.arrival] {
                for impact in &impacts() {
                    let [coarse, fine] = [20.0, 80.0].map(|cells| laws.at(cells, impact).unwrap());
                    assert!(0.0 < fine.most && fine.most < coarse.most, "{name}: {fine:?}");
                    assert!(fine.median <= fine.most, "{name}: {fine:?}");
                }
            }
        }
    }

    #[test]
    fn the_law_with_the_compressions_comes_first() {
        let [known, unknown, alone] = impacts();
        let evidence = known.evidence(40.0);
        assert_eq!(
            (evidence[CELLS], evidence[STRENGTH], evidence[OTHER_CELLS]),
            (40.0, 0.12, 32.0)
        );
        assert_eq!((evidence["compression"], evidence["other_compression"]), (0.1, 0.15));
        assert_eq!((unknown.evidence(40.0).len(), alone.evidence(40.0).len()), (3, 2));
        for measured in Data::shipped().schemes.values() {
            let first = &measured.arrival.most.0[0].evidence;
            assert!(first.iter().any(|name| name == "other_compression"), "{first:?}");
            // the arrival error is least at medium strength: weak shocks are wide
            let of_shocks = [[0.005, 0.004], [0.05, 0.03], [0.4, 0.09]];
            let [weak, medium, strong] = of_shocks.map(|[compression, strength]| {
                let compressions = Some([compression; 2]);
                let impact = ImpactIndicators { strength, compressions, ..known };
                measured.arrival.at(40.0, &impact).unwrap().most
            });
            assert!(medium < weak && medium < strong, "{weak} {medium} {strong}");
        }
    }
}
