//! Matrix-free products with symmetric matrices over the nodes of a plane,
//! M_ij = sum_p w_p (N_i N_j + phi_i phi_j), where phi_i = N_i (-e_y, e_x)/sqrt(I) belongs to the
//! [`spin`](super::spin) of a particle, for matrices with spin.
//!
//! M is never assembled: each particle adds w (N.x) N and w (phi.x) phi to a product, with the
//! weights that the patch holds anyway. An assembled matrix would have 49 entries per node for
//! windows of four nodes along each direction, and four times as many with spin. Its assembly would
//! take more operations, and more memory.
//!
//! This module does not depend on materials, time stepping or messages.

use std::ops::Range;

use decomp::array::{from_fn, map};
use wide::f64x4;

use crate::shape::{vector, with_width};
use crate::solver::packed::{add_to, dot, totals, with_packed};
use crate::solver::particle_weights::{Distances, ParticleWeights, add, lines};
use crate::solver::shape_weights::{GROUP_SIZE, Stencils};

/// Moment of inertia of a particle with spin, and distances of its nodes.
#[derive(Clone, Copy, Debug, Default)]
pub struct ParticleSpin {
    /// Moment of inertia per unit mass, I [m2].
    pub inertia: f64,
    /// Distances of the first four nodes along x [m].
    along: [f64; 4],
    /// Distances of the first four lines along y [m].
    across: [f64; 4],
    /// 1/I [1/m2].
    inverse: f64,
}

impl ParticleSpin {
    /// A particle with nodes at `distances`, and with I = `inertia` [m2].
    #[inline(always)]
    pub fn new(distances: &Distances, inertia: f64) -> Self {
        let (along, across) =
            (distances.four_along().to_array(), from_fn(|line| distances.across(line)));
        ParticleSpin { inertia, along, across, inverse: 1.0 / inertia }
    }
}

/// Weights of a narrow particle and their products with distances, one vector per line.
pub(super) struct PackedSpin<const V: usize> {
    values: [f64x4; V],
    /// Values times the distances along y [m].
    across: [f64x4; V],
    /// Distances along x [m].
    along: f64x4,
}

impl<const V: usize> PackedSpin<V> {
    #[inline(always)]
    pub(super) fn new(values: [f64x4; V], particle: &ParticleSpin) -> Self {
        let across = from_fn(|line| values[line] * f64x4::splat(particle.across[line]));
        PackedSpin { values, across, along: vector(&particle.along) }
    }

    /// Sums of the nodal vector (x, y) over the lines: N.x, N.y, and the angular momentum about the
    /// particle [m times the unit of x].
    #[inline(always)]
    pub(super) fn sums(&self, [x, y]: &[[f64x4; V]; 2]) -> [f64x4; 3] {
        let mean_y = dot(&self.values, y);
        [dot(&self.values, x), mean_y, self.along * mean_y - dot(&self.across, x)]
    }

    /// Adds N times the vector of the first two terms, and N (-e_y, e_x) times the third.
    #[inline(always)]
    pub(super) fn add(&self, [x, y]: &mut [[f64x4; V]; 2], terms: [f64; 3]) {
        let [mean_x, mean_y, turn] = terms.map(f64x4::splat);
        let mean_y = mean_y + self.along * turn;
        for line in 0..V {
            x[line] += self.values[line] * mean_x - self.across[line] * turn;
            y[line] += self.values[line] * mean_y;
        }
    }
}

/// Moment of inertia per unit mass of the weights of a particle about it, I [m2].
#[inline(always)]
pub(super) fn spin_inertia<const K: usize, const D: usize>(
    weights: &ParticleWeights<'_, K, D>,
    distances: &Distances,
) -> f64 {
    weights.sum(weights.values, |line| {
        let across = distances.across(line);
        let mut squares = [0.0; K];
        for k in 0..K {
            let along = distances.along(k);
            squares[k] = along * along + across * across;
        }
        squares
    })
}

/// [`spin_inertia`] of a window in vectors, before the sum over the nodes of a line.
#[inline(always)]
pub(super) fn packed_inertia<const V: usize>(values: &[f64x4; V], distances: &Distances) -> f64x4 {
    let along = distances.four_along();
    dot(
        values,
        &from_fn(|line| {
            let across = f64x4::splat(distances.across(line));
            along * along + across * across
        }),
    )
}

/// The sums of [`PackedSpin::sums`] over the nodes of a window of any width.
#[inline(always)]
pub(super) fn spin_sums<const K: usize, const D: usize>(
    weights: &ParticleWeights<'_, K, D>,
    distances: &Distances,
    [x, y]: [&[f64]; 2],
) -> [f64; 3] {
    let (mut mean, mut across_x) = ([[0.0; K]; 2], [0.0; K]);
    for line in 0..const { lines(K, D) } {
        let (values, across) = (&weights.values[line], distances.across(line));
        let (x, y) = (weights.line(x, line), weights.line(y, line));
        for k in 0..K {
            mean[0][k] += values[k] * x[k];
            mean[1][k] += values[k] * y[k];
            across_x[k] += values[k] * across * x[k];
        }
    }
    let mut sums = [0.0; 3];
    for k in 0..K {
        let moment = distances.along(k) * mean[1][k] - across_x[k];
        for (sum, term) in sums.iter_mut().zip([mean[0][k], mean[1][k], moment]) {
            *sum += term;
        }
    }
    sums
}

/// [`PackedSpin::add`] for a window of any width.
#[inline(always)]
pub(super) fn add_spin<const K: usize, const D: usize>(
    weights: &ParticleWeights<'_, K, D>,
    distances: &Distances,
    [x, y]: [&mut [f64]; 2],
    [mean_x, mean_y, turn]: [f64; 3],
) {
    for line in 0..const { lines(K, D) } {
        let (values, across) = (&weights.values[line], distances.across(line));
        let first = weights.first + line * weights.stride;
        let term_x = |k: usize| values[k] * mean_x - values[k] * across * turn;
        add::<K>(x, first, from_fn(term_x));
        add::<K>(y, first, from_fn(|k| values[k] * (mean_y + distances.along(k) * turn)));
    }
}

/// Matrix-free symmetric matrix over the nodes of a plane: the weight of each particle, and its spin.
#[derive(Clone, Debug, Default)]
pub struct ParticleMatrix {
    /// Weights w of all particles of the patch, including ghosts, such as their masses \[kg\].
    pub weights: Vec<f64>,
    /// The same particles with spin; empty for a matrix without.
    pub spinning: Vec<ParticleSpin>,
    /// Distances of the nodes from these particles, for the sums over wide windows.
    pub distances: Vec<Distances>,
}

impl ParticleMatrix {
    /// Memory per particle \[bytes\], with or without spin.
    pub const fn bytes_per_particle(spin: bool) -> usize {
        let spinning = size_of::<ParticleSpin>() + size_of::<Distances>();
        size_of::<f64>() + if spin { spinning } else { 0 }
    }

    /// `y` = M x for each of several fields over the nodes. With spin, fields 2k and 2k + 1 are the
    /// components of a vector along x and y. `runs` are the ranges of particles in canonical order.
    /// The product is valid at a node if `x` is valid at all nodes of the windows that contain it.
    ///
    /// # Panics
    ///
    /// If `x` and `y` have different lengths, or with spin an odd length.
    pub fn products<const D: usize>(
        &self,
        stencils: &Stencils,
        runs: &[Range<usize>],
        x: &[&[f64]],
        y: &mut [Vec<f64>],
    ) {
        fn packed<const K: usize, const V: usize, const D: usize>(
            matrix: &ParticleMatrix,
            stencils: &Stencils,
            x: &[&[f64]],
            y: &mut [Vec<f64>],
        ) {
            for group in &stencils.groups {
                let first = group.first();
                // numbers of particles known at compile time, so that there are no loops over them
                match group.packed_count() {
                    0 => matrix.add_one_by_one::<K, D>(stencils, group.particles(), x, y),
                    1 => matrix.add_packed::<K, V, D, 1>(stencils, first, x, y),
                    2 => matrix.add_packed::<K, V, D, 2>(stencils, first, x, y),
                    3 => matrix.add_packed::<K, V, D, 3>(stencils, first, x, y),
                    _ => matrix.add_packed::<K, V, D, GROUP_SIZE>(stencils, first, x, y),
                }
            }
        }
        fn single<const K: usize, const D: usize>(
            matrix: &ParticleMatrix,
            stencils: &Stencils,
            runs: &[Range<usize>],
            x: &[&[f64]],
            y: &mut [Vec<f64>],
        ) {
            runs.iter().cloned().for_each(|run| matrix.add_one_by_one::<K, D>(stencils, run, x, y));
        }
        assert_eq!(x.len(), y.len());
        let is_paired = x.len().is_multiple_of(2);
        assert!(self.spinning.is_empty() || is_paired, "with spin, fields are pairs of components");
        y.iter_mut().for_each(|y| y.fill(0.0));
        let width = stencils.width;
        with_packed!(
            width,
            packed(self, stencils, x, y),
            with_width!(width, single(self, stencils, runs, x, y))
        );
    }

    /// Adds the terms of `N` narrow particles with the same window, from `first` on.
    #[inline(always)]
    fn add_packed<const K: usize, const V: usize, const D: usize, const N: usize>(
        &self,
        stencils: &Stencils,
        first: usize,
        x: &[&[f64]],
        y: &mut [Vec<f64>],
    ) {
        let place = stencils.place(first);
        let weights: &[f64; N] = self.weights[first..].first_chunk().expect("N particles");
        let weights = f64x4::from(four_of(|k| weights[k % N], N));
        let values: [[f64x4; V]; N] = stencils.packed_group::<K, V, D, N>(first);
        if self.spinning.is_empty() {
            for (x, y) in x.iter().zip(y) {
                let nodes = place.nodes::<K, V>(x);
                let sums = totals::<K>(four_of(|k| dot(&values[k % N], &nodes), N));
                let terms = (weights * f64x4::from(sums)).to_array();
                let mut nodes = place.nodes::<K, V>(y);
                for k in 0..N {
                    add_to(&mut nodes, &values[k], terms[k]);
                }
                place.put::<K, V>(y, &nodes);
            }
            return;
        }
        let spinning: &[ParticleSpin; N] =
            self.spinning[first..].first_chunk().expect("N particles");
        let inverse = f64x4::from(four_of(|k| spinning[k % N].inverse, N));
        let spin: [PackedSpin<V>; N] = from_fn(|k| PackedSpin::new(values[k], &spinning[k]));
        for (x, y) in x.as_chunks::<2>().0.iter().zip(y.as_chunks_mut::<2>().0) {
            let nodes = map(x, |x| place.nodes::<K, V>(x));
            let all: [[f64x4; 3]; N] = from_fn(|k| spin[k].sums(&nodes));
            let [x_sums, y_sums, moments]: [f64x4; 3] =
                from_fn(|part| f64x4::from(totals::<K>(four_of(|k| all[k % N][part], N))));
            let terms = [weights * x_sums, weights * y_sums, weights * (moments * inverse)];
            let terms = map(&terms, |terms| terms.to_array());
            let mut nodes = from_fn(|a| place.nodes::<K, V>(&y[a]));
            for k in 0..N {
                spin[k].add(&mut nodes, map(&terms, |terms| terms[k]));
            }
            for (y, nodes) in y.iter_mut().zip(&nodes) {
                place.put::<K, V>(y, nodes);
            }
        }
    }

    /// Adds the terms of particles one by one.
    fn add_one_by_one<const K: usize, const D: usize>(
        &self,
        stencils: &Stencils,
        particles: Range<usize>,
        x: &[&[f64]],
        y: &mut [Vec<f64>],
    ) {
        for r in particles {
            let (weights, w) = (stencils.particle::<K, D>(r), self.weights[r]);
            let Some((distances, spin)) = self.distances.get(r).zip(self.spinning.get(r)) else {
                for (x, y) in x.iter().zip(&mut *y) {
                    let term = w * weights.dot(weights.values, x);
                    weights.add(y, weights.values, |n| n * term);
                }
                continue;
            };
            for (x, y) in x.as_chunks::<2>().0.iter().zip(y.as_chunks_mut::<2>().0) {
                let [x_sum, y_sum, moment] = spin_sums(&weights, distances, *x);
                let terms = map(&[x_sum, y_sum, moment * spin.inverse], |sum| w * sum);
                add_spin(&weights, distances, y.each_mut().map(|y| &mut y[..]), terms);
            }
        }
    }
}

/// `of(0)`, `of(1)`, ... for the first `count` of four entries, and zeros.
#[inline(always)]
fn four_of<T: Default>(of: impl Fn(usize) -> T, count: usize) -> [T; 4] {
    from_fn(|k| if k < count { of(k) } else { T::default() })
}

#[cfg(test)]
mod tests {
    use super::*;

    const STRIDE: usize = 12;
    const NODES: usize = 160;

    fn number(k: usize) -> f64 {
        ((k * k * 31 + k * 17) % 97) as f64 / 97.0
    }

    /// Weights of six particles in two groups, of which the second is wide if windows are, and the
    /// matrix of their masses, with or without spin.
    fn six<const K: usize>(spin: bool) -> (Stencils, ParticleMatrix) {
        let mut stencils = Stencils::default();
        stencils.resize::<K, 2>(6, STRIDE);
        let first = 2 + 2 * STRIDE as u32;
        stencils.first.copy_from_slice(&[first, first, first, first, first, first + 1]);
        stencils.values.iter_mut().enumerate().for_each(|(k, v)| *v = number(k));
        for (r, narrow) in stencils.narrow.iter_mut().enumerate() {
            *narrow = r < 5;
            let values = &mut stencils.values[r * K * K..(r + 1) * K * K];
            for (k, value) in values.iter_mut().enumerate() {
                if *narrow && (k % K >= 4 || k / K >= 4) {
                    *value = 0.0;
                }
            }
        }
        stencils.find_groups::<K>(std::slice::from_ref(&(0..6)));
        let distances = |r: usize| Distances {
            first: [-0.9 + 0.1 * r as f64, -0.7],
            skipped: [f64::from(u8::from(r == 1)), 0.0],
            cell: [0.5, 0.4],
        };
        let distances: Vec<Distances> = (0..if spin { 6 } else { 0 }).map(distances).collect();
        let spinning =
            |(r, at)| ParticleSpin::new(at, spin_inertia(&stencils.particle::<K, 2>(r), at));
        let spinning = distances.iter().enumerate().map(spinning).collect();
        let weights = vec![2.0, 0.3, 1.1, 0.7, 1.9, 0.4];
        let matrix = ParticleMatrix { weights, spinning, distances };
        (stencils, matrix)
    }

    /// Products with four fields by groups, one by one, and with the full matrix.
    fn check<const K: usize>(spin: bool) {
        let (stencils, matrix) = six::<K>(spin);
        let fields: Vec<Vec<f64>> =
            (0..4).map(|f| (0..NODES).map(|i| number(i * 7 + f * 13) - 0.4).collect()).collect();
        let x: Vec<&[f64]> = fields.iter().map(|field| &field[..]).collect();
        let mut y = vec![vec![f64::NAN; NODES]; 4];
        matrix.products::<2>(&stencils, std::slice::from_ref(&(0..6)), &x, &mut y);
        let mut one_by_one = vec![vec![0.0; NODES]; 4];
        matrix.add_one_by_one::<K, 2>(&stencils, 0..6, &x, &mut one_by_one);
        assert_eq!(y, one_by_one, "{K} nodes, spin {spin}");
        // N and phi of a particle for two components on all nodes
        let mut exact = vec![vec![0.0; NODES]; 4];
        for r in 0..6 {
            let weights = stencils.particle::<K, 2>(r);
            let at = |l: usize, k: usize| weights.first + l * STRIDE + k;
            let all = (0..K).flat_map(|l| (0..K).map(move |k| (l, k)));
            for (l, k) in all.clone() {
                for (m, j) in all.clone() {
                    let both = weights.values[l][k] * weights.values[m][j];
                    let turn = |l: usize, k: usize| {
                        let distances = &matrix.distances[r];
                        [-distances.across(l), distances.along(k)]
                    };
                    for f in 0..4 {
                        let mut term = both * x[f][at(m, j)];
                        if spin {
                            let (here, there) = (turn(l, k), turn(m, j));
                            let [vx, vy] = [x[f & 2][at(m, j)], x[(f & 2) + 1][at(m, j)]];
                            let inertia = matrix.spinning[r].inertia;
                            term += both * here[f & 1] * (there[0] * vx + there[1] * vy) / inertia;
                        }
                        exact[f][at(l, k)] += matrix.weights[r] * term;
                    }
                }
            }
        }
        for (y, exact) in y.iter().flatten().zip(exact.iter().flatten()) {
            assert!((y - exact).abs() < 1e-12 * exact.abs().max(1.0), "{K} nodes: {y} {exact}");
        }
        assert!(exact.iter().all(|field| field.iter().any(|y| y.abs() > 0.1)));
    }

    #[test]
    fn products_are_those_of_the_full_matrix() {
        for spin in [false, true] {
            check::<3>(spin);
            check::<4>(spin);
            check::<6>(spin);
            check::<10>(spin);
        }
    }
}
