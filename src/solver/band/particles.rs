//! Sums over particles: the matrix stored by nodes.

use decomp::array::map;
use wide::f64x4;

use super::{BLOCK_ENTRIES, Band, Touched, diagonals};
use crate::shape::{MOST_NODES, MOST_NODES_IN_PLANE, add_product, fours};
use crate::solver::particle_weights::{NARROW, ParticleWeights, lines};

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

impl Band {
    /// Adds a particle of mass `mass` [kg].
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
}
