//! Transfer between particles and grid: sums over particles in canonical order, dot products in
//! node order.
//!
//! A particle has weights on a window of K nodes along each of D directions, which is K^(D-1) lines
//! of K consecutive nodes of a field.
//!
//! This module does not depend on materials, time stepping or messages.

use decomp::array::map;
use wide::f64x4;

use crate::shape::{MOST_NODES, fours};

/// Number of lines in a window of `width` nodes along each of `dimension` directions.
pub const fn lines(width: usize, dimension: usize) -> usize {
    width.pow(dimension as u32 - 1)
}

/// Narrow windows have at most this many nodes along a direction: in a patch with a long particle,
/// most other particles use only this many nodes of the wide window.
pub const NARROW: usize = 4;

/// Distances of the nodes of a window from their particle [cells].
#[derive(Clone, Copy, Debug)]
pub struct Offset<const D: usize> {
    /// Distance of the first node with a weight [cells].
    pub first: [f64; D],
    /// Number of nodes before it.
    pub skipped: [f64; D],
}

impl<const D: usize> Offset<D> {
    /// Distance of node or line `k` along a direction [cells].
    #[inline(always)]
    pub fn at(&self, axis: usize, k: usize) -> f64 {
        self.first[axis] + (k as f64 - self.skipped[axis])
    }
}

/// Distances of the nodes of a window from their particle in a plane.
#[derive(Clone, Copy, Debug, Default)]
pub struct Distances {
    /// Distance of the first node with a weight [m].
    pub first: [f64; 2],
    /// Number of nodes before it.
    pub skipped: [f64; 2],
    /// Distance between nodes [m].
    pub cell: [f64; 2],
}

impl Distances {
    /// Distance of node `k` along x [m].
    #[inline(always)]
    pub fn along(&self, k: usize) -> f64 {
        self.first[0] + (k as f64 - self.skipped[0]) * self.cell[0]
    }

    /// Distance of line `line` along y [m].
    #[inline(always)]
    pub fn across(&self, line: usize) -> f64 {
        self.first[1] + (line as f64 - self.skipped[1]) * self.cell[1]
    }

    /// Distances of the first four nodes along x [m].
    #[inline(always)]
    pub fn four_along(&self) -> f64x4 {
        let nodes = f64x4::from([0.0, 1.0, 2.0, 3.0]) - f64x4::splat(self.skipped[0]);
        f64x4::splat(self.first[0]) + nodes * f64x4::splat(self.cell[0])
    }
}

/// Weights of one particle on its window of nodes.
#[derive(Clone, Copy, Debug)]
pub struct ParticleWeights<'a, const K: usize, const D: usize> {
    /// First node of the window, as index in the patch's arrays.
    pub first: usize,
    /// Distance from a line of the window to the next, in the patch's arrays.
    pub stride: usize,
    /// Whether weights beyond the first [`NARROW`] nodes along each direction are zero.
    pub narrow: bool,
    /// Values, line by line [-].
    pub values: &'a [[f64; K]],
    /// Gradients [1/m]: those along x, then those along y.
    pub gradients: &'a [[f64; K]],
}

impl<'a, const K: usize, const D: usize> ParticleWeights<'a, K, D> {
    /// Number of lines of the window.
    pub const LINES: usize = lines(K, D);

    /// Gradients along `axis`, line by line [1/m].
    #[inline(always)]
    pub fn gradient(&self, axis: usize) -> &'a [[f64; K]] {
        &self.gradients[axis * Self::LINES..(axis + 1) * Self::LINES]
    }

    /// Nodes of a line of the window.
    #[inline(always)]
    pub fn line<'f>(&self, field: &'f [f64], line: usize) -> &'f [f64; K] {
        window(field, self.first + line * self.stride)
    }

    /// Whether the window is wider than `NARROW` nodes, but only the first [`NARROW`] along each
    /// direction have weights.
    #[inline(always)]
    pub fn is_narrow(&self) -> bool {
        K > NARROW && self.narrow
    }

    /// Number of lines of the window with weights.
    #[inline(always)]
    fn lines(&self) -> usize {
        if self.is_narrow() { const { lines(NARROW, D) } } else { Self::LINES }
    }

    /// All `L` lines of the window in each of `N` fields, if several sums use them.
    #[inline(always)]
    pub fn windows<const L: usize, const N: usize>(
        &self,
        fields: [&[f64]; N],
    ) -> [[[f64; K]; L]; N] {
        debug_assert_eq!(L, const { lines(K, D) });
        // plain loops: compilers do not inline closures over arrays
        let mut windows = [[[0.0; K]; L]; N];
        for (window, field) in windows.iter_mut().zip(fields) {
            for (line, nodes) in window.iter_mut().enumerate().take(self.lines()) {
                *nodes = *self.line(field, line);
            }
        }
        windows
    }

    /// Adds `term` of each weight to the nodes of `field`, in the unit of the field.
    #[inline(always)]
    pub fn add(&self, field: &mut [f64], weights: &[[f64; K]], term: impl Fn(f64) -> f64) {
        for line in 0..self.lines() {
            let (at, weights) = (self.first + line * self.stride, &weights[line]);
            match weights.first_chunk::<NARROW>() {
                Some(weights) if self.is_narrow() => add(field, at, map(weights, &term)),
                _ => add(field, at, map(weights, &term)),
            }
        }
    }

    /// Sum of weights times nodal values, in the product of both units.
    #[inline(always)]
    pub fn dot(&self, weights: &[[f64; K]], field: &[f64]) -> f64 {
        self.sum(weights, |line| *self.line(field, line))
    }

    /// Sum of weights times the values of `of` for each line of nodes: first over the lines at each
    /// position, then over the positions starting from +0, so that trailing zero weights do not
    /// change a bit.
    #[inline(always)]
    pub fn sum(&self, weights: &[[f64; K]], of: impl Fn(usize) -> [f64; K]) -> f64 {
        if self.is_narrow() {
            sum(&weights[..const { lines(NARROW, D) }], NARROW, of)
        } else {
            sum(&weights[..Self::LINES], K, of)
        }
    }
}

/// [`ParticleWeights::sum`] over the first `nodes` positions of the lines.
#[inline(always)]
fn sum<const K: usize>(weights: &[[f64; K]], nodes: usize, of: impl Fn(usize) -> [f64; K]) -> f64 {
    let mut sums = [f64x4::ZERO; MOST_NODES.div_ceil(4)];
    for (line, weights) in weights.iter().enumerate() {
        let values = of(line);
        for (four, sums) in sums[..nodes.div_ceil(4)].iter_mut().enumerate() {
            *sums += fours(weights, four) * fours(&values, four);
        }
    }
    let mut total = 0.0;
    for k in 0..nodes {
        total += sums[k / 4].as_array()[k % 4];
    }
    total
}

/// Adds `terms` to `field` from node `first` on.
///
/// # Panics
///
/// If `field` has fewer than `first + K` nodes.
#[inline(always)]
pub fn add<const K: usize>(field: &mut [f64], first: usize, terms: [f64; K]) {
    let window: &mut [f64; K] =
        (&mut field[first..first + K]).try_into().expect("a window of K nodes");
    for k in 0..K {
        window[k] += terms[k];
    }
}

/// `value`, or zero if it is smaller than `least`.
#[inline(always)]
pub fn cut(value: f64, least: f64) -> f64 {
    if value.abs() < least { 0.0 } else { value }
}

/// `K` nodes of `field` from `first` on.
///
/// # Panics
///
/// If `field` has fewer than `first + K` nodes.
#[inline(always)]
pub fn window<const K: usize>(field: &[f64], first: usize) -> &[f64; K] {
    field[first..first + K].try_into().expect("a window of K nodes")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::add_product;

    /// Test values of either sign without a pattern, so that no error in a sum can cancel.
    fn line<const K: usize>(seed: usize) -> [f64; K] {
        decomp::array::from_fn(|k| ((seed * 31 + k * 17) % 97) as f64 / 7.0 - 6.0)
    }

    /// Sums by fours, also of narrow particles, equal sums of one term after the other, bit by bit.
    fn check<const K: usize, const D: usize>(narrow: bool) {
        let count = lines(K, D);
        let mut weights: Vec<[f64; K]> = (0..3 * count).map(line).collect();
        if narrow {
            for (at, weights) in weights.iter_mut().enumerate() {
                let from = if at % count < lines(NARROW, D) { NARROW } else { 0 };
                weights[from..].fill(0.0);
            }
        }
        let (values, gradients) = weights.split_at(count);
        let stride = K + 3;
        let field: Vec<f64> = (0..5 + count * stride).map(|i| line::<1>(i * i)[0]).collect();
        let weights: ParticleWeights<'_, K, D> =
            ParticleWeights { first: 5, stride, narrow, values, gradients };
        let mut sums = [0.0; K];
        for (l, weights) in values.iter().enumerate() {
            for k in 0..K {
                sums[k] += weights[k] * field[5 + l * stride + k];
            }
        }
        let sum = sums.iter().fold(0.0, |sum, s| sum + s);
        assert_eq!(weights.dot(values, &field), sum, "{K} nodes");
        let (mut fast, mut plain) = (field.clone(), field.clone());
        weights.add(&mut fast, values, |n| 0.7 * n);
        for (l, weights) in values.iter().enumerate() {
            for k in 0..K {
                plain[5 + l * stride + k] += 0.7 * weights[k];
            }
        }
        assert_eq!(fast, plain, "{K} nodes");
        let (mut fast, mut plain) = (field.clone(), field.clone());
        add_product(&mut fast, 2, 1.3, &values[0]);
        for k in 0..K {
            plain[2 + k] += 1.3 * values[0][k];
        }
        assert_eq!(fast, plain, "{K} nodes");
    }

    #[test]
    fn sums_by_fours_are_those_one_by_one() {
        check::<2, 1>(false);
        check::<3, 1>(false);
        check::<4, 1>(false);
        check::<6, 1>(false);
        check::<6, 1>(true);
        check::<10, 1>(false);
        check::<10, 1>(true);
        check::<18, 1>(false);
        check::<18, 1>(true);
        check::<2, 2>(false);
        check::<3, 2>(false);
        check::<4, 2>(false);
        check::<6, 2>(false);
        check::<6, 2>(true);
        check::<10, 2>(false);
        check::<10, 2>(true);
    }
}
