//! Times of steps: short runs of variants of a scene.

use std::sync::Barrier;
use std::time::Instant;

use decomp::{Serial, choose_cuts};

use crate::input;
use crate::perf_model::{Busy, RankWork, Share, Work};
use crate::scene::{CellSize, CheckedScene, FilterHalo};
use crate::simulation::{Compiled, LEAST_CELLS, Simulation};
use crate::solver::Stepper;
use crate::solver::clock::Activity;

/// Approximate numbers of particles of the variants on a line, and in a plane, where a particle has
/// about ten times the data.
const SIZES: [f64; 5] = [300.0, 1700.0, 7000.0, 28_000.0, 110_000.0];
const SIZES_IN_A_PLANE: [f64; 4] = [400.0, 1700.0, 7000.0, 28_000.0];

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
    /// Distribution over patches.
    pub share: Share,
    threads: usize,
}

/// Measured times of a variant.
#[derive(Clone)]
pub struct MeasuredVariant<'a> {
    /// The variant.
    pub variant: &'a Variant,
    /// Time of a step \[s\].
    pub total: f64,
    /// Time of a step in phases over patches \[s\].
    pub compute: f64,
}

impl MeasuredVariant<'_> {
    /// Work of the single rank; `cache` are the effective cache sizes for particles and patches
    /// \[B\].
    pub fn work(&self, cache: [f64; 2]) -> RankWork {
        self.variant.work.rank_works(&self.variant.share, cache)[0]
    }

    /// Keeps the faster of two measurements of the same variant.
    pub fn take_faster(&mut self, other: &Self) {
        if other.total < self.total {
            (self.total, self.compute) = (other.total, other.compute);
        }
    }
}

/// `scene` with `finer` times smaller cells, or with -`finer` times larger cells if negative, and
/// with `denser` times the particles per cell along x; `None` if there is no such scene.
fn sized(scene: &CheckedScene, finer: i64, denser: usize) -> Option<CheckedScene> {
    let mut new = scene.scene.clone();
    let factor = match finer {
        1.. => 1.0 / finer as f64,
        _ if divides(scene, -finer) => -finer as f64,
        _ => return None,
    };
    new.domain.cell_size = match scene.cell_size[..] {
        [size] => CellSize::Uniform(size * factor),
        _ => CellSize::PerDirection(scene.cell_size.iter().map(|size| size * factor).collect()),
    };
    for body in &mut new.bodies {
        if body.positions.is_none() {
            let mut counts = body.particles_per_cell(scene.dimension);
            counts[0] *= denser;
            body.particles_per_cell = Some(counts);
        }
    }
    new.decomposition.skip_quiescent = false;
    input::check(new, &scene.file).ok()
}

/// Whether `k` divides the number of cells in each direction.
fn divides(scene: &CheckedScene, k: i64) -> bool {
    scene.cells.iter().all(|&cells| cells as i64 % k == 0)
}

/// How many times finer the cells of `scene` must be for about `target` particles; negative: coarser.
fn finer(scene: &CheckedScene, target: f64) -> i64 {
    let ratio = target / scene.particles.max(1) as f64;
    match ratio.powf(1.0 / scene.dimension as f64) {
        more if more >= 1.0 => more.round() as i64,
        less => {
            let coarser = (1.0 / less).round() as i64;
            -(coarser..4 * coarser).find(|&k| divides(scene, k)).unwrap_or(1)
        }
    }
}

/// Variants with several sizes, patch counts and both halo methods, for this number of threads.
pub fn variants(scene: &CheckedScene, threads: usize) -> Vec<Variant> {
    let targets = if scene.dimension == 1 { &SIZES[..] } else { &SIZES_IN_A_PLANE };
    let mut sizes: Vec<(i64, usize)> = targets.iter().map(|&t| (finer(scene, t), 1)).collect();
    // other particles per cell separate the costs of particles and nodes
    sizes.push((finer(scene, 3500.0), 2));
    sizes.iter_mut().filter(|s| s.0 == -1).for_each(|s| s.0 = 1);
    sizes.dedup();
    let reach = Work::new(scene).reach;
    let mut all = Vec::new();
    for (finer, denser) in sizes {
        let Some(sized) = sized(scene, finer, denser) else { continue };
        let work = Work::new(&sized);
        // another reach would be another method
        if work.reach != reach {
            continue;
        }
        let mut counts = PATCHES.map(|patches| cuts(&sized, patches)).to_vec();
        counts.dedup();
        let number = |cuts: &Vec<usize>| cuts.iter().product::<usize>();
        for cuts in counts.into_iter().filter(|cuts| number(cuts) >= threads) {
            for halo in [FilterHalo::Exchange, FilterHalo::Redundant] {
                // a single patch has no neighbour for exchanges
                if number(&cuts) == 1 && halo == FilterHalo::Redundant {
                    continue;
                }
                let mut own = sized.clone();
                own.scene.domain.patches = Some(cuts.clone());
                own.scene.decomposition.filter_halo = Some(halo);
                let share = Work::share(&own, 1, threads, None, 0.0);
                all.push(Variant { scene: own, work: work.clone(), share, threads });
            }
        }
    }
    all
}

/// Numbers of patches in each direction, about `patches` together.
fn cuts(scene: &CheckedScene, patches: usize) -> Vec<usize> {
    match scene.cells[..] {
        [x, y] => choose_cuts([x, y], patches, LEAST_CELLS).to_vec(),
        _ => vec![patches.min((scene.cells[0] / LEAST_CELLS).max(1))],
    }
}

/// Runs the steps of a variant in batches; gives total and compute time of a step \[s\].
struct SampleRunner<'a, const D: usize> {
    simulation: Simulation<'a, D>,
    end: f64,
    batch: u64,
}

/// A run in batches of steps, in any dimension.
trait Batches {
    /// Runs one batch; `None` at the end of the run or if the run fails.
    fn batch(&mut self) -> Option<(f64, f64)>;
}

/// The run of a variant; `None` if it does not start.
fn runner<'a>(variant: &'a Variant) -> Option<Box<dyn Batches + 'a>> {
    fn boxed<'a, const D: usize>(variant: &'a Variant) -> Option<Box<dyn Batches + 'a>>
    where
        Stepper<D>: Compiled<D>,
    {
        Some(Box::new(SampleRunner::<D>::new(variant)?))
    }
    match variant.scene.dimension {
        1 => boxed::<1>(variant),
        _ => boxed::<2>(variant),
    }
}

impl<'a, const D: usize> SampleRunner<'a, D>
where
    Stepper<D>: Compiled<D>,
{
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
}

impl<const D: usize> Batches for SampleRunner<'_, D>
where
    Stepper<D>: Compiled<D>,
{
    fn batch(&mut self) -> Option<(f64, f64)> {
        let computed = |s: &mut Simulation<'_, D>| s.clock().seconds[Activity::Compute as usize];
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

/// Times of the batch of median time of a variant within about `seconds` \[s\]; `None` if it does
/// not run.
pub fn measure(variant: &Variant, seconds: f64) -> Option<MeasuredVariant<'_>> {
    let start = Instant::now();
    let mut runner = runner(variant)?;
    let mut batches = Vec::new();
    while batches.len() < LEAST_BATCHES || start.elapsed().as_secs_f64() < seconds {
        let Some(batch) = runner.batch() else { break };
        batches.push(batch);
    }
    batches.sort_by(|a, b| a.0.total_cmp(&b.0));
    let &(total, compute) = batches.get(batches.len() / 2)?;
    Some(MeasuredVariant { variant, total, compute })
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
    let single = || variants.iter().filter(|v| v.share.layout.patches == 1 && v.threads == 1);
    let bytes = |v: &Variant| v.work.particles * v.work.row_bytes;
    // the largest that stays in cache: a smaller one shares nothing with other cores
    let by_size = |v: &&Variant| v.work.particles as u64;
    let small = single().filter(|v| bytes(v) <= cache).max_by_key(by_size);
    let small = small.or_else(|| single().min_by_key(by_size))?;
    let large = single().max_by_key(by_size)?;
    let each = seconds / 4.0;
    let crowd = |variant: &Variant, count: usize| {
        alive();
        crowd(variant, count, each)
    };
    let ratio = |variant: &Variant| Some(crowd(variant, cores)? / crowd(variant, 1)?);
    let cold = |v: &Variant| crate::perf_model::cold_share(bytes(v), cache);
    let warm = ratio(small)?.max(1.0);
    let mixed = ratio(large)?.max(1.0);
    let cold = match cold(large) {
        share if share > 0.1 => (warm + (mixed - warm) / share).max(1.0),
        _ => mixed,
    };
    Some(Busy { cores, warm, cold })
}

/// Median time of a step while `count` threads each run a variant \[s\].
fn crowd(variant: &Variant, count: usize, seconds: f64) -> Option<f64> {
    let barrier = Barrier::new(count);
    let run = || {
        let runner = runner(variant);
        barrier.wait();
        let (mut runner, start) = (runner?, Instant::now());
        let mut times = Vec::new();
        while times.len() < LEAST_BATCHES || start.elapsed().as_secs_f64() < seconds {
            // all threads reach the end of the run at about the same time
            let Some((total, _)) = runner.batch() else { break };
            times.push(total);
        }
        times.sort_by(f64::total_cmp);
        times.get(times.len() / 2).copied()
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
