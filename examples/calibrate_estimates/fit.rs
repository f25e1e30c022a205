//! Fits a law by quantile regression of the logarithms (Koenker & Bassett 1978).

use flyer_mpm::accuracy::estimate::error_model::{LEAST, Law};
use nalgebra::{DMatrix, DVector};

use crate::estimates::CheckedEstimate;

/// Errors below this are rounding \[in the evidence's unit\].
const FLOOR: f64 = 1e-8;
/// Rounds of reweighting.
const ROUNDS: usize = 200;
/// The law of this evidence, with intervals that hold `share` of the cases, times a margin;
/// none where too few have it.
pub fn law(
    estimates: &[CheckedEstimate],
    evidence: &[&str],
    share: f64,
    margin: f64,
) -> Option<Law> {
    let usable: Vec<&CheckedEstimate> =
        estimates.iter().filter(|t| evidence.iter().all(|e| t.evidence.contains_key(*e))).collect();
    if usable.len() < 12 * (evidence.len() + 1) {
        return None;
    }
    Some(with_factor(weights(&usable, evidence, share), evidence, margin, usable.len()))
}

fn with_factor(weights: Vec<f64>, evidence: &[&str], factor: f64, cases: usize) -> Law {
    let evidence = evidence.iter().map(|e| e.to_string()).collect();
    Law { evidence, weights, factor, cases }
}

/// True error in the evidence's unit.
fn size(one: &CheckedEstimate) -> f64 {
    (one.error / one.unit).max(FLOOR)
}

/// Weights of the quantile `share`, by least squares reweighted and damped.
fn weights(estimates: &[&CheckedEstimate], evidence: &[&str], share: f64) -> Vec<f64> {
    let rows = estimates.len();
    let value = |row: usize, column: usize| match column {
        0 => 1.0,
        k => estimates[row].evidence[evidence[k - 1]].max(LEAST).ln(),
    };
    let a = DMatrix::from_fn(rows, evidence.len() + 1, value);
    let b = DVector::from_fn(rows, |row, _| size(estimates[row]).ln());
    let mut x: DVector<f64> = DVector::zeros(evidence.len() + 1);
    for round in 0..ROUNDS {
        let rest = &b - &a * &x;
        // from the middle to the quantile
        let share = if round < ROUNDS / 4 { 0.5 } else { share };
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
