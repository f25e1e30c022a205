//! Particles to grid and back: sums in canonical order, dot products in node order.
//!
//! A particle touches a window of K nodes along each of D directions, which is K^(D-1) lines of
//! K nodes that follow each other in a field.
//!
//! Knows no materials, no time stepping, no messages.

use wide::f64x4;

/// Lines of nodes in a window of `width` nodes along each of `dimension` directions.
pub const fn lines(width: usize, dimension: usize) -> usize {
    width.pow(dimension as u32 - 1)
}

/// Most nodes along one direction that a particle may touch.
pub const MOST_NODES: usize = 18;

/// Nodes along a direction from which on a window is wide: in a patch with a long particle most of
/// the others fill only as many nodes of theirs.
pub const NARROW: usize = 4;

/// The weights of one particle on its window of nodes.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a, const K: usize, const D: usize> {
    /// Its first node, in the patch's arrays.
    pub first: usize,
    /// From a line of the window to the next, in the patch's arrays.
    pub stride: usize,
    /// Whether weights beyond the first [`NARROW`] nodes along each direction are zero.
    pub narrow: bool,
    /// Values, a line after the other.
    pub values: &'a [[f64; K]],
    /// Gradients [1/m]: those along x, then those along y.
    pub gradients: &'a [[f64; K]],
}

impl<'a, const K: usize, const D: usize> Row<'a, K, D> {
    /// Lines of the window.
    pub const LINES: usize = lines(K, D);

    /// Gradients along `axis`, a line after the other.
    #[inline(always)]
    pub fn gradient(&self, axis: usize) -> &'a [[f64; K]] {
        &self.gradients[axis * Self::LINES..(axis + 1) * Self::LINES]
    }

    /// The nodes of a line of the window.
    #[inline(always)]
    pub fn line<'f>(&self, field: &'f [f64], line: usize) -> &'f [f64; K] {
        window(field, self.first + line * self.stride)
    }

    /// Whether only the first [`NARROW`] nodes of more along each direction count.
    #[inline(always)]
    pub fn is_narrow(&self) -> bool {
        K > NARROW && self.narrow
    }

    /// Lines of the window that count.
    #[inline(always)]
    fn lines(&self) -> usize {
        if self.is_narrow() { const { lines(NARROW, D) } } else { Self::LINES }
    }

    /// All `L` lines of the window in each of `N` fields, where several sums want them.
    #[inline(always)]
    pub fn windows<const L: usize, const N: usize>(
        &self,
        fields: [&[f64]; N],
    ) -> [[[f64; K]; L]; N] {
        debug_assert_eq!(L, const { lines(K, D) });
        // plain loops: closures over arrays stay calls
        let mut windows = [[[0.0; K]; L]; N];
        for (window, field) in windows.iter_mut().zip(fields) {
            for (line, nodes) in window.iter_mut().enumerate().take(self.lines()) {
                *nodes = *self.line(field, line);
            }
        }
        windows
    }

    /// Adds `term` of each line of weights to the nodes of `field`.
    #[inline(always)]
    pub fn add(&self, field: &mut [f64], weights: &[[f64; K]], term: impl Fn(f64) -> f64) {
        for line in 0..self.lines() {
            let (at, weights) = (self.first + line * self.stride, &weights[line]);
            match weights.first_chunk::<NARROW>() {
                Some(weights) if self.is_narrow() => add(field, at, weights.map(&term)),
                _ => add(field, at, weights.map(&term)),
            }
        }
    }

    /// Sum of weights times nodal values.
    #[inline(always)]
    pub fn dot(&self, weights: &[[f64; K]], field: &[f64]) -> f64 {
        self.sum(weights, |line| *self.line(field, line))
    }

    /// Sum of weights times what `of` gives for each line of nodes: over the lines for each place
    /// in them, then over the places from +0 on, so that weights of zero at the end change no bit.
    #[inline(always)]
    pub fn sum(&self, weights: &[[f64; K]], of: impl Fn(usize) -> [f64; K]) -> f64 {
        if self.is_narrow() {
            sum(&weights[..const { lines(NARROW, D) }], NARROW, of)
        } else {
            sum(&weights[..Self::LINES], K, of)
        }
    }
}

/// [`Row::sum`] over the first `nodes` places of lines.
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

/// Four places of a line from place 4 `four` on, zeros beyond its end. Compilers take sums over
/// arrays apart into single numbers.
#[inline(always)]
fn fours<const K: usize>(line: &[f64; K], four: usize) -> f64x4 {
    let at = |k: usize| if k < K { line[k] } else { 0.0 };
    f64x4::new(std::array::from_fn(|k| at(4 * four + k)))
}

/// Adds `factor` times a line of values to the numbers of `sums` from `first` on.
#[inline(always)]
pub fn add_product<const K: usize>(sums: &mut [f64], first: usize, factor: f64, values: &[f64; K]) {
    let sums: &mut [f64; K] = (&mut sums[first..first + K]).try_into().expect("K numbers");
    for four in 0..const { K.div_ceil(4) } {
        let four_sums = fours(sums, four) + f64x4::splat(factor) * fours(values, four);
        for (k, sum) in (4 * four..K).zip(four_sums.to_array()) {
            sums[k] = sum;
        }
    }
}

/// Adds `terms` to `field` from node `first` on.
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

/// The nodes of `field` from `first` on.
#[inline(always)]
pub fn window<const K: usize>(field: &[f64], first: usize) -> &[f64; K] {
    field[first..first + K].try_into().expect("a window of K nodes")
}

/// How the velocity goes back from the grid to the particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scheme {
    /// v_p' = a v_p + (1 - a) N vL + N (v' - vL): FLIP for a = 1 (Brackbill & Ruppel 1986), PIC
    /// for a = 0 (Harlow 1964).
    Blend(f64),
    /// v_p' = N v', with the affine part carried by the particle (Jiang et al. 2015).
    Affine,
    /// v_p' = N v' with v filtered by the series v = sum_(l<k) K^l vL, K = 1 - m^-1 M.
    Series {
        /// Number of terms k.
        order: u32,
        /// Whether the force goes through the series too: the full mass matrix, FMPM (Nairn &
        /// Hammerquist 2021); else XPIC (Hammerquist & Nairn 2017).
        force: bool,
    },
}

impl From<crate::scene::Transfer> for Scheme {
    fn from(transfer: crate::scene::Transfer) -> Self {
        use crate::scene::Transfer;
        match transfer {
            Transfer::Flip => Scheme::Blend(1.0),
            Transfer::Pic => Scheme::Blend(0.0),
            Transfer::FlipPic(a) => Scheme::Blend(a),
            Transfer::Apic => Scheme::Affine,
            Transfer::Xpic(order) => Scheme::Series { order, force: false },
            Transfer::Fmpm(order) => Scheme::Series { order, force: true },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers without a pattern that a sum could hide in, of either sign.
    fn line<const K: usize>(seed: usize) -> [f64; K] {
        std::array::from_fn(|k| ((seed * 31 + k * 17) % 97) as f64 / 7.0 - 6.0)
    }

    /// Sums by fours, of narrow rows too, are those of one number after the other, bit by bit.
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
        let row: Row<'_, K, D> = Row { first: 5, stride, narrow, values, gradients };
        let mut sums = [0.0; K];
        for (l, weights) in values.iter().enumerate() {
            for k in 0..K {
                sums[k] += weights[k] * field[5 + l * stride + k];
            }
        }
        let sum = sums.iter().fold(0.0, |sum, s| sum + s);
        assert_eq!(row.dot(values, &field), sum, "{K} nodes");
        let (mut fast, mut plain) = (field.clone(), field.clone());
        row.add(&mut fast, values, |n| 0.7 * n);
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
