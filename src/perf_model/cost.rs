//! The time of a step: counts times measured constants.

use super::fit::dot;
use super::load::{RankWork, Sent, Share, Work};
use super::machine::Machine;
use super::network::Network;
use crate::scene::{CheckedScene, FilterHalo};

/// Predicted time of a step for one distribution of the work.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// Ranks.
    pub ranks: usize,
    /// Threads of each rank.
    pub threads: usize,
    /// Number of patches on all ranks.
    pub patches: usize,
    /// Number of ranks with at least one patch.
    pub working: usize,
    /// How filters get values outside of a patch.
    pub halo: FilterHalo,
    /// Time of a step \[s\].
    pub step: f64,
    /// Fraction of the time of all ranks for computing \[-\].
    pub compute: f64,
    /// Fraction for packing, copying, and the overheads of messages \[-\].
    pub exchange: f64,
    /// Fraction for waiting: for messages, for the reduction, for the busiest rank \[-\].
    pub wait: f64,
    /// Number of messages of all ranks per step \[-\].
    pub messages: f64,
    /// Bytes in these messages \[B\].
    pub bytes: f64,
    /// Computing time of the busiest rank over the mean of all ranks \[-\].
    pub imbalance: f64,
    /// Fraction of the particles that a step does not compute, as their patches are quiescent \[-\].
    pub skipped: f64,
    /// Memory of the rank that needs most, without outputs \[B\].
    pub memory: u64,
}

impl Prediction {
    /// Means over several times of a run; the most memory.
    fn mean(all: &[Prediction]) -> Prediction {
        let mean =
            |of: &dyn Fn(&Prediction) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
        let step = mean(&|p| p.step);
        let of_time = |of: fn(&Prediction) -> f64| mean(&|p| of(p) * p.step) / step;
        Prediction {
            step,
            compute: of_time(|p| p.compute),
            exchange: of_time(|p| p.exchange),
            wait: of_time(|p| p.wait),
            messages: mean(&|p| p.messages),
            bytes: mean(&|p| p.bytes),
            imbalance: of_time(|p| p.imbalance),
            skipped: mean(&|p| p.skipped),
            memory: all.iter().map(|p| p.memory).max().unwrap_or(0),
            ..all[0].clone()
        }
    }
}

/// Predicts the time of a step with `network` between all ranks.
pub fn predict_with(
    machine: &Machine,
    network: &Network,
    work: &Work,
    share: &Share,
) -> Prediction {
    let works = work.rank_works(share, machine.coefficients.cache);
    let (ranks, layout) = (share.ranks, &share.layout);
    let node_workers = (layout.working * share.threads.min(layout.patches)).min(machine.cores);
    let exchanges = work.exchanges(share);
    let forks = match share.threads {
        1 => 0.0,
        _ if layout.patches == 1 => 0.0,
        _ => work.schedule.forks(layout.halo),
    };
    let c = &machine.coefficients;
    let mut total = Total::default();
    for (rank, Sent { messages: sent, bytes }) in works.iter().zip(work.sent(share)) {
        let slowing = machine.slowing(node_workers, rank.cold);
        let compute = slowing * dot(&rank.compute, &c.compute)
            + forks * (machine.fork_join + rank.patches * machine.fork_patch);
        let calls: f64 = (0..2).filter(|&x| rank.neighbours[x] > 0.0).map(|x| exchanges[x]).sum();
        let packing =
            slowing * dot(&rank.serial, &c.serial) + sent * network.overhead + calls * network.call;
        let inner = if work.overlap { slowing * dot(&rank.inner, &c.compute) } else { 0.0 };
        let flight = flight(network, rank, exchanges, inner);
        total.add(compute, packing, flight, sent, bytes);
    }
    // of very many ranks, some stand for all
    let total = total.of_all(layout.working as f64 / works.len().max(1) as f64);
    let reduction = network.reduction(ranks);
    let step = total.longest + reduction;
    let all = step * ranks as f64;
    Prediction {
        ranks,
        threads: share.threads,
        patches: layout.patches,
        working: layout.working,
        halo: layout.halo,
        step,
        compute: total.compute / all,
        exchange: total.packing / all,
        wait: (1.0 - (total.compute + total.packing) / all).max(0.0),
        messages: total.sent,
        bytes: total.bytes,
        imbalance: total.busiest * ranks as f64 / total.compute.max(f64::MIN_POSITIVE),
        skipped: share.skipped(),
        memory: share.most_memory(),
    }
}

/// Sums and maxima over the ranks.
#[derive(Default)]
struct Total {
    compute: f64,
    packing: f64,
    sent: f64,
    bytes: f64,
    busiest: f64,
    longest: f64,
}

impl Total {
    fn add(&mut self, compute: f64, packing: f64, flight: f64, sent: f64, bytes: f64) {
        self.compute += compute;
        self.packing += packing;
        self.sent += sent;
        self.bytes += bytes;
        self.busiest = self.busiest.max(compute);
        self.longest = self.longest.max(compute + packing + flight);
    }

    /// The sums of `times` as many ranks.
    fn of_all(self, times: f64) -> Self {
        Total {
            compute: self.compute * times,
            packing: self.packing * times,
            sent: self.sent * times,
            bytes: self.bytes * times,
            ..self
        }
    }
}

/// Time for which a rank waits for messages, beyond the computing on its inner patches \[s\].
fn flight(network: &Network, rank: &RankWork, exchanges: [f64; 2], inner: f64) -> f64 {
    let count: f64 = exchanges.iter().sum();
    let mut waits = 0.0;
    for (x, &times) in exchanges.iter().enumerate() {
        if rank.neighbours[x] > 0.0 && times > 0.0 {
            let bytes = rank.bytes[x] / if x == 0 { 1.0 } else { times };
            let alone = network.latency + bytes * network.seconds_per_byte;
            waits += times * (alone - inner / count).max(0.0);
        }
    }
    waits
}

/// Predicts the time of a step: within a node with the messages of the machine, else with
/// `network`.
pub fn predict(machine: &Machine, network: &Network, work: &Work, share: &Share) -> Prediction {
    let within = share.ranks * share.threads <= machine.cores;
    predict_with(machine, if within { &machine.network } else { network }, work, share)
}

/// Predicts the mean time of a step of a run of `scene`, whose work is `work`; `halo` replaces the
/// method that the program chooses.
pub fn predict_run(
    machine: &Machine,
    network: &Network,
    (scene, work): (&CheckedScene, &Work),
    [ranks, threads]: [usize; 2],
    halo: Option<FilterHalo>,
) -> Prediction {
    let at = |time: f64| {
        predict(machine, network, work, &Work::share(scene, ranks, threads, halo, time))
    };
    let all: Vec<Prediction> = Work::times(scene).into_iter().map(at).collect();
    Prediction::mean(&all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input;
    use crate::perf_model::machine::tests::machine;
    use crate::scene::CheckedScene;

    fn flyer(sets: &[&str]) -> CheckedScene {
        let text = include_bytes!("../../inputs/flyer.json");
        let sets: Vec<String> = sets.iter().map(|s| s.to_string()).collect();
        input::parse(text, "flyer.json", &sets).unwrap()
    }

    fn on(machine: &Machine, network: &Network, ranks: usize, halo: FilterHalo) -> Prediction {
        let patches = format!("domain.patches=[{}]", ranks.max(8));
        let scene = flyer(&["decomposition.skip_quiescent=false", &patches]);
        let work = Work::new(&scene);
        let share = Work::share(&scene, ranks, 1, Some(halo), 0.0);
        predict_with(machine, network, &work, &share)
    }

    #[test]
    fn more_latency_makes_more_time() {
        let own = Network::assumed();
        let mut before = 0.0;
        for latency in [1e-6, 3e-6, 10e-6, 100e-6] {
            let network = Network { latency, ..own.clone() };
            let step = on(&machine(), &network, 8, FilterHalo::Exchange).step;
            assert!(step > before, "{step} s with {latency} s");
            before = step;
        }
        // a single rank receives no messages
        let slow = Network { latency: 1.0, ..own.clone() };
        let [slow, own] = [&slow, &own].map(|n| on(&machine(), n, 1, FilterHalo::Exchange).step);
        assert_eq!(slow, own);
    }

    #[test]
    fn every_constant_counts() {
        let network = Network { overhead: 1e-6, call: 1e-6, ..Network::assumed() };
        let step = on(&machine(), &network, 4, FilterHalo::Exchange).step;
        for change in [
            Network { overhead: 2e-6, ..network.clone() },
            Network { call: 2e-6, ..network.clone() },
            Network { seconds_per_byte: 1e-7, ..network.clone() },
            Network { reduction_level: 1e-4, ..network.clone() },
        ] {
            assert!(on(&machine(), &change, 4, FilterHalo::Exchange).step > step, "{change:?}");
        }
        for k in 0..6 {
            let mut slower = machine();
            slower.coefficients.compute[k] += 1e-6;
            // 1700 particles stay in cache
            let same = k == 1 || k == 5;
            let now = on(&slower, &network, 4, FilterHalo::Exchange).step;
            assert_eq!(now > step, !same, "compute {k}");
        }
        for k in 0..6 {
            let mut slower = machine();
            slower.coefficients.serial[k] += 1e-6;
            assert!(on(&slower, &network, 4, FilterHalo::Exchange).step > step, "serial {k}");
        }
    }

    #[test]
    fn deep_ghosts_send_fewer_messages_and_compute_more() {
        let network = Network::assumed();
        for ranks in [2, 4, 8] {
            let [exchange, deep] = [FilterHalo::Exchange, FilterHalo::Redundant]
                .map(|halo| on(&machine(), &network, ranks, halo));
            assert!(deep.messages < exchange.messages / 8.0, "{} ranks", ranks);
            assert!(deep.compute * deep.step > exchange.compute * exchange.step);
        }
        // so redundant halos win if messages are slow
        let slow = Network { latency: 1e-3, ..network };
        let [exchange, deep] = [FilterHalo::Exchange, FilterHalo::Redundant]
            .map(|halo| on(&machine(), &slow, 8, halo));
        assert!(deep.step < exchange.step);
    }

    #[test]
    fn shares_make_a_whole_and_ranks_without_patches_wait() {
        for ranks in [1, 3, 8, 50] {
            let p = on(&machine(), &Network::assumed(), ranks, FilterHalo::Exchange);
            assert!((p.compute + p.exchange + p.wait - 1.0).abs() < 1e-9, "{p:?}");
            assert!(p.imbalance >= 1.0 && p.working <= ranks);
        }
        let scene = flyer(&["domain.patches=[4]"]);
        let work = Work::new(&scene);
        let share = Work::share(&scene, 100, 1, Some(FilterHalo::Exchange), 0.0);
        let p = predict_with(&machine(), &Network::assumed(), &work, &share);
        assert_eq!(p.working, 4);
        assert!(p.wait > 0.9, "{p:?}");
    }

    #[test]
    fn two_threads_share_patches_and_parts_of_one() {
        let mut quick = machine();
        quick.fork_join = 0.0;
        let step = |patches: usize, threads| {
            let patches = format!("domain.patches=[{patches}]");
            let scene = flyer(&["decomposition.skip_quiescent=false", &patches]);
            let work = Work::new(&scene);
            let share = Work::share(&scene, 1, threads, Some(FilterHalo::Exchange), 0.0);
            predict_with(&quick, &Network::assumed(), &work, &share).step
        };
        for patches in [1, 20] {
            let gain = step(patches, 1) / step(patches, 2);
            assert!((1.5..2.0).contains(&gain), "{patches} patches: {gain}");
        }
    }
}
