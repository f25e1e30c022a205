//! Choice of the patches: how many in each direction, and where the domain is cut.

use decomp::{Block, IndexBox, Layout, choose_cuts, deal_with_short_borders, even_cuts};

use crate::scene::{CheckedBody, CheckedScene};
use crate::solver::{Stepper, particles};

/// Narrowest useful patch [cells].
pub(crate) const LEAST_CELLS: usize = 16;

/// Patch width at which one worker loses little at the edges of quiescent patches [cells]: on a
/// line and in a plane.
const SLEEPING_CELLS: [usize; 2] = [64, 32];

/// Patches per worker, if several workers have patches that become quiescent or move, ...
const PATCHES_A_WORKER: usize = 8;

/// ... as long as patches are at least this wide [cells]: narrower ones cost more at their edges.
const SHARED_CELLS: [usize; 2] = [256, 64];

/// Patches per worker below which patches of a plane are cut down to [`SLEEPING_CELLS`]: with fewer a
/// worker may hold much more than the mean.
const LEAST_PATCHES_A_WORKER: usize = 4;

/// Number of patches for a scene on the given ranks and threads: as given in the scene, unless there
/// are fewer than several threads need; otherwise at least one for each thread of each rank unless
/// they would be too narrow, and several per thread if patches may be quiescent or in a plane.
pub fn patch_counts(scene: &CheckedScene, ranks: usize, threads: usize) -> Vec<usize> {
    match scene.dimension {
        1 => patch_parts::<1>(scene, ranks, threads).to_vec(),
        _ => patch_parts::<2>(scene, ranks, threads).to_vec(),
    }
}

/// Number of patches in each direction; see [`patch_counts`].
pub(super) fn patch_parts<const D: usize>(
    scene: &CheckedScene,
    ranks: usize,
    threads: usize,
) -> [usize; D] {
    let chosen = || chosen_parts(scene, ranks * threads);
    given_parts(scene, ranks, threads).unwrap_or_else(chosen)
}

/// The patches of the scene file; `None` if there are none, or if ranks have several threads, there are
/// fewer patches than threads in total, and the program would choose more.
fn given_parts<const D: usize>(
    scene: &CheckedScene,
    ranks: usize,
    threads: usize,
) -> Option<[usize; D]> {
    let given = scene.scene.domain.patches.as_ref()?;
    let count = given.iter().product::<usize>();
    let chosen = || chosen_parts::<D>(scene, ranks * threads).iter().product::<usize>();
    // threads without a patch would wait
    let is_kept = threads == 1 || count >= ranks * threads || count >= chosen();
    is_kept.then(|| std::array::from_fn(|a| given[a]))
}

/// Number of patches in each direction for `workers` threads of all ranks together.
fn chosen_parts<const D: usize>(scene: &CheckedScene, workers: usize) -> [usize; D] {
    let cells: [usize; D] = std::array::from_fn(|a| scene.cells[a]);
    let of_edge = |edge: [usize; 2]| cells.iter().map(|n| (n / edge[D - 1]).max(1)).product();
    let parts = |wanted: usize| choose_cuts(cells, wanted, LEAST_CELLS);
    match workers {
        1 if may_sleep::<D>(scene) => parts(of_edge(SLEEPING_CELLS)),
        _ if may_sleep::<D>(scene) => {
            let several: usize = of_edge(SHARED_CELLS);
            let fine: usize = of_edge(SLEEPING_CELLS);
            let least = if D > 1 { fine.min(LEAST_PATCHES_A_WORKER * workers) } else { 0 };
            parts(several.max(least).clamp(workers, PATCHES_A_WORKER * workers))
        }
        1 => [1; D],
        _ => {
            // in a plane four per worker: a long particle then widens the windows of fewer others,
            // and patch interiors are computed while messages travel
            let parts = parts(workers);
            let halves = D > 1 && (0..D).all(|a| cells[a] / parts[a] >= 2 * SHARED_CELLS[D - 1]);
            if halves { parts.map(|n| 2 * n) } else { parts }
        }
    }
}

/// Whether a body is at rest and free of stress, so that patches can be quiescent.
pub fn may_skip(scene: &CheckedScene) -> bool {
    match scene.dimension {
        1 => may_sleep::<1>(scene),
        _ => may_sleep::<2>(scene),
    }
}

/// As [`may_skip`], in `D` dimensions.
pub(super) fn may_sleep<const D: usize>(scene: &CheckedScene) -> bool {
    let mut bodies = scene.scene.bodies.iter().zip(&scene.bodies);
    let velocity = scene.grid_velocity::<D>();
    scene.skips_quiet()
        && scene.scene.body_force.is_none()
        && bodies.any(|(b, c)| c.motion.is_none() && c.velocity == velocity && b.pressure == 0.0)
}

/// The patches of a run on `ranks` ranks with `threads` threads each, dealt to ranks by their
/// particles.
pub(super) fn deal_patches<const D: usize>(
    scene: &CheckedScene,
    ranks: usize,
    threads: usize,
) -> Layout<D> {
    let layout = cut_domain(scene, ranks, threads);
    let count = |patch| count_particles(scene, &layout.patch(patch));
    let weights: Vec<u64> = (0..layout.count()).map(count).collect();
    deal_with_short_borders(layout, &weights, ranks)
}

/// Particles with which `rank` of `ranks` begins a run, one block per patch of the rank. It needs no
/// other rank.
pub fn initial_particles<const D: usize>(
    scene: &CheckedScene,
    stepper: &Stepper<D>,
    rank: usize,
    ranks: usize,
) -> Vec<Block<D>> {
    let layout = deal_patches(scene, ranks, 1);
    particles::fill(scene, stepper, &layout, rank, scene.frame().velocity(0.0))
}

/// Number of particles in the cells of `cells`, counted without creating them.
pub(super) fn count_particles<const D: usize>(scene: &CheckedScene, cells: &IndexBox<D>) -> u64 {
    scene.bodies.iter().map(|body| count_of_body(scene, body, cells)).sum()
}

/// Number of particles of `body` in the cells of `cells`, counted without creating them.
pub(super) fn count_of_body<const D: usize>(
    scene: &CheckedScene,
    body: &CheckedBody,
    cells: &IndexBox<D>,
) -> u64 {
    let x = |a: usize, cell: i64| scene.scene.domain.lower[a] + cell as f64 * scene.cell_size[a];
    if let Some(tiling) = &body.tiling {
        return tiling.count_in(particles::cell_box(cells)) as u64;
    }
    let along = |a: usize| {
        let (lower, upper) = (body.lower[a], body.upper[a]);
        let inside = upper.min(x(a, cells.upper[a])) - lower.max(x(a, cells.lower[a]));
        inside.max(0.0) / (upper - lower) * body.lattice[a] as f64
    };
    (0..D).map(along).product::<f64>().round() as u64
}

/// Weight of a particle relative to that of an empty cell when the domain is cut.
const PARTICLE_WEIGHT: u64 = 4;

/// Domain cut into patches: of equal width if they are those of the scene, otherwise with about
/// the same initial number of particles in each row and column of patches.
pub(super) fn cut_domain<const D: usize>(
    scene: &CheckedScene,
    ranks: usize,
    threads: usize,
) -> Layout<D> {
    let parts = patch_parts::<D>(scene, ranks, threads);
    let domain = IndexBox::new([0; D], std::array::from_fn(|a| scene.cells[a] as i64));
    let sides = scene.side_properties::<D>().map(|ends| ends.map(|side| side.ghosts));
    if given_parts::<D>(scene, ranks, threads).is_some() || parts == [1; D] {
        return Layout::new(domain, sides, parts);
    }
    let cuts = std::array::from_fn(|a| {
        let across = domain.count() as u64 / scene.cells[a] as u64;
        let weights: Vec<u64> = particles::slices(scene, a)
            .into_iter()
            .map(|particles| across + PARTICLE_WEIGHT * particles)
            .collect();
        even_cuts(&weights, parts[a], LEAST_CELLS)
    });
    Layout::with_cuts(domain, sides, cuts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input;

    #[test]
    fn threads_share_a_scene_of_too_few_patches() {
        let scene = |patches: &str| {
            let sets = [patches, "domain.cell_size=4e-5"].map(String::from);
            let text = include_bytes!("../../inputs/flyer_2d.json");
            input::parse(text, "flyer_2d.json", &sets).unwrap()
        };
        let given = scene("domain.patches=[2,2]");
        assert_eq!(patch_parts::<2>(&given, 2, 1), [2, 2]);
        // with one thread per rank, given patches are kept even if ranks have none
        assert_eq!(patch_parts::<2>(&given, 8, 1), [2, 2]);
        assert_eq!(patch_parts::<2>(&given, 2, 2), [2, 2]);
        let chosen = patch_parts::<2>(&scene("domain.patches=null"), 2, 4);
        assert!(chosen.iter().product::<usize>() >= 8);
        assert_eq!(patch_parts::<2>(&given, 2, 4), chosen);
        // patches that are narrower than any chosen one are kept, if there are more of them
        let narrow = scene("domain.patches=[20,10]");
        assert_eq!(patch_parts::<2>(&narrow, 101, 2), [20, 10]);
        // chosen patches have about equal numbers of particles, given ones equal widths
        let widths = |threads| {
            let layout = cut_domain::<2>(&given, 2, threads);
            let patches = (0..layout.count()).map(|patch| layout.patch(patch).extent(1));
            let widths: std::collections::BTreeSet<_> = patches.collect();
            widths.len()
        };
        assert_eq!(widths(1), 1);
        assert!(widths(4) > 1);
    }
}
