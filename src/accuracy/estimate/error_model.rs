//! How errors follow from evidence: laws fitted on random impacts.
//!
//! The half-width is exp(w0 + sum of w_k ln(evidence_k)) times a factor. The weights are those of a
//! high quantile of ln|error| (Koenker & Bassett 1978), so that what is risky is given more room;
//! the factor is a margin for materials that were not fitted on.
//! `scripts/calibrate_estimates.sh` fits them anew and writes [`DATA`]'s file.

use serde::{Deserialize, Serialize};

use super::indicators::Evidence;
use super::range::FittedRange;

/// The shipped laws.
pub const DATA: &str = include_str!("laws.json");

/// Evidence below this counts as this: what rounding and sampling leave \[-\].
pub const LEAST: f64 = 1e-7;

/// A law for one set of evidence.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Law {
    /// Names of the evidence that it needs.
    pub evidence: Vec<String>,
    /// w0, and a weight for each.
    pub weights: Vec<f64>,
    /// What the fitted size is multiplied by.
    pub factor: f64,
    /// Runs that it was fitted on.
    pub cases: usize,
}

/// The laws of a quantity, the one that needs most first.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Quantity(pub Vec<Law>);

/// All laws.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Laws {
    /// How they were made.
    pub source: String,
    /// The impacts that they were fitted on and compared with.
    pub fitted: FittedRange,
    /// Of the plateau's pressure, relative.
    pub plateau_pressure: Quantity,
    /// Of arrivals, in times that sound takes through a cell.
    pub arrival_time: Quantity,
    /// Of the relative L1 of a profile.
    pub l1: Quantity,
}

impl Laws {
    /// The shipped laws.
    pub fn shipped() -> Laws {
        serde_json::from_str(DATA).expect("the shipped laws are whole")
    }
}

impl Law {
    /// The size of error that the evidence speaks of, without the factor; none where some is
    /// missing.
    pub fn size(&self, evidence: &Evidence) -> Option<f64> {
        let mut sum = *self.weights.first()?;
        for (name, weight) in self.evidence.iter().zip(&self.weights[1..]) {
            sum += weight * evidence.get(name)?.max(LEAST).ln();
        }
        Some(sum.exp())
    }
}

impl Quantity {
    /// The half-width by the first law whose evidence is all there.
    pub fn half_width(&self, evidence: &Evidence) -> Option<f64> {
        self.0.iter().find_map(|law| Some(law.factor * law.size(evidence)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_law_with_all_its_evidence_speaks() {
        let law = |evidence: &[&str], weights: &[f64], factor| Law {
            evidence: evidence.iter().map(|e| e.to_string()).collect(),
            weights: weights.to_vec(),
            factor,
            cases: 1,
        };
        let both = law(&["a", "b"], &[0.0, 1.0, 0.5], 2.0);
        let one = law(&["a"], &[0.0, 1.0], 10.0);
        let quantity = Quantity(vec![both, one]);
        let evidence = |pairs: &[(&str, f64)]| -> Evidence {
            pairs.iter().map(|(n, v)| (n.to_string(), *v)).collect()
        };
        let near = |a: Option<f64>, b: f64| assert!((a.unwrap() - b).abs() < 1e-12, "{a:?} {b}");
        near(quantity.half_width(&evidence(&[("a", 0.5), ("b", 0.25)])), 0.5);
        near(quantity.half_width(&evidence(&[("a", 0.5)])), 5.0);
        near(quantity.half_width(&evidence(&[("a", 0.0)])), 10.0 * LEAST);
        assert_eq!(quantity.half_width(&evidence(&[("b", 1.0)])), None);
    }

    #[test]
    fn the_shipped_laws_can_be_read() {
        let laws = Laws::shipped();
        for quantity in [&laws.plateau_pressure, &laws.arrival_time, &laws.l1] {
            assert!(!quantity.0.is_empty());
            for law in &quantity.0 {
                assert_eq!(law.weights.len(), law.evidence.len() + 1);
                assert!(law.factor > 0.0 && law.weights.iter().all(|w| w.is_finite()));
            }
        }
    }
}
