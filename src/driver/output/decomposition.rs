//! What sharing the work over ranks has cost: a part of `summary.json`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::scene::{BalanceCost, FilterHalo};

/// What sharing the work has cost, over all ranks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DecompositionSummary {
    /// Step from which this run went on by a checkpoint: all that is counted here came after it;
    /// 0: the start.
    #[serde(default)]
    pub first_step: u64,
    /// How filters got what lies beyond a patch.
    pub filter_halo: FilterHalo,
    /// Whether inner patches were computed while messages were on their way.
    pub overlap: bool,
    /// Whether patches at rest were left out.
    pub skip_quiet: bool,
    /// Steps between two looks at the balance of loads; 0: none.
    pub balance_every: u64,
    /// What counted as a patch's load.
    pub balance_cost: BalanceCost,
    /// Particles times steps that were computed.
    pub particle_steps_computed: u64,
    /// Particles times steps that were left out, at rest.
    pub particle_steps_skipped: u64,
    /// Sum over steps of the particles that the busiest rank computed.
    pub busiest_particle_steps: u64,
    /// The busiest ranks' particle-steps over those of an even split \[-\]; 1 is perfect.
    pub imbalance: f64,
    /// Times that patches moved between ranks.
    pub balances: u64,
    /// Patches moved in all.
    pub patches_moved: u64,
    /// Particles that passed from one patch to another, of the same rank or not.
    pub particles_migrated: u64,
    /// Bytes that all ranks together sent in a step \[B\].
    pub bytes_per_step: f64,
    /// Messages that all ranks together sent in a step.
    pub messages_per_step: f64,
    /// Each rank.
    pub ranks: Vec<RankSummary>,
}

/// One rank.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RankSummary {
    /// Its number.
    pub rank: usize,
    /// Patches that it had at the end.
    pub patches: usize,
    /// Particles that it had at the end.
    pub particles: u64,
    /// Particles times steps that it computed.
    pub particle_steps: u64,
    /// Particles times steps that it left out, at rest.
    pub particle_steps_skipped: u64,
    /// Wall seconds of the time loop by what it did: compute, exchange, wait, migrate, balance,
    /// output, and the rest \[s\].
    pub seconds: BTreeMap<String, f64>,
    /// User CPU time of the time loop \[s\].
    pub cpu_seconds: f64,
    /// Bytes that it sent in the time loop \[B\].
    pub bytes: u64,
    /// Messages that it sent in the time loop.
    pub messages: u64,
    /// Particles that passed from one of its patches to another patch.
    pub particles_migrated: u64,
    /// Patches that it gave away.
    pub patches_moved: u64,
}

impl DecompositionSummary {
    /// Sums over the ranks of a run from the start; `steps` is the number of steps.
    pub fn new(
        filter_halo: FilterHalo,
        options: &crate::scene::Decomposition,
        steps: u64,
        busiest_particle_steps: u64,
        balances: u64,
        ranks: Vec<RankSummary>,
    ) -> Self {
        let sum = |of: fn(&RankSummary) -> u64| ranks.iter().map(of).sum::<u64>();
        let computed = sum(|r| r.particle_steps);
        let even = computed as f64 / ranks.len().max(1) as f64;
        let per_step = |total: u64| total as f64 / steps.max(1) as f64;
        DecompositionSummary {
            first_step: 0,
            filter_halo,
            overlap: options.overlap,
            skip_quiet: options.skip_quiet,
            balance_every: options.balance.every,
            balance_cost: options.balance.cost,
            particle_steps_computed: computed,
            particle_steps_skipped: sum(|r| r.particle_steps_skipped),
            busiest_particle_steps,
            imbalance: if even > 0.0 { busiest_particle_steps as f64 / even } else { 1.0 },
            balances,
            patches_moved: sum(|r| r.patches_moved),
            particles_migrated: sum(|r| r.particles_migrated),
            bytes_per_step: per_step(sum(|r| r.bytes)),
            messages_per_step: per_step(sum(|r| r.messages)),
            ranks,
        }
    }

    /// Seconds by activity, summed over the ranks.
    pub fn seconds(&self) -> BTreeMap<String, f64> {
        let mut all = BTreeMap::new();
        for (name, seconds) in self.ranks.iter().flat_map(|r| &r.seconds) {
            *all.entry(name.clone()).or_default() += seconds;
        }
        all
    }
}
