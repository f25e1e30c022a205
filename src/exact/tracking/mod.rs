//! Front tracking of a plate impact in Lagrangian coordinates: the true solution, with fans.
//!
//! The solution is a sequence of fronts with constant states between them. Fans are split into
//! small fronts, each a jump that conserves mass, momentum and energy. Where two fronts meet, the
//! Riemann problem between the outer states gives the outgoing waves. There is no grid and no
//! smearing. This one rule covers shocks, their attenuation by a fan, waves that steepen into
//! shocks, reflections at free surfaces and at the interface, and separation and renewed contact of
//! the plates. With n fronts per fan the error decreases as 1/n^2, once the staircase is read as in
//! [`super::smoothing`]; the cost grows as n^2. Sources: Dafermos (1972), J. Math. Anal. Appl. 38,
//! 33; Holden & Risebro (2015), Front Tracking for Hyperbolic Conservation Laws, ch. 6.
//!
//! Frame: flyer [-L, 0] at +U, target [0, T] at rest, contact at t = 0; X is the position before
//! the impact.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::profile::PathKind;
use super::profile::Plate;
use super::wave::{WaveState, at_rest};
use super::wave_interactions::{check, impedance_match};
use super::{ExactError, positive};
use crate::material::MieGruneisen;

mod events;
mod read;
mod wave_emission;

/// Greatest number of interactions before the tracking gives up.
const MOST_EVENTS: usize = 20_000_000;

/// Greatest number of interactions after a front has reached the target's rear. Profiles are no
/// longer scored then; the waves are only drawn.
const MOST_EVENTS_FROM_REAR: usize = 500_000;

/// Kind of a front.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FrontKind {
    /// A small part of a smooth wave.
    Weak,
    /// The edge of a fan: it has no strength and runs at the sound speed.
    Edge(PathKind),
    /// A shock.
    Strong,
    /// A jump of density and energy only.
    Contact,
    /// A material point whose history is recorded, with its number.
    Probe(usize),
    /// The flyer's free rear.
    Rear,
    /// The contact face of the plates.
    Interface,
    /// The target's free rear.
    End,
}

/// One front, and the state to its right.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrackedFront {
    /// Kind of the front.
    pub kind: FrontKind,
    /// -1 left-going, 0 fixed to the material, 1 right-going.
    pub family: i8,
    /// Lagrangian position at the time `t` [m].
    pub x: f64,
    /// Time to which `x` and `place` belong [s].
    pub t: f64,
    /// Lagrangian speed, signed [m/s].
    pub speed: f64,
    /// State to the right of the front.
    pub right: WaveState,
    /// Number of the path that the front draws; `None` if it draws none.
    pub path: Option<usize>,
    /// Eulerian position at the time `t`, for fronts that draw a path [m].
    pub place: f64,
    /// Whether the front is in the flyer.
    flyer: bool,
    prev: usize,
    next: usize,
    stamp: u32,
}

impl TrackedFront {
    fn fixed(kind: FrontKind, x: f64, right: WaveState) -> TrackedFront {
        TrackedFront {
            kind,
            family: 0,
            x,
            t: 0.0,
            speed: 0.0,
            right,
            path: None,
            place: x,
            flyer: true,
            prev: NONE,
            next: NONE,
            stamp: 0,
        }
    }

    /// Lagrangian position at `t` [m].
    pub(super) fn at(&self, t: f64) -> f64 {
        self.x + self.speed * (t - self.t)
    }

    /// Eulerian position at `t` [m], if the front draws a path.
    pub(super) fn place_at(&self, t: f64) -> f64 {
        self.place + (self.right.u + (1.0 - self.right.chi) * self.speed) * (t - self.t)
    }
}

const NONE: usize = usize::MAX;

/// Two neighbours that will meet; the soonest meeting compares as the greatest.
#[derive(Clone, Copy, Debug)]
struct Meeting {
    t: f64,
    fronts: [usize; 2],
    stamps: [u32; 2],
}

impl PartialEq for Meeting {
    fn eq(&self, other: &Meeting) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Meeting {}

impl PartialOrd for Meeting {
    fn partial_cmp(&self, other: &Meeting) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Meeting {
    fn cmp(&self, other: &Meeting) -> Ordering {
        other.t.total_cmp(&self.t).then_with(|| other.fronts.cmp(&self.fronts))
    }
}

/// One change of the state of a recorded material point.
#[derive(Clone, Copy, Debug)]
pub(super) struct WaveRecord {
    /// Time of the change [s].
    pub t: f64,
    /// Family of the arriving front: 0 from the right, 2 from the left, 1 neither.
    pub family: usize,
    /// Whether the front is a shock.
    pub strong: bool,
    /// Whether the front is the edge of a wave.
    pub edge: bool,
    /// Pressure [Pa] and velocity [m/s] after the front.
    pub after: [f64; 2],
}

/// The contact faces of the plates, whether they touch or not.
#[derive(Clone, Copy, Debug)]
struct Faces {
    t: f64,
    /// Eulerian positions of the flyer's face and of the target's [m].
    x: [f64; 2],
    open: bool,
    version: u32,
}

/// Parameters of the tracking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TrackingSetup {
    /// Material of the flyer.
    pub flyer: MieGruneisen,
    /// Material of the target.
    pub target: MieGruneisen,
    /// Closing speed U [m/s].
    pub speed: f64,
    /// Thickness L of the flyer [m].
    pub thickness: f64,
    /// Thickness T of the target [m].
    pub target_thickness: f64,
    /// Number of fronts of a fan that falls from P2 to 0.
    pub wavelets: usize,
    /// Whether the target's rear is a free surface.
    pub free_rear: bool,
}

/// The sequence of fronts at one time.
#[derive(Clone, Debug)]
pub(super) struct Tracker {
    /// Parameters of the tracking.
    pub setup: TrackingSetup,
    fronts: Vec<TrackedFront>,
    free: Vec<usize>,
    heap: BinaryHeap<Meeting>,
    /// Current time [s].
    pub time: f64,
    rear: usize,
    interface: usize,
    faces: Faces,
    /// Pressure of one front of a fan [Pa].
    quantum: f64,
    /// Weaker waves than this are not emitted; their jump stays where it is [Pa].
    least: f64,
    tolerance: f64,
    /// Number of interactions so far.
    pub events: usize,
    next_merge: usize,
    /// Records of the interface (target's side), of the flyer's rear, of the interface (flyer's
    /// side), of the target's rear, and of the probes.
    pub records: Vec<Vec<WaveRecord>>,
    /// Paths: plate, kind, corner points of time [s] and Eulerian position [m].
    pub paths: Vec<(Plate, PathKind, Vec<[f64; 2]>)>,
    /// Numbers of the paths that end within a smooth wave of their own family.
    pub steepened: Vec<usize>,
    /// Time of the first separation of the plates [s], interpolated between the fronts of the fan.
    pub separation_time: Option<f64>,
    /// Time at which a front first reached the target's rear [s], and the number of interactions by
    /// then.
    pub reached_end: Option<(f64, usize)>,
    /// Reason why the waves are not followed beyond the time reached.
    pub stopped: Option<ExactError>,
}

/// Index of the record of the interface; this and the next three records are always kept.
pub(super) const INTERFACE_RECORD: usize = 0;
/// See [`INTERFACE_RECORD`].
pub(super) const REAR_RECORD: usize = 1;
/// See [`INTERFACE_RECORD`].
pub(super) const FLYER_FACE_RECORD: usize = 2;
/// Record of the target's rear.
pub(super) const END_RECORD: usize = 3;
/// Index of the first probe's record.
pub(super) const FIRST_PROBE: usize = 4;

impl Tracker {
    /// The state at the moment of contact; `probes` are Lagrangian positions in the plates [m].
    pub(super) fn new(
        setup: TrackingSetup,
        probes: &[(Plate, f64)],
    ) -> Result<Tracker, ExactError> {
        let TrackingSetup { flyer, target, speed, thickness, .. } = setup;
        check(&flyer, &target, speed, thickness)?;
        positive("the target's thickness", setup.target_thickness)?;
        if !(8..=20_000).contains(&setup.wavelets) {
            let value = setup.wavelets as f64;
            return Err(ExactError::Number { name: "wavelets", value, allowed: "8 to 20000" });
        }
        let u2 = impedance_match(&flyer, &target, speed);
        let p2 = super::wave::shocked(&target, u2).p;
        let quantum = p2 / setup.wavelets as f64;
        let mut tracker = Tracker {
            setup,
            fronts: Vec::new(),
            free: Vec::new(),
            heap: BinaryHeap::new(),
            time: 0.0,
            rear: 0,
            interface: 0,
            faces: Faces { t: 0.0, x: [0.0; 2], open: false, version: 0 },
            quantum,
            least: (2e-5 * quantum).min(1e-6 * p2),
            tolerance: 1e-12 * p2,
            events: 0,
            next_merge: 1000,
            records: vec![Vec::new(); FIRST_PROBE + probes.len()],
            paths: Vec::new(),
            steepened: Vec::new(),
            separation_time: None,
            reached_end: None,
            stopped: None,
        };
        let (moving, still) = (at_rest(speed), at_rest(0.0));
        let mut fixed: Vec<TrackedFront> = vec![
            TrackedFront::fixed(FrontKind::Rear, -thickness, moving),
            TrackedFront::fixed(FrontKind::Interface, 0.0, still),
            TrackedFront::fixed(FrontKind::End, setup.target_thickness, still),
        ];
        let least = 1e-9 * thickness.min(setup.target_thickness);
        for (number, &(plate, x)) in probes.iter().enumerate() {
            let (range, state) = match plate {
                Plate::Flyer => (-thickness..=0.0, moving),
                Plate::Target => (0.0..=setup.target_thickness, still),
            };
            if x < range.start() - least || x > range.end() + least || x.is_nan() {
                return Err(ExactError::Number {
                    name: "a tracer",
                    value: x,
                    allowed: "in its plate",
                });
            }
            // slightly inside of the ends, so that the order of the fronts is unambiguous
            let x = x.clamp(range.start() + least, range.end() - least);
            fixed.push(TrackedFront::fixed(FrontKind::Probe(FIRST_PROBE + number), x, state));
        }
        fixed.sort_by(|a, b| a.x.total_cmp(&b.x));
        for front in fixed {
            let last = tracker.fronts.len().checked_sub(1).unwrap_or(NONE);
            let k = tracker.insert_after(last, front);
            if front.kind == FrontKind::Interface {
                tracker.interface = k;
            }
        }
        tracker.meet_at_interface(None, None)?;
        Ok(tracker)
    }

    /// Advances to the time `t`, or to the time from which the waves cannot be followed; see
    /// [`Tracker::stopped`].
    pub(super) fn advance(&mut self, t: f64) {
        if self.stopped.is_some() {
            return;
        }
        match self.follow(t) {
            Ok(()) => self.time = t,
            Err(reason) => self.stopped = Some(reason),
        }
    }

    /// Greatest number of interactions allowed at this time.
    fn most_events(&self) -> usize {
        let from_rear = self.reached_end.map(|(_, before)| before + MOST_EVENTS_FROM_REAR);
        from_rear.map_or(MOST_EVENTS, |most| most.min(MOST_EVENTS))
    }

    /// Follows all interactions up to the time `t`.
    fn follow(&mut self, t: f64) -> Result<(), ExactError> {
        while let Some(&meeting) = self.heap.peek() {
            if meeting.t > t {
                break;
            }
            self.heap.pop();
            let [a, b] = meeting.fronts;
            if a == self.interface && b == NONE {
                if meeting.stamps[0] == self.faces.version {
                    self.time = meeting.t;
                    self.close()?;
                }
                continue;
            }
            let fresh = self.fronts[a].stamp == meeting.stamps[0]
                && self.fronts[b].stamp == meeting.stamps[1]
                && self.fronts[a].next == b;
            if !fresh {
                continue;
            }
            self.time = meeting.t;
            self.events += 1;
            let limit = self.most_events();
            if self.events > limit {
                return Err(ExactError::TooManyWaves { limit, time: self.time });
            }
            self.collision(a, b)?;
            if self.events >= self.next_merge {
                self.merge_small();
                self.next_merge = self.events + 4 * self.fronts.len() + 1000;
            }
        }
        Ok(())
    }

    /// The fronts from the flyer's rear to the target's rear.
    pub(super) fn row(&self) -> impl Iterator<Item = &TrackedFront> {
        let mut k = self.rear;
        std::iter::from_fn(move || {
            let front = self.fronts.get(k)?;
            k = front.next;
            Some(front)
        })
    }

    /// Current Eulerian positions of the flyer's face and of the target's [m].
    pub(super) fn faces(&self) -> [f64; 2] {
        let [l, r] = self.facing();
        let dt = self.time - self.faces.t;
        [self.faces.x[0] + l.u * dt, self.faces.x[1] + r.u * dt]
    }

    /// The states on both sides of the interface.
    fn facing(&self) -> [WaveState; 2] {
        let i = &self.fronts[self.interface];
        [self.fronts[i.prev].right, i.right]
    }

    fn insert_after(&mut self, prev: usize, front: TrackedFront) -> usize {
        let next = if prev == NONE { NONE } else { self.fronts[prev].next };
        let k = match self.free.pop() {
            Some(k) => {
                let stamp = self.fronts[k].stamp;
                self.fronts[k] = TrackedFront { stamp, ..front };
                k
            }
            None => {
                self.fronts.push(front);
                self.fronts.len() - 1
            }
        };
        self.fronts[k].prev = prev;
        self.fronts[k].next = next;
        self.fronts[k].flyer =
            prev == NONE || (self.fronts[prev].flyer && front.kind != FrontKind::Interface);
        if prev != NONE {
            self.fronts[prev].next = k;
        }
        if next != NONE {
            self.fronts[next].prev = k;
        }
        k
    }

    fn remove(&mut self, k: usize) {
        let TrackedFront { prev, next, .. } = self.fronts[k];
        if prev != NONE {
            self.fronts[prev].next = next;
        }
        if next != NONE {
            self.fronts[next].prev = prev;
        }
        self.fronts[k].stamp = self.fronts[k].stamp.wrapping_add(1);
        self.free.push(k);
    }

    /// Computes when front `a` meets its right neighbour, and queues the meeting.
    fn foresee(&mut self, a: usize) {
        let b = self.fronts[a].next;
        if b == NONE {
            return;
        }
        let (fa, fb) = (&self.fronts[a], &self.fronts[b]);
        let closing = fa.speed - fb.speed;
        if closing <= 1e-12 * self.setup.flyer.c0 {
            return;
        }
        let gap = fb.at(self.time) - fa.at(self.time);
        let t = self.time + (gap / closing).max(0.0);
        self.heap.push(Meeting { t, fronts: [a, b], stamps: [fa.stamp, fb.stamp] });
    }
}
