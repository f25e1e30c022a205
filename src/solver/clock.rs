//! Timing: seconds of each activity of a rank, cost of each patch, and a timeline.

use std::time::Instant;

use nix::sys::resource::{UsageWho, getrusage};
use smallvec::SmallVec;

/// Activity of a rank.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activity {
    /// Phases over patches.
    Compute,
    /// Packing, copying and unpacking of ghosts, migrating particles and nodal values.
    Exchange,
    /// Waiting for other ranks.
    Wait,
    /// Moving whole patches.
    Migrate,
    /// Deciding which patches move.
    Balance,
    /// Gathering of output data.
    Output,
}

impl Activity {
    /// All activities, in the order of [`Clock::seconds`].
    pub const ALL: [Activity; 6] = [
        Activity::Compute,
        Activity::Exchange,
        Activity::Wait,
        Activity::Migrate,
        Activity::Balance,
        Activity::Output,
    ];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Activity::Compute => "compute",
            Activity::Exchange => "exchange",
            Activity::Wait => "wait",
            Activity::Migrate => "migrate",
            Activity::Balance => "balance",
            Activity::Output => "output",
        }
    }
}

/// Interval on a timeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Name of the activity.
    pub name: &'static str,
    /// Number of the step.
    pub step: u64,
    /// Start since that of the clock [ns].
    pub start: u64,
    /// Duration [ns].
    pub length: u64,
}

/// Phases and exchanges that a rank has done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Phases over patches outside of an exchange of particles.
    pub plain_phases: u64,
    /// Phases over patches from an exchange of particles to the next, if halos are exchanged.
    pub nodal_phases: u64,
    /// Exchanges of particles.
    pub particle_exchanges: u64,
    /// Exchanges of nodal values.
    pub node_exchanges: u64,
    /// Fields in these exchanges.
    pub node_fields: u64,
}

/// Clock of a rank.
#[derive(Clone, Debug)]
pub struct Clock {
    /// Phases and exchanges so far.
    pub operations: Operations,
    /// Time of each activity, in the order of [`Activity::ALL`] [s].
    pub seconds: [f64; Activity::ALL.len()],
    /// Events of the rank, while a timeline is recorded.
    pub events: Vec<Event>,
    origin: Instant,
    step: u64,
    traced: bool,
    sampled: bool,
    stopped: bool,
}

impl Clock {
    /// A clock that starts now.
    pub fn new() -> Self {
        Clock {
            operations: Operations::default(),
            seconds: [0.0; Activity::ALL.len()],
            events: Vec::new(),
            origin: Instant::now(),
            step: 0,
            traced: false,
            sampled: false,
            stopped: false,
        }
    }

    /// Stops the clock: unread times cost several per cent of a step of few particles.
    pub fn stop(&mut self) {
        self.stopped = true;
    }

    /// Whether the clock is stopped.
    pub fn is_stopped(&self) -> bool {
        self.stopped
    }

    /// The present time; `None` if the clock is stopped.
    pub fn now(&self) -> Option<Instant> {
        (!self.stopped).then(Instant::now)
    }

    /// Sets what to record in `step`: timeline events, and the cost of patches.
    pub fn start_step(&mut self, step: u64, traced: bool, sampled: bool) {
        (self.step, self.traced, self.sampled) = (step, traced, sampled);
    }

    /// Adds `seconds` [s] to an activity.
    pub fn add(&mut self, activity: Activity, seconds: f64) {
        self.seconds[activity as usize] += seconds;
    }

    /// Adds the time from `start` to now to an activity, minus the time `other` [s] that is counted
    /// elsewhere. `start` is that of [`Clock::now`].
    pub fn add_since(&mut self, activity: Activity, start: Option<Instant>, other: f64) {
        if let Some(start) = start {
            self.add(activity, (start.elapsed().as_secs_f64() - other).max(0.0));
        }
    }

    /// Records an event of the rank from `start` to now, if a timeline is recorded.
    pub fn event(&mut self, name: &'static str, start: Option<Instant>) {
        if self.traced
            && let Some(start) = start
        {
            let event = self.watcher().event(name, start);
            self.events.push(event);
        }
    }

    /// Settings that the stopwatches of patches need.
    pub fn watcher(&self) -> Watcher {
        Watcher { origin: self.origin, step: self.step, traced: self.traced, sampled: self.sampled }
    }
}

impl Default for Clock {
    fn default() -> Self {
        Clock::new()
    }
}

/// Part of a clock that all threads share.
#[derive(Clone, Copy, Debug)]
pub struct Watcher {
    origin: Instant,
    step: u64,
    traced: bool,
    sampled: bool,
}

impl Watcher {
    /// Runs a phase of a patch, timed by the stopwatch of the patch.
    pub fn time<T>(&self, name: &'static str, patch: &mut T, phase: impl FnOnce(&mut T))
    where
        T: AsMut<Stopwatch>,
    {
        if !self.traced && !self.sampled {
            return phase(patch);
        }
        patch.as_mut().runs = true;
        let start = Instant::now();
        phase(patch);
        let event = self.event(name, start);
        let watch = patch.as_mut();
        watch.runs = false;
        watch.computed += event.length as f64 * 1e-9;
        watch.spent += event.length as f64 * 1e-9;
        if self.traced {
            watch.events.push(event);
        }
    }

    fn event(&self, name: &'static str, start: Instant) -> Event {
        let since = start.duration_since(self.origin).as_nanos() as u64;
        let length = start.elapsed().as_nanos() as u64;
        Event { name, step: self.step, start: since, length }
    }
}

/// Runs the contribution of a [part](super::parts) of a step to a phase of a patch, and adds its
/// time if phases are timed.
#[inline(always)]
pub fn timed<T: AsMut<Stopwatch>>(part: usize, patch: &mut T, phase: impl FnOnce(&mut T)) {
    if !patch.as_mut().runs {
        return phase(patch);
    }
    let start = Instant::now();
    phase(patch);
    let seconds = start.elapsed().as_secs_f64();
    let parts = &mut patch.as_mut().parts;
    if parts.len() <= part {
        parts.resize(part + 1, 0.0);
    }
    parts[part] += seconds;
}

/// Like `timed`, with `part` optional, for a phase that does not need the patch.
#[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
#[inline(always)]
pub fn timed_if<R>(part: Option<usize>, watch: &mut Stopwatch, phase: impl FnOnce() -> R) -> R {
    let Some(part) = part else { return phase() };
    let mut result = None;
    timed(part, watch, |_| result = Some(phase()));
    result.expect("the phase has run")
}

impl AsMut<Stopwatch> for Stopwatch {
    fn as_mut(&mut self) -> &mut Stopwatch {
        self
    }
}

/// Number of measurements whose median is the cost of a patch: outliers have little effect.
const MEASURED: usize = 9;

/// Stopwatch of a patch.
#[derive(Clone, Debug, Default)]
pub struct Stopwatch {
    /// Events of the patch, while a timeline is recorded.
    pub events: Vec<Event>,
    /// Time of the phases that were timed [s].
    pub computed: f64,
    /// Time of each part of a step in these phases [s]; trailing parts without time may be missing.
    pub parts: SmallVec<[f64; 32]>,
    /// Whether a phase is being timed.
    runs: bool,
    spent: f64,
    /// Seconds of the last measured steps; the oldest is overwritten first.
    measured: [f64; MEASURED],
    count: usize,
}

impl Stopwatch {
    /// Ends a measured step.
    pub fn end_step(&mut self) {
        self.measured[self.count % MEASURED] = std::mem::take(&mut self.spent);
        self.count += 1;
    }

    /// Ends a step that was timed only for the shares of effects.
    pub fn forget_step(&mut self) {
        self.spent = 0.0;
    }

    /// Computing time of the patch per step [s]; `None` before the first measurement.
    pub fn cost(&self) -> Option<f64> {
        let mut known = self.measured;
        let known = &mut known[..self.count.min(MEASURED)];
        known.sort_by(f64::total_cmp);
        known.get(known.len() / 2).copied()
    }
}

/// User CPU time of this process so far [s].
pub fn user_cpu_seconds() -> f64 {
    getrusage(UsageWho::RUSAGE_SELF).map_or(0.0, |usage| {
        let time = usage.user_time();
        time.tv_sec() as f64 + 1e-6 * time.tv_usec() as f64
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_patch_is_timed_where_it_is_asked_for() {
        let (mut clock, mut watch) = (Clock::new(), Stopwatch::default());
        let busy = |_: &mut Stopwatch| std::thread::sleep(std::time::Duration::from_millis(2));
        clock.start_step(1, false, false);
        clock.watcher().time("phase", &mut watch, busy);
        assert_eq!((watch.spent, watch.events.len()), (0.0, 0));
        clock.start_step(2, true, false);
        clock.watcher().time("phase", &mut watch, busy);
        assert_eq!((watch.events[0].name, watch.events[0].step), ("phase", 2));
        assert!(watch.events[0].length >= 2_000_000);
        watch.end_step();
        assert!(watch.cost().unwrap() >= 2e-3 && watch.spent == 0.0);
    }

    #[test]
    fn a_stopped_clock_counts_no_time() {
        let mut clock = Clock::new();
        let start = clock.now();
        std::thread::sleep(std::time::Duration::from_millis(2));
        clock.add_since(Activity::Compute, start, 0.0);
        assert!(clock.seconds[Activity::Compute as usize] >= 2e-3);
        let before = clock.seconds;
        clock.stop();
        clock.start_step(1, true, false);
        let start = clock.now();
        clock.add_since(Activity::Compute, start, 0.0);
        clock.event("phase", start);
        assert_eq!((start, clock.seconds, clock.events.len()), (None, before, 0));
    }

    #[test]
    fn a_cost_is_the_median_of_the_last_steps() {
        let mut watch = Stopwatch::default();
        assert_eq!(watch.cost(), None);
        for (spent, cost) in [(5.0, 5.0), (1.0, 5.0), (2.0, 2.0)] {
            watch.spent = spent;
            watch.end_step();
            assert_eq!(watch.cost(), Some(cost));
        }
        for _ in 0..MEASURED {
            watch.spent = 3.0;
            watch.end_step();
        }
        assert_eq!(watch.cost(), Some(3.0));
    }
}
