//! Where the time goes: seconds of each activity of a rank, cost of each patch, and a timeline.

use nix::sys::resource::{UsageWho, getrusage};
use std::time::Instant;

use crate::effects::Effect;

/// What a rank does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activity {
    /// Phases over patches.
    Compute,
    /// Packing, copying and unpacking of ghosts, moved particles and nodal values.
    Exchange,
    /// Waiting for other ranks.
    Wait,
    /// Moving whole patches.
    Migrate,
    /// Deciding which patches move.
    Balance,
    /// Gathering what is written.
    Output,
}

impl Activity {
    /// All of them, in the order of [`Clock::seconds`].
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

/// A stretch of time on a timeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// What was done.
    pub name: &'static str,
    /// Number of the step.
    pub step: u64,
    /// Start since the clock's [ns].
    pub start: u64,
    /// Length [ns].
    pub length: u64,
}

/// The clock of a rank.
#[derive(Clone, Debug)]
pub struct Clock {
    /// Seconds of each activity, in the order of [`Activity::ALL`].
    pub seconds: [f64; Activity::ALL.len()],
    /// The rank's own events, while a timeline is kept.
    pub events: Vec<Event>,
    origin: Instant,
    step: u64,
    traced: bool,
    sampled: bool,
}

impl Clock {
    /// A clock that starts now.
    pub fn new() -> Self {
        Clock {
            seconds: [0.0; Activity::ALL.len()],
            events: Vec::new(),
            origin: Instant::now(),
            step: 0,
            traced: false,
            sampled: false,
        }
    }

    /// Sets what is kept of `step`: its events on the timeline, and the cost of patches.
    pub fn start_step(&mut self, step: u64, traced: bool, sampled: bool) {
        (self.step, self.traced, self.sampled) = (step, traced, sampled);
    }

    /// Counts seconds of an activity.
    pub fn add(&mut self, activity: Activity, seconds: f64) {
        self.seconds[activity as usize] += seconds;
    }

    /// Counts an activity from `start` to now, less `other` seconds that are counted elsewhere.
    pub fn add_since(&mut self, activity: Activity, start: Instant, other: f64) {
        self.add(activity, (start.elapsed().as_secs_f64() - other).max(0.0));
    }

    /// Notes an event of the rank from `start` to now, if a timeline is kept.
    pub fn event(&mut self, name: &'static str, start: Instant) {
        if self.traced {
            let event = self.watcher().event(name, start);
            self.events.push(event);
        }
    }

    /// What a patch needs for its own clock.
    pub fn watcher(&self) -> Watcher {
        Watcher { origin: self.origin, step: self.step, traced: self.traced, sampled: self.sampled }
    }
}

impl Default for Clock {
    fn default() -> Self {
        Clock::new()
    }
}

/// The part of a clock that all threads share.
#[derive(Clone, Copy, Debug)]
pub struct Watcher {
    origin: Instant,
    step: u64,
    traced: bool,
    sampled: bool,
}

impl Watcher {
    /// Runs a phase of a patch by the patch's `watch`.
    pub fn time<T>(&self, name: &'static str, patch: &mut T, phase: impl FnOnce(&mut T))
    where
        T: AsMut<Watch>,
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

/// Runs what an effect adds to a phase of a patch, and counts its time where phases are timed.
#[inline(always)]
pub fn spend<T: AsMut<Watch>>(effect: Effect, patch: &mut T, part: impl FnOnce(&mut T)) {
    if !patch.as_mut().runs {
        return part(patch);
    }
    let start = Instant::now();
    part(patch);
    patch.as_mut().effects[effect as usize] += start.elapsed().as_secs_f64();
}

/// Measurements of which a patch's cost is the median: one that was disturbed counts for little.
const MEASURED: usize = 9;

/// The clock of a patch.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    /// Its events, while a timeline is kept.
    pub events: Vec<Event>,
    /// Seconds of the phases that were timed.
    pub computed: f64,
    /// Seconds of each effect in them, in the order of [`Effect::ALL`].
    pub effects: [f64; Effect::COUNT],
    /// Whether a phase is being timed.
    runs: bool,
    spent: f64,
    /// Seconds of the steps measured last, the oldest overwritten first.
    measured: [f64; MEASURED],
    count: usize,
}

impl Watch {
    /// Ends a step that was measured.
    pub fn end_step(&mut self) {
        self.measured[self.count % MEASURED] = std::mem::take(&mut self.spent);
        self.count += 1;
    }

    /// Ends a step that was timed for the effects' sake alone.
    pub fn forget_step(&mut self) {
        self.spent = 0.0;
    }

    /// Seconds a step; `None` until measured.
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

    impl AsMut<Watch> for Watch {
        fn as_mut(&mut self) -> &mut Watch {
            self
        }
    }

    #[test]
    fn a_patch_is_timed_where_it_is_asked_for() {
        let (mut clock, mut watch) = (Clock::new(), Watch::default());
        let busy = |_: &mut Watch| std::thread::sleep(std::time::Duration::from_millis(2));
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
    fn a_cost_is_the_median_of_the_last_steps() {
        let mut watch = Watch::default();
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
