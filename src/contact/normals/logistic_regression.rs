//! Normals by logistic regression on particle corners (Nairn, Hammerquist & Smith 2020).

use super::body_pair::{BodyPair, BoundaryPoint, ContactPlanes, unit};

pub(super) const PLANE_ONLY: bool = true;

pub(super) const USES_FACES: bool = false;

/// Fraction of the half edges at which corners are taken, so that two bodies in contact can be
/// separated.
const INSET: f64 = 0.9;

pub(super) fn planes<const D: usize>(
    pair: &BodyPair<'_, D>,
    corners: &mut Vec<BoundaryPoint<D>>,
) -> ContactPlanes<D> {
    corners.clear();
    for (particles, second) in pair.particles.into_iter().zip([false, true]) {
        for particle in particles {
            let [first, other] = &particle.half_edges;
            for (s, t) in [(-INSET, -INSET), (INSET, -INSET), (-INSET, INSET), (INSET, INSET)] {
                let corner = |a: usize| particle.place[a] + s * first[a] + t * other[a];
                corners.push((std::array::from_fn(|a| corner(a) / pair.cell[a]), second));
            }
        }
    }
    let normal = logistic_regression(corners, pair.cell);
    normal.and_then(|normal| pair.plane(normal)).into_iter().collect()
}

/// Weight of |w|^2/2 (ridge term), relative to a total weight of 1 for the points of each body.
const RIDGE: f64 = 1e-5;

/// Maximum number of Newton steps; a few are enough.
const STEPS: usize = 40;

/// Unit normal from the first of two bodies to the second by logistic regression (Nairn,
/// Hammerquist & Smith 2020): the line w.x + w_0 = 0 that best separates the particle corners of
/// the two bodies. Newton's method finds the minimum of
///
/// ```text
/// sum_j m_j log(1 + exp(-c_j (w.x_j + w_0))) + r |w|^2/2,   c_j = -1, +1
/// ```
///
/// The weights m_j have the same sum for both bodies, so that a sliver counts as much as the block
/// that it touches. More accurate than gradients if an edge is curved within the support of a node,
/// or if few particles touch it. `cell` [m] converts lengths to cells. `None` in one dimension and
/// if no plane is found.
fn logistic_regression<const D: usize>(
    points: &[BoundaryPoint<D>],
    cell: &[f64; D],
) -> Option<[f64; D]> {
    let seconds = points.iter().filter(|p| p.1).count();
    if D != 2 || seconds == 0 || seconds == points.len() {
        return None;
    }
    let weights = [1.0 / (points.len() - seconds) as f64, 1.0 / seconds as f64];
    let mut w = [0.0; 3];
    // the previous step, and the directional derivative along it at its start
    let mut last = ([0.0; 3], 0.0);
    for k in 0..STEPS {
        let (mut slope, mut hessian) = ([RIDGE * w[0], RIDGE * w[1], 0.0], [[0.0; 3]; 3]);
        (hessian[0][0], hessian[1][1]) = (RIDGE, RIDGE);
        for (x, second) in points {
            let x = [x[0], x[D - 1], 1.0];
            let sign = if *second { 1.0 } else { -1.0 };
            let margin = sign * (w[0] * x[0] + w[1] * x[1] + w[2]);
            if margin > CERTAIN {
                continue;
            }
            let miss = 1.0 / (1.0 + margin.exp());
            let weight = weights[usize::from(*second)] * miss;
            for i in 0..3 {
                slope[i] -= weight * sign * x[i];
                for k in 0..=i {
                    hessian[i][k] += weight * (1.0 - miss) * x[i] * x[k];
                }
            }
        }
        // the sum is convex: a derivative that has changed sign and is no less steep lies beyond
        // the minimum
        let along = |step: &[f64; 3]| (0..3).map(|i| slope[i] * step[i]).sum::<f64>();
        if along(&last.0) < -last.1 {
            last = (last.0.map(|s| 0.5 * s), 0.5 * last.1);
            (0..3).for_each(|i| w[i] += last.0[i]);
            continue;
        }
        let step = solve(hessian, slope)?;
        last = (step, along(&step));
        (0..3).for_each(|i| w[i] -= step[i]);
        if k == 0
            && let Some(start) = between(points, &w)
        {
            (w, last) = (start, ([0.0; 3], 0.0));
            continue;
        }
        let length = |v: &[f64; 3]| v.iter().fold(0.0f64, |l, x| l.max(x.abs()));
        if length(&step) < CONVERGED * length(&w).max(1.0) {
            break;
        }
    }
    let normal = std::array::from_fn(|a| w[a] / cell[a]);
    let whole = w.iter().all(|w| w.is_finite()) && (w[0] != 0.0 || w[1] != 0.0);
    whole.then(|| unit(normal))
}

/// The line with the normal `w` midway between the two bodies, steep enough to separate their
/// corners; `None` if they overlap along `w`. The minimum is the same from any start, but from here
/// the iteration needs a third of the steps.
fn between<const D: usize>(points: &[BoundaryPoint<D>], w: &[f64; 3]) -> Option<[f64; 3]> {
    let scale = STEEP / (w[0] * w[0] + w[1] * w[1]).sqrt();
    let (mut first, mut second) = (f64::NEG_INFINITY, f64::INFINITY);
    for (x, of_second) in points {
        let along = scale * (w[0] * x[0] + w[1] * x[D - 1]);
        if *of_second {
            second = second.min(along);
        } else {
            first = first.max(along);
        }
    }
    (first < second).then(|| [scale * w[0], scale * w[1], -0.5 * (first + second)])
}

/// Initial length of w [1/cell]: a third of the length for two squares of half a cell.
const STEEP: f64 = 30.0;

/// Relative length of the last step.
const CONVERGED: f64 = 1e-12;

/// A point this far on its own side contributes less than rounding.
const CERTAIN: f64 = 40.0;

/// Solution of three equations with a symmetric positive definite matrix, given by its lower half,
/// by Cholesky factorisation.
fn solve(mut a: [[f64; 3]; 3], mut b: [f64; 3]) -> Option<[f64; 3]> {
    for i in 0..3 {
        for k in 0..=i {
            let sum = (0..k).fold(a[i][k], |sum, j| sum - a[i][j] * a[k][j]);
            if i > k {
                a[i][k] = sum / a[k][k];
            } else if sum > 0.0 {
                a[i][i] = sum.sqrt();
            } else {
                return None;
            }
        }
        b[i] = (0..i).fold(b[i], |sum, j| sum - a[i][j] * b[j]) / a[i][i];
    }
    for i in (0..3).rev() {
        b[i] = (i + 1..3).fold(b[i], |sum, j| sum - a[j][i] * b[j]) / a[i][i];
    }
    Some(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Corners of squares on both sides of a line through the origin with normal `n`, shifted
    /// along it by `slide`.
    fn squares(n: [f64; 2], slide: f64) -> Vec<BoundaryPoint<2>> {
        let mut points = Vec::new();
        for (i, k) in (-4..4).flat_map(|i| (-3..3).map(move |k| (i, k))) {
            let along = 0.5 * f64::from(i) + if k < 0 { 0.0 } else { slide };
            let across = 0.5 * f64::from(k);
            for (s, t) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
                let (s, t) = (along + 0.25 * INSET * s, across + 0.25 * (1.0 + INSET * t));
                points.push(([t * n[0] - s * n[1], t * n[1] + s * n[0]], k >= 0));
            }
        }
        points
    }

    #[test]
    fn regression_finds_the_line_between() {
        for angle in [0.0f64, 0.3, 1.2, 2.5, 4.0] {
            let n = [angle.cos(), angle.sin()];
            for slide in [0.0, 0.17, -0.4] {
                let points = squares(n, slide);
                let found = logistic_regression(&points, &[1.0, 1.0]).unwrap();
                let turned = (found[0] * n[1] - found[1] * n[0]).abs();
                assert!(turned < 2e-3 && found[0] * n[0] + found[1] * n[1] > 0.9, "{turned}");
                let other: Vec<_> = points.iter().map(|(x, second)| (*x, !second)).collect();
                let back = logistic_regression(&other, &[1.0, 1.0]).unwrap();
                assert!((0..2).all(|a| (back[a] + found[a]).abs() < 1e-12), "antisymmetric");
            }
        }
        // cells that are not square: the normal must be that in physical space
        let points: Vec<_> = squares([0.6, 0.8], 0.0)
            .into_iter()
            .map(|(x, second)| ([x[0] / 2.0, x[1]], second))
            .collect();
        let found = logistic_regression(&points, &[2.0, 1.0]).unwrap();
        assert!((found[0] * 0.8 - found[1] * 0.6).abs() < 2e-3, "{found:?}");
        assert_eq!(logistic_regression(&points[..4], &[1.0, 1.0]), None, "one body alone");
    }
}
