//! Stencil radius of particles, which determines the depth of ghost layers and halos.

use super::exchange::Sleep;
use super::relaxation;
use super::scheme::Scheme;
use crate::scene::{CheckedBody, CheckedScene, FilterHalo, Stepping, StressUpdate};
use crate::shape::{most_nodes, padded_width};

/// Ratio by which a particle may be longer at the middle of a step than at its start.
const STRETCH: f64 = 1.25;

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

/// Number of passes of the flux limiter over neighbouring nodes, each as far as a product: edges,
/// shares and corrections of force and velocity.
const LIMITER_PRODUCTS: u32 = 6;

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

impl<const D: usize> Scheme<D> {
    /// Greatest initial extent of particles along a direction [cells].
    pub fn longest_at_start(&self, scene: &CheckedScene) -> f64 {
        let extent = |body: &CheckedBody, a: usize| match &body.tiling {
            Some(tiling) => tiling.longest()[a],
            None => (body.upper[a] - body.lower[a]) / body.lattice[a] as f64,
        };
        let extents = scene.bodies.iter().flat_map(|body| (0..D).map(move |a| (body, a)));
        extents.map(|(body, a)| extent(body, a) / scene.cell_size[a]).fold(0.0, f64::max)
    }

    /// Stencil radius of particles up to `length` long [cells], with room to stretch in a step;
    /// `None` if they are longer than any stencil.
    pub fn reach(&self, length: f64) -> Option<StencilRadius> {
        let length = if self.domains_deform() { length * STRETCH } else { length };
        let nodes = self.shape.nodes(length);
        (nodes <= most_nodes(D)).then_some(StencilRadius { nodes, products: self.products() })
    }

    /// Number of products with a matrix between sums over particles and the gather.
    fn products(&self) -> usize {
        let own = self.transfer.products(self.compatible);
        let relaxed = self.relaxation.map_or(0, |_| relaxation::ORDER - 1);
        let limited = if self.fields.limiter.is_some() { LIMITER_PRODUCTS } else { 0 };
        (own + limited).max(relaxed).max(self.of_effects.products) as usize
    }

    /// Distance from moving material within which a step may change a particle, for a stencil
    /// radius [cells]. The terms of the filters and of the pressure projection spread velocity and
    /// pressure in each pass of a step over the grid. The velocity that does the work spreads
    /// further, but it does no work on material without stress.
    pub fn influence_radius(&self, reach: StencilRadius) -> i64 {
        let limited = if self.fields.limiter.is_some() { LIMITER_PRODUCTS } else { 0 };
        let filter = self.transfer.order + limited;
        let order = filter.max(self.relaxation.map_or(0, |_| relaxation::ORDER));
        let pass = reach.cells() + i64::from(order) * (reach.nodes as i64 - 1) + 2;
        match (self.stepping, self.stress_update) {
            (Stepping::Midpoint, _) | (_, StressUpdate::Last) => pass,
            _ => 2 * pass,
        }
    }

    /// Conditions for quiescent patches: everything that a step computes has been computed at rest,
    /// including pressure relaxation.
    pub fn sleep(&self) -> Sleep {
        let f = &self.fields;
        Sleep {
            needed: 1 + self.relaxation.map_or(0, |r| r.interval),
            kept: [
                f.mass,
                f.inverse,
                f.volume,
                f.edge,
                f.relaxation[0],
                f.relaxation[1],
                f.relaxed_ratio.unwrap_or(usize::MAX),
            ],
        }
    }

    /// Longest particle [cells] for which `reach` is sufficient.
    pub fn longest_within(&self, reach: StencilRadius) -> f64 {
        (reach.nodes + 1 - self.shape.nodes(0.01)) as f64
    }

    /// Longest particle [cells] for which any stencil is sufficient, with room to stretch.
    pub(super) fn longest_ever(&self) -> f64 {
        self.longest_within(StencilRadius { nodes: most_nodes(D), products: 0 }) / STRETCH
    }
}
