//! Patches and ranks of a run, counted from the scene alone: no particle is made, and no message is
//! sent. The patches, their ranks and the plans of the exchanges are those of a run.

use decomp::{IndexBox, Layout, PatchLoads, SideKind, busiest_share};

use super::balance::{MOST_PARTICLES, WORTH};
use super::exchange_plan::{ExchangePlan, HaloDepths, halo_depths};
use super::memory::{memory_of, seen};
use super::patches::{assign_domain, count_of_body, count_particles};
use super::quiescence::ActiveFrom;
use crate::effects;
use crate::scene::{CheckedScene, FilterHalo};
use crate::solver::{StencilRadius, Stepper};

/// Largest number of ranks that are all counted; of more ranks some are counted.
const MOST_COUNTED: usize = 64;

/// Number of these that have most particles.
const FULLEST: usize = 8;

/// Cost of a ghost and of a node relative to a particle, and of a patch: the load by which patches
/// are assigned to ranks when a run measures their times.
const GHOST_COST: f64 = 0.5;
const PATCH_COST: u64 = 8;

/// Size of a word of a message \[B\].
const WORD: u64 = 8;

/// Numbers of ranks and threads, halo and time for which the layout of a scene is counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WantedLayout {
    /// Number of ranks.
    pub ranks: usize,
    /// Threads of each rank.
    pub threads: usize,
    /// How filters obtain values beyond a patch; `None`: as the scene says, or as a run chooses.
    pub halo: Option<FilterHalo>,
    /// Longest particle \[cells\]; `None`: that of the start.
    pub longest: Option<f64>,
    /// Time of the run \[s\]: patches that no wave has reached are quiescent.
    pub time: f64,
}

/// A patch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CountedPatch {
    /// Number of own particles.
    pub own: u64,
    /// Number of ghosts, images among them.
    pub ghosts: u64,
    /// Number of nodes with material on which the patch computes.
    pub nodes: f64,
    /// Number of nodes whose values come from other patches.
    pub halo: u64,
    /// Whether it needs nothing from other ranks.
    pub is_inner: bool,
    /// Whether no step computes it.
    pub is_quiescent: bool,
}

/// Patches and messages of one rank.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CountedRank {
    /// Number of the rank.
    pub rank: usize,
    /// Its patches.
    pub patches: Vec<CountedPatch>,
    /// Number of ranks to which it sends particles in each exchange of particles, and nodal values in
    /// each exchange of these.
    pub takers: [usize; 2],
    /// Size of its messages in an exchange of particles \[B\].
    pub particle_bytes: u64,
    /// Size of its messages in an exchange of one nodal field \[B\].
    pub field_bytes: u64,
    /// Memory, as estimated before a run, without outputs \[B\].
    pub memory: u64,
}

/// Patches and ranks of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct CountedLayout {
    /// How filters obtain values beyond a patch.
    pub halo: FilterHalo,
    /// Number of patches.
    pub patches: usize,
    /// Number of ranks that have patches.
    pub working: usize,
    /// These ranks, or the fullest and some others of very many.
    pub ranks: Vec<CountedRank>,
}

/// Counts the patches and ranks of `wanted`; `None` if particles are longer than any stencil.
pub fn count_layout(scene: &CheckedScene, wanted: &WantedLayout) -> Option<CountedLayout> {
    match scene.dimension {
        1 => Counter::<1>::new(scene, wanted).map(|counter| counter.count()),
        _ => Counter::<2>::new(scene, wanted).map(|counter| counter.count()),
    }
}

struct Counter<'a, const D: usize> {
    scene: &'a CheckedScene,
    wanted: &'a WantedLayout,
    stepper: Stepper<D>,
    layout: Layout<D>,
    reach: StencilRadius,
    depths: HaloDepths,
    active_from: ActiveFrom<'a, D>,
}

impl<'a, const D: usize> Counter<'a, D> {
    fn new(scene: &'a CheckedScene, wanted: &'a WantedLayout) -> Option<Self> {
        let stepper = effects::stepper::<D>(scene);
        let longest = wanted.longest.unwrap_or_else(|| stepper.longest_at_start(scene));
        let reach = stepper.reach(longest)?;
        let layout = assign_domain::<D>(scene, wanted.ranks, wanted.threads);
        let active_from = ActiveFrom::new(scene, &stepper, reach);
        let depths = match wanted.halo {
            Some(filter) => HaloDepths::of(filter, reach),
            None => halo_depths(scene, &layout, reach, wanted.ranks * wanted.threads),
        };
        Some(Counter { scene, wanted, stepper, layout, reach, depths, active_from })
    }

    fn count(mut self) -> CountedLayout {
        self.balance();
        let owners = self.layout.ranks();
        let mut held = vec![0; self.wanted.ranks];
        let order = self.layout.order();
        for (position, &rank) in owners.iter().enumerate() {
            let cells = self.layout.patch(order.patch_at(position));
            held[rank as usize] += 1 + count_particles(self.scene, &cells);
        }
        let working: Vec<usize> = (0..held.len()).filter(|&rank| held[rank] > 0).collect();
        let counted = some_ranks(&working, &held);
        CountedLayout {
            halo: self.depths.filter,
            patches: owners.len(),
            working: working.len(),
            ranks: counted.into_iter().map(|rank| self.rank(rank)).collect(),
        }
    }

    /// Assigns the patches to ranks by their loads, as a run does once it has measured them.
    fn balance(&mut self) {
        let balance = self.scene.scene.decomposition.balance;
        let ranks = self.wanted.ranks;
        if self.wanted.time <= 0.0 || balance.every == 0 || ranks == 1 {
            return;
        }
        let order = self.layout.order();
        let patches = (0..self.layout.count()).map(|k| self.patch(order.patch_at(k), true));
        let patches: Vec<CountedPatch> = patches.collect();
        let load = |patch: &CountedPatch| match patch.is_quiescent || patch.own == 0 {
            true => 0,
            false if balance.cost.measures_time() => {
                let others = patch.ghosts as f64 + patch.nodes;
                patch.own + (GHOST_COST * others).ceil() as u64 + PATCH_COST
            }
            false => patch.own,
        };
        let work: Vec<u64> = patches.iter().map(load).collect();
        let particles: Vec<u64> = patches.iter().map(|patch| patch.own).collect();
        let owners = self.layout.ranks();
        let loads = PatchLoads { work: &work, particles: &particles };
        let new = loads.reassign(&owners, ranks, MOST_PARTICLES);
        let [now, then] = [&owners, &new].map(|of| busiest_share(&work, of, ranks) as f64);
        if now - then > WORTH * now {
            self.layout = self.layout.clone().with_ranks(order, &new);
        }
    }

    fn rank(&self, rank: usize) -> CountedRank {
        let plan = ExchangePlan::new(
            self.scene,
            &self.stepper,
            &self.layout,
            self.reach,
            rank,
            self.depths,
        );
        let patches = self.layout.patches_of(rank).into_iter().zip(&plan.inner_particles);
        let count = |cells: &IndexBox<D>| count_particles(self.scene, cells);
        let columns = self.stepper.columns.specs.iter().filter(|spec| spec.ghost).count();
        let (node_takers, values) = match self.depths.filter {
            FilterHalo::Exchange => (plan.nodes.send_ranks().len(), plan.nodes.values_sent()),
            FilterHalo::Redundant => (0, 0),
        };
        let depths = (self.reach, self.depths.ghosts);
        CountedRank {
            rank,
            patches: patches.map(|(patch, &is_inner)| self.patch(patch, is_inner)).collect(),
            takers: [plan.particles.send_ranks().len(), node_takers],
            particle_bytes: WORD * plan.particles.ghost_words(columns, &count),
            field_bytes: WORD * values as u64,
            memory: memory_of(self.scene, &self.stepper, &self.layout, rank, depths),
        }
    }

    fn patch(&self, patch: usize, is_inner: bool) -> CountedPatch {
        let HaloDepths { filter, ghosts, deeper } = self.depths;
        let cells = self.layout.patch(patch);
        let own = count_particles(self.scene, &cells);
        CountedPatch {
            own,
            ghosts: seen(self.scene, &self.layout, patch, ghosts).saturating_sub(own),
            nodes: self.cells_with_material(&cells.grow(deeper)),
            halo: match filter {
                FilterHalo::Exchange => self.halo_nodes(&cells),
                FilterHalo::Redundant => 0,
            },
            is_inner,
            is_quiescent: self.active_from.time(&cells) > self.wanted.time,
        }
    }

    /// Number of cells of `cells` and of their images that are filled, as fractions of full cells.
    fn cells_with_material(&self, cells: &IndexBox<D>) -> f64 {
        let domain = self.layout.domain();
        let images = self.layout.images(self.depths.deeper);
        let sources = images.iter().map(|image| image.source_cells(cells).intersect(domain));
        let sources = sources.filter(|source| !source.is_empty());
        sources.map(|source| filled_cells(self.scene, &source)).sum()
    }

    /// Number of nodes of the halo of a patch with the cells `cells` that lie in the domain, or beyond
    /// periodic sides.
    fn halo_nodes(&self, cells: &IndexBox<D>) -> u64 {
        let domain = self.layout.domain();
        let mut all = cells.grow(self.reach.halo());
        for (a, sides) in self.layout.sides().iter().enumerate() {
            if sides[0] != SideKind::Wrap {
                all.lower[a] = all.lower[a].max(domain.lower[a]);
                all.upper[a] = all.upper[a].min(domain.upper[a]);
            }
        }
        let nodes = |b: &IndexBox<D>| (0..D).map(|a| b.extent(a) as u64 + 1).product::<u64>();
        // of a shared face every patch owns the nodes of its lower sides
        nodes(&all) - cells.count() as u64
    }
}

/// Number of cells of `cells` that are filled, as fractions of full cells.
fn filled_cells<const D: usize>(scene: &CheckedScene, cells: &IndexBox<D>) -> f64 {
    let bodies = scene.bodies.iter().zip(&scene.scene.bodies);
    let filled = bodies.map(|(checked, body)| {
        let given = checked.tiling.is_some() && body.positions.is_none();
        let density = match given {
            true => body.particles_per_cell(D).iter().product::<usize>() as f64,
            false => {
                let length = |a: usize| (checked.upper[a] - checked.lower[a]) / scene.cell_size[a];
                checked.particles as f64 / (0..D).map(length).product::<f64>()
            }
        };
        count_of_body(scene, checked, cells) as f64 / density
    });
    filled.sum()
}

/// All of `ranks`, or of very many the fullest and others at even distances; `held` is what each rank
/// holds.
fn some_ranks(ranks: &[usize], held: &[u64]) -> Vec<usize> {
    if ranks.len() <= MOST_COUNTED {
        return ranks.to_vec();
    }
    let mut fullest = ranks.to_vec();
    fullest.sort_by_key(|&rank| std::cmp::Reverse(held[rank]));
    let even = MOST_COUNTED - FULLEST;
    let others = (0..even).map(|k| ranks[k * ranks.len() / even]);
    let mut some: Vec<usize> = fullest.into_iter().take(FULLEST).chain(others).collect();
    some.sort_unstable();
    some.dedup();
    some
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_ranks_the_fullest_and_some_others_are_counted() {
        let held: Vec<u64> = (0..1000).map(|rank| 5 + u64::from(rank == 501)).collect();
        let ranks: Vec<usize> = (0..1000).collect();
        let some = some_ranks(&ranks, &held);
        assert!(some.len() <= MOST_COUNTED && some.len() >= MOST_COUNTED - FULLEST);
        assert!(some.contains(&501) && some.is_sorted());
        assert_eq!(some_ranks(&ranks[..64], &held), &ranks[..64]);
    }
}
