//! Costs of a run over all ranks, gathered at rank 0.

use std::time::Instant;

use decomp::{Comm, Traffic, bytes_of, words_of};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::driver::output::decomposition::{DecompositionSummary, RankSummary};
use crate::driver::output::trace::TraceEvent;
use crate::scene::Decomposition;
use crate::simulation::Simulation;
use crate::solver::clock::{Activity, Event, user_cpu_seconds};

/// Each rank's value at rank 0, by rank; empty on other ranks. Collective.
fn gather<T: Serialize + DeserializeOwned>(comm: &dyn Comm, value: &T) -> Vec<T> {
    let text = serde_json::to_vec(value).expect("accounts are plain data");
    let all = comm.gather(&words_of(&text));
    let read = |words: &Vec<u64>| serde_json::from_slice(&bytes_of(words));
    all.iter().map(|w| read(w).expect("a rank sends what it serialized")).collect()
}

/// The state of this rank's counters at the start of its time loop.
pub struct LoopStart {
    time: Instant,
    cpu: f64,
    traffic: Traffic,
}

/// What this rank has used in its time loop.
pub struct LoopUse {
    /// Wall time \[s\].
    pub wall: f64,
    /// User CPU time \[s\].
    pub cpu: f64,
    /// Bytes that it has sent.
    pub bytes: u64,
    /// Messages that it has sent.
    pub messages: u64,
    /// Bytes that it has received for outputs.
    pub output_bytes: u64,
}

impl LoopStart {
    /// Reads the counters.
    pub fn now(comm: &dyn Comm) -> Self {
        LoopStart { time: Instant::now(), cpu: user_cpu_seconds(), traffic: comm.traffic() }
    }

    /// What was used since then; `output_bytes` were received for outputs.
    pub fn end(self, comm: &dyn Comm, output_bytes: u64) -> LoopUse {
        let traffic = comm.traffic();
        LoopUse {
            wall: self.time.elapsed().as_secs_f64(),
            cpu: user_cpu_seconds() - self.cpu,
            bytes: traffic.bytes - self.traffic.bytes,
            messages: traffic.messages - self.traffic.messages,
            output_bytes,
        }
    }
}

/// Costs of a run over all ranks.
pub struct Costs {
    /// Work and messages by rank.
    pub decomposition: DecompositionSummary,
    /// Wall time of the time loop of rank 0 \[s\].
    pub loop_wall: f64,
    /// User CPU time of the time loops \[s\].
    pub loop_cpu: f64,
    /// User CPU time of the other ranks \[s\].
    pub others_cpu: f64,
    /// Share of each [part](crate::solver::parts) of a step in the ranks' computing time \[-\];
    /// `None` without samples.
    pub step_shares: Option<Vec<f64>>,
}

/// Costs over all ranks, at rank 0, from what each has `used` in its time loop. Collective.
pub fn costs<const D: usize>(
    comm: &dyn Comm,
    simulation: &mut Simulation<'_, D>,
    options: &Decomposition,
    used: &LoopUse,
) -> Option<Costs> {
    let decomposition = decomposition(comm, simulation, options, used);
    let step_shares = step_shares(comm, simulation);
    let spent = comm.gather(&[used.cpu.to_bits(), user_cpu_seconds().to_bits()]);
    let seconds = |rank: &[u64], k: usize| f64::from_bits(rank[k]);
    let loop_cpu: f64 = spent.iter().map(|r| seconds(r, 0)).sum();
    Some(Costs {
        decomposition: decomposition?,
        loop_wall: used.wall,
        // a run shorter than the clock's tick has no CPU time
        loop_cpu: if loop_cpu > 0.0 { loop_cpu } else { used.wall },
        others_cpu: spent.iter().skip(1).map(|r| seconds(r, 1)).sum(),
        step_shares,
    })
}

/// Work and messages of all ranks, at rank 0. Collective.
fn decomposition<const D: usize>(
    comm: &dyn Comm,
    simulation: &mut Simulation<'_, D>,
    options: &Decomposition,
    used: &LoopUse,
) -> Option<DecompositionSummary> {
    let tally = simulation.tally();
    let spent = simulation.clock().seconds;
    let named = Activity::ALL.iter().zip(spent).map(|(a, s)| (a.name().to_string(), s));
    let rest = ("rest".to_string(), (used.wall - spent.iter().sum::<f64>()).max(0.0));
    let mine = RankSummary {
        rank: comm.rank(),
        patches: simulation.layout().patches_of(comm.rank()).len(),
        particles: simulation.particles(),
        particle_steps: tally.particle_steps,
        particle_steps_skipped: tally.skipped_particle_steps,
        seconds: named.chain([rest]).collect(),
        cpu_seconds: used.cpu,
        bytes: used.bytes,
        messages: used.messages,
        output_bytes_received: used.output_bytes,
        particles_migrated: tally.migrated,
        patches_moved: tally.patches_moved,
    };
    let ranks = gather(comm, &mine);
    (comm.rank() == 0).then(|| {
        let (steps, halo) = (simulation.steps_made(), simulation.filter_halo());
        let first_step = simulation.steps() - steps;
        let (busiest, balances) = (tally.busiest_particle_steps, tally.balances);
        let all = DecompositionSummary::new(halo, options, steps, busiest, balances, ranks);
        DecompositionSummary { first_step, ..all }
    })
}

/// The timelines of all ranks, at rank 0; empty on other ranks. Collective.
pub fn timeline<const D: usize>(
    comm: &dyn Comm,
    simulation: &mut Simulation<'_, D>,
) -> Vec<TraceEvent> {
    let rank = comm.rank();
    let line = |tid: usize, event: Event| TraceEvent {
        name: event.name.to_string(),
        pid: rank,
        tid,
        step: event.step,
        ts: event.start as f64 * 1e-3,
        dur: event.length as f64 * 1e-3,
    };
    let mut mine: Vec<TraceEvent> =
        simulation.clock().events.drain(..).map(|e| line(0, e)).collect();
    for (patch, event) in simulation.take_patch_events() {
        mine.push(line(patch + 1, event));
    }
    gather(comm, &mine).into_iter().flatten().collect()
}

/// Share of each [part](crate::solver::parts) of a step in the ranks' computing time, from samples;
/// at rank 0, and `None` without samples. Collective.
fn step_shares<const D: usize>(
    comm: &dyn Comm,
    simulation: &Simulation<'_, D>,
) -> Option<Vec<f64>> {
    let all: Vec<(f64, Vec<f64>)> = gather(comm, &simulation.part_seconds());
    let total: f64 = all.iter().map(|(computed, _)| computed).sum();
    let count = all.iter().map(|(_, parts)| parts.len()).max().unwrap_or(0);
    let share = |k: usize| all.iter().filter_map(|(_, parts)| parts.get(k)).sum::<f64>() / total;
    (total > 0.0).then(|| (0..count).map(share).collect())
}
