//! Statistics of all ranks of a run, gathered at rank 0.

use decomp::{Comm, Traffic, bytes_of, words_of};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::driver::output::decomposition::{DecompositionSummary, RankSummary};
use crate::driver::output::trace::TraceEvent;
use crate::simulation::Simulation;
use crate::solver::clock::{Activity, Event};

/// Each rank's value at rank 0, by rank; empty on other ranks. Collective.
fn gather<T: Serialize + DeserializeOwned>(comm: &dyn Comm, value: &T) -> Vec<T> {
    let text = serde_json::to_vec(value).expect("accounts are plain data");
    let all = comm.gather(&words_of(&text));
    let read = |words: &Vec<u64>| serde_json::from_slice(&bytes_of(words));
    all.iter().map(|w| read(w).expect("a rank sends what it serialized")).collect()
}

/// Work and messages of all ranks, at rank 0. On this rank the time loop took `wall` and `cpu`
/// seconds and received `output_bytes` for outputs; its traffic was `before` at the start of the
/// loop. Collective.
pub fn decomposition<const D: usize>(
    comm: &dyn Comm,
    simulation: &mut Simulation<'_, D>,
    options: &crate::scene::Decomposition,
    wall: f64,
    cpu: f64,
    output_bytes: u64,
    before: Traffic,
) -> Option<DecompositionSummary> {
    let (traffic, tally) = (comm.traffic(), simulation.tally());
    let spent = simulation.clock().seconds;
    let named = Activity::ALL.iter().zip(spent).map(|(a, s)| (a.name().to_string(), s));
    let rest = ("rest".to_string(), (wall - spent.iter().sum::<f64>()).max(0.0));
    let mine = RankSummary {
        rank: comm.rank(),
        patches: simulation.layout().patches_of(comm.rank()).len(),
        particles: simulation.particles(),
        particle_steps: tally.particle_steps,
        particle_steps_skipped: tally.skipped_particle_steps,
        seconds: named.chain([rest]).collect(),
        cpu_seconds: cpu,
        bytes: traffic.bytes - before.bytes,
        messages: traffic.messages - before.messages,
        output_bytes_received: output_bytes,
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
pub fn step_shares<const D: usize>(
    comm: &dyn Comm,
    simulation: &Simulation<'_, D>,
) -> Option<Vec<f64>> {
    let all: Vec<(f64, Vec<f64>)> = gather(comm, &simulation.part_seconds());
    let total: f64 = all.iter().map(|(computed, _)| computed).sum();
    let count = all.iter().map(|(_, parts)| parts.len()).max().unwrap_or(0);
    let share = |k: usize| all.iter().filter_map(|(_, parts)| parts.get(k)).sum::<f64>() / total;
    (total > 0.0).then(|| (0..count).map(share).collect())
}
