//! Products of the matrix with vectors over the nodes.

use std::ops::Range;

use decomp::array::map;

use super::{BLOCK, BLOCK_ENTRIES, Band};

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
    /// ends, for several vectors at a time; with blocks of two by two, x and y are the two
    /// components of vectors. M is in [kg], so that y has the unit of x times [kg].
    pub fn product<const V: usize>(&self, x: [&[f64]; V], range: Range<usize>, y: [&mut [f64]; V]) {
        self.each_product(x, range, y, |product, _, _| product);
    }

    /// (M x)_i at node `i`, which must be at least the width of the band away from the ends, in the
    /// unit of x times [kg].
    pub fn product_at(&self, x: &[f64], i: usize) -> f64 {
        let mut sum = self.diagonal(0, i..i + 1)[0] * x[i];
        for (d, &o) in self.offsets.iter().enumerate().skip(1) {
            sum += self.diagonal(d, i..i + 1)[0] * x[i + o];
            sum += self.diagonal(d, i - o..i - o + 1)[0] * x[i - o];
        }
        sum
    }

    /// y = t + x - d M x on the nodes `range` for several vectors at a time, with a diagonal matrix
    /// d [1/kg]: from one sum of a series to the next by Horner's rule. t, x and y have the same
    /// unit.
    pub fn next_sums<'a, const V: usize>(
        &self,
        x: [&'a [f64]; V],
        d: &[f64],
        t: [&'a [f64]; V],
        range: Range<usize>,
        y: [&mut [f64]; V],
    ) {
        let cut = |fields: [&'a [f64]; V]| map(&fields, |field| &field[range.clone()]);
        let (x_here, d, t) = (cut(x), &d[range.clone()], cut(t));
        self.each_product(x, range, y, |product, v, i| t[v][i] + (x_here[v][i] - d[i] * product));
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
        if self.entries == BLOCK_ENTRIES {
            return self.products_of_blocks(x, range, y, f);
        }
        match self.offsets.len() {
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

    /// Diagonals other than the main one with nonzero entries of `nodes`, and the distances to their
    /// other nodes.
    #[inline(always)]
    fn filled_diagonals(&self, nodes: Range<usize>) -> impl Iterator<Item = (usize, usize)> + '_ {
        let others = self.offsets.iter().copied().enumerate().skip(1);
        others.filter(move |&(d, o)| {
            self.is_filled(d, nodes.start, nodes.end)
                || self.is_filled(d, nodes.start - o, nodes.end - o)
        })
    }

    /// Whether diagonal `d` has nonzero entries in the blocks of the nodes `from` to before `to`.
    #[inline(always)]
    fn is_filled(&self, d: usize, from: usize, to: usize) -> bool {
        let count = self.offsets.len();
        let each = self.entries * count;
        for block in from / BLOCK..=(to - 1) / BLOCK {
            let filled = &self.filled[block * each..(block + 1) * each];
            for k in 0..self.entries {
                if filled[k * count + d] {
                    return true;
                }
            }
        }
        false
    }

    /// Adds the products of `G` diagonals and their mirror images, with the distances to their other
    /// nodes, to the sums of `nodes`, one diagonal after the other.
    #[inline(always)]
    fn add_diagonals<const G: usize, const V: usize>(
        &self,
        diagonals: [(usize, usize); G],
        x: [&[f64]; V],
        nodes: Range<usize>,
        sums: &mut [[f64; SEGMENT]; V],
    ) {
        let n = nodes.end - nodes.start;
        let before = |o: usize| nodes.start - o..nodes.end - o;
        let above = map(&diagonals, |(d, _)| self.diagonal(d, nodes.clone()));
        let below = map(&diagonals, |(d, o)| self.diagonal(d, before(o)));
        for v in 0..V {
            let x_above = map(&diagonals, |(_, o)| &x[v][nodes.start + o..nodes.end + o]);
            let x_below = map(&diagonals, |(_, o)| &x[v][before(o)]);
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

    /// The sums of blocks of two by two for vectors in a plane, each two consecutive fields, diagonal
    /// by diagonal.
    #[inline(always)]
    fn products_of_blocks<const V: usize>(
        &self,
        x: [&[f64]; V],
        range: Range<usize>,
        y: [&mut [f64]; V],
        f: impl Fn(f64, usize, usize) -> f64,
    ) {
        let count = self.offsets.len();
        let blocks = |d: usize, nodes: Range<usize>| -> [&[f64]; BLOCK_ENTRIES] {
            decomp::array::from_fn(|k| self.diagonal(k * count + d, nodes.clone()))
        };
        by_segments(range, y, f, |nodes, sums| {
            let (from, to, n) = (nodes.start, nodes.end, nodes.end - nodes.start);
            let [xx, yy, xy, yx] = blocks(0, from..to);
            for (sums, x) in sums.as_chunks_mut::<2>().0.iter_mut().zip(x.as_chunks::<2>().0) {
                let ([sum_x, sum_y], [ux, uy]) = (sums, x.map(|x| &x[from..to]));
                for i in 0..n {
                    sum_x[i] += xx[i] * ux[i] + xy[i] * uy[i];
                    sum_y[i] += yx[i] * ux[i] + yy[i] * uy[i];
                }
            }
            for (d, o) in self.filled_diagonals(from..to) {
                let (above, below) = (blocks(d, from..to), blocks(d, from - o..to - o));
                for (sums, x) in sums.as_chunks_mut::<2>().0.iter_mut().zip(x.as_chunks::<2>().0) {
                    let [sum_x, sum_y] = sums;
                    let [ux, uy] = x.map(|x| &x[from + o..to + o]);
                    let [wx, wy] = x.map(|x| &x[from - o..to - o]);
                    let ([xx, yy, xy, yx], [zxx, zyy, zxy, zyx]) = (above, below);
                    for i in 0..n {
                        sum_x[i] += xx[i] * ux[i] + xy[i] * uy[i];
                        sum_y[i] += yx[i] * ux[i] + yy[i] * uy[i];
                        // transposed blocks below the diagonal
                        sum_x[i] += zxx[i] * wx[i] + zyx[i] * wy[i];
                        sum_y[i] += zxy[i] * wx[i] + zyy[i] * wy[i];
                    }
                }
            }
        });
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
