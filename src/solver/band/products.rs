//! Products of the matrix with vectors over the nodes.

use std::ops::Range;

use decomp::array::map;

use super::{BLOCK, Band};

/// Greatest number of nodes whose sums are computed at a time, so that they stay in the L1 cache.
const SEGMENT: usize = 128;

/// y = f(sum_i, v, i) on the nodes of `range` for each vector v, some nodes at a time: `add` adds the
/// terms of its nodes to zeros; i is relative to the start of `range`.
#[inline(always)]
fn by_segments<const V: usize>(
    range: Range<usize>,
    y: [&mut [f64]; V],
    f: impl Fn(f64, usize, usize) -> f64,
    add: impl Fn(Range<usize>, &mut [[f64; SEGMENT]; V]),
) {
    let mut from = range.start;
    while from < range.end {
        let to = range.end.min(from + SEGMENT);
        let n = to - from;
        let mut sums = [[0.0; SEGMENT]; V];
        add(from..to, &mut sums);
        for v in 0..V {
            let y = &mut y[v][from..to];
            for i in 0..n {
                y[i] = f(sums[v][i], v, from - range.start + i);
            }
        }
        from = to;
    }
}

impl Band {
    /// y = M x on the nodes `range`, which must be at least the width of the band away from the
    /// ends, for several vectors at a time. M is in [kg], so that y has the unit of x times [kg].
    pub fn product<const V: usize>(&self, x: [&[f64]; V], range: Range<usize>, y: [&mut [f64]; V]) {
        self.each_product(x, range, y, |product, _, _| product);
    }

    /// y = t + a (x - d M x) on the nodes `range` for several vectors at a time, with a diagonal
    /// matrix d [1/kg] and a number a of `shares` [-] for each vector: from one sum of a series to
    /// the next by Horner's rule. t, x and y have the same unit.
    pub fn next_sums<'a, const V: usize>(
        &self,
        x: [&'a [f64]; V],
        d: &[f64],
        t: [&'a [f64]; V],
        shares: [f64; V],
        range: Range<usize>,
        y: [&mut [f64]; V],
    ) {
        let cut = |fields: [&'a [f64]; V]| map(&fields, |field| &field[range.clone()]);
        let (x_here, d, t) = (cut(x), &d[range.clone()], cut(t));
        let change = |product: f64, v: usize, i: usize| x_here[v][i] - d[i] * product;
        // mostly all shares are 1: a product less per node
        if shares == [1.0; V] {
            self.each_product(x, range, y, |product, v, i| t[v][i] + change(product, v, i));
        } else {
            self.each_product(x, range, y, |product, v, i| {
                t[v][i] + shares[v] * change(product, v, i)
            });
        }
    }

    /// y = f((M x)_i, v, i) on the nodes of `range` for each vector v; i is relative to its start.
    #[inline(always)]
    fn each_product<const V: usize>(
        &self,
        x: [&[f64]; V],
        range: Range<usize>,
        y: [&mut [f64]; V],
        f: impl Fn(f64, usize, usize) -> f64,
    ) {
        match self.count {
            3 => self.products_of::<3, V>(x, range, y, f),
            4 => self.products_of::<4, V>(x, range, y, f),
            _ => self.products_by_diagonals(x, range, y, f),
        }
    }

    /// The same sums in the same order, diagonal by diagonal, for many diagonals. Blocks of zeros
    /// on a diagonal are skipped, which does not change a bit, as sums start from +0.
    #[inline(always)]
    fn products_by_diagonals<const V: usize>(
        &self,
        x: [&[f64]; V],
        range: Range<usize>,
        y: [&mut [f64]; V],
        f: impl Fn(f64, usize, usize) -> f64,
    ) {
        by_segments(range, y, f, |nodes, sums| {
            let (from, to) = (nodes.start, nodes.end);
            let n = to - from;
            let main = self.diagonal(0, from..to);
            for v in 0..V {
                let (sums, x) = (&mut sums[v][..n], &x[v][from..to]);
                for i in 0..n {
                    sums[i] += main[i] * x[i];
                }
            }
            let mut filled = self.filled_diagonals(from..to);
            while let Some(first) = filled.next() {
                match filled.next() {
                    Some(second) => self.add_diagonals([first, second], x, from..to, sums),
                    None => self.add_diagonals([first], x, from..to, sums),
                }
            }
        });
    }

    /// Diagonals other than the main one with nonzero entries of `nodes`.
    #[inline(always)]
    fn filled_diagonals(&self, nodes: Range<usize>) -> impl Iterator<Item = usize> + '_ {
        (1..self.count).filter(move |&d| {
            self.is_filled(d, nodes.start, nodes.end)
                || self.is_filled(d, nodes.start - d, nodes.end - d)
        })
    }

    /// Whether diagonal `d` has nonzero entries in the blocks of the nodes `from` to before `to`.
    #[inline(always)]
    fn is_filled(&self, d: usize, from: usize, to: usize) -> bool {
        (from / BLOCK..=(to - 1) / BLOCK).any(|block| self.filled[block * self.count + d])
    }

    /// Adds the products of `G` diagonals and their mirror images to the sums of `nodes`, one
    /// diagonal after the other.
    #[inline(always)]
    fn add_diagonals<const G: usize, const V: usize>(
        &self,
        diagonals: [usize; G],
        x: [&[f64]; V],
        nodes: Range<usize>,
        sums: &mut [[f64; SEGMENT]; V],
    ) {
        let n = nodes.end - nodes.start;
        let before = |d: usize| nodes.start - d..nodes.end - d;
        let above = map(&diagonals, |d| self.diagonal(d, nodes.clone()));
        let below = map(&diagonals, |d| self.diagonal(d, before(d)));
        for v in 0..V {
            let x_above = map(&diagonals, |d| &x[v][nodes.start + d..nodes.end + d]);
            let x_below = map(&diagonals, |d| &x[v][before(d)]);
            let sums = &mut sums[v][..n];
            for i in 0..n {
                let mut sum = sums[i];
                for g in 0..G {
                    sum += above[g][i] * x_above[g][i];
                    sum += below[g][i] * x_below[g][i];
                }
                sums[i] = sum;
            }
        }
    }

    /// The same sums in the same order, for a few diagonals known at compile time, so that
    /// compilers vectorize them.
    #[inline(always)]
    fn products_of<const W: usize, const V: usize>(
        &self,
        x: [&[f64]; V],
        range: Range<usize>,
        y: [&mut [f64]; V],
        f: impl Fn(f64, usize, usize) -> f64,
    ) {
        let (from, to) = (range.start, range.end);
        if from >= to {
            return;
        }
        let n = to - from;
        let main = self.diagonal(0, from..to);
        let above: [&[f64]; W] = decomp::array::from_fn(|d| self.diagonal(d, from..to));
        let below: [&[f64]; W] = decomp::array::from_fn(|d| self.diagonal(d, from - d..to - d));
        for v in 0..V {
            let y = &mut y[v][from..to];
            let x_above: [&[f64]; W] = decomp::array::from_fn(|d| &x[v][from + d..to + d]);
            let x_below: [&[f64]; W] = decomp::array::from_fn(|d| &x[v][from - d..to - d]);
            for i in 0..n {
                let mut sum = main[i] * x_above[0][i];
                for d in 1..W {
                    sum += above[d][i] * x_above[d][i];
                    sum += below[d][i] * x_below[d][i];
                }
                y[i] = f(sum, v, i);
            }
        }
    }
}
