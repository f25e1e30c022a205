//! Symmetric matrices over the nodes of a patch, such as the mass matrix.
//!
//! This module does not depend on materials or messages.

use std::ops::Range;

use decomp::array::map;
use wide::f64x4;

use crate::shape::{MOST_NODES, MOST_NODES_IN_PLANE, add_product, fours};
use crate::solver::particle_weights::{NARROW, ParticleWeights, lines};

/// Number of nodes of which a diagonal is zero or not together, and which are cleared together.
const BLOCK: usize = 64;

/// Greatest number of nodes whose sums are computed at a time, so that they stay in the L1 cache.
const SEGMENT: usize = 128;

/// Doubles per page of memory: addresses at this distance share a set of the L1 cache, ...
const PAGE: usize = 512;

/// ... so the entries of a node on successive diagonals are shifted by this many doubles.
const APART: usize = 24;

/// Number of entries of a block of two by two: xx, yy, xy, yx.
const BLOCK_ENTRIES: usize = 4;

/// Adds the blocks of a node and a line of `M` nodes to the node's entries xx, yy, xy and yx, each
/// `count` long, from `first` on. `terms` are the node's value, and its products with the distances
/// along x and y over I, `line` those of the other nodes.
///
/// # Panics
///
/// If `first + M` exceeds `count`.
#[inline(always)]
fn add_blocks<const M: usize>(
    row: &mut [f64],
    count: usize,
    first: usize,
    [term, x, y]: [f64; 3],
    [values, along, across]: [&[f64; M]; 3],
) {
    // one check for all four entries
    assert!(first + M <= count);
    let [term, x, y] = [term, x, y].map(f64x4::splat);
    for four in 0..const { M.div_ceil(4) } {
        let [values, along, across] = map(&[values, along, across], |line| fours(line, four));
        let both = term * values;
        let terms = [both + y * across, both + x * along, -(y * along), -(x * across)];
        for (entry, terms) in terms.into_iter().enumerate() {
            let at = entry * count + first + 4 * four;
            let terms = terms.to_array();
            for (sum, term) in row[at..at + 4.min(M - 4 * four)].iter_mut().zip(terms) {
                *sum += term;
            }
        }
    }
}

/// Symmetric matrix M_ij = sum_p m_p N_ip N_jp over the nodes of a patch, stored by diagonals: a
/// diagonal holds M_(i,i+offset) at i, for offsets to later nodes. With spin an entry is a block of
/// two by two, and the diagonals of its entries follow each other.
#[derive(Clone, Debug, Default)]
pub struct Band {
    /// The matrix stored by nodes, while particles are added; otherwise zeros.
    rows: Vec<f64>,
    /// Entries that particles have changed, for each block of nodes.
    touched: Vec<Touched>,
    /// Diagonals one after another, `stride` apart.
    diagonals: Vec<f64>,
    stride: usize,
    /// For each block of nodes, the diagonals with nonzero entries.
    filled: Vec<bool>,
    /// Distance from a node to the other node of each diagonal, in the patch's arrays.
    offsets: Vec<usize>,
    /// Number of entries per pair of nodes: 1, or 4 for blocks of two by two.
    entries: usize,
    /// Whether narrow particles contribute to each diagonal.
    near: Vec<bool>,
}

/// Entries that particles have changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
enum Touched {
    /// None.
    #[default]
    No,
    /// Diagonals of narrow particles.
    Near,
    /// All diagonals.
    All,
}

/// Number of diagonals for windows of `width` nodes along each of `dimension` directions.
const fn diagonals(width: usize, dimension: usize) -> usize {
    (lines(2 * width - 1, dimension) * (2 * width - 1)).div_ceil(2)
}

/// Copies the entries of diagonal `d` from `rows` of `count` entries; returns whether any is not
/// zero.
fn turn_one(rows: &[f64], count: usize, d: usize, diagonal: &mut [f64]) -> bool {
    let mut bits = 0;
    for (value, row) in diagonal.iter_mut().zip(rows.chunks_exact(count)) {
        *value = row[d];
        bits |= value.to_bits();
    }
    bits != 0
}

/// The same for the four diagonals from `d` on, by squares of four by four entries.
fn turn_four<const COUNT: usize>(
    rows: &[[f64; COUNT]],
    d: usize,
    diagonals: [&mut [f64]; 4],
) -> [bool; 4] {
    let (squares, rest) = rows.as_chunks::<4>();
    let mut bits = [f64x4::ZERO; 4];
    let mut columns = diagonals.map(|diagonal| diagonal.as_chunks_mut::<4>());
    for (i, square) in squares.iter().enumerate() {
        let lines = map(&[0, 1, 2, 3], |line: usize| fours_from(&square[line], d));
        let turned = f64x4::transpose(lines);
        for k in 0..4 {
            columns[k].0[i] = turned[k].to_array();
            bits[k] |= turned[k];
        }
    }
    let mut filled = bits.map(|bits| bits.to_array().iter().any(|b| b.to_bits() != 0));
    for (k, (_, last)) in columns.iter_mut().enumerate() {
        for (value, row) in last.iter_mut().zip(rest) {
            *value = row[d + k];
            filled[k] |= value.to_bits() != 0;
        }
    }
    filled
}

/// Four numbers of a row from `first` on.
#[inline(always)]
fn fours_from(row: &[f64], first: usize) -> f64x4 {
    let four: [f64; 4] = row[first..first + 4].try_into().expect("four numbers");
    f64x4::from(four)
}

impl Band {
    /// Prepares a sum over particles with `width` nodes along each of `dimension` directions, on
    /// `nodes` nodes, in arrays with lines of length `stride`.
    pub fn clear(&mut self, nodes: usize, width: usize, dimension: usize, stride: usize) {
        self.clear_entries(nodes, width, dimension, stride, 1);
    }

    /// Prepares a sum of blocks of two by two over particles with [`Band::add_spin`], with the
    /// arguments of [`Band::clear`] in a plane.
    pub fn clear_blocks(&mut self, nodes: usize, width: usize, stride: usize) {
        self.clear_entries(nodes, width, 2, stride, BLOCK_ENTRIES);
    }

    fn clear_entries(
        &mut self,
        nodes: usize,
        width: usize,
        dimension: usize,
        stride: usize,
        entries: usize,
    ) {
        let count = entries * diagonals(width, dimension);
        let across = if dimension == 1 { 1 } else { width };
        let place = |line: usize, k: usize| match line {
            0 => k,
            _ => line * stride + k + 1 - width,
        };
        let lengths = (0..across).map(|line| (line, if line == 0 { width } else { 2 * width - 1 }));
        let places = lengths.flat_map(|(line, length)| (0..length).map(move |k| (line, k)));
        let offsets = places.clone().map(|(line, k)| place(line, k));
        if self.rows.len() == nodes * count && offsets.clone().eq(self.offsets.iter().copied()) {
            // the last sum has left zeros
            return;
        }
        self.entries = entries;
        self.offsets.clear();
        self.offsets.extend(offsets);
        debug_assert_eq!(entries * self.offsets.len(), count);
        let is_near = |(line, k): (usize, usize)| match line {
            0 => k < NARROW,
            _ => line < NARROW && (k + 1).abs_diff(width) < NARROW,
        };
        self.near.clear();
        let near = places.map(is_near);
        (0..entries).for_each(|_| self.near.extend(near.clone()));
        let blocks = nodes.div_ceil(BLOCK);
        self.touched.clear();
        self.touched.resize(blocks, Touched::No);
        self.filled.clear();
        self.filled.resize(blocks * count, false);
        self.rows.clear();
        self.rows.resize(nodes * count, 0.0);
        self.stride = nodes.next_multiple_of(PAGE) + APART;
        self.diagonals.clear();
        self.diagonals.resize(self.stride * count, 0.0);
    }

    /// Entries of a diagonal for some nodes.
    #[inline(always)]
    fn diagonal(&self, d: usize, nodes: Range<usize>) -> &[f64] {
        &self.diagonals[d * self.stride + nodes.start..d * self.stride + nodes.end]
    }

    /// Notes that a particle changes entries of nodes from the first to the last of a line.
    #[inline(always)]
    fn touch(&mut self, [first, last]: [usize; 2], entries: Touched) {
        let (first, last) = (first / BLOCK, last / BLOCK);
        for block in [first, last] {
            let touched = &mut self.touched[block];
            if *touched < entries {
                *touched = entries;
            }
            if first == last {
                break;
            }
        }
    }

    /// Adds a particle of mass `mass`.
    #[inline(always)]
    pub fn add<const K: usize, const D: usize>(
        &mut self,
        weights: &ParticleWeights<'_, K, D>,
        mass: f64,
    ) {
        if weights.is_narrow() {
            self.add_part::<K, D, NARROW>(weights, mass);
        } else {
            self.add_part::<K, D, K>(weights, mass);
        }
    }

    /// Adds the products of the first `M` nodes along each direction.
    #[inline(always)]
    fn add_part<const K: usize, const D: usize, const M: usize>(
        &mut self,
        weights: &ParticleWeights<'_, K, D>,
        mass: f64,
    ) {
        let count = const { diagonals(K, D) };
        let first_nodes =
            |values: &[f64; K]| -> [f64; M] { *values.first_chunk().expect("as many nodes") };
        for line in 0..const { lines(M, D) } {
            let from = weights.first + line * weights.stride;
            self.touch([from, from + M - 1], if M < K { Touched::Near } else { Touched::All });
            // a length known at compile time avoids bounds checks
            let rows = &mut self.rows[from * count..][..const { K * diagonals(K, D) }];
            let (here, later) = weights.values[..const { lines(M, D) }][line..]
                .split_first()
                .expect("the lines from this one on");
            // zeros after the last node, so that all nodes of the line add as many terms
            let mut padded = [0.0; 2 * MOST_NODES];
            padded[..M].copy_from_slice(&here[..M]);
            for i in 0..M {
                let term = mass * here[i];
                if M == NARROW {
                    let shifted: &[f64; M] = padded[i..].first_chunk().expect("room for zeros");
                    add_product(rows, i * count, term, shifted);
                } else {
                    for k in i..M {
                        rows[i * count + k - i] += term * here[k];
                    }
                }
                for (line, values) in later.iter().enumerate() {
                    let first = i * count + K + line * (2 * K - 1) + K - 1 - i;
                    add_product(rows, first, term, &first_nodes(values));
                }
            }
        }
    }

    /// Adds a particle of mass `mass` with spin: m (N_i N_j + phi_i phi_j), a block of two by two
    /// for each pair of nodes, with the feature of a rotation phi_i = N_i (-e_y, e_x)/sqrt(I) at
    /// the distance e of node i from the particle. `first` is the distance of the first node of
    /// the window [m], `cell` the distance between nodes [m], `inverse` is 1/I [1/m2].
    #[inline(always)]
    pub fn add_spin<const K: usize, const D: usize>(
        &mut self,
        weights: &ParticleWeights<'_, K, D>,
        mass: f64,
        (first, cell): ([f64; 2], [f64; 2]),
        inverse: f64,
    ) {
        if weights.is_narrow() {
            self.add_spin_part::<K, D, NARROW>(weights, mass, (first, cell), inverse);
        } else {
            self.add_spin_part::<K, D, K>(weights, mass, (first, cell), inverse);
        }
    }

    /// Adds the blocks of the first `M` nodes along each direction.
    #[inline(always)]
    fn add_spin_part<const K: usize, const D: usize, const M: usize>(
        &mut self,
        weights: &ParticleWeights<'_, K, D>,
        mass: f64,
        (first, cell): ([f64; 2], [f64; 2]),
        inverse: f64,
    ) {
        let count = const { diagonals(K, D) };
        // values, and their products with the distances along x and y
        let mut parts = [[[0.0; M]; K]; 3];
        for line in 0..const { lines(M, D) } {
            let values: [f64; M] = *weights.values[line].first_chunk().expect("as many nodes");
            let across = first[1] + line as f64 * cell[1];
            for k in 0..M {
                parts[0][line][k] = values[k];
                parts[1][line][k] = values[k] * (first[0] + k as f64 * cell[0]);
                parts[2][line][k] = values[k] * across;
            }
        }
        let turn = mass * inverse;
        for line in 0..const { lines(M, D) } {
            let from = weights.first + line * weights.stride;
            self.touch([from, from + M - 1], if M < K { Touched::Near } else { Touched::All });
            let here = map(&[0, 1, 2], |part: usize| &parts[part][line]);
            // zeros after the last node, so that all nodes of the line add as many terms
            let mut padded = [[0.0; 2 * MOST_NODES_IN_PLANE]; 3];
            for (padded, here) in padded.iter_mut().zip(here) {
                padded[..M].copy_from_slice(here);
            }
            let rows = &mut self.rows[from * BLOCK_ENTRIES * count..]
                [..const { K * BLOCK_ENTRIES * diagonals(K, D) }];
            for i in 0..M {
                let [term, x, y] = [mass * here[0][i], turn * here[1][i], turn * here[2][i]];
                let row = &mut rows[i * BLOCK_ENTRIES * count..][..BLOCK_ENTRIES * count];
                let [a, b, c] = &padded;
                let shifted: [&[f64; M]; 3] =
                    map(&[a, b, c], |p| p[i..].first_chunk().expect("room for zeros"));
                add_blocks(row, count, 0, [term, x, y], shifted);
                let [a, b, c] = &parts;
                for later in line + 1..const { lines(M, D) } {
                    let first = K + (later - line - 1) * (2 * K - 1) + K - 1 - i;
                    let there = [&a[later], &b[later], &c[later]];
                    add_blocks(row, count, first, [term, x, y], there);
                }
            }
        }
    }

    /// Completes the matrix after all particles have been added.
    pub fn finish(&mut self) {
        // known to the compiler for windows of 4 nodes on a line, and of 3 and 4 nodes in a plane,
        // without and with spin
        const LINE: usize = diagonals(4, 1);
        const THREE: usize = diagonals(3, 2);
        const FOUR: usize = diagonals(4, 2);
        const SPIN_THREE: usize = BLOCK_ENTRIES * THREE;
        const SPIN_FOUR: usize = BLOCK_ENTRIES * FOUR;
        match self.entries * self.offsets.len() {
            LINE => self.turn::<LINE>(),
            THREE => self.turn::<THREE>(),
            FOUR => self.turn::<FOUR>(),
            SPIN_THREE => self.turn::<SPIN_THREE>(),
            SPIN_FOUR => self.turn::<SPIN_FOUR>(),
            _ => self.turn::<0>(),
        }
    }

    /// Turns the matrix stored by nodes into diagonals, of which there are `COUNT` if it is not 0.
    fn turn<const COUNT: usize>(&mut self) {
        let count = if COUNT > 0 { COUNT } else { self.entries * self.offsets.len() };
        let nodes = self.rows.len() / count;
        let blocks = self.touched.iter_mut().zip(self.filled.chunks_exact_mut(count));
        for (block, (touched, filled)) in blocks.enumerate() {
            let from = block * BLOCK;
            let to = nodes.min(from + BLOCK);
            let touched = std::mem::take(touched);
            // block by block, so that its rows are loaded once
            let rows = &mut self.rows[from * count..to * count];
            let mut first = 0;
            for diagonals in self.diagonals.chunks_mut(4 * self.stride) {
                let some = first..count.min(first + 4);
                let filled = &mut filled[some.clone()];
                let mut parts = diagonals.chunks_exact_mut(self.stride).map(|d| &mut d[from..to]);
                if touched == Touched::No
                    || (touched == Touched::Near && !self.near[some].contains(&true))
                {
                    for (part, filled) in parts.zip(filled) {
                        if std::mem::take(filled) {
                            part.fill(0.0);
                        }
                    }
                } else if COUNT > 0 && filled.len() == 4 {
                    let parts = decomp::array::from_fn(|_| parts.next().expect("four diagonals"));
                    filled.copy_from_slice(&turn_four(rows.as_chunks::<COUNT>().0, first, parts));
                } else {
                    for ((part, filled), d) in parts.zip(filled).zip(first..) {
                        *filled = turn_one(rows, count, d, part);
                    }
                }
                first += 4;
            }
            if touched != Touched::No {
                rows.fill(0.0);
            }
        }
    }

    /// Calls `act` with each other node of a line that shares particles with node `i`, and the entry
    /// of both.
    #[inline(always)]
    pub fn each_neighbour(&self, i: usize, mut act: impl FnMut(usize, f64)) {
        for (d, &o) in self.offsets.iter().enumerate().skip(1) {
            act(i + o, self.diagonals[d * self.stride + i]);
            act(i - o, self.diagonals[d * self.stride + i - o]);
        }
    }

    /// y = M x on the nodes `range`, which must be at least the width of the band away from the
    /// ends, for several vectors at a time; with blocks of two by two, x and y are the two
    /// components of vectors.
    pub fn product<const V: usize>(&self, x: [&[f64]; V], range: Range<usize>, y: [&mut [f64]; V]) {
        self.each_product(x, range, y, |product, _, _| product);
    }

    /// Distances from a node to the others with which it may have an entry, in the patch's arrays.
    pub fn distances(&self) -> impl Iterator<Item = isize> + Clone + '_ {
        let later = self.offsets.iter().skip(1).map(|&o| o as isize);
        later.clone().chain(later.map(|o| -o))
    }

    /// (M x)_i at node `i`, which must be at least the width of the band away from the ends.
    pub fn product_at(&self, x: &[f64], i: usize) -> f64 {
        let mut sum = self.diagonal(0, i..i + 1)[0] * x[i];
        for (d, &o) in self.offsets.iter().enumerate().skip(1) {
            sum += self.diagonal(d, i..i + 1)[0] * x[i + o];
            sum += self.diagonal(d, i - o..i - o + 1)[0] * x[i - o];
        }
        sum
    }

    /// y = t + x - d M x on the nodes `range` for several vectors at a time, with a diagonal matrix
    /// d: from one sum of a series to the next by Horner's rule.
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
        let count = self.offsets.len();
        let mut from = range.start;
        while from < range.end {
            let to = range.end.min(from + SEGMENT);
            let n = to - from;
            let mut sums = [[0.0; SEGMENT]; V];
            let main = self.diagonal(0, from..to);
            for v in 0..V {
                let (sums, x) = (&mut sums[v][..n], &x[v][from..to]);
                for i in 0..n {
                    sums[i] += main[i] * x[i];
                }
            }
            let mut filled = self.filled_diagonals(from..to, count);
            while let Some(first) = filled.next() {
                match filled.next() {
                    Some(second) => self.add_diagonals([first, second], x, from..to, &mut sums),
                    None => self.add_diagonals([first], x, from..to, &mut sums),
                }
            }
            for v in 0..V {
                let y = &mut y[v][from..to];
                for i in 0..n {
                    y[i] = f(sums[v][i], v, from - range.start + i);
                }
            }
            from = to;
        }
    }

    /// Diagonals other than the main one with nonzero entries of `nodes`, of entries in `count`
    /// diagonals each, and the distances to their other nodes.
    #[inline(always)]
    fn filled_diagonals(
        &self,
        nodes: Range<usize>,
        count: usize,
    ) -> impl Iterator<Item = (usize, usize)> + '_ {
        let others = self.offsets.iter().copied().enumerate().skip(1);
        others.filter(move |&(d, o)| {
            let blocks = [nodes.clone(), nodes.start - o..nodes.end - o];
            blocks.into_iter().any(|nodes| {
                let blocks = nodes.start / BLOCK..=(nodes.end - 1) / BLOCK;
                let entry = |block: usize, k: usize| block * self.entries * count + k * count + d;
                blocks.into_iter().any(|b| (0..self.entries).any(|k| self.filled[entry(b, k)]))
            })
        })
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
        let n = nodes.len();
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
        let mut from = range.start;
        while from < range.end {
            let to = range.end.min(from + SEGMENT);
            let n = to - from;
            let mut sums = [[0.0; SEGMENT]; V];
            let blocks = |d: usize, nodes: Range<usize>| -> [&[f64]; BLOCK_ENTRIES] {
                decomp::array::from_fn(|k| self.diagonal(k * count + d, nodes.clone()))
            };
            let [xx, yy, xy, yx] = blocks(0, from..to);
            for (sums, x) in sums.as_chunks_mut::<2>().0.iter_mut().zip(x.as_chunks::<2>().0) {
                let ([sum_x, sum_y], [ux, uy]) = (sums, x.map(|x| &x[from..to]));
                for i in 0..n {
                    sum_x[i] += xx[i] * ux[i] + xy[i] * uy[i];
                    sum_y[i] += yx[i] * ux[i] + yy[i] * uy[i];
                }
            }
            for (d, o) in self.filled_diagonals(from..to, count) {
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
            for v in 0..V {
                let y = &mut y[v][from..to];
                for i in 0..n {
                    y[i] = f(sums[v][i], v, from - range.start + i);
                }
            }
            from = to;
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A particle: first node, mass and values.
    type Particle<const K: usize> = (usize, f64, Vec<[f64; K]>);

    /// Adds particles to `band` and compares its products with several vectors at a time with the
    /// products of a full matrix.
    fn check_with<const K: usize, const D: usize>(
        band: &mut Band,
        extent: [usize; 2],
        particles: &[Particle<K>],
        inner: Range<usize>,
    ) {
        let nodes = extent[0] * extent[1];
        band.clear(nodes, K, D, extent[0]);
        let mut full = vec![vec![0.0; nodes]; nodes];
        for (first, mass, values) in particles {
            let beyond = |l: usize, k: usize| l >= NARROW || k >= NARROW;
            let mut places = (0..values.len()).flat_map(|l| (0..K).map(move |k| (l, k)));
            let narrow = K > NARROW && places.all(|(l, k)| !beyond(l, k) || values[l][k] == 0.0);
            let weights: ParticleWeights<'_, K, D> = ParticleWeights {
                first: *first,
                stride: extent[0],
                narrow,
                values,
                gradients: &[],
            };
            band.add(&weights, *mass);
            let place = |l: usize, k: usize| first + l * extent[0] + k;
            for (l, k) in (0..values.len()).flat_map(|l| (0..K).map(move |k| (l, k))) {
                for (m, j) in (0..values.len()).flat_map(|m| (0..K).map(move |j| (m, j))) {
                    full[place(l, k)][place(m, j)] += mass * values[l][k] * values[m][j];
                }
            }
        }
        band.finish();
        let vector = |v: usize| (0..nodes).map(|i| (i * i % (17 + v)) as f64).collect::<Vec<_>>();
        let (x, t) = ([vector(0), vector(1)], [vector(2), vector(3)]);
        let of = |i: usize, x: &[f64]| (0..nodes).map(|j| full[i][j] * x[j]).sum::<f64>();
        let is_close = |y: f64, exact: f64| (y - exact).abs() < 1e-12 * exact.abs().max(1.0);
        let mut y = vec![0.0; nodes];
        band.product([&x[0]], inner.clone(), [&mut y]);
        assert!(particles.is_empty() || inner.clone().any(|i| y[i] != 0.0));
        for i in inner.clone() {
            assert!(is_close(y[i], of(i, &x[0])), "node {i}: {} {}", y[i], of(i, &x[0]));
        }
        let (d, mut next) = (vector(4), [vec![0.0; nodes], vec![0.0; nodes]]);
        let into = next.each_mut().map(|y| &mut y[..]);
        band.next_sums(
            x.each_ref().map(|x| &x[..]),
            &d,
            t.each_ref().map(|t| &t[..]),
            inner.clone(),
            into,
        );
        for (v, i) in (0..2).flat_map(|v| inner.clone().map(move |i| (v, i))) {
            let exact = t[v][i] + (x[v][i] - d[i] * of(i, &x[v]));
            assert!(is_close(next[v][i], exact), "vector {v}, node {i}: {} {exact}", next[v][i]);
        }
    }

    fn check<const K: usize, const D: usize>(
        extent: [usize; 2],
        particles: &[Particle<K>],
        inner: Range<usize>,
    ) {
        check_with::<K, D>(&mut Band::default(), extent, particles, inner);
    }

    #[test]
    fn the_band_is_the_matrix_of_products() {
        let particles = [
            (3, 2.0, vec![[0.2, 0.5, 0.3]]),
            (4, 1.5, vec![[0.1, 0.6, 0.3]]),
            (3, 0.7, vec![[0.0, 0.4, 0.6]]),
        ];
        check::<3, 1>([12, 1], &particles, 3..9);
    }

    #[test]
    fn in_a_plane_too() {
        let lines = |a: f64| vec![[0.1, 0.2, 0.05], [a, 0.25, 0.1], [0.0, 0.07, 0.3 - a]];
        let particles = [(40, 2.0, lines(0.1)), (41, 1.5, lines(0.2)), (52, 0.7, lines(0.05))];
        check::<3, 2>([12, 9], &particles, 36..80);
    }

    #[test]
    fn with_four_nodes_a_line_too() {
        let lines = |a: f64| -> Vec<[f64; 4]> {
            (0..4).map(|l| decomp::array::from_fn(|k| a + (l * 5 + k * 3) as f64 / 40.0)).collect()
        };
        // nodes in a number that neither four nor a block divides
        let particles = [(45, 2.0, lines(0.1)), (46, 1.5, lines(0.2)), (71, 0.7, lines(0.05))];
        check::<4, 2>([13, 15], &particles, 48..140);
        let line = |a: f64| vec![[a, 0.4, 0.3, 0.3 - a]];
        check::<4, 1>([19, 1], &[(4, 2.0, line(0.1)), (6, 0.5, line(0.2))], 4..14);
    }

    /// One matrix used for several sums: a sum contains nothing of the previous one, for narrow
    /// particles, for wide particles, and without particles.
    #[test]
    fn a_matrix_holds_its_last_sum_alone() {
        const K: usize = 6;
        let extent = [40, 23];
        let values = |nodes: usize, seed: usize| -> Vec<[f64; K]> {
            let value = |l: usize, k: usize| {
                if l.max(k) < nodes { ((l * 7 + k * 5 + seed) % 11) as f64 / 40.0 } else { 0.0 }
            };
            (0..K).map(|l| decomp::array::from_fn(|k| value(l, k))).collect()
        };
        let inner = 6 * extent[0]..16 * extent[0];
        let at = |x: usize, y: usize| y * extent[0] + x;
        let narrow = |x, y| (at(x, y), 1.5, values(NARROW, x));
        let wide = |x, y| (at(x, y), 0.8, values(K, y));
        let mut band = Band::default();
        for particles in [
            vec![narrow(4, 7), narrow(5, 7), wide(20, 8), wide(7, 9)],
            vec![narrow(4, 7), narrow(21, 8), narrow(30, 10)],
            vec![wide(11, 10)],
            vec![],
            vec![narrow(30, 12)],
        ] {
            check_with::<K, 2>(&mut band, extent, &particles, inner.clone());
        }
    }
}
