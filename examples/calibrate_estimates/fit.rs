//! Fits a law by least absolute deviations of the logarithms, and the factor that makes its
//! intervals hold the truth.

use flyer_mpm::estimate::law::{LEAST, Law};
use nalgebra::{DMatrix, DVector};

use crate::estimates::Told;

/// Errors below this are rounding \[in the evidence's unit\].
const FLOOR: f64 = 1e-8;
/// Rounds of reweighting.
const ROUNDS: usize = 60;
/// Folds by which the factor is found: none of its ratios is of a case that the weights saw.
const FOLDS: usize = 10;

/// The law of this evidence, with intervals that hold `share` of the cases; none where too few
/// have it.
pub fn law(told: &[Told], evidence: &[&str], share: f64) -> Option<Law> {
    let usable: Vec<&Told> =
        told.iter().filter(|t| evidence.iter().all(|e| t.evidence.contains_key(*e))).collect();
    if usable.len() < 12 * (evidence.len() + 1) {
        return None;
    }
    let mut ratios = Vec::new();
    for fold in 0..FOLDS {
        let pick = |own: bool| -> Vec<&Told> {
            let of = usable.iter().enumerate().filter(|(k, _)| (k % FOLDS == fold) == own);
            of.map(|(_, t)| *t).collect()
        };
        let law = with_factor(weights(&pick(false), evidence), evidence, 1.0, 0);
        ratios.extend(pick(true).iter().filter_map(|t| Some(size(t) / law.size(&t.evidence)?)));
    }
    ratios.sort_by(f64::total_cmp);
    let at = (share * ratios.len() as f64).ceil() as usize;
    let factor = ratios[at.min(ratios.len() - 1)];
    Some(with_factor(weights(&usable, evidence), evidence, factor, usable.len()))
}

fn with_factor(weights: Vec<f64>, evidence: &[&str], factor: f64, cases: usize) -> Law {
    let evidence = evidence.iter().map(|e| e.to_string()).collect();
    Law { evidence, weights, factor, cases }
}

/// True error in the evidence's unit.
fn size(told: &Told) -> f64 {
    (told.error / told.unit).max(FLOOR)
}

/// Weights of least absolute deviations, by least squares reweighted.
fn weights(told: &[&Told], evidence: &[&str]) -> Vec<f64> {
    let rows = told.len();
    let value = |row: usize, column: usize| match column {
        0 => 1.0,
        k => told[row].evidence[evidence[k - 1]].max(LEAST).ln(),
    };
    let a = DMatrix::from_fn(rows, evidence.len() + 1, value);
    let b = DVector::from_fn(rows, |row, _| size(told[row]).ln());
    let mut w = DVector::from_element(rows, 1.0);
    let mut x = DVector::zeros(evidence.len() + 1);
    for _ in 0..ROUNDS {
        let scaled = DMatrix::from_fn(rows, a.ncols(), |r, c| w[r] * a[(r, c)]);
        let mut normal = a.transpose() * &scaled;
        // a breath of ridge, so that evidence that goes together does no harm
        for k in 1..normal.nrows() {
            normal[(k, k)] += 1e-3 * rows as f64;
        }
        let right = scaled.transpose() * &b;
        if let Some(solved) = normal.lu().solve(&right) {
            x = solved;
        }
        let rest = &b - &a * &x;
        w = rest.map(|r| 1.0 / r.abs().max(1e-2));
    }
    x.iter().copied().collect()
}
