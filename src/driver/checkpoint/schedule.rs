//! Schedule of checkpoints, and of an early end of a run.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::time::{Duration, Instant};

use crate::scene::CheckedScene;

/// Default wall time between checkpoints [s].
pub const WALL_SECONDS: f64 = 600.0;

/// Largest share of the run time that default checkpoints may take.
const SHARE: f64 = 0.02;

/// Requests of a rank to all ranks: 0 for none, a checkpoint, an end by wall time, or an end by a
/// signal (its number plus `SIGNAL`).
const CHECKPOINT: u8 = 1;
const WALL_LIMIT: u8 = 2;
const SIGNAL: u8 = 16;

/// Reason for an early end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The wall time limit is reached.
    WallLimit,
    /// A signal of this number was received.
    Signal(u8),
}

/// Times at which checkpoints are due.
#[derive(Debug)]
pub struct CheckpointSchedule {
    every_seconds: Option<f64>,
    every_steps: Option<u64>,
    at_times: Vec<f64>,
    wall: Option<Duration>,
    /// Number of checkpoints that are kept; 0: none are written.
    pub keep: u64,
    /// Whether checkpoints are removed after a successful run, because the scene did not ask for
    /// them.
    pub passing: bool,
    limit: Option<Instant>,
    signal: Arc<AtomicU8>,
    due: u64,
    next: usize,
    wall_due: Option<Instant>,
}

/// The number of the first interval that ends after `time`.
fn interval_after(time: f64, every: f64) -> u64 {
    ((time / every).floor() as u64).saturating_add(1)
}

impl CheckpointSchedule {
    /// Creates the schedule of a run at `time` [s] whose process started at `started`. `signal`
    /// holds the number of a received signal.
    pub fn new(
        scene: &CheckedScene,
        time: f64,
        started: Instant,
        signal: Arc<AtomicU8>,
    ) -> CheckpointSchedule {
        let asked = scene.scene.output.checkpoint.as_ref();
        let options = asked.cloned().unwrap_or_default();
        let timed = options.every_seconds.is_some()
            || options.every_steps.is_some()
            || !options.at_times.is_empty();
        let wall = options.every_wall_seconds.or((!timed).then_some(WALL_SECONDS));
        let duration = |s: f64| Duration::try_from_secs_f64(s).unwrap_or(Duration::MAX);
        let wall = wall.map(duration).filter(|_| options.keep > 0);
        CheckpointSchedule {
            due: options.every_seconds.map_or(0, |every| interval_after(time, every)),
            next: options.at_times.iter().filter(|&&at| at <= time).count(),
            every_seconds: options.every_seconds,
            every_steps: options.every_steps,
            at_times: options.at_times,
            wall_due: wall.and_then(|wall| Instant::now().checked_add(wall)),
            wall,
            keep: options.keep,
            passing: asked.is_none(),
            limit: scene.scene.time.wall_limit.and_then(|s| started.checked_add(duration(s))),
            signal,
        }
    }

    /// Request of this rank to all ranks; only rank 0 (`first`) uses its clock.
    pub fn asks(&self, first: bool) -> u8 {
        let past = |at: Option<Instant>| first && at.is_some_and(|at| Instant::now() >= at);
        match self.signal.load(Ordering::Relaxed) {
            0 if past(self.limit) => WALL_LIMIT,
            0 if past(self.wall_due) => CHECKPOINT,
            0 => 0,
            signal => SIGNAL.saturating_add(signal),
        }
    }

    /// The reason for an early end in the agreed request `asked`, if any.
    pub fn stops(asked: u8) -> Option<Stop> {
        match asked {
            0 | CHECKPOINT => None,
            WALL_LIMIT => Some(Stop::WallLimit),
            signal => Some(Stop::Signal(signal.saturating_sub(SIGNAL))),
        }
    }

    /// Whether a checkpoint is due at the end of step `step` at `time` \[s\], with the agreed
    /// request `asked`; the same on all ranks.
    pub fn is_due(&mut self, time: f64, step: u64, asked: u8) -> bool {
        let mut due = asked >= CHECKPOINT;
        if let Some(every) = self.every_seconds
            && time >= self.due as f64 * every
        {
            self.due = interval_after(time, every);
            due = true;
        }
        while self.at_times.get(self.next).is_some_and(|&at| time >= at) {
            self.next += 1;
            due = true;
        }
        due |= self.every_steps.is_some_and(|every| step.is_multiple_of(every));
        due && self.keep > 0
    }

    /// Records that a checkpoint was written and took this time.
    pub fn written(&mut self, took: Duration) {
        let Some(wall) = self.wall else { return };
        let least = took.div_f64(SHARE);
        let wall = if self.passing { wall.max(least) } else { wall };
        self.wall_due = Instant::now().checked_add(wall);
    }
}
