//! How far particles reach, which decides how deep ghosts and halos are.

use super::MOST_NODES;
use crate::scene::FilterHalo;

/// How far particles reach in one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reach {
    /// Nodes that the longest particle may touch.
    pub nodes: usize,
    /// Products with a matrix between the particles' sums and what they take back.
    pub products: usize,
}

impl Reach {
    /// Cells from which particles reach a patch's nodes.
    pub fn cells(&self) -> i64 {
        self.nodes.div_ceil(2) as i64
    }

    /// Depth of the halo in which a patch needs other owners' nodal values.
    pub fn halo(&self) -> i64 {
        (2 * self.cells() - 1).max(2)
    }

    /// How much deeper ghosts must come from for a patch to do without others' nodal values:
    /// each product spoils the outermost nodes, as many as a particle touches less one.
    pub fn deeper(&self) -> i64 {
        self.cells() + (self.products * (self.nodes - 1)) as i64 + 1
    }

    /// Depth of the nodal arrays for ghosts from `ghosts` cells away, so that neither a ghost's
    /// stencil nor a product with the mass matrix ever leaves them.
    pub fn depth(&self, ghosts: i64) -> i64 {
        let stencils = ghosts + self.cells() - 1 + self.nodes.max(4) as i64;
        // at an open side the nodes that are computed end with the padded stencil of a particle
        // in the last cell, and a product looks as far again
        stencils.max(2 * self.padded_nodes() as i64 - 3)
    }

    /// Nodes that the stencil of the longest particle has room for, as `with_shape!` rounds them.
    fn padded_nodes(&self) -> usize {
        match self.nodes {
            0..=4 => self.nodes,
            5..=6 => 6,
            7..=10 => 10,
            _ => MOST_NODES,
        }
    }
}

/// Share of its own cells that a patch may compute a second time before messages are cheaper.
const WORTH: f64 = 0.35;

impl FilterHalo {
    /// The cheaper way for patches of at least `narrowest` cells on `workers` ranks times
    /// threads.
    pub fn choose(reach: Reach, narrowest: usize, workers: usize) -> Self {
        let twice = 2 * (reach.cells() + reach.deeper());
        if workers > 1 && (twice as f64) < WORTH * narrowest as f64 {
            FilterHalo::Deep
        } else {
            FilterHalo::Exchange
        }
    }
}
