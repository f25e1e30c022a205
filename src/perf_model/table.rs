//! Predictions for many ranks and the limits of scaling, as tables.

use std::fmt::Write;

use super::cost::{Prediction, predict_run};
use super::load::Work;
use super::machine::{COMPUTE, Machine, SERIAL};
use super::network::Network;
use crate::scene::{CheckedScene, FilterHalo};

/// Largest number of ranks in a table.
const MOST_RANKS: usize = 100_000;

/// Predictions of a scene for several numbers of ranks.
#[derive(Clone, Debug)]
pub struct Forecast {
    /// One rank with one thread, the base of the speed-up.
    pub base: Prediction,
    /// For each number of ranks: the prediction with the halo method of the program, and with the
    /// other method if that is faster.
    pub rows: Vec<(Prediction, Option<Prediction>)>,
    /// Limits of strong scaling.
    pub limits: ScalingLimits,
}

/// Limits of strong scaling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalingLimits {
    /// Largest number of patches; additional ranks have no work.
    pub patches: usize,
    /// Smallest number of ranks with an efficiency below one half; `None`: above 100 000.
    pub half: Option<usize>,
    /// Number of ranks with the shortest step; `None`: the largest number examined.
    pub fastest: Option<usize>,
}

/// The requested numbers of ranks, followed by 1, 2, 5, 10, ... beyond them.
pub fn ranks_to(asked: &[usize]) -> Vec<usize> {
    let greatest = asked.iter().copied().max().unwrap_or(0);
    let decades = (0..6).flat_map(|k| [1, 2, 5].map(|d| d * 10usize.pow(k)));
    let mut all: Vec<usize> =
        decades.filter(|&r| r > greatest && r <= MOST_RANKS).chain(asked.iter().copied()).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// Predicts a scene on each of `ranks` with `threads` each.
pub fn forecast(
    machine: &Machine,
    network: &Network,
    scene: &CheckedScene,
    ranks: &[usize],
    threads: usize,
) -> Forecast {
    let work = Work::new(scene);
    let on = |ranks: usize, threads: usize, halo: Option<FilterHalo>| {
        predict_run(machine, network, (scene, &work), [ranks, threads], halo)
    };
    let base = on(1, 1, None);
    let rows = ranks
        .iter()
        .map(|&ranks| {
            let own = on(ranks, threads, None);
            let other = match own.halo {
                FilterHalo::Redundant => FilterHalo::Exchange,
                FilterHalo::Exchange => FilterHalo::Redundant,
            };
            let other = on(ranks, threads, Some(other));
            let faster = other.step < own.step;
            (own, faster.then_some(other))
        })
        .collect();
    let mut limits =
        ScalingLimits { patches: Work::most_patches(scene, threads), half: None, fastest: None };
    let mut best = (1, f64::INFINITY);
    for ranks in scanned() {
        let step = on(ranks, threads, None).step;
        if efficiency(&base, ranks * threads, step) < 0.5 && limits.half.is_none() {
            limits.half = Some(ranks);
        }
        if step < best.1 {
            best = (ranks, step);
        }
    }
    limits.fastest = (best.0 < MOST_RANKS).then_some(best.0);
    Forecast { base, rows, limits }
}

/// All numbers of ranks up to 32, then steps of a sixteenth.
fn scanned() -> impl Iterator<Item = usize> {
    std::iter::successors(Some(1usize), |r| (*r < MOST_RANKS).then(|| (r + 1).max(r + r / 16)))
        .map(|r| r.min(MOST_RANKS))
}

fn efficiency(base: &Prediction, workers: usize, step: f64) -> f64 {
    base.step / (step * workers as f64)
}

/// Name of a halo method in files and tables.
pub(super) fn halo_name(halo: FilterHalo) -> &'static str {
    match halo {
        FilterHalo::Exchange => "exchange",
        FilterHalo::Redundant => "redundant",
    }
}

/// Whether a prediction is outside of the measured range.
pub(super) fn extrapolated(machine: &Machine, ranks: usize, threads: usize) -> bool {
    let messages = ranks > 1 && (ranks > machine.ranks || !machine.network.measured);
    let forks = threads > 1 && (threads > 2 || !machine.fork_measured);
    messages || forks || ranks * threads > machine.busy.cores.max(1)
}

/// The forecast as aligned text, for a run of `steps` steps.
pub fn table(machine: &Machine, network: &Network, forecast: &Forecast, steps: f64) -> String {
    let head = [
        "ranks",
        "threads",
        "patches",
        "step us",
        "loop s",
        "speed-up",
        "effic %",
        "compute %",
        "exchange %",
        "wait %",
        "skipped %",
        "messages",
        "kB",
        "MB",
        "halo",
        "cheapest",
    ];
    let mut lines = vec![head.map(String::from).to_vec()];
    for (own, other) in &forecast.rows {
        let (ranks, threads) = (own.ranks, own.threads);
        let mark = if extrapolated(machine, ranks, threads) { "*" } else { "" };
        let efficiency = efficiency(&forecast.base, ranks * threads, own.step);
        let cheapest = match other {
            None => halo_name(own.halo).to_string(),
            Some(o) => format!("{} {}", halo_name(o.halo), number(o.step * 1e6)),
        };
        lines.push(vec![
            format!("{mark}{ranks}"),
            threads.to_string(),
            own.patches.to_string(),
            number(own.step * 1e6),
            number(own.step * steps),
            number(efficiency * (ranks * threads) as f64),
            format!("{:.1}", 100.0 * efficiency),
            format!("{:.1}", 100.0 * own.compute),
            format!("{:.1}", 100.0 * own.exchange),
            format!("{:.1}", 100.0 * own.wait),
            format!("{:.1}", 100.0 * own.skipped),
            number(own.messages / own.working.max(1) as f64),
            number(1e-3 * own.bytes / own.working.max(1) as f64),
            number(1e-6 * own.memory as f64),
            halo_name(own.halo).into(),
            cheapest,
        ]);
    }
    let mut text = aligned(&lines);
    text += "messages and kB that a rank sends in a step, MB of the rank that needs most memory\n";
    text += "* extrapolated beyond what was measured\n";
    let beyond = format!(
        "messages between nodes: {} ({:.2} us, {:.1} GB/s; {})\n",
        network.name,
        network.latency * 1e6,
        1e-9 / network.seconds_per_byte.max(1e-15),
        network.source
    );
    let own = &machine.network;
    let within = format!(
        "messages within a node of {} cores: {:.2} us, {:.1} GB/s; {}\n",
        machine.cores,
        own.latency * 1e6,
        1e-9 / own.seconds_per_byte.max(1e-15),
        own.source
    );
    text + &within + &beyond + &limits_text(&forecast.limits)
}

fn limits_text(limits: &ScalingLimits) -> String {
    let mut text = format!(
        "patches run out at {0}: on more than {0} ranks some have nothing to do\n",
        limits.patches
    );
    text += &match limits.half {
        Some(ranks) => format!("efficiency falls below 50 % at {ranks} ranks\n"),
        None => format!("efficiency stays above 50 % up to {MOST_RANKS} ranks\n"),
    };
    text += &match limits.fastest {
        Some(ranks) => format!("more than {ranks} ranks make it no faster\n"),
        None => format!("up to {MOST_RANKS} ranks each more make it faster\n"),
    };
    text
}

/// The constants as aligned text.
pub fn machine_table(machine: &Machine) -> String {
    let c = &machine.coefficients;
    let ns = |value: f64| format!("{:.3}", value * 1e9);
    let mut lines = vec![vec!["constant".to_string(), "ns".to_string()]];
    let named = |group: &str, names: &[&str], values: &[f64], lines: &mut Vec<Vec<String>>| {
        for (name, value) in names.iter().zip(values) {
            lines.push(vec![format!("{group} {name}"), ns(*value)]);
        }
    };
    named("compute", &COMPUTE, &c.compute, &mut lines);
    named("exchange", &SERIAL, &c.serial, &mut lines);
    let network = &machine.network;
    let mark = |measured: bool| if measured { "" } else { " (assumed)" };
    let forks = mark(machine.fork_measured);
    lines.push(vec![format!("fork and join{forks}"), ns(machine.fork_join)]);
    lines.push(vec![format!("fork and join, a patch{forks}"), ns(machine.fork_patch)]);
    let messages = mark(network.measured);
    for (name, value) in [
        ("latency L", network.latency),
        ("byte G", network.seconds_per_byte),
        ("message overhead 2 o", network.overhead),
        ("exchange call", network.call),
        ("reduction, a level", network.reduction_level),
    ] {
        lines.push(vec![format!("{name}{messages}"), ns(value)]);
    }
    let mut text = format!("{}, {} cores\n", machine.processor, machine.cores);
    text += &aligned(&lines);
    let [rows, patches] = c.cache.map(|bytes| bytes * 1e-6);
    let _ = writeln!(text, "cold beyond {rows:.2} MB of rows, patches beyond {patches:.2} MB");
    let busy = &machine.busy;
    let _ = writeln!(
        text,
        "with {} busy cores a step takes {:.3} times as long, {:.3} times out of cache",
        busy.cores, busy.warm, busy.cold
    );
    for (what, q) in [
        ("phases, one thread", &machine.compute_quality),
        ("steps, one thread", &machine.quality),
        ("steps, two threads", &machine.fork_quality),
    ] {
        let _ = writeln!(
            text,
            "fit of {what}: {} samples, rms {:.1} %, largest {:.1} %",
            q.samples,
            100.0 * q.rms,
            100.0 * q.largest
        );
    }
    text
}

/// A number with at least three digits.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let digits = 2 - value.abs().max(1e-9).log10().floor().clamp(-6.0, 2.0) as i32;
    format!("{value:.*}", digits.max(0) as usize)
}

/// Right-aligned columns with two spaces between them.
pub(super) fn aligned(lines: &[Vec<String>]) -> String {
    let columns = lines.iter().map(Vec::len).max().unwrap_or(0);
    let width =
        |k: usize| lines.iter().filter_map(|l| l.get(k)).map(String::len).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for line in lines {
        let cells: Vec<String> =
            line.iter().zip(&widths).map(|(cell, width)| format!("{cell:>width$}")).collect();
        text += cells.join("  ").trim_end();
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_go_on_beyond_those_asked_for() {
        assert_eq!(ranks_to(&[1, 3, 4])[..6], [1, 3, 4, 5, 10, 20]);
        assert_eq!(ranks_to(&[]).last(), Some(&100_000));
        assert_eq!(ranks_to(&[]).len(), 16);
        assert_eq!(ranks_to(&[250_000]), [250_000]);
        let scanned: Vec<usize> = scanned().collect();
        assert!(scanned.windows(2).all(|w| w[0] < w[1]));
        assert_eq!((scanned[0], scanned[1], scanned.last()), (1, 2, Some(&100_000)));
    }

    #[test]
    fn numbers_have_three_digits() {
        assert_eq!(
            [171.23, 1.2345, 0.012345, 12345.0, 0.0].map(number),
            ["171", "1.23", "0.0123", "12345", "0"]
        );
    }
}
