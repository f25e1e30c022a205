//! Measures the constants of [`crate::perf_model`]: runs the method of a scene in process with
//! several sizes and patch counts, and sends messages between ranks.
//!
//! Measures and fits only; reads and writes no files or tables.

mod messages;
mod samples;

use std::time::{Duration, Instant};

use decomp::Comm;

use crate::perf_model::fit::{Fit, Sample, dot, fit};
use crate::perf_model::{
    Busy, COMPUTE, Coefficients, Machine, Network, Quality, SERIAL, SchemeCosts,
};
use crate::scene::CheckedScene;

use samples::{MeasuredVariant, Variant};

/// Default total time of a calibration, approximate \[s\].
pub const SECONDS: f64 = 16.0;

/// Fractions of this time: steps on one thread, on two threads, on all cores at once.
const SHARES: [f64; 3] = [0.6, 0.2, 0.1];

/// Cache sizes to try \[B\]; the pair with the best fit is used.
const CACHES: [f64; 9] = [0.25e6, 0.5e6, 1e6, 2e6, 4e6, 8e6, 16e6, 32e6, 64e6];

/// Reasons why there are no constants.
#[derive(Debug, thiserror::Error)]
pub enum CalibrateError {
    /// No variant of the scene can run.
    #[error("{0}: no size of this scene runs a few steps; allowed: a scene that `flyer-mpm` runs")]
    NothingRuns(String),
}

/// One sample of the fit, for a table.
#[derive(Clone, Debug)]
pub struct Residual {
    /// Number of particles \[-\].
    pub particles: f64,
    /// Patches.
    pub patches: usize,
    /// Threads.
    pub threads: usize,
    /// How filters got values outside of a patch.
    pub halo: crate::scene::FilterHalo,
    /// Measured time of a step \[s\].
    pub measured: f64,
    /// Fitted time of a step \[s\].
    pub fitted: f64,
}

/// Measures everything in about `seconds` \[s\]. Rank 0 gets the constants and the residuals of the
/// fit. Collective.
///
/// # Errors
///
/// If no variant of the scene can run.
pub fn calibrate(
    comm: &dyn Comm,
    scene: &CheckedScene,
    seconds: f64,
) -> Result<Option<(Machine, Vec<Residual>)>, CalibrateError> {
    // the other ranks must not use memory or cores while rank 0 computes alone
    let mut received = Vec::new();
    if comm.rank() != 0 {
        let pause = Duration::from_secs_f64(seconds * SHARES.iter().sum::<f64>());
        comm.exchange(&[], &[0], &mut received, &mut || sleep(comm, pause));
        if received[0] == [0] {
            return Ok(None);
        }
        messages::measure(comm);
        return Ok(None);
    }
    let computed = compute(scene, seconds, &|| comm.heartbeat());
    let word = [u64::from(computed.is_ok())];
    let sends: Vec<(usize, &[u64])> = (1..comm.size()).map(|r| (r, &word[..])).collect();
    comm.exchange(&sends, &[], &mut received, &mut || {});
    let (mut machine, residuals) = computed?;
    machine.ranks = comm.size();
    if let Some(network) = messages::measure(comm) {
        machine.network = network;
    }
    Ok(Some((machine, residuals)))
}

/// Interval between two heartbeats of a sleeping rank.
const NAP: Duration = Duration::from_millis(10);

/// Sleeps, and sends heartbeats meanwhile.
fn sleep(comm: &dyn Comm, pause: Duration) {
    let end = Instant::now() + pause;
    while Instant::now() < end {
        std::thread::sleep(NAP.min(end.saturating_duration_since(Instant::now())));
        comm.heartbeat();
    }
}

/// Constants that one process measures alone; `alive` is called from time to time.
fn compute(
    scene: &CheckedScene,
    seconds: f64,
    alive: &dyn Fn(),
) -> Result<(Machine, Vec<Residual>), CalibrateError> {
    let cores = cores();
    let variants = samples::variants(scene, 1);
    let alone = take(&variants, SHARES[0] * seconds, alive);
    if alone.len() < 2 {
        return Err(CalibrateError::NothingRuns(scene.file.clone()));
    }
    let (coefficients, compute_quality) = best_cache(&alone);
    let cache = coefficients.cache[0];
    let busy = samples::busy(&variants, cores.min(64), SHARES[2] * seconds, cache, alive);
    let mut machine = Machine {
        format: crate::perf_model::FORMAT,
        processor: processor(),
        cores,
        scheme: SchemeCosts::of(scene),
        coefficients,
        busy: busy.unwrap_or(Busy { cores: 1, warm: 1.0, cold: 1.0 }),
        fork_join: 5e-6,
        fork_patch: 0.0,
        fork_measured: false,
        network: Network::assumed(),
        ranks: 1,
        quality: Quality { samples: 0, rms: 0.0, largest: 0.0 },
        compute_quality,
        fork_quality: Quality { samples: 0, rms: 0.0, largest: 0.0 },
    };
    let mut residuals: Vec<Residual> = alone.iter().map(|m| residual(&machine, m)).collect();
    machine.quality = quality(&residuals);
    if cores > 1 {
        let variants = samples::variants(scene, 2);
        let two = take(&variants, SHARES[1] * seconds, alive);
        let forks = fit(&two.iter().map(|m| fork_sample(&machine, m)).collect::<Vec<_>>());
        [machine.fork_join, machine.fork_patch] = forks.coefficients;
        machine.fork_measured = !two.is_empty();
        let two: Vec<Residual> = two.iter().map(|m| residual(&machine, m)).collect();
        machine.fork_quality = quality(&two);
        residuals.extend(two);
    }
    Ok((machine, residuals))
}

/// Measures all variants within about `seconds`, in two rounds, so that a long disturbance does not
/// affect both measurements of a variant. Variants that fail are omitted.
fn take<'a>(variants: &'a [Variant], seconds: f64, alive: &dyn Fn()) -> Vec<MeasuredVariant<'a>> {
    let end = Instant::now() + Duration::from_secs_f64(seconds);
    let mut found: Vec<Option<MeasuredVariant>> = vec![None; variants.len()];
    for round in 0..2 {
        for (k, variant) in variants.iter().enumerate() {
            let left = end.saturating_duration_since(Instant::now()).as_secs_f64();
            let each = left / ((2 - round) * variants.len() - k).max(1) as f64;
            if round == 1 && left == 0.0 {
                break;
            }
            alive();
            if let Some(new) = samples::measure(variant, each) {
                match &mut found[k] {
                    Some(old) => old.take_faster(&new),
                    empty => *empty = Some(new),
                }
            }
        }
    }
    found.into_iter().flatten().collect()
}

/// Coefficients for the cache sizes with the best fit.
fn best_cache(samples: &[MeasuredVariant]) -> (Coefficients, Quality) {
    let pairs = CACHES.iter().flat_map(|&rows| CACHES.map(|patches| [rows, patches]));
    let tried = pairs.map(|cache| {
        let compute: Fit<{ COMPUTE.len() }> = fit(&samples
            .iter()
            .map(|m| Sample { features: m.work(cache).compute, value: m.compute, whole: m.total })
            .collect::<Vec<_>>());
        let serial: Fit<{ SERIAL.len() }> = fit(&samples
            .iter()
            .map(|m| Sample {
                features: m.work(cache).serial,
                value: m.total - m.compute,
                whole: m.total,
            })
            .collect::<Vec<_>>());
        let coefficients =
            Coefficients { compute: compute.coefficients, serial: serial.coefficients, cache };
        let quality =
            Quality { samples: samples.len(), rms: compute.rms, largest: compute.largest };
        (coefficients, quality)
    });
    tried.min_by(|a, b| a.1.rms.total_cmp(&b.1.rms)).expect("some sizes are tried")
}

/// Time of a step on several threads beyond its computing, against the number of forks.
fn fork_sample(machine: &Machine, m: &MeasuredVariant) -> Sample<2> {
    let work = m.work(machine.coefficients.cache);
    let slowing = machine.slowing(m.variant.share.threads, work.cold);
    let c = &machine.coefficients;
    let known = slowing * (dot(&work.compute, &c.compute) + dot(&work.serial, &c.serial));
    let forks = m.variant.work.schedule.forks(m.variant.share.layout.halo);
    let features = [forks, forks * m.variant.share.layout.patches as f64];
    Sample { features, value: m.total - known, whole: m.total }
}

fn residual(machine: &Machine, m: &MeasuredVariant) -> Residual {
    let none = Network { reduction_level: 0.0, ..Network::assumed() };
    let predicted =
        crate::perf_model::predict_with(machine, &none, &m.variant.work, &m.variant.share);
    Residual {
        particles: m.variant.work.particles,
        patches: m.variant.share.layout.patches,
        threads: m.variant.share.threads,
        halo: m.variant.share.layout.halo,
        measured: m.total,
        fitted: predicted.step,
    }
}

fn quality(residuals: &[Residual]) -> Quality {
    let relative = || residuals.iter().map(|r| (r.fitted / r.measured - 1.0).abs());
    let square: f64 = relative().map(|r| r * r).sum();
    Quality {
        samples: residuals.len(),
        rms: (square / residuals.len().max(1) as f64).sqrt(),
        largest: relative().fold(0.0, f64::max),
    }
}

/// Number of cores that this process may use.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// Name of the processor; `unknown` without `/proc/cpuinfo`.
pub fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    name.map_or("unknown", |(_, name)| name.trim()).into()
}
