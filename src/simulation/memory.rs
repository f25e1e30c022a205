//! Memory of one rank, estimated from its patches before they are made.

use decomp::{IndexBox, Layout};

use super::exchange_plan::halo_depths;
use super::patches::{assign_domain, count_particles, patch_counts};
use crate::effects;
use crate::scene::CheckedScene;
use crate::solver::memory::PatchSize;
use crate::solver::{StencilRadius, Stepper};

/// Memory of the program without particles: code, libraries and buffers [bytes].
const PROGRAM: u64 = 30 << 20;

/// Size of the arrays over that of the gaps between them on the heap [-]; the gaps were measured as
/// about 3 % of the memory.
const ARRAYS_PER_GAP: u64 = 32;

/// Numbers of cells along a direction and of patches above which patches are not counted, because the
/// counts take much memory themselves.
const MOST_CELLS: usize = 20_000_000;
const MOST_PATCHES: usize = 1_000_000;

/// Estimated memory of `rank` of `ranks` in a run with `threads` threads a rank [bytes], from the
/// particles, ghosts and nodes of its patches, without outputs.
pub fn rank_memory(scene: &CheckedScene, rank: usize, ranks: usize, threads: usize) -> u64 {
    let patches = patch_counts(scene, ranks, threads);
    let patches = patches.into_iter().fold(1, usize::saturating_mul);
    let longest = scene.cells.iter().copied().max().unwrap_or(1);
    match scene.dimension {
        _ if longest > MOST_CELLS || patches > MOST_PATCHES => scene.memory() / ranks as u64,
        1 => memory_in::<1>(scene, rank, ranks, threads),
        _ => memory_in::<2>(scene, rank, ranks, threads),
    }
}

fn memory_in<const D: usize>(
    scene: &CheckedScene,
    rank: usize,
    ranks: usize,
    threads: usize,
) -> u64 {
    let stepper = effects::stepper::<D>(scene);
    let layout = assign_domain::<D>(scene, ranks, threads);
    let longest = stepper.longest_at_start(scene);
    let Some(reach) = stepper.reach(longest) else { return scene.memory() / ranks as u64 };
    let ghost_layers = halo_depths(scene, &layout, reach, ranks * threads).ghosts;
    memory_of(scene, &stepper, &layout, rank, (reach, ghost_layers))
}

/// Memory of the patches that `rank` has in `layout` [bytes], with ghosts of `ghost_layers` cells.
pub(super) fn memory_of<const D: usize>(
    scene: &CheckedScene,
    stepper: &Stepper<D>,
    layout: &Layout<D>,
    rank: usize,
    (reach, ghost_layers): (StencilRadius, i64),
) -> u64 {
    let longest = stepper.longest_at_start(scene);
    let patch = |patch: usize| {
        let cells = &layout.patch(patch);
        let own = count_particles(scene, cells);
        let edges = [cells.extent(0) as u64, cells.extent(D - 1) as u64];
        let ghosts = seen(scene, layout, patch, ghost_layers).saturating_sub(own);
        let size = PatchSize { own, ghosts, cells: edges, ghost_layers };
        stepper.patch_bytes(longest, reach, &size)
    };
    let patches = layout.patches_of(rank).into_iter().map(patch);
    let arrays = patches.fold(0, u64::saturating_add);
    PROGRAM.saturating_add(arrays).saturating_add(arrays / ARRAYS_PER_GAP)
}

/// Number of particles and images that `patch` sees, its own among them.
pub(super) fn seen<const D: usize>(
    scene: &CheckedScene,
    layout: &Layout<D>,
    patch: usize,
    depth: i64,
) -> u64 {
    let halo = layout.halo(patch, depth);
    let counts = layout.images(depth).into_iter().map(|image| {
        let source: IndexBox<D> = image.source_cells(&halo).intersect(layout.domain());
        if source.is_empty() { 0 } else { count_particles(scene, &source) }
    });
    counts.sum()
}
