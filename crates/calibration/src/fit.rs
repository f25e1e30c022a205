//! Fits a law by quantile regression of the logarithms (Koenker & Bassett 1978). The factor follows
//! from cases that were left out of the regression (cross-conformal calibration, Vovk 2015).

use std::collections::BTreeMap;

use calibration::estimates::CheckedEstimate;
use flyer_mpm::accuracy::estimate::error_model::{Law, indicators_of, term};
use nalgebra::{DMatrix, DVector};

/// Quantile of the regression of error models. It is below the share that the intervals hold, since
/// few cases lie beyond a quantile near 1; the factor makes up for the rest.
pub const REGRESSED: f64 = 0.9;
/// Errors below this are rounding \[in the evidence's unit\].
const FLOOR: f64 = 1e-8;
/// Rounds of reweighting.
const ROUNDS: usize = 200;
/// Parts into which the cases are divided; each part is left out of one regression.
const PARTS: usize = 10;

/// A set of evidence.
#[derive(Clone, Copy, Debug)]
pub struct EvidenceSet {
    /// Indicators that are terms of the law.
    pub terms: &'static [&'static str],
    /// Indicators whose products of two, and squares, are further terms.
    pub products: &'static [&'static str],
}

impl EvidenceSet {
    /// Names of all terms.
    pub fn names(&self) -> Vec<String> {
        let numbered = self.products.iter().enumerate();
        let products = numbered.flat_map(|(k, first)| {
            self.products[k..].iter().map(move |second| format!("{first}*{second}"))
        });
        self.terms.iter().map(|term| term.to_string()).chain(products).collect()
    }
}

/// The law with the narrowest intervals of those of several sets of evidence, with intervals that hold
/// `share` of cases that are left out of the fit; `None` if too few cases have the evidence.
pub fn narrowest(all: &[&CheckedEstimate], sets: &[EvidenceSet], share: f64) -> Option<Law> {
    let laws = sets.iter().filter_map(|set| law(all, &set.names(), share, REGRESSED));
    laws.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(law, _)| law)
}

/// The law of this evidence, by regression of the quantile `regressed`, with the median of half-width
/// over error in cases that are left out of the fit. No two cases have the same scheme, and few the
/// same materials, so that the cases left out are of other schemes and materials.
pub fn law(
    all: &[&CheckedEstimate],
    evidence: &[String],
    share: f64,
    regressed: f64,
) -> Option<(Law, f64)> {
    let has = |t: &&CheckedEstimate| evidence.iter().all(|e| value(t, e).is_some());
    let usable: Vec<&CheckedEstimate> = all.iter().copied().filter(has).collect();
    if usable.len() < 12 * (evidence.len() + 1) {
        return None;
    }
    let ranges = ranges(&usable, evidence);
    let of = |weights, factor| Law {
        evidence: evidence.to_vec(),
        weights,
        factor,
        cases: usable.len(),
        ranges: ranges.clone(),
    };
    let mut scores = Vec::new();
    for part in 0..PARTS {
        let numbered = usable.iter().enumerate();
        let kept: Vec<&CheckedEstimate> =
            numbered.clone().filter(|(k, _)| k % PARTS != part).map(|(_, t)| *t).collect();
        let law = of(weights(&kept, evidence, regressed), 1.0);
        let left_out = numbered.filter(|(k, _)| k % PARTS == part).map(|(_, t)| *t);
        scores.extend(left_out.filter_map(|t| Some(size(t) / law.size(&t.evidence)?)));
    }
    // the quantile of finitely many scores that holds the share of further cases
    let n = scores.len() as f64;
    let factor = quantile(scores.iter().copied(), (share * (n + 1.0) / n).min(1.0));
    let ratio = factor / quantile(scores.into_iter(), 0.5);
    Some((of(weights(&usable, evidence, regressed), factor), ratio))
}

/// Value of a term.
fn value(one: &CheckedEstimate, name: &str) -> Option<f64> {
    term(&one.evidence, &BTreeMap::new(), name)
}

/// Least and greatest value of each indicator.
fn ranges(all: &[&CheckedEstimate], evidence: &[String]) -> BTreeMap<String, [f64; 2]> {
    let range = |name: &str| {
        let values = all.iter().map(|t| t.evidence[name]);
        let [least, greatest] = [f64::INFINITY, f64::NEG_INFINITY];
        let ends = |[low, high]: [f64; 2], v: f64| [low.min(v), high.max(v)];
        (name.to_string(), values.fold([least, greatest], ends))
    };
    evidence.iter().flat_map(|term| indicators_of(term)).map(range).collect()
}

/// The smallest of the values that `share` of them do not exceed; NaN without values.
pub fn quantile(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(f64::total_cmp);
    let at = ((share * all.len() as f64).ceil() as usize).clamp(1, all.len().max(1));
    all.get(at - 1).copied().unwrap_or(f64::NAN)
}

/// True error in the evidence's unit.
fn size(one: &CheckedEstimate) -> f64 {
    (one.error / one.unit).max(FLOOR)
}

/// Weights of a quantile, by least squares reweighted and damped.
fn weights(estimates: &[&CheckedEstimate], evidence: &[String], quantile: f64) -> Vec<f64> {
    let rows = estimates.len();
    let value = |row: usize, column: usize| match column {
        0 => 1.0,
        k => value(estimates[row], &evidence[k - 1]).expect("the case has the evidence"),
    };
    let a = DMatrix::from_fn(rows, evidence.len() + 1, value);
    let b = DVector::from_fn(rows, |row, _| size(estimates[row]).ln());
    let mut x: DVector<f64> = DVector::zeros(evidence.len() + 1);
    for round in 0..ROUNDS {
        let rest = &b - &a * &x;
        // from the middle to the quantile
        let share = if round < ROUNDS / 4 { 0.5 } else { quantile };
        let side = |r: f64| if r > 0.0 { share } else { 1.0 - share };
        let w = rest.map(|r| if round == 0 { 1.0 } else { side(r) / r.abs().max(1e-2) });
        let scaled = DMatrix::from_fn(rows, a.ncols(), |r, c| w[r] * a[(r, c)]);
        let mut normal = a.transpose() * &scaled;
        // a breath of ridge, so that evidence that goes together does no harm
        for k in 1..normal.nrows() {
            normal[(k, k)] += 1e-3 * rows as f64;
        }
        if let Some(solved) = normal.lu().solve(&(scaled.transpose() * &b)) {
            x = if round == 0 { solved } else { 0.5 * (x + solved) };
        }
    }
    x.iter().copied().collect()
}
