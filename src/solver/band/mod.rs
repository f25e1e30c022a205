//! Symmetric matrices over the nodes of a line, such as the mass matrix.
//!
//! This module does not depend on materials or messages.

mod products;

use std::ops::Range;

use decomp::array::{from_fn, map};
use wide::f64x4;

use crate::shape::add_product;
use crate::solver::particle_weights::{NARROW, ParticleWeights};

/// Number of nodes of which a diagonal is zero or not together, and which are cleared together.
const BLOCK: usize = 64;

/// Doubles per page of memory: addresses at this distance share a set of the L1 cache, ...
const PAGE: usize = 512;

/// ... so the entries of a node on successive diagonals are shifted by this many doubles.
const APART: usize = 24;

/// Symmetric matrix M_ij = sum_p w_p N_ip N_jp over the nodes of a line, stored by diagonals:
/// diagonal d holds M_(i,i+d) at i.
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
    /// Number of diagonals.
    count: usize,
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
    /// Memory of the matrix per node for windows of `width` nodes [bytes]: it is held by nodes and by
    /// diagonals.
    pub const fn bytes_per_node(width: usize) -> usize {
        2 * size_of::<f64>() * width
    }

    /// Prepares a sum over particles with `width` nodes, on `nodes` nodes.
    pub fn clear(&mut self, nodes: usize, width: usize) {
        if self.rows.len() == nodes * width && self.count == width {
            // the last sum has left zeros
            return;
        }
        self.count = width;
        let blocks = nodes.div_ceil(BLOCK);
        self.touched.clear();
        self.touched.resize(blocks, Touched::No);
        self.filled.clear();
        self.filled.resize(blocks * width, false);
        self.rows.clear();
        self.rows.resize(nodes * width, 0.0);
        self.stride = nodes.next_multiple_of(PAGE) + APART;
        self.diagonals.clear();
        self.diagonals.resize(self.stride * width, 0.0);
    }

    /// Adds a particle of weight `w`, such as its mass [kg].
    #[inline(always)]
    pub fn add<const K: usize, const D: usize>(
        &mut self,
        weights: &ParticleWeights<'_, K, D>,
        w: f64,
    ) {
        if weights.is_narrow() {
            self.add_part::<K, D, NARROW>(weights, w);
        } else {
            self.add_part::<K, D, K>(weights, w);
        }
    }

    /// Adds the products of the first `M` nodes.
    #[inline(always)]
    fn add_part<const K: usize, const D: usize, const M: usize>(
        &mut self,
        weights: &ParticleWeights<'_, K, D>,
        w: f64,
    ) {
        let (from, values) = (weights.first, &weights.values[0]);
        self.touch([from, from + M - 1], if M < K { Touched::Near } else { Touched::All });
        // a length known at compile time avoids bounds checks
        let rows = &mut self.rows[from * K..][..const { K * K }];
        for i in 0..M {
            let term = w * values[i];
            if M == NARROW {
                // zeros after the last node, so that all nodes add as many terms
                let shifted: [f64; M] = from_fn(|k| if i + k < M { values[i + k] } else { 0.0 });
                add_product(rows, i * K, term, &shifted);
            } else {
                for k in i..M {
                    rows[i * K + k - i] += term * values[k];
                }
            }
        }
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

    /// Completes the matrix after all particles have been added.
    pub fn finish(&mut self) {
        match self.count {
            // known to the compiler for the windows of splines
            4 => self.turn::<4>(),
            _ => self.turn::<0>(),
        }
    }

    /// Turns the matrix stored by nodes into diagonals, of which there are `COUNT` if it is not 0.
    fn turn<const COUNT: usize>(&mut self) {
        let count = if COUNT > 0 { COUNT } else { self.count };
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
                let filled = &mut filled[first..count.min(first + 4)];
                let mut parts = diagonals.chunks_exact_mut(self.stride).map(|d| &mut d[from..to]);
                if touched == Touched::No || (touched == Touched::Near && first >= NARROW) {
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

    /// Calls `act` with each other node that shares particles with node `i`, and the entry of both
    /// [kg].
    #[inline(always)]
    pub fn each_neighbour(&self, i: usize, mut act: impl FnMut(usize, f64)) {
        let mut both = |d: usize| {
            let diagonal = &self.diagonals[d * self.stride..];
            act(i + d, diagonal[i]);
            act(i - d, diagonal[i - d]);
        };
        match self.count {
            // known to the compiler for the windows of splines
            4 => [1, 2, 3].into_iter().for_each(both),
            count => (1..count).for_each(&mut both),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A particle: first node, mass and values.
    type Particle<const K: usize> = (usize, f64, [f64; K]);

    /// Adds particles to `band` and compares its products with several vectors at a time with the
    /// products of a full matrix.
    fn check_with<const K: usize>(
        band: &mut Band,
        nodes: usize,
        particles: &[Particle<K>],
        inner: Range<usize>,
    ) {
        band.clear(nodes, K);
        let mut full = vec![vec![0.0; nodes]; nodes];
        for (first, mass, values) in particles {
            let narrow = K > NARROW && values[NARROW.min(K)..].iter().all(|n| *n == 0.0);
            let weights: ParticleWeights<'_, K, 1> = ParticleWeights {
                first: *first,
                stride: nodes,
                narrow,
                values: std::slice::from_ref(values),
                gradients: &[],
            };
            band.add(&weights, *mass);
            for (k, j) in (0..K).flat_map(|k| (0..K).map(move |j| (k, j))) {
                full[first + k][first + j] += mass * values[k] * values[j];
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
        let [x_fields, t_fields] = [&x, &t].map(|all| all.each_ref().map(|x| &x[..]));
        for shares in [[1.0; 2], [1.0, 0.75]] {
            let into = next.each_mut().map(|y| &mut y[..]);
            band.next_sums(x_fields, &d, t_fields, shares, inner.clone(), into);
            for (v, i) in (0..2).flat_map(|v| inner.clone().map(move |i| (v, i))) {
                let exact = t[v][i] + shares[v] * (x[v][i] - d[i] * of(i, &x[v]));
                assert!(is_close(next[v][i], exact), "{v}, node {i}: {} {exact}", next[v][i]);
            }
        }
    }

    #[test]
    fn the_band_is_the_matrix_of_products() {
        let three =
            [(3, 2.0, [0.2, 0.5, 0.3]), (4, 1.5, [0.1, 0.6, 0.3]), (3, 0.7, [0.0, 0.4, 0.6])];
        check_with(&mut Band::default(), 12, &three, 3..9);
        // nodes in a number that neither four nor a block divides
        let line = |a: f64| [a, 0.4, 0.3, 0.3 - a];
        check_with(&mut Band::default(), 71, &[(4, 2.0, line(0.1)), (6, 0.5, line(0.2))], 4..66);
    }

    /// One matrix used for several sums: a sum contains nothing of the previous one, for narrow
    /// particles, for wide particles, and without particles.
    #[test]
    fn a_matrix_holds_its_last_sum_alone() {
        const K: usize = 6;
        let values = |nodes: usize, seed: usize| -> [f64; K] {
            decomp::array::from_fn(|k| {
                if k < nodes { ((k * 5 + seed) % 11) as f64 / 40.0 } else { 0.0 }
            })
        };
        let narrow = |x: usize| (x, 1.5, values(NARROW, x));
        let wide = |x: usize| (x, 0.8, values(K, x));
        let mut band = Band::default();
        for particles in [
            vec![narrow(8), narrow(9), wide(200), wide(70)],
            vec![narrow(8), narrow(210), narrow(130)],
            vec![wide(110)],
            vec![],
            vec![narrow(130)],
        ] {
            check_with::<K>(&mut band, 300, &particles, 6..290);
        }
    }
}
