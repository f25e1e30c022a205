//! Normals of the contact plane.

/// The unit normal from the first of two bodies to the second by the gradient of the share that the
/// first has of the volume filled at a node,
///
/// ```text
/// n ~ V_b g_a - V_a g_b,   V = sum V_p N,   g = sum V_p G
/// ```
///
/// with a body's filled volume V [cells] and its gradient g, which points out of the body (after
/// Lemiale, Hurmane & Nairn 2010, with the gradients of volume, as Nairn 2013 has them, that do not
/// depend on density). Where the two bodies fill space this is g_a = -g_b. Where a body only just
/// reaches the node, its own edge tells the normal, and not how unevenly a wave has
/// compressed the other one. Antisymmetric in the bodies, bit by bit.
///
/// None where the gradients tell of no direction.
pub fn volume_gradient<const D: usize>(
    volume: [f64; 2],
    [a, b]: [&[f64; D]; 2],
) -> Option<[f64; D]> {
    let square = |v: &[f64; D]| v.iter().map(|x| x * x).sum::<f64>();
    let (a, b) = (a.map(|x| volume[1] * x), b.map(|x| volume[0] * x));
    let difference = std::array::from_fn(|k| a[k] - b[k]);
    let scale = square(&a) + square(&b);
    (square(&difference) > 1e-12 * scale).then(|| unit(difference))
}

/// A corner of a particle, drawn in to [`INSET`] of its half edges, so that two bodies in contact
/// can be told apart: its place seen from the node [cells], and whether it is of the
/// second body.
pub type Point<const D: usize> = ([f64; D], bool);

/// See [`Point`].
pub const INSET: f64 = 0.9;

/// Weight of |w|^2/2 beside the points, of which each body's weigh 1.
const RIDGE: f64 = 1e-5;

/// Most of Newton's steps; a few are enough.
const STEPS: usize = 40;

/// The unit normal from the first of two bodies to the second by logistic regression (Nairn,
/// Hammerquist & Smith 2020): the line w.x + w_0 = 0 that best tells corners of the one's particles
/// from those of the other, the minimum of
///
/// ```text
/// sum_j m_j log(1 + exp(-c_j (w.x_j + w_0))) + r |w|^2/2,   c_j = -1, +1
/// ```
///
/// by Newton's method, where m_j gives both bodies the same weight, so that a sliver counts as
/// much as the block that it touches. Better than gradients where an edge is not straight over a
/// node's reach, or where few particles touch it; `cell` [m] turns lengths into cells. In one
/// direction and where it does not converge, none.
pub fn logistic_regression<const D: usize>(
    points: &[Point<D>],
    cell: &[f64; D],
) -> Option<[f64; D]> {
    let seconds = points.iter().filter(|p| p.1).count();
    if D != 2 || seconds == 0 || seconds == points.len() {
        return None;
    }
    let weights = [1.0 / (points.len() - seconds) as f64, 1.0 / seconds as f64];
    let mut w = [0.0; 3];
    // the step that has led here, and the slope along it where it began
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
        // the sum is convex: a slope that has turned and is no less steep is beyond the minimum
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

/// The line across `w` midway between the two bodies, steep enough to tell corners apart; none where
/// they overlap along it. The minimum is the same from any start, and from here it takes a third of
/// the steps.
fn between<const D: usize>(points: &[Point<D>], w: &[f64; 3]) -> Option<[f64; 3]> {
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

/// Length of w at the start [1/cell]: a third of that between two squares of half a cell.
const STEEP: f64 = 30.0;

/// Relative length of the last step.
const CONVERGED: f64 = 1e-12;

/// A point this far on its own side adds less than rounding.
const CERTAIN: f64 = 40.0;

/// The solution of three equations with a symmetric positive matrix, of which the lower half is
/// given, by Cholesky's factors.
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

/// Components smaller than this are rounding's.
const AXIS: f64 = 1e-10;

/// A vector of length 1 along `v`; along an axis if it is so to rounding.
pub(super) fn unit<const D: usize>(v: [f64; D]) -> [f64; D] {
    let length = |v: &[f64; D]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let first = length(&v);
    let v = v.map(|x| if x.abs() < AXIS * first { 0.0 } else { x });
    let length = length(&v);
    v.map(|x| x / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_normal_points_from_the_first_to_the_second() {
        assert_eq!(volume_gradient([0.5, 0.5], [&[2.0], &[-1.5]]), Some([1.0]));
        let axis = volume_gradient([0.5, 0.5], [&[0.0, -3.0], &[1e-14, 2.0]]);
        assert_eq!(axis, Some([0.0, -1.0]));
        assert_eq!(volume_gradient([0.5, 0.5], [&[0.0], &[0.0]]), None);
        let (a, b) = ([0.3, 1.7], [-0.2, -1.1]);
        let n = volume_gradient([0.4, 0.7], [&a, &b]).unwrap();
        assert_eq!(volume_gradient([0.7, 0.4], [&b, &a]).unwrap(), n.map(|x| -x));
    }

    #[test]
    fn where_a_body_only_reaches_the_node_its_edge_tells_the_normal() {
        // the other fills the node, and a wave has compressed it unevenly
        assert_eq!(volume_gradient([1e-4, 1.0], [&[1e-3], &[0.02]]), Some([1.0]));
    }

    /// Corners of squares on both sides of a line through the origin with normal `n`, shifted
    /// along it by `slide`.
    fn squares(n: [f64; 2], slide: f64) -> Vec<Point<2>> {
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
        // cells that are not square: the normal is that of the scene's space
        let points: Vec<_> = squares([0.6, 0.8], 0.0)
            .into_iter()
            .map(|(x, second)| ([x[0] / 2.0, x[1]], second))
            .collect();
        let found = logistic_regression(&points, &[2.0, 1.0]).unwrap();
        assert!((found[0] * 0.8 - found[1] * 0.6).abs() < 2e-3, "{found:?}");
        assert_eq!(logistic_regression(&points[..4], &[1.0, 1.0]), None, "one body alone");
    }
}
