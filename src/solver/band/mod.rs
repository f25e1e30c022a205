//! Symmetric matrices over the nodes of a patch, such as the mass matrix.
//!
//! This module does not depend on materials or messages.

mod particles;
mod products;
mod spinning;

use std::ops::Range;

use decomp::array::map;
use wide::f64x4;

use crate::solver::particle_weights::{Distances, NARROW, lines};

/// Number of nodes of which a diagonal is zero or not together, and which are cleared together.
const BLOCK: usize = 64;

/// Doubles per page of memory: addresses at this distance share a set of the L1 cache, ...
const PAGE: usize = 512;

/// ... so the entries of a node on successive diagonals are shifted by this many doubles.
const APART: usize = 24;

/// Greatest number of particles of a group that are added at a time.
pub const TOGETHER: usize = 4;

/// A particle with spin, see [`Band::add_spin`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Spinning {
    /// Mass [kg].
    pub mass: f64,
    /// Distances of the nodes of the window from the particle.
    pub place: Distances,
    /// 1/I [1/m2].
    pub inverse: f64,
}

/// Number of entries of a block of two by two: xx, yy, xy, yx.
const BLOCK_ENTRIES: usize = 4;

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

/// Place of the first entry that node `node` of a line and the `later`-th line from its own on add
/// to, for windows of `width` nodes; the entries of the node start at `row`. On the node's own line
/// zeros are added to entries before.
#[inline(always)]
const fn first_entry(width: usize, row: usize, node: usize, later: usize) -> usize {
    match later {
        0 => row - node,
        _ => row + width + (later - 1) * (2 * width - 1) + width - 1 - node,
    }
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
    /// Memory of the matrix per node for windows of `width` nodes along each of `dimension`
    /// directions [bytes]: it is held by nodes and by diagonals.
    pub const fn bytes_per_node(width: usize, dimension: usize) -> usize {
        2 * size_of::<f64>() * diagonals(width, dimension)
    }

    /// The same for blocks of two by two, in a plane [bytes].
    pub const fn block_bytes_per_node(width: usize) -> usize {
        BLOCK_ENTRIES * Band::bytes_per_node(width, 2)
    }

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

    /// Completes the matrix after all particles have been added.
    pub fn finish(&mut self) {
        // known to the compiler for windows of 4 nodes on a line, and of 3, 4 and 6 nodes in a plane,
        // without and with spin
        const LINE: usize = diagonals(4, 1);
        const THREE: usize = diagonals(3, 2);
        const FOUR: usize = diagonals(4, 2);
        const SIX: usize = diagonals(6, 2);
        const SPIN_THREE: usize = BLOCK_ENTRIES * THREE;
        const SPIN_FOUR: usize = BLOCK_ENTRIES * FOUR;
        const SPIN_SIX: usize = BLOCK_ENTRIES * SIX;
        match self.entries * self.offsets.len() {
            LINE => self.turn::<LINE>(),
            THREE => self.turn::<THREE>(),
            FOUR => self.turn::<FOUR>(),
            SIX => self.turn::<SIX>(),
            SPIN_THREE => self.turn::<SPIN_THREE>(),
            SPIN_FOUR => self.turn::<SPIN_FOUR>(),
            SPIN_SIX => self.turn::<SPIN_SIX>(),
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

    /// Calls `act` with each other node of a line that shares particles with node `i`, and the
    /// entry of both [kg].
    #[inline(always)]
    pub fn each_neighbour(&self, i: usize, mut act: impl FnMut(usize, f64)) {
        for (d, &o) in self.offsets.iter().enumerate().skip(1) {
            act(i + o, self.diagonals[d * self.stride + i]);
            act(i - o, self.diagonals[d * self.stride + i - o]);
        }
    }

    /// Distances from a node to the others with which it may have an entry, in the patch's arrays.
    pub fn distances(&self) -> impl Iterator<Item = isize> + Clone + '_ {
        let later = self.offsets.iter().skip(1).map(|&o| o as isize);
        later.clone().chain(later.map(|o| -o))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::particle_weights::ParticleWeights;
    use crate::solver::shape_weights::Stencils;

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

    /// Weights of five particles, four of which have one window of `K` nodes along each direction.
    fn grouped<const K: usize, const D: usize>(stride: usize) -> Stencils {
        let mut stencils = Stencils::default();
        stencils.resize::<K, D>(5, stride);
        let first = 2 + (D as u32 - 1) * 2 * stride as u32;
        stencils.first.copy_from_slice(&[first, first, first, first, first + 1]);
        stencils.narrow.fill(true);
        let number = |k: usize| ((k * k * 31 + k * 17) % 97) as f64 / 97.0;
        stencils.values.iter_mut().enumerate().for_each(|(k, v)| *v = number(k));
        stencils
    }

    #[test]
    fn groups_have_the_sums_of_single_particles() {
        fn check<const K: usize, const V: usize, const D: usize>(nodes: usize, stride: usize) {
            let (stencils, mass) = (grouped::<K, D>(stride), [2.0, 0.3, 1.1, 0.7, 1.9]);
            let [mut one, mut grouped] = [Band::default(), Band::default()];
            one.clear(nodes, K, D, stride);
            grouped.clear(nodes, K, D, stride);
            for r in 0..5 {
                one.add::<K, D>(&stencils.particle(r), mass[r]);
            }
            for group in stencils.groups::<K>(0..5) {
                grouped.add_group::<K, V, D>(&stencils, group, |r| mass[r]);
            }
            assert!(one.rows.iter().any(|m| *m > 0.5));
            assert_eq!(one.rows, grouped.rows, "{K} nodes");
            assert_eq!(one.touched, grouped.touched, "{K} nodes");
        }
        check::<3, 1, 1>(20, 20);
        check::<4, 1, 1>(20, 20);
        check::<3, 3, 2>(120, 12);
        check::<4, 4, 2>(120, 12);
        check::<6, 4, 2>(160, 12);
    }

    #[test]
    fn groups_with_spin_too() {
        fn check<const K: usize, const V: usize>() {
            let (stencils, stride) = (grouped::<K, 2>(12), 12);
            let spinning: Vec<Spinning> = (0..5)
                .map(|r| Spinning {
                    mass: 2.0 - 0.3 * r as f64,
                    place: Distances {
                        first: [-0.9 + 0.1 * r as f64, -0.7],
                        skipped: [f64::from(u8::from(r == 1)), 0.0],
                        cell: [0.5, 0.4],
                    },
                    inverse: 3.0 + r as f64,
                })
                .collect();
            let [mut one, mut grouped] = [Band::default(), Band::default()];
            one.clear_blocks(160, K, stride);
            grouped.clear_blocks(160, K, stride);
            for (r, p) in spinning.iter().enumerate() {
                one.add_spin::<K, 2>(&stencils.particle(r), p.mass, p.place, p.inverse);
            }
            for group in stencils.groups::<K>(0..5) {
                let some = &spinning[group.clone()];
                grouped.add_spinning::<K, V, 2>(&stencils, group, some);
            }
            assert!(one.rows.iter().any(|m| *m < -0.1));
            assert_eq!(one.rows, grouped.rows, "{K} nodes");
        }
        check::<3, 3>();
        check::<4, 4>();
        check::<6, 4>();
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
