//! One row of the table: a configuration with the medians over its runs.

use serde::Serialize;

use super::configuration::RankBinding;
use super::launch::ScalingRun;
use super::measured_run::{MeasuredDecomposition, MeasuredRun};
use super::row_prediction::RowPrediction;
use super::statistics::{PARTS, median, shares};

/// Medians of a configuration. Values that the program did not count are absent.
#[derive(Clone, Debug, Serialize)]
pub struct ScalingRow {
    /// Ranks.
    pub ranks: usize,
    /// Threads of each rank.
    pub threads: usize,
    /// Ranks times threads.
    pub workers: usize,
    /// Whether patches at rest were skipped.
    pub skip_quiescent: bool,
    /// Whether there are more workers than cores.
    pub oversubscribed: bool,
    /// Placement of the ranks: core, none, oversubscribed.
    pub binding: &'static str,
    /// Patches.
    pub patches: usize,
    /// Particles.
    pub particles: u64,
    /// Steps.
    pub steps: u64,
    /// Wall time of the time loop, median \[s\].
    pub wall_seconds: f64,
    /// Least wall time \[s\].
    pub wall_seconds_min: f64,
    /// Greatest wall time \[s\].
    pub wall_seconds_max: f64,
    /// User CPU time of all ranks, set-up and files included, median \[s\].
    pub cpu_seconds: f64,
    /// Wall time of the loop times workers over particles times steps \[s\].
    pub worker_seconds_per_particle_step: f64,
    /// Particle-steps per wall second over those of 1 x 1 \[-\].
    pub speed_up: f64,
    /// Speed-up over the number of workers \[-\].
    pub efficiency: f64,
    /// Share of the ranks' time in computing \[-\].
    pub compute: Option<f64>,
    /// Share in packing, sending and unpacking ghosts \[-\].
    pub exchange: Option<f64>,
    /// Share in migrating particles \[-\].
    pub migrate: Option<f64>,
    /// Share in moving patches between ranks \[-\].
    pub balance: Option<f64>,
    /// Share in waiting for other ranks \[-\].
    pub wait: Option<f64>,
    /// Share in recording results \[-\].
    pub output: Option<f64>,
    /// Share in the rest of the loop \[-\].
    pub rest: Option<f64>,
    /// Bytes sent per step, all ranks \[B\].
    pub bytes_per_step: Option<f64>,
    /// Number of messages per step, all ranks \[-\].
    pub messages_per_step: Option<f64>,
    /// Work of the busiest rank over the mean \[-\].
    pub imbalance: Option<f64>,
    /// Share of particle-steps that were skipped \[-\].
    pub skipped: Option<f64>,
    /// Predicted wall time of the time loop \[s\]; absent without the constants of a machine.
    pub predicted_seconds: Option<f64>,
    /// Predicted bytes sent per step, all ranks, without outputs \[B\].
    pub predicted_bytes_per_step: f64,
    /// Predicted number of messages sent per step, all ranks, without outputs \[-\].
    pub predicted_messages_per_step: f64,
}

impl ScalingRow {
    /// The row of a job's runs, of which there is at least one; `base` is the row of 1 x 1, or
    /// none for that row itself.
    ///
    /// # Panics
    ///
    /// If there is no run.
    pub fn new(
        job: &ScalingRun,
        runs: &[MeasuredRun],
        predicted: &RowPrediction,
        base: Option<&ScalingRow>,
    ) -> ScalingRow {
        let walls = || runs.iter().map(|run| run.loop_wall_seconds);
        let wall = median(walls()).expect("a job has runs");
        let [first, ..] = runs else { unreachable!("a job has runs") };
        let workers = job.configuration.workers();
        let particle_steps = first.particles as f64 * first.steps as f64;
        let per_step = wall * workers as f64 / particle_steps;
        let efficiency = base.map_or(1.0, |b| b.worker_seconds_per_particle_step / per_step);
        let counted = || runs.iter().filter_map(|run| run.decomposition.as_ref());
        let middle =
            |value: fn(&MeasuredDecomposition) -> Option<f64>| median(counted().filter_map(value));
        let time = shares(counted().flat_map(|d| &d.ranks).map(|rank| &rank.seconds));
        let share = |part: usize| time.map(|shares| shares[part]);
        ScalingRow {
            ranks: job.configuration.ranks,
            threads: job.configuration.threads,
            workers,
            skip_quiescent: job.skip_quiescent,
            oversubscribed: job.binding == RankBinding::Oversubscribed,
            binding: job.binding.name(),
            patches: first.patches.iter().product(),
            particles: first.particles,
            steps: first.steps,
            wall_seconds: wall,
            wall_seconds_min: walls().fold(f64::INFINITY, f64::min),
            wall_seconds_max: walls().fold(0.0, f64::max),
            cpu_seconds: median(runs.iter().map(|run| run.cpu_seconds)).unwrap_or(f64::NAN),
            worker_seconds_per_particle_step: per_step,
            speed_up: efficiency * workers as f64,
            efficiency,
            compute: share(0),
            exchange: share(1),
            migrate: share(2),
            balance: share(3),
            wait: share(4),
            output: share(5),
            rest: share(6),
            bytes_per_step: middle(|d| d.bytes_per_step),
            messages_per_step: middle(|d| d.messages_per_step),
            imbalance: middle(|d| d.imbalance),
            skipped: middle(MeasuredDecomposition::skipped),
            predicted_seconds: predicted.step.map(|step| step * first.steps as f64),
            predicted_bytes_per_step: predicted.bytes,
            predicted_messages_per_step: predicted.messages,
        }
    }

    /// The shares of time in the order of [`PARTS`] \[-\].
    pub fn shares(&self) -> [Option<f64>; PARTS.len()] {
        let ScalingRow { compute, exchange, migrate, balance, wait, output, rest, .. } = *self;
        [compute, exchange, migrate, balance, wait, output, rest]
    }

    /// Difference of the greatest and the least wall time over the median \[-\].
    pub fn spread(&self) -> f64 {
        (self.wall_seconds_max - self.wall_seconds_min) / self.wall_seconds
    }
}

#[cfg(test)]
pub(super) mod tests {
    use std::path::PathBuf;

    use serde_json::json;

    use super::super::configuration::Configuration;
    use super::*;

    /// A job, and its runs with these wall times \[s\].
    pub(in super::super) fn measured(
        ranks: usize,
        walls: &[f64],
        sections: bool,
    ) -> (ScalingRun, Vec<MeasuredRun>) {
        let job = ScalingRun {
            configuration: Configuration { ranks, threads: 1 },
            binding: RankBinding::Core,
            skip_quiescent: false,
            scene: PathBuf::new(),
            sets: Vec::new(),
        };
        let run = |wall: &f64| {
            let mut run = json!({
                "particles": 1000, "steps": 100, "patches": [4], "loop_wall_seconds": wall,
                "cpu_seconds": 2.0 * wall,
            });
            if sections {
                run["decomposition"] = json!({
                    "filter_halo": "redundant", "particle_steps_computed": 3e6,
                    "particle_steps_skipped": 1e6, "imbalance": 1.07, "bytes_per_step": 512.0,
                    "messages_per_step": 4.0,
                    "ranks": [{"rank": 0, "seconds": {"compute": 0.75, "wait": 0.25}}],
                });
            }
            serde_json::from_value(run).unwrap()
        };
        (job, walls.iter().map(run).collect())
    }

    #[test]
    fn speed_up_is_against_the_base() {
        let (job, runs) = measured(1, &[8.0, 12.0, 9.0], false);
        let base = ScalingRow::new(&job, &runs, &RowPrediction::default(), None);
        assert_eq!((base.wall_seconds, base.speed_up, base.efficiency), (9.0, 1.0, 1.0));
        assert_eq!(base.spread(), 4.0 / 9.0);
        assert_eq!((base.cpu_seconds, base.shares(), base.skipped), (18.0, [None; 7], None));
        let (job, runs) = measured(4, &[3.0], true);
        let row = ScalingRow::new(&job, &runs, &RowPrediction::default(), Some(&base));
        assert!((row.speed_up - 3.0).abs() < 1e-12 && (row.efficiency - 0.75).abs() < 1e-12);
        assert_eq!((row.compute, row.wait, row.skipped), (Some(0.75), Some(0.25), Some(0.25)));
    }

    #[test]
    fn a_weak_row_counts_its_own_particles() {
        let (job, runs) = measured(1, &[2.0], false);
        let base = ScalingRow::new(&job, &runs, &RowPrediction::default(), None);
        let (job, mut runs) = measured(2, &[2.5], false);
        runs[0].particles = 2000;
        let row = ScalingRow::new(&job, &runs, &RowPrediction::default(), Some(&base));
        assert!((row.efficiency - 0.8).abs() < 1e-12 && (row.speed_up - 1.6).abs() < 1e-12);
    }
}
