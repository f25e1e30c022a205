//! Distribution of the work: patches of a scene with their ghosts and halos, and their ranks.

use decomp::{assign_patches, choose_cuts};

use super::machine::{COMPUTE, SERIAL};
use super::particle_density::Terrain;
use super::schedule::StepCounts;
use crate::effects;
use crate::scene::{CheckedScene, FilterHalo};
use crate::simulation::patch_counts;
use crate::solver::StencilRadius;

/// Properties of a scene that determine the time of a step.
#[derive(Clone, Debug)]
pub struct Work {
    /// Particles over the cells.
    pub terrain: Terrain,
    /// Counts of a step.
    pub schedule: StepCounts,
    /// Reach of the particles on the grid.
    pub reach: StencilRadius,
    /// Memory of a particle with its weights \[B\].
    pub row_bytes: f64,
    /// Size of a ghost particle in a message \[B\].
    pub ghost_bytes: f64,
    /// Whether inner patches are computed while messages are in flight.
    pub overlap: bool,
    /// Distance at which moving material activates a patch \[cells\]; 0 if no patch is quiescent.
    notice: f64,
    /// Whether loads are balanced by measured cost.
    evened: bool,
}

/// A patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchWork {
    lower: f64,
    upper: f64,
    /// Number of own particles \[-\].
    pub rows: f64,
    /// Number of ghost particles \[-\].
    pub ghosts: f64,
    /// Number of nodes on which the patch computes \[-\].
    pub nodes: f64,
    /// Number of nodes with values from other patches \[-\].
    pub halo: f64,
}

/// One distribution of a scene over ranks.
#[derive(Clone, Debug)]
pub struct Share {
    /// Ranks.
    pub ranks: usize,
    /// Threads of each rank.
    pub threads: usize,
    /// How filters get values outside of a patch.
    pub halo: FilterHalo,
    /// All patches.
    pub patches: Vec<PatchWork>,
    /// First patch of each rank that has patches, and the end of the last.
    pub starts: Vec<usize>,
}

/// Work of one rank in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RankWork {
    /// Numbers of the things that the busiest thread computes, in the order of [`COMPUTE`] \[-\].
    pub compute: [f64; COMPUTE.len()],
    /// Part of these numbers on patches that need no data from other ranks \[-\].
    pub inner: [f64; COMPUTE.len()],
    /// Numbers of the things that the rank packs, copies and unpacks, in the order of [`SERIAL`]
    /// \[-\].
    pub serial: [f64; SERIAL.len()],
    /// Number of ranks from which it receives ghost particles, and nodal values \[-\].
    pub neighbours: [f64; 2],
    /// Bytes received in one exchange of ghost particles, and in all exchanges of nodal values
    /// \[B\].
    pub bytes: [f64; 2],
    /// Fraction of its particles that do not stay in cache \[-\].
    pub cold: f64,
}

impl Work {
    /// The work of a scene.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn new(scene: &CheckedScene) -> Self {
        let (stepper, terrain) = (effects::stepper::<1>(scene), Terrain::new(scene));
        let reach = stepper.reach(terrain.longest).expect("the scene check refuses longer ones");
        let columns = &stepper.columns.specs;
        let ghost_columns = columns.iter().filter(|c| c.ghost).count();
        let options = &scene.scene.decomposition;
        Work {
            schedule: StepCounts::of(&scene.scene.method),
            // columns, weights and their gradients, index of the first node, cell and id
            row_bytes: 8.0 * (columns.len() + 2 * reach.nodes + 2) as f64,
            // patch and kind, id, cell, columns
            ghost_bytes: 8.0 * (3 + ghost_columns) as f64,
            notice: if scene.skips_quiet() { stepper.influence_radius(reach) as f64 } else { 0.0 },
            overlap: options.overlap,
            evened: options.balance.every > 0 && options.balance.cost.measures_time(),
            reach,
            terrain,
        }
    }

    /// Halo method that the program chooses for this number of patches.
    pub fn chosen_halo(
        &self,
        scene: &CheckedScene,
        patches: usize,
        ranks: usize,
        threads: usize,
    ) -> FilterHalo {
        let narrowest = self.terrain.cells / patches.max(1);
        let choose = || FilterHalo::choose(self.reach, narrowest, ranks * threads);
        scene.scene.decomposition.filter_halo.unwrap_or_else(choose)
    }

    /// Number of patches that the program creates.
    pub fn patches(scene: &CheckedScene, ranks: usize, threads: usize) -> usize {
        patch_counts(scene, ranks, threads)[0]
    }

    /// Number of patches in the scene file, else the largest number that the program creates.
    pub fn most_patches(scene: &CheckedScene) -> usize {
        match &scene.scene.domain.patches {
            Some(patches) => patches[0],
            None => choose_cuts([scene.cells[0]], usize::MAX, crate::simulation::LEAST_CELLS)[0],
        }
    }

    /// Depth of the ghost layer \[cells\].
    fn depth(&self, halo: FilterHalo) -> f64 {
        (self.reach.cells() + if halo == FilterHalo::Redundant { self.reach.deeper() } else { 0 })
            as f64
    }

    /// Distributes the scene like the program: patches of equal width, consecutive ones on a rank.
    pub fn share(&self, patches: usize, ranks: usize, threads: usize, halo: FilterHalo) -> Share {
        let (cells, depth) = (self.terrain.cells, self.depth(halo));
        let computed = if halo == FilterHalo::Redundant { self.reach.deeper() as f64 } else { 0.0 };
        let cut = |k: usize| (k * cells / patches) as f64;
        let all: Vec<PatchWork> = (0..patches)
            .map(|k| {
                let (lower, upper) = (cut(k), cut(k + 1));
                let t = &self.terrain;
                let filled = t.filled_in(lower - computed, upper + computed);
                let sides = f64::from(u8::from(k > 0 || t.is_joined()))
                    + f64::from(u8::from(k + 1 < patches || t.is_joined()));
                PatchWork {
                    lower,
                    upper,
                    rows: t.particles_in(lower, upper),
                    ghosts: t.particles_in(lower - depth, lower)
                        + t.particles_in(upper, upper + depth),
                    nodes: filled,
                    halo: if halo == FilterHalo::Redundant {
                        0.0
                    } else {
                        sides * (self.reach.halo() as f64 + 0.5)
                    },
                }
            })
            .collect();
        // a patch has a cost besides its particles, and loads are balanced by time
        let weight = |p: &PatchWork| match self.evened {
            true => (p.rows + 0.5 * (p.ghosts + p.nodes)).ceil() as u64 + 8,
            false => p.rows.round() as u64,
        };
        let weights: Vec<u64> = all.iter().map(weight).collect();
        let given = assign_patches(&weights, ranks);
        let mut starts: Vec<usize> =
            (0..patches).filter(|&k| k == 0 || given[k] != given[k - 1]).collect();
        starts.push(patches);
        Share { ranks, threads, halo, patches: all, starts }
    }

    /// Work of each rank that has patches. `cache`: effective cache sizes for particles and for
    /// patches \[B\].
    pub fn rank_works(&self, share: &Share, cache: [f64; 2]) -> Vec<RankWork> {
        let count = share.starts.len() - 1;
        (0..count).map(|r| self.rank_work(share, r, cache)).collect()
    }

    fn rank_work(&self, share: &Share, r: usize, cache: [f64; 2]) -> RankWork {
        let mine = &share.patches[share.starts[r]..share.starts[r + 1]];
        let (first, last) = (mine[0].lower, mine[mine.len() - 1].upper);
        let (depth, schedule) = (self.depth(share.halo), &self.schedule);
        let seen = depth.max(self.notice) + 1.0;
        let alone = share.starts.len() == 2;
        let end = self.terrain.cells as f64;
        let joined = self.terrain.is_joined();
        // cells within `reach` of a patch that belong to other ranks, below and above
        let foreign = |p: &PatchWork, reach: f64| {
            let below = (first - (p.lower - reach)).max(0.0).min(reach);
            let above = (p.upper + reach - last).max(0.0).min(reach);
            if alone {
                return [0.0; 2];
            }
            let below = if joined { below } else { below.min(first) };
            let above = if joined { above } else { above.min(end - last) };
            [below, above]
        };
        let rows: f64 = mine.iter().map(|p| p.rows).sum();
        let ghosts: f64 = mine.iter().map(|p| p.ghosts).sum();
        // each thread sweeps through all of its particles at least once per step
        let threads = share.threads.min(mine.len()) as f64;
        let swept = (rows + ghosts) / threads * self.row_bytes;
        let [cold, cold_patch] = cache.map(|cache| cold_share(swept, cache));
        let features = |p: &PatchWork| [p.rows, cold * p.rows, p.ghosts, p.nodes, 1.0, cold_patch];
        let is_inner = |p: &PatchWork| foreign(p, seen) == [0.0; 2];
        let inner: Vec<_> = mine.iter().filter(|p| is_inner(p)).map(features).collect();
        let border: Vec<_> = mine.iter().filter(|p| !is_inner(p)).map(features).collect();
        let inner = busiest(&inner, share.threads);
        let border = busiest(&border, share.threads);
        let compute = std::array::from_fn(|k| inner[k] + border[k]);
        let halo: f64 = mine.iter().map(|p| p.halo).sum();
        let exchanges = schedule.exchanges(share.halo);
        let sends = schedule.row_exchanges;
        let serial = [
            sends * rows,
            sends * ghosts,
            schedule.node_fields * halo,
            exchanges * mine.len() as f64,
            exchanges,
            1.0,
        ];
        // a particle travels once, however many patches of the rank see it
        let [below, above] = mine.iter().map(|p| foreign(p, depth)).fold(
            [0.0f64; 2],
            |[below, above], [other_below, other_above]| {
                [below.max(other_below), above.max(other_above)]
            },
        );
        let foreign_rows = self.terrain.particles_in(first - below, first)
            + self.terrain.particles_in(last, last + above);
        let reach = self.reach.halo() as f64;
        let foreign_nodes: f64 = mine.iter().map(|p| foreign(p, reach).iter().sum::<f64>()).sum();
        let node_bytes = match share.halo {
            FilterHalo::Exchange => 8.0 * schedule.node_fields * foreign_nodes,
            FilterHalo::Redundant => 0.0,
        };
        RankWork {
            compute,
            inner,
            serial,
            neighbours: [self.neighbours(share, r, seen), self.neighbours(share, r, reach + 1.0)],
            bytes: [foreign_rows * self.ghost_bytes, node_bytes],
            cold,
        }
    }

    /// Number of ranks with cells within `reach` of those of rank `r`.
    fn neighbours(&self, share: &Share, r: usize, reach: f64) -> f64 {
        let count = share.starts.len() - 1;
        let mine = &share.patches[share.starts[r]..share.starts[r + 1]];
        let (first, last) = (mine[0].lower, mine[mine.len() - 1].upper);
        let end = self.terrain.cells as f64;
        // rank that owns a cell
        let rank_of = |cell: f64| {
            let patch = share.patches.partition_point(|p| p.upper <= cell);
            share.starts.partition_point(|&s| s <= patch.min(share.patches.len() - 1)) - 1
        };
        let lowest = rank_of((first - reach).max(0.0)).min(r);
        let highest = rank_of((last + reach - 1.0).min(end - 1.0)).max(r);
        let mut found = highest - lowest;
        if self.terrain.is_joined() {
            if first - reach < 0.0 {
                found += count - rank_of((first - reach + end).max(0.0)).min(count);
            }
            if last + reach > end {
                found += rank_of((last + reach - 1.0 - end).min(end - 1.0)) + 1;
            }
        }
        found.min(count - 1) as f64
    }
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
