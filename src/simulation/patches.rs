//! Choice of the patches: how many in each direction, and where the domain is cut.

use decomp::{
    Block, IndexBox, Layout, SideKind, assign_patches, assign_with_short_borders, busiest_share,
    choose_cuts, even_cuts,
};

use crate::scene::{CheckedBody, CheckedScene};
use crate::solver::{Stepper, particles};

/// Narrowest useful patch [cells].
pub(crate) const LEAST_CELLS: usize = 16;

/// Patch width at which one worker loses little at the edges of quiescent patches [cells]: on a
/// line and in a plane.
const SLEEPING_CELLS: [usize; 2] = [200, 32];

/// Patches with particles per worker in a plane where no patch becomes quiescent, at most.
const MOST_BUSY_PATCHES: usize = 8;

/// Number of workers above which fewer numbers of patches are compared: each takes time for all patches.
const MANY_WORKERS: usize = 64;

/// Width from which such patches are at least two per worker [cells]: one is computed while the
/// messages of the other travel. Narrower ones cost more at their edges.
const BUSY_CELLS: usize = 32;

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
        _ if D == 1 => parts(workers),
        _ => {
            let pairs = parts(2 * workers);
            let is_wide = (0..D).all(|a| cells[a] / pairs[a] >= BUSY_CELLS);
            // in steps of a quarter of the workers, of twice all workers if there are many
            let quarters = if is_wide { 8 } else { 4 }..=4 * MOST_BUSY_PATCHES;
            let quarters = quarters.step_by(if workers > MANY_WORKERS { 8 } else { 1 });
            // patches without particles do not count
            let (filled, all) = (filled_patches(scene, pairs), pairs.iter().product::<usize>());
            let choices = quarters.map(|k| parts((k * workers * all).div_ceil(4 * filled)));
            let work = |&parts: &[usize; D]| work_of_busiest(scene, parts, workers);
            choices.min_by_key(work).expect("a range with an end above its start")
        }
    }
}

/// Number of patches with particles if the domain is cut into `parts` patches, at least 1.
fn filled_patches<const D: usize>(scene: &CheckedScene, parts: [usize; D]) -> usize {
    let layout = cut_by_work(scene, parts);
    let is_filled = |&p: &usize| count_particles(scene, &layout.patch(p)) > 0;
    (0..layout.count()).filter(is_filled).count().max(1)
}

/// Work of the busiest of `workers` if the domain is cut into `parts` patches; see [`patch_work`].
fn work_of_busiest<const D: usize>(scene: &CheckedScene, parts: [usize; D], workers: usize) -> u64 {
    let layout = cut_by_work(scene, parts);
    let patches = layout.order().patches();
    let work: Vec<u64> = patches.iter().map(|&p| patch_work(scene, &layout.patch(p))).collect();
    busiest_share(&work, &assign_patches(&work, workers), workers)
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
    scene.skips_quiet()
        && scene.scene.body_force.is_none()
        && bodies.any(|(b, c)| is_at_rest::<D>(scene, c) && b.pressure == 0.0)
}

/// Whether `body` is at rest relative to the grid at the start.
fn is_at_rest<const D: usize>(scene: &CheckedScene, body: &CheckedBody) -> bool {
    body.motion.is_none() && body.velocity == scene.grid_velocity::<D>()
}

/// The patches of a run on `ranks` ranks with `threads` threads each, assigned to ranks by their work
/// in a step.
pub(super) fn assign_domain<const D: usize>(
    scene: &CheckedScene,
    ranks: usize,
    threads: usize,
) -> Layout<D> {
    let layout = cut_domain(scene, ranks, threads);
    let work: Vec<u64> = (0..layout.count()).map(|p| patch_work(scene, &layout.patch(p))).collect();
    assign_with_short_borders(layout, &work, ranks)
}

/// Depth of the ghosts that [`patch_work`] counts: those of quadratic functions [cells].
const GHOST_CELLS: i64 = 3;

/// Expected work of a patch with the cells `cells` in a step: a ghost and the nodes around it cost
/// three quarters of an own particle.
fn patch_work<const D: usize>(scene: &CheckedScene, cells: &IndexBox<D>) -> u64 {
    let work = |cells: &IndexBox<D>| -> u64 {
        let of_body = |body| particle_work::<D>(scene, body) * count_of_body(scene, body, cells);
        scene.bodies.iter().map(of_body).sum()
    };
    match work(cells) {
        0 => 0,
        own => own + 3 * work(&cells.grow(GHOST_CELLS)),
    }
}

/// Work of a particle of `body` in a step, in quarters of that of a particle that lies still: one that
/// moves over the grid is often near more nodes, and has a stress.
fn particle_work<const D: usize>(scene: &CheckedScene, body: &CheckedBody) -> u64 {
    if is_at_rest::<D>(scene, body) { 4 } else { 5 }
}

/// Particles with which `rank` of `ranks` begins a run, one block per patch of the rank. It needs no
/// other rank.
pub fn initial_particles<const D: usize>(
    scene: &CheckedScene,
    stepper: &Stepper<D>,
    rank: usize,
    ranks: usize,
) -> Vec<Block<D>> {
    let layout = assign_domain(scene, ranks, 1);
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

/// Domain cut into patches: of equal width if they are those of the scene, otherwise with about the
/// same initial work in each row and column of patches.
pub(super) fn cut_domain<const D: usize>(
    scene: &CheckedScene,
    ranks: usize,
    threads: usize,
) -> Layout<D> {
    match given_parts::<D>(scene, ranks, threads) {
        Some(parts) => {
            let (domain, sides) = domain_and_sides(scene);
            Layout::new(domain, sides, parts)
        }
        None => cut_by_work(scene, chosen_parts(scene, ranks * threads)),
    }
}

/// Domain cut into `parts` patches with about the same initial work in each row and column.
fn cut_by_work<const D: usize>(scene: &CheckedScene, parts: [usize; D]) -> Layout<D> {
    let (domain, sides) = domain_and_sides(scene);
    let work = |body: &CheckedBody| particle_work::<D>(scene, body);
    let cuts = std::array::from_fn(|a| {
        // an empty cell costs about a quarter of a particle
        let empty = domain.count() as u64 / scene.cells[a] as u64;
        let mut weights = particles::slices(scene, a, work);
        weights.iter_mut().for_each(|weight| *weight += empty);
        even_cuts(&weights, parts[a], LEAST_CELLS)
    });
    Layout::with_cuts(domain, sides, cuts)
}

/// The cells of the domain, and the kinds of its sides.
fn domain_and_sides<const D: usize>(scene: &CheckedScene) -> (IndexBox<D>, [[SideKind; 2]; D]) {
    let domain = IndexBox::new([0; D], std::array::from_fn(|a| scene.cells[a] as i64));
    (domain, scene.side_properties::<D>().map(|ends| ends.map(|side| side.ghosts)))
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

    #[test]
    fn chosen_patches_share_the_particles_of_a_plane() {
        let plate = include_bytes!("../../inputs/flyer_2d.json").as_slice();
        let disks = include_bytes!("../../inputs/disks.json").as_slice();
        // the disks fill a quarter of the domain
        for (text, cell, most_patches) in [(plate, 1.6e-5, 5), (disks, 2e-3, 16)] {
            let sets =
                [format!("domain.cell_size={cell}"), "decomposition.skip_quiescent=false".into()];
            let scene = input::parse(text, "plane.json", &sets).unwrap();
            for workers in [2, 3, 4, 8, 16, 32, 64] {
                let layout = assign_domain::<2>(&scene, workers, 1);
                assert!((workers..=most_patches * workers).contains(&layout.count()), "{workers}");
                let patches = layout.order().patches().into_iter();
                let particles: Vec<u64> =
                    patches.map(|p| count_particles(&scene, &layout.patch(p))).collect();
                let most = busiest_share(&particles, &layout.ranks(), workers) as f64;
                let mean = particles.iter().sum::<u64>() as f64 / workers as f64;
                assert!(most < 1.3 * mean, "{cell}, {workers}: {}", most / mean);
            }
        }
    }

    #[test]
    fn particles_in_motion_count_more() {
        let text = include_bytes!("../../inputs/flyer_2d.json");
        let scene = input::parse(text, "flyer_2d.json", &[]).unwrap();
        // a box of cells inside the flyer and one of the same size inside the target
        let work =
            |lower: [i64; 2]| patch_work(&scene, &IndexBox::new(lower, lower.map(|cell| cell + 8)));
        assert_eq!(4 * work([45, 20]), 5 * work([100, 20]));
        // half of the cells hold nothing
        assert!(work([31, 20]) < work([45, 20]));
        assert_eq!(work([0, 170]), 0);
    }
}
