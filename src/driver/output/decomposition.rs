//! Costs of the distribution over ranks: a part of `summary.json`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::scene::{BalanceCost, FilterHalo};

/// Costs of the distribution over ranks, for all ranks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DecompositionSummary {
    /// Step at which the run was restarted from a checkpoint; 0: it was not. All counts here are
    /// from this step on.
    #[serde(default)]
    pub first_step: u64,
    /// How filters obtain values beyond a patch.
    pub filter_halo: FilterHalo,
    /// Whether inner patches were computed while messages were on their way.
    pub overlap: bool,
    /// Whether quiescent patches were skipped.
    pub skip_quiescent: bool,
    /// Steps between two checks of the load balance; 0: no balancing.
    pub balance_every: u64,
    /// Measure of the load of a patch.
    pub balance_cost: BalanceCost,
    /// Particles times steps that were computed.
    pub particle_steps_computed: u64,
    /// Particles times steps that were skipped in quiescent patches.
    pub particle_steps_skipped: u64,
    /// Sum over steps of the particles computed by the busiest rank.
    pub busiest_particle_steps: u64,
    /// Particle-steps of the busiest ranks over those of an even distribution \[-\]; 1 is perfect.
    pub imbalance: f64,
    /// Number of times that patches moved between ranks.
    pub balances: u64,
    /// Total number of patches moved.
    pub patches_moved: u64,
    /// Particles that moved from one patch to another, on the same rank or not.
    pub particles_migrated: u64,
    /// Bytes sent per step by all ranks together \[B\].
    pub bytes_per_step: f64,
    /// Number of messages sent per step by all ranks together \[-\].
    pub messages_per_step: f64,
    /// Values of each rank.
    pub ranks: Vec<RankSummary>,
}

/// Work and messages of one rank.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RankSummary {
    /// Number of the rank.
    pub rank: usize,
    /// Patches of the rank at the end.
    pub patches: usize,
    /// Particles of the rank at the end.
    pub particles: u64,
    /// Particles times steps that the rank computed.
    pub particle_steps: u64,
    /// Particles times steps that the rank skipped in quiescent patches.
    pub particle_steps_skipped: u64,
    /// Wall time of the time loop by activity: compute, exchange, wait, migrate, balance, output,
    /// and the rest \[s\].
    pub seconds: BTreeMap<String, f64>,
    /// User CPU time of the time loop \[s\].
    pub cpu_seconds: f64,
    /// Bytes that the rank sent in the time loop \[B\].
    pub bytes: u64,
    /// Messages that the rank sent in the time loop.
    pub messages: u64,
    /// Bytes that the rank received in the time loop for profiles, histories, fields and
    /// checkpoints \[B\].
    #[serde(default)]
    pub output_bytes_received: u64,
    /// Particles that moved from a patch of the rank to another patch.
    pub particles_migrated: u64,
    /// Patches that the rank gave away.
    pub patches_moved: u64,
}

impl DecompositionSummary {
    /// Sums over the ranks of a run without restart; `steps` is the number of steps.
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
            skip_quiescent: options.skip_quiescent,
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

    /// Wall time by activity, summed over the ranks \[s\].
    pub fn seconds(&self) -> BTreeMap<String, f64> {
        let mut all = BTreeMap::new();
        for (name, seconds) in self.ranks.iter().flat_map(|r| &r.seconds) {
            *all.entry(name.clone()).or_default() += seconds;
        }
        all
    }
}
