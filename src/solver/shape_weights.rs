//! Weights of a patch's particles on its nodes, and the weights that the total-Lagrangian frame
//! keeps.
//!
//! This module does not depend on materials, time stepping or messages.

use std::ops::Range;

use decomp::Block;
use wide::f64x4;

use crate::solver::packed::{PACKED, PackedWeights, WindowPlace, pack};
use crate::solver::particle_weights::{NARROW, ParticleWeights, lines};

/// Greatest number of particles in a group.
pub const GROUP_SIZE: usize = 4;

/// Numbers after the last weight, so that the last line of a window can be loaded as four numbers.
const SPARE: usize = PACKED - 1;

/// Weights of all particles of a patch, including ghosts, on windows of `width` nodes along each
/// direction.
#[derive(Clone, Debug, Default)]
pub struct Stencils {
    /// Number of nodes along one direction.
    pub width: usize,
    /// Distance from a line of nodes to the next in the patch's arrays.
    pub stride: usize,
    /// First node of each particle's window, as index in the patch's arrays.
    pub first: Vec<u32>,
    /// Whether a particle's window starts one node before its first weight, along x or a line (1)
    /// and y (2).
    pub skipped: Vec<u8>,
    /// Whether a particle's weights beyond the first [`NARROW`] nodes are zero, if windows are
    /// wider.
    pub narrow: Vec<bool>,
    /// Values [-], `width`^D per particle.
    pub values: Vec<f64>,
    /// Gradients [1/m], `width`^D per particle and direction.
    pub gradients: Vec<f64>,
    /// Groups of particles in canonical order, in a plane for windows of more than two nodes along
    /// a direction.
    pub groups: Vec<Group>,
    /// Data kept by the total-Lagrangian frame.
    kept: Kept,
}

/// At most [`GROUP_SIZE`] consecutive particles with the same window, all of them narrow or none.
#[derive(Clone, Copy, Debug)]
pub struct Group {
    first: u32,
    count: u8,
    narrow: bool,
}

impl Group {
    /// First particle.
    #[inline(always)]
    pub fn first(self) -> usize {
        self.first as usize
    }

    /// Particles.
    #[inline(always)]
    pub fn particles(self) -> Range<usize> {
        self.first()..self.first() + usize::from(self.count)
    }

    /// Number of particles whose weights are in vectors: all narrow ones, no wide one.
    #[inline(always)]
    pub fn packed_count(self) -> usize {
        if self.narrow { usize::from(self.count) } else { 0 }
    }
}

/// Data that the total-Lagrangian frame keeps from step to step: the weights of a particle or its
/// image depend only on its id and its cell.
#[derive(Clone, Debug, Default)]
struct Kept {
    /// Gradients with respect to the initial positions [1/m].
    gradients: Vec<f64>,
    ids: Vec<u64>,
    /// Cells, component by component.
    cells: Vec<i32>,
}

impl Stencils {
    /// Room for the weights of `particles` on windows of `K` nodes along each direction, in arrays
    /// with lines of `stride` nodes.
    pub(super) fn resize<const K: usize, const D: usize>(
        &mut self,
        particles: usize,
        stride: usize,
    ) {
        let nodes = const { K * lines(K, D) };
        self.width = K;
        self.stride = stride;
        self.first.resize(particles, 0);
        self.skipped.resize(particles, 0);
        self.values.resize(particles * nodes + SPARE, 0.0);
        self.gradients.resize(particles * nodes * D + SPARE, 0.0);
        self.narrow.resize(if K > NARROW { particles } else { 0 }, false);
    }

    /// Weights of `particle`.
    #[inline(always)]
    pub fn particle<const K: usize, const D: usize>(
        &self,
        particle: usize,
    ) -> ParticleWeights<'_, K, D> {
        let nodes = const { K * lines(K, D) };
        ParticleWeights {
            first: self.first[particle] as usize,
            stride: self.stride,
            narrow: K > NARROW && self.narrow[particle],
            values: self.values[particle * nodes..(particle + 1) * nodes].as_chunks().0,
            gradients: self.gradients[particle * nodes * D..(particle + 1) * nodes * D]
                .as_chunks()
                .0,
        }
    }

    /// Weights of `particles` in order, with fewer bounds checks than one by one.
    #[inline(always)]
    pub fn particles<const K: usize, const D: usize>(
        &self,
        particles: Range<usize>,
    ) -> impl Iterator<Item = ParticleWeights<'_, K, D>> {
        let nodes = const { K * lines(K, D) };
        let first = self.first[particles.clone()].iter();
        let values =
            self.values[particles.start * nodes..particles.end * nodes].chunks_exact(nodes);
        let gradients = self.gradients[particles.start * nodes * D..particles.end * nodes * D]
            .chunks_exact(nodes * D);
        // empty if windows are not wider
        let narrow = self.narrow.get(particles).unwrap_or_default();
        let weights = first.zip(values).zip(gradients).enumerate();
        weights.map(move |(at, ((&first, values), gradients))| ParticleWeights {
            first: first as usize,
            stride: self.stride,
            narrow: K > NARROW && narrow[at],
            values: values.as_chunks().0,
            gradients: gradients.as_chunks().0,
        })
    }

    /// Weights of `particle` in `V` vectors.
    #[inline(always)]
    pub fn packed<const K: usize, const V: usize, const D: usize>(
        &self,
        particle: usize,
    ) -> PackedWeights<V, D> {
        PackedWeights {
            values: self.packed_values::<K, V, D>(particle),
            gradients: self.packed_gradients::<K, V, D>(particle),
        }
    }

    /// Values of `particle` in `V` vectors.
    #[inline(always)]
    pub fn packed_values<const K: usize, const V: usize, const D: usize>(
        &self,
        particle: usize,
    ) -> [f64x4; V] {
        pack::<K, V>(&self.values[particle * const { K * lines(K, D) }..])
    }

    /// Values of `N` particles from `first` on, each in `V` vectors.
    #[inline(always)]
    pub fn packed_group<const K: usize, const V: usize, const D: usize, const N: usize>(
        &self,
        first: usize,
    ) -> [[f64x4; V]; N] {
        let nodes = const { K * lines(K, D) };
        // a length known at compile time: one check for all of them
        let numbers = &self.values[first * nodes..][..const { N * K * lines(K, D) + SPARE }];
        decomp::array::from_fn(|k| pack::<K, V>(&numbers[k * nodes..]))
    }

    /// Gradients of `particle` along each direction in `V` vectors [1/m].
    #[inline(always)]
    pub fn packed_gradients<const K: usize, const V: usize, const D: usize>(
        &self,
        particle: usize,
    ) -> [[f64x4; V]; D] {
        let nodes = const { K * lines(K, D) };
        let gradients = &self.gradients[particle * nodes * D..];
        decomp::array::from_fn(|a| pack::<K, V>(&gradients[a * nodes..]))
    }

    /// Weights of `particles` in order on windows of two nodes along each direction of a plane, with
    /// fewer bounds checks than one by one.
    #[inline(always)]
    pub fn squares<const D: usize>(
        &self,
        particles: Range<usize>,
    ) -> impl Iterator<Item = PackedWeights<1, D>> {
        let (from, to) = (4 * particles.start, 4 * particles.end);
        let values = self.values[from..to].as_chunks::<4>().0.iter();
        let gradients = self.gradients[D * from..D * to].chunks_exact(4 * D);
        values.zip(gradients).map(|(values, gradients)| PackedWeights {
            values: [f64x4::from(*values)],
            gradients: decomp::array::from_fn(|a| pack::<2, 1>(&gradients[4 * a..])),
        })
    }

    /// Whether `particle` has weights on at most the first [`NARROW`] nodes along each direction of its
    /// window of `K`.
    #[inline(always)]
    pub fn is_narrow<const K: usize>(&self, particle: usize) -> bool {
        K <= NARROW || self.narrow[particle]
    }

    /// Window of `particle`.
    #[inline(always)]
    pub fn place(&self, particle: usize) -> WindowPlace {
        WindowPlace { first: self.first[particle], stride: self.stride as u32 }
    }

    /// Finds the groups of particles in `runs`, the ranges of particles in canonical order.
    pub(super) fn find_groups<const K: usize>(&mut self, runs: &[Range<usize>]) {
        let Stencils { groups, first, narrow, .. } = self;
        groups.clear();
        for run in runs {
            // empty if windows are not wider
            let narrow = narrow.get(run.clone()).unwrap_or_default();
            let is_narrow = |at: usize| K <= NARROW || narrow[at];
            let mut group: Option<Group> = None;
            for (at, window) in first[run.clone()].iter().enumerate() {
                match &mut group {
                    Some(group)
                        if usize::from(group.count) < GROUP_SIZE
                            && first[group.first as usize] == *window
                            && group.narrow == is_narrow(at) =>
                    {
                        group.count += 1;
                    }
                    _ => {
                        groups.extend(group);
                        let start = (run.start + at) as u32;
                        group = Some(Group { first: start, count: 1, narrow: is_narrow(at) });
                    }
                }
            }
            groups.extend(group);
        }
    }

    /// Whether the particles of `block`, including ghosts, are those whose weights were last kept.
    pub fn are_kept<const D: usize>(&self, block: &Block<D>) -> bool {
        let cells = &block.cells[..block.particles()];
        !self.kept.ids.is_empty()
            && self.kept.ids == block.ids
            && self.kept.cells.as_slice() == cells.as_flattened()
    }

    /// Keeps the new weights of `block`, whose gradients are with respect to the initial positions.
    pub fn keep<const D: usize>(&mut self, block: &Block<D>) {
        let Stencils { gradients, kept, .. } = self;
        std::mem::swap(gradients, &mut kept.gradients);
        gradients.resize(kept.gradients.len(), 0.0);
        kept.ids.clone_from(&block.ids);
        kept.cells.clear();
        kept.cells.extend_from_slice(block.cells[..block.particles()].as_flattened());
    }

    /// Discards the kept data.
    pub fn forget(&mut self) {
        self.kept = Kept::default();
    }

    /// Pushes the kept gradients of all particles of `block` forward with the inverse of F in the
    /// columns from `push` on, G = F^-T G0.
    pub fn push_gradients<const K: usize, const D: usize>(
        &mut self,
        block: &Block<D>,
        push: usize,
    ) {
        let particles = block.particles();
        let nodes = const { K * lines(K, D) };
        let inverse = |k: usize| &block.columns[push + k][..particles];
        let pairs = (self.gradients[..particles * nodes * D].chunks_exact_mut(nodes * D))
            .zip(self.kept.gradients.chunks_exact(nodes * D))
            .enumerate();
        if D == 1 {
            let f = inverse(0);
            for (r, (gradients, first)) in pairs {
                for (g, g0) in gradients.iter_mut().zip(first) {
                    *g = f[r] * g0;
                }
            }
            return;
        }
        let [xx, xy, yx, yy] = decomp::array::from_fn(inverse);
        for (r, (gradients, first)) in pairs {
            let (gx, gy) = gradients.split_at_mut(nodes);
            let (x, y) = first.split_at(nodes);
            for k in 0..nodes {
                gx[k] = xx[r] * x[k] + yx[r] * y[k];
                gy[k] = xy[r] * x[k] + yy[r] * y[k];
            }
        }
    }

    /// Gradients of a particle with respect to its initial position along `axis` [1/m], line by
    /// line.
    pub fn first_gradient<const K: usize, const D: usize>(
        &self,
        particle: usize,
        axis: usize,
    ) -> &[[f64; K]] {
        let nodes = const { K * lines(K, D) };
        let from = (particle * D + axis) * nodes;
        self.kept.gradients[from..from + nodes].as_chunks().0
    }
}
