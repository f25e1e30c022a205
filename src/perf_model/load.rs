//! Distribution of the work: patches of a scene with their ghosts and halos, and their ranks.

use super::machine::{COMPUTE, SERIAL};
use super::schedule::StepCounts;
use crate::effects;
use crate::scene::{CheckedScene, FilterHalo};
use crate::simulation::{
    CountedLayout, CountedPatch, CountedRank, LEAST_CELLS, WantedLayout, count_layout, may_skip,
    patch_counts,
};
use crate::solver::StencilRadius;

/// Number of times in a run at which quiescent patches are counted.
const TIMES: usize = 8;

/// Properties of a scene that determine the time of a step.
#[derive(Clone, Debug)]
pub struct Work {
    /// Number of particles \[-\].
    pub particles: f64,
    /// Counts of a step.
    pub schedule: StepCounts,
    /// Reach of the particles on the grid.
    pub reach: StencilRadius,
    /// Memory of a particle with its weights \[B\].
    pub row_bytes: f64,
    /// Whether inner patches are computed while messages are in flight.
    pub overlap: bool,
    /// Size of a checkpoint, all ranks together \[B\].
    pub checkpoint_bytes: f64,
}

/// One distribution of a scene over ranks.
#[derive(Clone, Debug)]
pub struct Share {
    /// Ranks.
    pub ranks: usize,
    /// Threads of each rank.
    pub threads: usize,
    /// Patches and messages of the ranks.
    pub layout: CountedLayout,
}

/// Work of one rank in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RankWork {
    /// Number of its patches \[-\].
    pub patches: f64,
    /// Numbers of the things that the busiest thread computes, in the order of [`COMPUTE`] \[-\].
    pub compute: [f64; COMPUTE.len()],
    /// Part of these numbers on patches that need no data from other ranks \[-\].
    pub inner: [f64; COMPUTE.len()],
    /// Numbers of the things that the rank packs, copies and unpacks, in the order of [`SERIAL`]
    /// \[-\].
    pub serial: [f64; SERIAL.len()],
    /// Number of ranks to which it sends ghost particles, and nodal values \[-\].
    pub neighbours: [f64; 2],
    /// Bytes sent in one exchange of ghost particles, and in all exchanges of nodal values \[B\].
    pub bytes: [f64; 2],
    /// Fraction of its particles that do not stay in cache \[-\].
    pub cold: f64,
}

impl Work {
    /// The work of a scene.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn new(scene: &CheckedScene) -> Self {
        let (columns, state_bytes, reach) = match scene.dimension {
            1 => particle_sizes::<1>(scene),
            _ => particle_sizes::<2>(scene),
        };
        let reach = reach.expect("the scene check refuses longer particles");
        let weights = (1 + scene.dimension) * reach.nodes.pow(scene.dimension as u32);
        Work {
            particles: scene.particles as f64,
            schedule: StepCounts::of(scene),
            // columns, weights and their gradients, index of the first node, cell and id
            row_bytes: 8.0 * (columns + weights + 2) as f64,
            overlap: scene.scene.decomposition.overlap,
            reach,
            checkpoint_bytes: scene.particles as f64 * state_bytes as f64,
        }
    }

    /// Largest number of patches with `threads` threads a rank: that of the scene file, which is no
    /// limit for several threads, else the number with the narrowest patches.
    pub fn most_patches(scene: &CheckedScene, threads: usize) -> usize {
        let given = scene.scene.domain.patches.as_ref().map(|p| p.iter().product::<usize>());
        match given {
            Some(given) if threads == 1 => given,
            _ => {
                let cells = scene.cells.iter().map(|n| (n / LEAST_CELLS).max(1));
                let chosen: usize = patch_counts(scene, 1, 1).iter().product();
                cells.product::<usize>().max(chosen).max(given.unwrap_or(1))
            }
        }
    }

    /// Times of a run \[s\] at which the distribution differs: several if patches may be quiescent.
    pub fn times(scene: &CheckedScene) -> Vec<f64> {
        let count = if may_skip(scene) { TIMES } else { 1 };
        let end = scene.scene.time.end;
        (0..count).map(|k| end * (k as f64 + 0.5) / count as f64).collect()
    }

    /// Distributes the scene as the program does, at a `time` of the run \[s\]; at 0, before a first
    /// balance of the loads. `halo` replaces the method that the program chooses.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn share(
        scene: &CheckedScene,
        ranks: usize,
        threads: usize,
        halo: Option<FilterHalo>,
        time: f64,
    ) -> Share {
        let wanted = WantedLayout { ranks, threads, halo, longest: None, time };
        Self::share_of(scene, &wanted).expect("the scene check refuses longer particles")
    }

    /// Distributes the scene as `wanted`; `None` if particles are longer than any stencil.
    pub fn share_of(scene: &CheckedScene, wanted: &WantedLayout) -> Option<Share> {
        let layout = count_layout(scene, wanted)?;
        Some(Share { ranks: wanted.ranks, threads: wanted.threads, layout })
    }

    /// Work of each counted rank. `cache`: effective cache sizes for particles and for patches
    /// \[B\].
    pub fn rank_works(&self, share: &Share, cache: [f64; 2]) -> Vec<RankWork> {
        share.layout.ranks.iter().map(|rank| self.rank_work(share, rank, cache)).collect()
    }

    fn rank_work(&self, share: &Share, rank: &CountedRank, cache: [f64; 2]) -> RankWork {
        let (schedule, halo) = (&self.schedule, share.layout.halo);
        let sum = |of: fn(&CountedPatch) -> u64| rank.patches.iter().map(of).sum::<u64>() as f64;
        let (rows, ghosts) = (sum(|p| p.own), sum(|p| p.ghosts));
        let active = || rank.patches.iter().filter(|p| !p.is_quiescent);
        // each thread sweeps through all of its particles at least once per step
        let threads = share.threads.min(rank.patches.len()).max(1) as f64;
        let swept: f64 = active().map(|p| (p.own + p.ghosts) as f64).sum();
        let swept = swept / threads * self.row_bytes;
        let [cold, cold_patch] = cache.map(|cache| cold_share(swept, cache));
        let features = |p: &CountedPatch| {
            let own = p.own as f64;
            [own, cold * (p.own + p.ghosts) as f64, p.ghosts as f64, p.nodes, 1.0, cold_patch]
        };
        let of = |is_inner: bool| {
            let some: Vec<_> = active().filter(|p| p.is_inner == is_inner).map(features).collect();
            busiest(&some, share.threads)
        };
        let (inner, border) = (of(true), of(false));
        let exchanges = schedule.exchanges(halo);
        let sends = schedule.row_exchanges;
        RankWork {
            patches: rank.patches.len() as f64,
            compute: std::array::from_fn(|k| inner[k] + border[k]),
            inner,
            serial: [
                sends * rows,
                sends * ghosts,
                schedule.node_fields * sum(|p| p.halo),
                exchanges * rank.patches.len() as f64,
                exchanges,
                1.0,
            ],
            neighbours: rank.takers.map(|takers| takers as f64),
            bytes: [rank.particle_bytes as f64, schedule.node_fields * rank.field_bytes as f64],
            cold,
        }
    }
}

/// Messages and bytes that a rank sends in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sent {
    /// Number of messages \[-\].
    pub messages: f64,
    /// Size of these messages \[B\].
    pub bytes: f64,
}

impl Work {
    /// Numbers of exchanges of ghost particles and of nodal values in a step \[-\].
    pub fn exchanges(&self, share: &Share) -> [f64; 2] {
        let nodes = self.schedule.exchanges(share.layout.halo) - self.schedule.row_exchanges;
        [self.schedule.row_exchanges, nodes]
    }

    /// Messages and bytes of each counted rank in a step.
    pub fn sent(&self, share: &Share) -> Vec<Sent> {
        let [particles, nodes] = self.exchanges(share);
        let of = |rank: &CountedRank| {
            let [to_particles, to_nodes] = rank.takers.map(|takers| takers as f64);
            let fields = self.schedule.node_fields * rank.field_bytes as f64;
            Sent {
                messages: particles * to_particles + nodes * to_nodes,
                bytes: particles * rank.particle_bytes as f64 + fields,
            }
        };
        share.layout.ranks.iter().map(of).collect()
    }
}

impl Share {
    /// Fraction of the particles that no step computes \[-\].
    pub fn skipped(&self) -> f64 {
        let patches = || self.layout.ranks.iter().flat_map(|rank| &rank.patches);
        let all: u64 = patches().map(|p| p.own).sum();
        let skipped: u64 = patches().filter(|p| p.is_quiescent).map(|p| p.own).sum();
        skipped as f64 / all.max(1) as f64
    }

    /// Memory of the rank that needs most, without outputs \[B\].
    pub fn most_memory(&self) -> u64 {
        self.layout.ranks.iter().map(|rank| rank.memory).max().unwrap_or(0)
    }
}

/// Number of columns of a particle, bytes of its state, and the reach of the particles.
fn particle_sizes<const D: usize>(scene: &CheckedScene) -> (usize, usize, Option<StencilRadius>) {
    let stepper = effects::stepper::<D>(scene);
    let columns = &stepper.columns;
    let reach = stepper.reach(stepper.longest_at_start(scene));
    (columns.specs.len(), columns.state_bytes(D), reach)
}

/// Fraction of `swept` bytes of repeatedly swept data that does not stay in a cache of `cache`
/// bytes \[-\]: none up to the size of the cache, all from twice its size, because the least
/// recently used data are evicted first.
pub fn cold_share(swept: f64, cache: f64) -> f64 {
    if cache <= 0.0 { 0.0 } else { (swept / cache - 1.0).clamp(0.0, 1.0) }
}

/// Counts of the busiest thread. Patches are assigned to the least busy thread, large ones first.
fn busiest<const N: usize>(patches: &[[f64; N]], threads: usize) -> [f64; N] {
    let sum = |a: &[f64; N], b: &[f64; N]| std::array::from_fn(|k| a[k] + b[k]);
    if threads <= 1 {
        return patches.iter().fold([0.0; N], |a, b| sum(&a, b));
    }
    // own and ghost particles, regardless of their cost
    let load = |p: &[f64; N]| p[0] + p[2];
    let mut sorted: Vec<&[f64; N]> = patches.iter().collect();
    sorted.sort_by(|a, b| load(b).total_cmp(&load(a)));
    let mut loads = vec![[0.0; N]; threads.min(patches.len().max(1))];
    for patch in sorted {
        let least = loads.iter_mut().min_by(|a, b| load(a).total_cmp(&load(b)));
        let least = least.expect("at least one thread");
        *least = sum(least, patch);
    }
    loads.into_iter().max_by(|a, b| load(a).total_cmp(&load(b))).unwrap_or([0.0; N])
}
