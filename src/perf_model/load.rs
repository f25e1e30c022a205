//! Who has how much: the patches of a scene, their ghosts and halos, and their ranks.

use decomp::{assign_patches, choose_cuts};

use super::machine::{COMPUTE, SERIAL};
use super::particle_density::Terrain;
use super::schedule::Schedule;
use crate::scene::{BalanceCost, CheckedScene, FilterHalo};
use crate::simulation::patch_counts;
use crate::solver::{Reach, Stepper};

/// A scene, as far as the time of its step goes.
#[derive(Clone, Debug)]
pub struct Work {
    /// Its particles.
    pub terrain: Terrain,
    /// Its step.
    pub schedule: Schedule,
    /// How far its particles reach.
    pub reach: Reach,
    /// Bytes of a particle's row with its weights \[B\].
    pub row_bytes: f64,
    /// Bytes of a ghost's row in a message \[B\].
    pub ghost_bytes: f64,
    /// Whether inner patches are computed while messages are on their way.
    pub overlap: bool,
    /// How far moving material is noticed \[cells\]; 0 if no patch sleeps.
    notice: f64,
    /// Whether loads are evened by cost.
    evened: bool,
}

/// A patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchWork {
    lower: f64,
    upper: f64,
    /// Its particles.
    pub rows: f64,
    /// Copies of others' particles.
    pub ghosts: f64,
    /// Nodes on which it computes.
    pub nodes: f64,
    /// Nodes whose values come from other patches.
    pub halo: f64,
}

/// One way to share a scene.
#[derive(Clone, Debug)]
pub struct Share {
    /// Ranks.
    pub ranks: usize,
    /// Threads of each rank.
    pub threads: usize,
    /// How filters get what lies beyond a patch.
    pub halo: FilterHalo,
    /// All patches.
    pub patches: Vec<PatchWork>,
    /// First patch of each rank that has any, and their end.
    pub starts: Vec<usize>,
}

/// What a rank does in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RankWork {
    /// What it computes, by [`COMPUTE`], on the busiest thread.
    pub compute: [f64; COMPUTE.len()],
    /// The part of it on patches that hear of no other rank.
    pub inner: [f64; COMPUTE.len()],
    /// What it packs, copies and unpacks, by [`SERIAL`].
    pub serial: [f64; SERIAL.len()],
    /// Ranks that it hears of in an exchange of rows, and in one of nodes.
    pub neighbours: [f64; 2],
    /// Bytes that come to it in one exchange of rows, and in all of nodes \[B\].
    pub bytes: [f64; 2],
    /// Share of its rows that do not stay in cache.
    pub cold: f64,
}

impl Work {
    /// The work of a scene.
    pub fn new(scene: &CheckedScene) -> Self {
        let (stepper, terrain) = (Stepper::<1>::new(scene), Terrain::new(scene));
        let reach = stepper.reach(terrain.longest).expect("the scene check refuses longer ones");
        let columns = &stepper.columns.specs;
        let ghost_columns = columns.iter().filter(|c| c.ghost).count();
        let options = &scene.scene.decomposition;
        Work {
            schedule: Schedule::of(&scene.scene.method),
            // columns, weights and their gradients, place of the first node, cell and id
            row_bytes: 8.0 * (columns.len() + 2 * reach.nodes + 2) as f64,
            // patch and kind, id, cell, columns
            ghost_bytes: 8.0 * (3 + ghost_columns) as f64,
            notice: if scene.skips_quiet() { stepper.notice(reach) as f64 } else { 0.0 },
            overlap: options.overlap,
            evened: options.balance.every > 0 && options.balance.cost == BalanceCost::Time,
            reach,
            terrain,
        }
    }

    /// The way that the program chooses for so many patches.
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

    /// Number of patches that the program makes.
    pub fn patches(scene: &CheckedScene, ranks: usize, threads: usize) -> usize {
        patch_counts(scene, ranks, threads)[0]
    }

    /// Most patches that the program makes of its own accord, or those that the scene names.
    pub fn most_patches(scene: &CheckedScene) -> usize {
        match &scene.scene.domain.patches {
            Some(patches) => patches[0],
            None => choose_cuts([scene.cells[0]], usize::MAX, crate::simulation::LEAST_CELLS)[0],
        }
    }

    /// How deep ghosts come from \[cells\].
    fn depth(&self, halo: FilterHalo) -> f64 {
        (self.reach.cells() + if halo == FilterHalo::Deep { self.reach.deeper() } else { 0 }) as f64
    }

    /// Shares the scene as the program does: patches of even width, a stretch of them a rank.
    pub fn share(&self, patches: usize, ranks: usize, threads: usize, halo: FilterHalo) -> Share {
        let (cells, depth) = (self.terrain.cells, self.depth(halo));
        let computed = if halo == FilterHalo::Deep { self.reach.deeper() as f64 } else { 0.0 };
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
                    halo: if halo == FilterHalo::Deep {
                        0.0
                    } else {
                        sides * (self.reach.halo() as f64 + 0.5)
                    },
                }
            })
            .collect();
        // a patch costs something beside its rows, and loads are evened by time
        let weight = |p: &PatchWork| match self.evened {
            true => (p.rows + 0.5 * (p.ghosts + p.nodes)).ceil() as u64 + 8,
            false => p.rows.round() as u64,
        };
        let weights: Vec<u64> = all.iter().map(weight).collect();
        let order: Vec<usize> = (0..patches).collect();
        let given = assign_patches(&weights, &order, ranks);
        let mut starts: Vec<usize> =
            (0..patches).filter(|&k| k == 0 || given[k] != given[k - 1]).collect();
        starts.push(patches);
        Share { ranks, threads, halo, patches: all, starts }
    }

    /// What each rank that has patches does in a step; `cache` is what stays near a
    /// core, of rows and of patches \[B\].
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
        // what of `reach` cells about a patch other ranks have, below and above
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
        // all rows are swept once a step at least, by each thread its part
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
        let foreign_rows: f64 = mine
            .iter()
            .map(|p| {
                let [below, above] = foreign(p, depth);
                self.terrain.particles_in(first - below, first)
                    + self.terrain.particles_in(last, last + above)
            })
            .sum();
        let reach = self.reach.halo() as f64;
        let foreign_nodes: f64 = mine.iter().map(|p| foreign(p, reach).iter().sum::<f64>()).sum();
        let node_bytes = match share.halo {
            FilterHalo::Exchange => 8.0 * schedule.node_fields * foreign_nodes,
            FilterHalo::Deep => 0.0,
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

    /// Ranks with cells within `reach` of those of rank `r`.
    fn neighbours(&self, share: &Share, r: usize, reach: f64) -> f64 {
        let count = share.starts.len() - 1;
        let mine = &share.patches[share.starts[r]..share.starts[r + 1]];
        let (first, last) = (mine[0].lower, mine[mine.len() - 1].upper);
        let end = self.terrain.cells as f64;
        // the rank of a cell
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

/// What of a set of rows that is swept again and again does not stay in a cache: none up to its
/// size, all from twice its size on, for the rows used longest ago give way first.
pub fn cold_share(swept: f64, cache: f64) -> f64 {
    if cache <= 0.0 { 0.0 } else { (swept / cache - 1.0).clamp(0.0, 1.0) }
}

/// The busiest thread's features, patches dealt to the least busy one after another, large ones
/// first.
fn busiest<const N: usize>(patches: &[[f64; N]], threads: usize) -> [f64; N] {
    let sum = |a: &[f64; N], b: &[f64; N]| std::array::from_fn(|k| a[k] + b[k]);
    if threads <= 1 {
        return patches.iter().fold([0.0; N], |a, b| sum(&a, b));
    }
    // rows and ghosts, whatever they cost
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
