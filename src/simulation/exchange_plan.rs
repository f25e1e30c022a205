//! Exchanges of particles and of nodal values between patches.

use decomp::{GhostExchange, GhostReach, Layout, NodeExchange};

use crate::scene::{CheckedScene, FilterHalo};
use crate::solver::{StencilRadius, Stepper};

/// Plan of all exchanges, for one stencil radius and one distribution of patches.
pub(super) struct ExchangePlan<const D: usize> {
    pub(super) particles: GhostExchange<D>,
    pub(super) nodes: NodeExchange<D>,
    pub(super) inner_particles: Vec<bool>,
    pub(super) inner_nodes: Vec<bool>,
    pub(super) filter: FilterHalo,
    /// Depth of the ghost layer around a patch [cells].
    pub(super) ghosts: i64,
    /// Layers that a patch computes beyond its own nodes.
    pub(super) deeper: i64,
}

/// How filters obtain values beyond a patch, and the depths that follow.
#[derive(Clone, Copy)]
pub(super) struct HaloDepths {
    pub(super) filter: FilterHalo,
    /// Depth of the ghost layer around a patch [cells].
    pub(super) ghosts: i64,
    /// Layers that a patch computes beyond its own nodes.
    pub(super) deeper: i64,
}

/// Depths for a stencil radius on `workers` ranks times threads.
pub(super) fn halo_depths<const D: usize>(
    scene: &CheckedScene,
    layout: &Layout<D>,
    reach: StencilRadius,
    workers: usize,
) -> HaloDepths {
    let choose = || FilterHalo::choose(reach, layout.narrowest(), workers);
    HaloDepths::of(scene.scene.decomposition.filter_halo.unwrap_or_else(choose), reach)
}

impl HaloDepths {
    /// Depths for a stencil radius.
    pub(super) fn of(filter: FilterHalo, reach: StencilRadius) -> Self {
        let deeper = match filter {
            FilterHalo::Exchange => 0,
            FilterHalo::Redundant => reach.deeper(),
        };
        HaloDepths { filter, ghosts: reach.cells() + deeper, deeper }
    }
}

impl<const D: usize> ExchangePlan<D> {
    pub(super) fn new(
        scene: &CheckedScene,
        stepper: &Stepper<D>,
        layout: &Layout<D>,
        reach: StencilRadius,
        rank: usize,
        depths: HaloDepths,
    ) -> Self {
        let HaloDepths { filter, ghosts, deeper } = depths;
        let notice = scene.skips_quiet().then(|| stepper.influence_radius(reach));
        let particles =
            GhostExchange::new(layout, rank, GhostReach { depth: ghosts, travel: 1, notice });
        let nodes =
            NodeExchange::layered(layout, rank, reach.halo(), reach.depth(ghosts), stepper.layers);
        ExchangePlan {
            inner_particles: particles.inner().to_vec(),
            inner_nodes: nodes.inner().to_vec(),
            particles,
            nodes,
            filter,
            ghosts,
            deeper,
        }
    }
}
