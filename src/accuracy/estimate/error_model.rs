//! Error models: the expected error from indicators, fitted on random impacts.
//!
//! The half-width is exp(w0 + sum of w_k ln(indicator_k)) times a factor. The weights are fitted to
//! a high quantile of ln|error| (Koenker & Bassett 1978), so that uncertain cases get a wider
//! interval. The factor is a margin for materials outside of the fit.
//! `scripts/calibrate_estimates.sh` repeats the fit and writes the file of [`DATA`].

use serde::{Deserialize, Serialize};

use super::indicators::Evidence;
use super::range::FittedRange;

/// The shipped error models.
pub const DATA: &str = include_str!("laws.json");

/// Lower limit of an indicator: smaller values are rounding and sampling noise \[-\].
pub const LEAST: f64 = 1e-7;

/// Error model for one set of indicators.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Law {
    /// Names of the indicators that it needs.
    pub evidence: Vec<String>,
    /// w0 and one weight per indicator, in the exponent: error = exp(w0 + sum w ln(indicator))
    /// \[-\].
    pub weights: Vec<f64>,
    /// Safety factor on the fitted error \[-\].
    pub factor: f64,
    /// Number of runs in the fit.
    pub cases: usize,
}

/// Error models of one quantity; the one that needs the most indicators comes first.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct QuantityLaws(pub Vec<Law>);

/// Error models of all quantities.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Laws {
    /// Origin of the fit.
    pub source: String,
    /// The range of impacts used for the fit and its validation.
    pub fitted: FittedRange,
    /// Plateau pressure: relative error \[-\].
    pub plateau_pressure: QuantityLaws,
    /// Arrival time: error in sound transit times of a cell \[-\].
    pub arrival_time: QuantityLaws,
    /// Profile: relative L1 error of the pressure \[-\].
    pub l1: QuantityLaws,
}

impl Laws {
    /// The shipped error models.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn shipped() -> Laws {
        serde_json::from_str(DATA).expect("the shipped laws are whole")
    }
}

impl Law {
    /// The error expected from the indicators, without the factor \[-\], relative as in [`Laws`];
    /// `None` if an indicator is missing.
    pub fn size(&self, evidence: &Evidence) -> Option<f64> {
        let mut sum = *self.weights.first()?;
        for (name, weight) in self.evidence.iter().zip(&self.weights[1..]) {
            sum += weight * evidence.get(name)?.max(LEAST).ln();
        }
        Some(sum.exp())
    }
}

impl QuantityLaws {
    /// Half-width by the first error model whose indicators are all present \[-\], relative as in
    /// [`Laws`]; `None` if there is no such model.
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
        let quantity = QuantityLaws(vec![both, one]);
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
