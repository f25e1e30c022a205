//! Times of steps: short runs of variants of a scene.

use std::sync::Barrier;
use std::time::Instant;

use decomp::Serial;

use crate::input;
use crate::perf_model::{Busy, RankWork, Share, Work};
use crate::scene::{CellSize, CheckedScene, FilterHalo};
use crate::simulation::{LEAST_CELLS, Simulation};
use crate::solver::clock::Activity;

/// Approximate numbers of particles of the variants.
const SIZES: [f64; 5] = [300.0, 1700.0, 7000.0, 28_000.0, 110_000.0];

/// Numbers of patches of the variants.
const PATCHES: [usize; 4] = [1, 4, 16, 61];

/// Steps before the measurement.
const WARM_UP: u64 = 3;

/// Smallest time of a batch \[s\], so that the cost of reading the clock is negligible.
const BATCH: f64 = 0.5e-3;

/// Smallest number of batches per variant.
const LEAST_BATCHES: usize = 4;

/// A scene with a given size and number of patches; no patch is skipped as quiescent.
pub struct Variant {
    scene: CheckedScene,
    /// Work of the variant.
    pub work: Work,
    patches: usize,
    threads: usize,
    halo: FilterHalo,
}

/// Measured times of a variant.
#[derive(Clone)]
pub struct MeasuredVariant<'a> {
    /// The variant.
    pub variant: &'a Variant,
    /// Distribution over patches.
    pub share: Share,
    /// Time of a step \[s\].
    pub total: f64,
    /// Time of a step in phases over patches \[s\].
    pub compute: f64,
}

impl MeasuredVariant<'_> {
    /// Work of the single rank; `cache` are the effective cache sizes for particles and patches
    /// \[B\].
    pub fn work(&self, cache: [f64; 2]) -> RankWork {
        self.variant.work.rank_works(&self.share, cache)[0]
    }

    /// Keeps the faster of two measurements of the same variant.
    pub fn take_faster(&mut self, other: &Self) {
        if other.total < self.total {
            (self.total, self.compute) = (other.total, other.compute);
        }
    }
}

/// `scene` with `finer` times smaller cells, or with -`finer` times larger cells if negative, and
/// with `denser` times the particles per cell; `None` if there is no such scene.
fn sized(scene: &CheckedScene, finer: i64, denser: usize) -> Option<CheckedScene> {
    let mut new = scene.scene.clone();
    let size = match finer {
        1.. => scene.cell_size[0] / finer as f64,
        _ if scene.cells[0] as i64 % finer == 0 => scene.cell_size[0] * -finer as f64,
        _ => return None,
    };
    new.domain.cell_size = CellSize::Uniform(size);
    for body in &mut new.bodies {
        if body.positions.is_none() {
            let counts = body.particles_per_cell(scene.dimension);
            body.particles_per_cell = Some(counts.into_iter().map(|n| n * denser).collect());
        }
    }
    new.decomposition.skip_quiescent = false;
    input::check(new, &scene.file).ok()
}

/// Variants with several sizes, patch counts and both halo methods, for this number of threads.
pub fn variants(scene: &CheckedScene, threads: usize) -> Vec<Variant> {
    let now = scene.particles.max(1) as f64;
    let finer = |target: f64| match target / now {
        more if more >= 1.0 => more.round() as i64,
        less => {
            let coarser = (1.0 / less).round() as i64;
            let divides = |k: &i64| scene.cells[0] as i64 % k == 0;
            -(coarser..4 * coarser).find(divides).unwrap_or(1)
        }
    };
    let mut sizes: Vec<(i64, usize)> = SIZES.map(|target| (finer(target), 1)).to_vec();
    sizes.iter_mut().filter(|s| s.0 == -1).for_each(|s| s.0 = 1);
    // other particles per cell separate the costs of particles and nodes
    sizes.push((finer(3500.0).max(1), 2));
    sizes.dedup();
    let mut all = Vec::new();
    for (finer, denser) in sizes {
        let Some(sized) = sized(scene, finer, denser) else { continue };
        let work = Work::new(&sized);
        // another reach would be another method
        if work.reach != Work::new(scene).reach {
            continue;
        }
        let most = (sized.cells[0] / LEAST_CELLS).max(1);
        let mut counts = PATCHES.map(|p| p.min(most)).to_vec();
        counts.dedup();
        for patches in counts.into_iter().filter(|&p| p >= threads) {
            for halo in [FilterHalo::Exchange, FilterHalo::Redundant] {
                // a single patch has no neighbour for exchanges
                if patches == 1 && halo == FilterHalo::Redundant {
                    continue;
                }
                let mut own = sized.clone();
                own.scene.domain.patches = Some(vec![patches]);
                own.scene.decomposition.filter_halo = Some(halo);
                all.push(Variant { scene: own, work: work.clone(), patches, threads, halo });
            }
        }
    }
    all
}

/// Runs the steps of a variant in batches; gives total and compute time of a step \[s\].
struct SampleRunner<'a> {
    simulation: Simulation<'a, 1>,
    end: f64,
    batch: u64,
}

impl<'a> SampleRunner<'a> {
    fn new(variant: &'a Variant) -> Option<Self> {
        let mut simulation = Simulation::new(&variant.scene, &Serial, variant.threads).ok()?;
        let end = variant.scene.scene.time.end;
        let start = Instant::now();
        for _ in 0..WARM_UP {
            simulation.advance(end).ok()?;
        }
        let step = start.elapsed().as_secs_f64() / WARM_UP as f64;
        let every = variant.scene.scene.method.pressure_relaxation.map_or(1, |r| r.interval.max(1));
        let batch = ((BATCH / step).ceil() as u64).clamp(1, 1000).next_multiple_of(every.into());
        Some(SampleRunner { simulation, end, batch })
    }

    /// Runs one batch; `None` at the end of the run or if the run fails.
    fn batch(&mut self) -> Option<(f64, f64)> {
        let computed = |s: &mut Simulation<'_, 1>| s.clock().seconds[Activity::Compute as usize];
        let before = computed(&mut self.simulation);
        let start = Instant::now();
        for _ in 0..self.batch {
            if self.simulation.time() >= self.end {
                return None;
            }
            self.simulation.advance(self.end).ok()?;
        }
        let total = start.elapsed().as_secs_f64();
        let compute = computed(&mut self.simulation) - before;
        let each = 1.0 / self.batch as f64;
        Some((total * each, compute * each))
    }
}

/// Times of the fastest batch of a variant within about `seconds` \[s\]; `None` if it does not run.
pub fn measure(variant: &Variant, seconds: f64) -> Option<MeasuredVariant<'_>> {
    let start = Instant::now();
    let mut runner = SampleRunner::new(variant)?;
    let mut best: Option<(f64, f64)> = None;
    for count in 0.. {
        if count >= LEAST_BATCHES && start.elapsed().as_secs_f64() >= seconds {
            break;
        }
        let Some(new) = runner.batch() else { break };
        best = Some(best.map_or(new, |old| if new.0 < old.0 { new } else { old }));
    }
    let (total, compute) = best?;
    let Variant { work, patches, threads, halo, .. } = variant;
    let share = work.share(*patches, 1, *threads, *halo);
    Some(MeasuredVariant { variant, share, total, compute })
}

/// Slowdown of a step while `cores` cores compute, relative to one alone \[-\], measured in about
/// `seconds` \[s\]: for particles that stay in a cache of `cache` bytes, and for particles that do
/// not. `None` for one core. `alive` is called from time to time.
pub fn busy(
    variants: &[Variant],
    cores: usize,
    seconds: f64,
    cache: f64,
    alive: &dyn Fn(),
) -> Option<Busy> {
    if cores < 2 {
        return None;
    }
    let single = || variants.iter().filter(|v| v.patches == 1 && v.threads == 1);
    let small = single().min_by_key(|v| (v.work.terrain.particles - 1700.0).abs() as u64)?;
    let large = single().max_by_key(|v| v.work.terrain.particles as u64)?;
    let each = seconds / 4.0;
    let crowd = |variant: &Variant, count: usize| {
        alive();
        crowd(variant, count, each)
    };
    let ratio = |variant: &Variant| Some(crowd(variant, cores)? / crowd(variant, 1)?);
    let cold = |v: &Variant| {
        crate::perf_model::cold_share(v.work.terrain.particles * v.work.row_bytes, cache)
    };
    let warm = ratio(small)?.max(1.0);
    let mixed = ratio(large)?.max(1.0);
    let cold = match cold(large) {
        share if share > 0.1 => (warm + (mixed - warm) / share).max(1.0),
        _ => mixed,
    };
    Some(Busy { cores, warm, cold })
}

/// Lower quartile of the time of a step while `count` threads each run a variant \[s\].
fn crowd(variant: &Variant, count: usize, seconds: f64) -> Option<f64> {
    let barrier = Barrier::new(count);
    let run = || {
        let runner = SampleRunner::new(variant);
        barrier.wait();
        let (mut runner, start) = (runner?, Instant::now());
        let mut times = Vec::new();
        while times.len() < LEAST_BATCHES || start.elapsed().as_secs_f64() < seconds {
            // all threads reach the end of the run at about the same time
            let Some((total, _)) = runner.batch() else { break };
            times.push(total);
        }
        times.sort_by(f64::total_cmp);
        times.get(times.len() / 4).copied()
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..count).map(|_| scope.spawn(run)).collect();
        let times: Vec<Option<f64>> =
            threads.into_iter().map(|t| t.join().expect("a run does not panic")).collect();
        let times: Option<Vec<f64>> = times.into_iter().collect();
        times.map(|t| t.iter().sum::<f64>() / t.len() as f64)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_default_number_of_particles_per_cell_is_multiplied_as_a_given_one() {
        let mut value: serde_json::Value =
            serde_json::from_str(include_str!("../../../inputs/flyer.json")).unwrap();
        let particles = |value: &serde_json::Value, denser| {
            let scene = input::parse(value.to_string().as_bytes(), "flyer.json", &[]).unwrap();
            sized(&scene, 1, denser).unwrap().particles
        };
        let given = particles(&value, 2);
        for body in value["bodies"].as_array_mut().unwrap() {
            body.as_object_mut().unwrap().remove("particles_per_cell");
        }
        assert_eq!((particles(&value, 1), particles(&value, 2)), (given / 2, given));
    }
}
