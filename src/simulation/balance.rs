//! Load balancing: patches move between ranks so that no rank waits for the busiest.

use decomp::{PatchLoads, busiest_share, relocate};

use super::run::Simulation;
use crate::balance::PatchLoad;
use crate::solver::clock::Activity;
use crate::solver::patch::Patch;

/// Interval in steps between measurements of the patches' cost: reading the clock costs time.
const SAMPLE_EVERY: u64 = 5;

/// Cost of moving a particle to another rank, in steps of that particle: it is packed, sent and
/// unpacked with all its columns, and its patch is set up again.
const MOVE_COST: u64 = 4;

/// Gains below this fraction of the load of the busiest rank are noise.
pub(super) const WORTH: f64 = 0.03;

/// Particles of a rank over the mean, quiescent ones included, above which quiescent patches move
/// when patches are assigned anew, ...
pub(super) const MOST_PARTICLES: f64 = 1.25;

/// ... and above which they are assigned anew even if the steps gain nothing.
const CROWDED: f64 = 1.45;

impl<const D: usize> Simulation<'_, D> {
    /// Whether the cost of patches is measured in `step`.
    pub(super) fn samples(&self, step: u64) -> bool {
        let balance = self.scene.scene.decomposition.balance;
        self.may_balance()
            && balance.cost.measures_time()
            && step.is_multiple_of(SAMPLE_EVERY.min(balance.every))
    }

    fn may_balance(&self) -> bool {
        let every = self.scene.scene.decomposition.balance.every;
        every > 0 && self.comm.size() > 1 && self.layout.count() > 1
    }

    /// Moves patches if the step is due for it and the accumulated loss exceeds the cost of moving:
    /// for any interval, the loss is at most twice the unavoidable one. Collective.
    pub(super) fn balance(&mut self) {
        let every = self.scene.scene.decomposition.balance.every;
        if !self.may_balance() || !self.step.is_multiple_of(every) {
            return;
        }
        let start = self.clock.now();
        let waited = self.comm.traffic().waited;
        let (costs, particles) = self.gather_costs();
        let (ranks, owners) = (self.comm.size(), self.layout.ranks());
        let loads = PatchLoads { work: &costs, particles: &particles };
        let wanted = loads.reassign(&owners, ranks, MOST_PARTICLES);
        let now = busiest_share(&costs, &owners, ranks);
        let then = busiest_share(&costs, &wanted, ranks);
        let moved: u64 = (0..particles.len())
            .filter(|&p| wanted[p] != owners[p])
            .map(|p| particles[p].max(1))
            .sum();
        let all = particles.iter().sum::<u64>().max(1) as f64;
        let mean = costs.iter().sum::<u64>() as f64 / all;
        let gain = (now - then.min(now)) as f64;
        let worth = gain > WORTH * now as f64;
        self.imbalance_debt += if worth { gain * every as f64 } else { 0.0 };
        let pays = self.imbalance_debt > (MOVE_COST * moved) as f64 * mean;
        // memory does not wait for a gain in time
        let most = busiest_share(&particles, &owners, ranks);
        let crowded = most as f64 > CROWDED * all / ranks as f64
            && busiest_share(&particles, &wanted, ranks) < most;
        let waited = self.comm.traffic().waited - waited;
        self.clock.event("balance", start);
        self.clock.add(Activity::Wait, waited);
        self.clock.add_since(Activity::Balance, start, waited);
        if (worth && pays) || crowded {
            self.imbalance_debt = 0.0;
            self.move_patches(&wanted);
        }
    }

    /// Cost and number of particles of every patch in the order of the layout, on every rank.
    /// Collective.
    fn gather_costs(&self) -> (Vec<u64>, Vec<u64>) {
        let rule = self.scene.scene.decomposition.balance.cost;
        let (count, order) = (self.layout.count(), self.layout.order());
        let mut sums = vec![0; 2 * count];
        let mine = self.layout.patches_of(self.comm.rank());
        for (patch, index) in self.patches.iter().zip(mine) {
            let particles = patch.block.own() as u64;
            let computed = if patch.quiescence.is_quiescent() { 0 } else { particles };
            let load = PatchLoad { particles: computed, seconds: patch.stopwatch.cost() };
            // a quiescent patch is measured too, but no step computes it
            let at = order.position(index);
            sums[at] = if computed > 0 { rule.of(&load).max(1) as i64 } else { 0 };
            sums[count + at] = particles as i64;
        }
        self.comm.sum(&mut sums);
        let mut sums = sums.into_iter().map(|t| t as u64);
        (sums.by_ref().take(count).collect(), sums.collect())
    }

    fn move_patches(&mut self, ranks: &[u32]) {
        let start = self.clock.now();
        let waited = self.comm.traffic().waited;
        let reach = self.reach.expect("known since the start");
        let new = self.layout.clone().with_ranks(self.layout.order(), ranks);
        let (depth, deeper) = (reach.depth(self.plan.ghosts), self.plan.deeper);
        let (fields, layers) = (self.stepper.fields.count, self.stepper.layers);
        let limit = self.stepper.longest_within(reach);
        // the timeline of a patch stays with the rank that computed it
        self.given_events = self.take_patch_events();
        // and so do the contact forces of its last step
        let rank = self.comm.rank();
        for (patch, index) in self.patches.iter().zip(self.layout.patches_of(rank)) {
            if new.rank_of(index) != rank {
                self.given_contact.extend(&patch.contact.forces);
            }
        }
        let patches = std::mem::take(&mut self.patches);
        let specs = &self.stepper.columns.specs;
        let (patches, moved) =
            relocate(self.comm, &self.layout, &new, patches, specs, |index, block| {
                let mut patch = Patch::new(&new, index, block);
                patch.set_arrays(&new, index, depth, deeper, fields, layers);
                patch.reach_length = limit;
                patch
            });
        self.patches = patches;
        self.layout = new;
        self.make_plan(reach);
        self.tally.balances += 1;
        self.tally.patches_moved += moved.patches;
        let waited = self.comm.traffic().waited - waited;
        self.clock.event("move patches", start);
        self.clock.add(Activity::Wait, waited);
        self.clock.add_since(Activity::Migrate, start, waited);
    }
}
