//! Symmetric matrices over the nodes of a patch, M_ij = sum_p w_p N_ip N_jp, such as the mass matrix:
//! banded on a line, matrix-free in a plane.
//!
//! This module does not depend on materials, time stepping or messages.

use std::ops::Range;

use super::band::Band;
use super::particle_matrix::ParticleMatrix;
use crate::solver::particle_weights::ParticleWeights;
use crate::solver::shape_weights::Stencils;

/// Particles and computed nodes of a patch, for products.
#[derive(Clone, Copy)]
pub struct ProductContext<'a> {
    /// Weights of its particles.
    pub stencils: &'a Stencils,
    /// Ranges of particles in canonical order.
    pub runs: &'a [Range<usize>],
    /// Ranges of the nodes.
    pub lines: &'a [Range<usize>],
}

/// Symmetric matrix over the nodes of a patch: banded on a line, matrix-free in a plane.
#[derive(Clone, Debug, Default)]
pub struct NodalMatrix {
    /// The matrix on a line.
    pub band: Band,
    /// The matrix in a plane.
    pub particles: ParticleMatrix,
}

impl NodalMatrix {
    /// Memory per node and per particle \[bytes\], for windows of `width` nodes along each of
    /// `dimension` directions, with or without spin.
    pub const fn bytes(width: usize, dimension: usize, spin: bool) -> [usize; 2] {
        match dimension {
            1 => [Band::bytes_per_node(width), 0],
            _ => [0, ParticleMatrix::bytes_per_particle(spin)],
        }
    }

    /// Starts the matrix, on windows of `K` nodes along each direction and on `nodes` nodes: in a
    /// plane stores the weights `w` of all particles, ghosts included; on a line sets all entries to
    /// 0, and [`add`](Self::add) adds each particle.
    pub fn start<const K: usize, const D: usize>(
        &mut self,
        nodes: usize,
        w: impl Iterator<Item = f64>,
    ) {
        if const { D == 1 } {
            return self.band.clear(nodes, K);
        }
        self.particles.weights.clear();
        self.particles.weights.extend(w);
    }

    /// Adds a particle of the weight `w` on a line.
    #[inline(always)]
    pub fn add<const K: usize, const D: usize>(
        &mut self,
        weights: &ParticleWeights<'_, K, D>,
        w: f64,
    ) {
        if const { D == 1 } {
            self.band.add(weights, w);
        }
    }

    /// Completes the matrix on a line.
    pub fn finish<const D: usize>(&mut self) {
        if const { D == 1 } {
            self.band.finish();
        }
    }

    /// `y` = M x on the computed nodes and 0 elsewhere, for several fields at a time. With spin,
    /// fields 2k and 2k + 1 are the components of a vector. The unit of y is that of x times that of w.
    pub fn products<const D: usize>(
        &self,
        context: ProductContext<'_>,
        x: &[&[f64]],
        y: &mut [Vec<f64>],
    ) {
        if const { D > 1 } {
            self.particles.products::<D>(context.stencils, context.runs, x, y);
        }
        for (x, y) in x.iter().zip(y) {
            clear_others(context.lines, y);
            if const { D == 1 } {
                context.lines.iter().for_each(|line| self.band.product([x], line.clone(), [y]));
            }
        }
    }

    /// `y` = t + a (x - d M x) on the computed nodes, for several fields at a time, with a diagonal
    /// matrix d and a number a of `shares` [-] for each field: from one sum of a series to the next
    /// by Horner's rule. In a plane other nodes are set to 0, on a line they keep their values. t, x
    /// and y have the same unit.
    pub fn next_sums<const D: usize, const V: usize>(
        &self,
        context: ProductContext<'_>,
        x: [&[f64]; V],
        d: &[f64],
        t: [&[f64]; V],
        shares: [f64; V],
        y: &mut [Vec<f64>; V],
    ) {
        if const { D == 1 } {
            for line in context.lines {
                let y = y.each_mut().map(|y| &mut y[..]);
                self.band.next_sums(x, d, t, shares, line.clone(), y);
            }
            return;
        }
        self.products::<D>(context, &x, y);
        for line in context.lines {
            let d = &d[line.clone()];
            for v in 0..V {
                let [x, t] = [x[v], t[v]].map(|field| &field[line.clone()]);
                let y = &mut y[v][line.clone()];
                let share = shares[v];
                for i in 0..y.len() {
                    y[i] = t[i] + share * (x[i] - d[i] * y[i]);
                }
            }
        }
    }
}

/// Sets the nodes of `field` outside of `lines` to 0.
fn clear_others(lines: &[Range<usize>], field: &mut [f64]) {
    let mut from = 0;
    for line in lines {
        field[from..line.start].fill(0.0);
        from = line.end;
    }
    field[from..].fill(0.0);
}
