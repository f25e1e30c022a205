//! Error models: the expected error from indicators, fitted on random impacts.
//!
//! The half-width is exp(w0 + sum of w_k ln(indicator_k)) times a factor; products of two logarithms
//! can be further terms of the sum. An indicator outside of its range in the fit counts as the nearer
//! end of the range, because products cannot be extrapolated. The weights are fitted to a high
//! quantile of ln|error| (Koenker & Bassett 1978), so that uncertain cases get a wider interval. The
//! factor makes the intervals hold the intended share of cases that were left out of the fit
//! (conformal calibration, Vovk et al. 2005). Each family of schemes has models of its own. Outside
//! of the fitted range a further factor of at least 1 makes them hold 90 % of the cases.
//! `scripts/calibrate_estimates.sh` repeats the fit and writes the file of [`DATA`].

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::indicators::Evidence;
use super::range::{EstimateBasis, FittedRange};
use super::scheme_family::SchemeFamily;

/// The shipped error models.
pub const DATA: &str = include_str!("laws.json");

/// Lower limit of an indicator: smaller values are rounding and sampling noise \[-\].
pub const LEAST: f64 = 1e-7;

/// Error model for one set of indicators.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Law {
    /// Names of the terms: an indicator, or two with `*` between them for the product of their
    /// logarithms.
    pub evidence: Vec<String>,
    /// w0 and one weight per term, in the exponent: error = exp(w0 + sum w term) \[-\].
    pub weights: Vec<f64>,
    /// Safety factor on the fitted error \[-\].
    pub factor: f64,
    /// Number of runs in the fit.
    pub cases: usize,
    /// Least and greatest value of each indicator in the fit \[-\].
    pub ranges: BTreeMap<String, [f64; 2]>,
}

/// Error models of one quantity; the one that needs the most indicators comes first.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct QuantityLaws(pub Vec<Law>);

/// Error models of all quantities of one family of schemes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FamilyLaws {
    /// Plateau pressure: relative error \[-\].
    pub plateau_pressure: QuantityLaws,
    /// Arrival time: error in sound transit times of a cell \[-\].
    pub arrival_time: QuantityLaws,
    /// Profile: relative L1 error of the pressure \[-\].
    pub l1: QuantityLaws,
}

/// Factors on the half-widths of scenes outside of the fitted range \[-\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GuessFactors {
    /// Of the plateau pressure \[-\].
    pub plateau_pressure: f64,
    /// Of the arrival time \[-\].
    pub arrival_time: f64,
    /// Of the L1 of a profile \[-\].
    pub l1: f64,
}

impl Default for GuessFactors {
    fn default() -> GuessFactors {
        GuessFactors { plateau_pressure: 1.0, arrival_time: 1.0, l1: 1.0 }
    }
}

/// Error models of all families of schemes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Laws {
    /// Origin of the fit.
    pub source: String,
    /// The range of impacts used for the fit and its validation.
    pub fitted: FittedRange,
    /// Error models by family.
    pub families: BTreeMap<SchemeFamily, FamilyLaws>,
    /// Factors on the half-widths outside of this range.
    pub guess: GuessFactors,
}

impl Laws {
    /// The shipped error models.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn shipped() -> Laws {
        serde_json::from_str(DATA).expect("the shipped laws are whole")
    }

    /// The error models of a family with the factors of a basis; empty models, which give no
    /// half-width, if the family is not in the fit.
    pub fn of(&self, family: SchemeFamily, basis: EstimateBasis) -> FamilyLaws {
        let laws = self.families.get(&family).cloned().unwrap_or_default();
        match basis {
            EstimateBasis::Calibrated => laws,
            EstimateBasis::Guess => FamilyLaws {
                plateau_pressure: laws.plateau_pressure.widened(self.guess.plateau_pressure),
                arrival_time: laws.arrival_time.widened(self.guess.arrival_time),
                l1: laws.l1.widened(self.guess.l1),
            },
        }
    }
}

impl Law {
    /// The error expected from the indicators, without the factor \[-\], relative as in [`Laws`];
    /// `None` if an indicator is missing.
    pub fn size(&self, evidence: &Evidence) -> Option<f64> {
        let mut sum = *self.weights.first()?;
        for (name, weight) in self.evidence.iter().zip(&self.weights[1..]) {
            sum += weight * term(evidence, &self.ranges, name)?;
        }
        Some(sum.exp())
    }
}

/// Names of the indicators in a term of an error model.
pub fn indicators_of(term: &str) -> impl Iterator<Item = &str> {
    term.split('*')
}

/// A term of an error model \[-\]: the logarithm of an indicator, or the product of the logarithms of
/// several with `*` between them, each within its range if it has one; `None` if an indicator is
/// missing.
pub fn term(evidence: &Evidence, ranges: &BTreeMap<String, [f64; 2]>, term: &str) -> Option<f64> {
    let logarithm = |name| {
        let value = *evidence.get(name)?;
        let value = ranges.get(name).map_or(value, |range| value.clamp(range[0], range[1]));
        Some(value.max(LEAST).ln())
    };
    indicators_of(term).map(logarithm).product()
}

impl QuantityLaws {
    /// Half-width by the first error model whose indicators are all present \[-\], relative as in
    /// [`Laws`]; `None` if there is no such model.
    pub fn half_width(&self, evidence: &Evidence) -> Option<f64> {
        self.0.iter().find_map(|law| Some(law.factor * law.size(evidence)?))
    }

    /// The same models with half-widths times `factor` \[-\].
    fn widened(self, factor: f64) -> QuantityLaws {
        let wider = |law: Law| Law { factor: factor * law.factor, ..law };
        QuantityLaws(self.0.into_iter().map(wider).collect())
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
            ranges: BTreeMap::new(),
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
        // a product of logarithms
        let product = QuantityLaws(vec![law(&["a*b"], &[0.0, 1.0], 1.0)]);
        let found = product.half_width(&evidence(&[("a", 0.5), ("b", 0.25)]));
        near(found, (0.5_f64.ln() * 0.25_f64.ln()).exp());
        assert_eq!(product.half_width(&evidence(&[("a", 0.5)])), None);
        // outside of its range in the fit an indicator counts as the end of the range
        let ranges = [("a".to_string(), [0.25, 0.5])].into();
        let limited = QuantityLaws(vec![Law { ranges, ..law(&["a"], &[0.0, 1.0], 1.0) }]);
        for (given, counted) in [(0.1, 0.25), (0.3, 0.3), (0.9, 0.5)] {
            near(limited.half_width(&evidence(&[("a", given)])), counted);
        }
    }

    #[test]
    fn every_family_has_shipped_laws() {
        let laws = Laws::shipped();
        for family in SchemeFamily::ALL {
            let of = laws.of(family, EstimateBasis::Calibrated);
            for quantity in [&of.plateau_pressure, &of.arrival_time, &of.l1] {
                assert!(!quantity.0.is_empty(), "{family:?}");
                for law in &quantity.0 {
                    assert_eq!(law.weights.len(), law.evidence.len() + 1);
                    assert!(law.factor > 0.0 && law.weights.iter().all(|w| w.is_finite()));
                }
            }
        }
    }

    #[test]
    fn a_guess_is_wider() {
        let shipped = Laws::shipped().guess;
        assert!(
            shipped.plateau_pressure >= 1.0 && shipped.arrival_time >= 1.0 && shipped.l1 >= 1.0
        );
        let guess = GuessFactors { plateau_pressure: 2.0, arrival_time: 3.0, l1: 4.0 };
        let laws = Laws { guess, ..Laws::shipped() };
        for family in SchemeFamily::ALL {
            let [inside, outside] =
                [EstimateBasis::Calibrated, EstimateBasis::Guess].map(|b| laws.of(family, b));
            let ratio = |of: fn(&FamilyLaws) -> &QuantityLaws| {
                of(&outside).0[0].factor / of(&inside).0[0].factor
            };
            assert!((ratio(|laws| &laws.plateau_pressure) - 2.0).abs() < 1e-12);
            assert!((ratio(|laws| &laws.arrival_time) - 3.0).abs() < 1e-12);
            assert!((ratio(|laws| &laws.l1) - 4.0).abs() < 1e-12);
        }
    }
}
