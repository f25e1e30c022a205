//! Least squares with relative weights and non-negative coefficients.

use nalgebra::{DMatrix, DVector};

/// Singular values below this fraction of the largest count as zero. Features that the samples
/// cannot distinguish then share their cost, with the same prediction.
const SINGULAR: f64 = 1e-6;

/// Result of a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit<const N: usize> {
    /// Coefficients, not negative, in the unit of [`Sample::value`] per count.
    pub coefficients: [f64; N],
    /// Root mean square of the relative residuals \[-\].
    pub rms: f64,
    /// Largest relative residual \[-\].
    pub largest: f64,
}

/// Counts and measured value of one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<const N: usize> {
    /// Counts, one per coefficient \[-\].
    pub features: [f64; N],
    /// Measured value, in any unit; times are in \[s\].
    pub value: f64,
    /// Scale of the residual in the unit of `value`: the value itself, or a total of which it is a
    /// part.
    pub whole: f64,
}

/// The coefficients c >= 0 with the smallest sum of ((features.c - value) / whole)^2. A negative
/// coefficient is set to zero and the others are fitted again. Samples with `whole` not above zero
/// are omitted.
pub fn fit<const N: usize>(samples: &[Sample<N>]) -> Fit<N> {
    let used: Vec<&Sample<N>> = samples.iter().filter(|s| s.whole > 0.0).collect();
    // a feature that is always zero gets no coefficient
    let mut kept: Vec<usize> =
        (0..N).filter(|&k| used.iter().any(|s| s.features[k] != 0.0)).collect();
    let mut coefficients = [0.0; N];
    while !kept.is_empty() && !used.is_empty() {
        let found = solve(&used, &kept);
        let worst = (0..kept.len()).min_by(|&a, &b| found[a].total_cmp(&found[b]));
        match worst {
            Some(k) if found[k] < 0.0 => {
                kept.remove(k);
            }
            _ => {
                kept.iter().zip(&found).for_each(|(&k, &c)| coefficients[k] = c);
                break;
            }
        }
    }
    let residual = |s: &&Sample<N>| ((dot(&s.features, &coefficients) - s.value) / s.whole).abs();
    let residuals = || used.iter().map(residual);
    let square: f64 = residuals().map(|r| r * r).sum();
    Fit {
        coefficients,
        rms: (square / used.len().max(1) as f64).sqrt(),
        largest: residuals().fold(0.0, f64::max),
    }
}

/// Scalar product.
pub fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Coefficients of the columns `kept`, of any sign.
fn solve<const N: usize>(samples: &[&Sample<N>], kept: &[usize]) -> Vec<f64> {
    let entry = |i: usize, k: usize| samples[i].features[kept[k]] / samples[i].whole;
    let mut matrix = DMatrix::from_fn(samples.len(), kept.len(), entry);
    // normalize the columns, so that the cut of singular values is meaningful
    let lengths: Vec<f64> =
        (0..kept.len()).map(|k| matrix.column(k).norm().max(f64::MIN_POSITIVE)).collect();
    for (mut column, length) in matrix.column_iter_mut().zip(&lengths) {
        column /= *length;
    }
    let svd = matrix.svd(true, true);
    let cut = SINGULAR * svd.singular_values.max();
    let values = DVector::from_fn(samples.len(), |i, _| samples[i].value / samples[i].whole);
    let found = svd.solve(&values, cut).expect("both sides of the decomposition were asked for");
    found.iter().zip(&lengths).map(|(c, length)| c / length).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample<const N: usize>(features: [f64; N], value: f64) -> Sample<N> {
        Sample { features, value, whole: value }
    }

    fn samples(c: [f64; 3], noise: f64) -> Vec<Sample<3>> {
        (0..40)
            .map(|k| {
                let (rows, patches) = (10f64.powf(1.0 + 0.1 * f64::from(k)), f64::from(k % 7 + 1));
                let features = [rows, patches, 1.0];
                let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
                sample(features, dot(&features, &c) * (1.0 + sign * noise))
            })
            .collect()
    }

    #[test]
    fn known_coefficients_are_found() {
        let known = [5e-8, 2e-6, 1e-5];
        let fit = fit(&samples(known, 0.0));
        for (found, known) in fit.coefficients.iter().zip(known) {
            assert!((found / known - 1.0).abs() < 1e-6, "{found} {known}");
        }
        assert!(fit.largest < 1e-9);
    }

    #[test]
    fn noise_stays_as_large_as_it_is() {
        let fit = fit(&samples([5e-8, 2e-6, 1e-5], 0.05));
        assert!((fit.coefficients[0] / 5e-8 - 1.0).abs() < 0.05);
        assert!(fit.rms > 0.02 && fit.largest < 0.1, "{fit:?}");
    }

    #[test]
    fn none_is_negative() {
        let fit = fit(&samples([5e-8, -1e-8, 1e-5], 0.0));
        assert_eq!(fit.coefficients[1], 0.0);
        assert!(fit.coefficients[0] > 0.0 && fit.coefficients[2] > 0.0);
    }

    #[test]
    fn what_cannot_be_distinguished_still_predicts() {
        let twice = |k| sample([f64::from(k), 2.0 * f64::from(k)], 3.0 * f64::from(k));
        let samples: Vec<Sample<2>> = (1..9).map(twice).collect();
        assert!((dot(&[10.0, 20.0], &fit(&samples).coefficients) - 30.0).abs() < 1e-9);
    }
}
