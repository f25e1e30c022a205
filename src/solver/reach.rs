//! Stencil radius of particles, which determines the depth of ghost layers and halos.

use crate::scene::FilterHalo;
use crate::shape::padded_width;

/// Stencil radius of particles in one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StencilRadius {
    /// Number of nodes in the support of the longest particle along a direction.
    pub nodes: usize,
    /// Number of products with a matrix between sums over particles and the gather.
    pub products: usize,
}

impl StencilRadius {
    /// Distance within which particles contribute to the nodes of a patch [cells].
    pub fn cells(&self) -> i64 {
        self.nodes.div_ceil(2) as i64
    }

    /// Depth of the halo in which a patch needs nodal values of other owners [nodes].
    pub fn halo(&self) -> i64 {
        (2 * self.cells() - 1).max(2)
    }

    /// Additional depth of ghosts that makes nodal values of other owners unnecessary [cells]: each
    /// product invalidates the outermost nodes, one less than a particle's number of nodes.
    pub fn deeper(&self) -> i64 {
        self.cells() + (self.products * (self.nodes - 1)) as i64 + 1
    }

    /// Depth of the nodal arrays for a ghost layer of `ghosts` cells, such that no stencil of a
    /// ghost and no product with the mass matrix exceeds the arrays.
    pub fn depth(&self, ghosts: i64) -> i64 {
        let stencils = ghosts + self.cells() - 1 + self.nodes.max(4) as i64;
        // at an open side the computed nodes end with the padded stencil of a particle in the last
        // cell, and a product reads as many nodes further
        stencils.max(2 * padded_width(self.nodes) as i64 - 3)
    }
}

/// Fraction of its own cells that a patch may compute redundantly before messages are cheaper.
const WORTH: f64 = 0.35;

impl FilterHalo {
    /// Cheaper method for patches of at least `narrowest` cells on `workers` ranks times threads.
    pub fn choose(reach: StencilRadius, narrowest: usize, workers: usize) -> Self {
        let twice = 2 * (reach.cells() + reach.deeper());
        if workers > 1 && (twice as f64) < WORTH * narrowest as f64 {
            FilterHalo::Redundant
        } else {
            FilterHalo::Exchange
        }
    }
}
