//! Sums over particles: the matrix stored by nodes.

use std::ops::Range;

use decomp::array::map;
use wide::f64x4;

use super::{BLOCK_ENTRIES, Band, TOGETHER, Touched, diagonals, first_entry};
use crate::shape::{MOST_NODES, MOST_NODES_IN_PLANE, add_product, fours, vector};
use crate::solver::packed::{WindowPlace, between, packed_nodes};
use crate::solver::particle_weights::{Distances, NARROW, ParticleWeights, lines, window};
use crate::solver::shape_weights::Stencils;

/// Adds the products of node `NODE` of line `LINE` with the nodes of its line from itself on, and
/// with those of later lines, for some particles.
#[inline(always)]
fn add_node<
    const K: usize,
    const V: usize,
    const D: usize,
    const N: usize,
    const LINE: usize,
    const NODE: usize,
>(
    rows: &mut [f64],
    values: &[[f64x4; V]; N],
    terms: &[[[f64; 4]; V]; N],
) {
    let row = const { NODE * diagonals(K, D) };
    let at = |later: usize| first_entry(K, row, NODE, later);
    let mut sums = [f64x4::ZERO; V];
    for later in 0..const { V.saturating_sub(LINE) } {
        sums[later] = vector(window(rows, at(later)));
    }
    for k in 0..N {
        let (values, terms) = (&values[k], &terms[k]);
        let term = f64x4::splat(terms[LINE][NODE]);
        sums[0] += term * (values[LINE] & between(NODE, K));
        for later in 1..const { V.saturating_sub(LINE) } {
            sums[later] += term * values[LINE + later];
        }
    }
    for later in 0..const { V.saturating_sub(LINE) } {
        rows[at(later)..at(later) + 4].copy_from_slice(sums[later].as_array());
    }
}

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

    /// Notes that narrow particles change entries of a line from the node `from` on.
    #[inline(always)]
    pub(super) fn touch_group<const K: usize>(&mut self, from: usize) {
        let nodes = [from, from + const { packed_nodes(K) } - 1];
        self.touch(nodes, if K > NARROW { Touched::Near } else { Touched::All });
    }

    /// Adds the narrow particles of `group`, which have the same window in `V` vectors, with the
    /// `mass` of each.
    #[inline(always)]
    pub fn add_group<const K: usize, const V: usize, const D: usize>(
        &mut self,
        stencils: &Stencils,
        group: Range<usize>,
        mass: impl Fn(usize) -> f64,
    ) {
        let (place, mut from) = (stencils.place(group.start), group.start);
        // numbers of particles known at compile time, so that there are no loops over them
        while from < group.end {
            let count = TOGETHER.min(group.end - from);
            match count {
                1 => self.add_some::<K, V, D, 1>(stencils, place, from, &mass),
                2 => self.add_some::<K, V, D, 2>(stencils, place, from, &mass),
                3 => self.add_some::<K, V, D, 3>(stencils, place, from, &mass),
                _ => self.add_some::<K, V, D, TOGETHER>(stencils, place, from, &mass),
            }
            from += count;
        }
    }

    /// Adds `N` particles from `from` on.
    #[inline(always)]
    fn add_some<const K: usize, const V: usize, const D: usize, const N: usize>(
        &mut self,
        stencils: &Stencils,
        place: WindowPlace,
        from: usize,
        mass: &impl Fn(usize) -> f64,
    ) {
        let (mut values, mut terms) = ([[f64x4::ZERO; V]; N], [[[0.0; 4]; V]; N]);
        for k in 0..N {
            let m = f64x4::splat(mass(from + k));
            for (l, line) in stencils.packed_values::<K, V, D>(from + k).iter().enumerate() {
                values[k][l] = *line & between(0, K);
                terms[k][l] = (m * *line).to_array();
            }
        }
        self.add_terms::<K, V, D, N>(place, &values, &terms);
    }

    /// Adds the products of the lines of `values` with `terms`, the same lines times the mass.
    #[inline(always)]
    fn add_terms<const K: usize, const V: usize, const D: usize, const N: usize>(
        &mut self,
        place: WindowPlace,
        values: &[[f64x4; V]; N],
        terms: &[[[f64; 4]; V]; N],
    ) {
        // constants, so that sums stay in registers
        self.add_line::<K, V, D, N, 0>(place, values, terms);
        if const { V > 1 } {
            self.add_line::<K, V, D, N, 1>(place, values, terms);
        }
        if const { V > 2 } {
            self.add_line::<K, V, D, N, 2>(place, values, terms);
        }
        if const { V > 3 } {
            self.add_line::<K, V, D, N, 3>(place, values, terms);
        }
    }

    /// The products of line `LINE` with itself and later lines.
    #[inline(always)]
    fn add_line<
        const K: usize,
        const V: usize,
        const D: usize,
        const N: usize,
        const LINE: usize,
    >(
        &mut self,
        place: WindowPlace,
        values: &[[f64x4; V]; N],
        terms: &[[[f64; 4]; V]; N],
    ) {
        let count = const { diagonals(K, D) };
        let from = place.first + LINE * place.stride;
        self.touch_group::<K>(from);
        // a length known at compile time avoids bounds checks
        let rows = &mut self.rows[from * count..][..const { K * diagonals(K, D) }];
        add_node::<K, V, D, N, LINE, 0>(rows, values, terms);
        add_node::<K, V, D, N, LINE, 1>(rows, values, terms);
        add_node::<K, V, D, N, LINE, 2>(rows, values, terms);
        if const { K > 3 } {
            add_node::<K, V, D, N, LINE, 3>(rows, values, terms);
        }
    }

    /// Adds a particle of mass `mass` with spin: m (N_i N_j + phi_i phi_j), a block of two by two
    /// for each pair of nodes, with the feature of a rotation phi_i = N_i (-e_y, e_x)/sqrt(I) at
    /// the distance e of node i from the particle, in `place`; `inverse` is 1/I [1/m2].
    #[inline(always)]
    pub fn add_spin<const K: usize, const D: usize>(
        &mut self,
        weights: &ParticleWeights<'_, K, D>,
        mass: f64,
        place: Distances,
        inverse: f64,
    ) {
        if weights.is_narrow() {
            self.add_spin_part::<K, D, NARROW>(weights, mass, place, inverse);
        } else {
            self.add_spin_part::<K, D, K>(weights, mass, place, inverse);
        }
    }

    /// Adds the blocks of the first `M` nodes along each direction.
    #[inline(always)]
    fn add_spin_part<const K: usize, const D: usize, const M: usize>(
        &mut self,
        weights: &ParticleWeights<'_, K, D>,
        mass: f64,
        place: Distances,
        inverse: f64,
    ) {
        let count = const { diagonals(K, D) };
        // values, and their products with the distances along x and y
        let mut parts = [[[0.0; M]; K]; 3];
        for line in 0..const { lines(M, D) } {
            let values: [f64; M] = *weights.values[line].first_chunk().expect("as many nodes");
            let across = place.across(line);
            for k in 0..M {
                parts[0][line][k] = values[k];
                parts[1][line][k] = values[k] * place.along(k);
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
