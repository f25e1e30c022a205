//! Insertion of waves into the sequence of fronts.

use super::super::profile::PathKind;
use super::super::profile::Plate;
use super::super::wave::{WaveState, jump, sound_speed};
use super::{FrontKind, NONE, TrackedFront, Tracker};
use crate::material::MieGruneisen;

/// A front whose compression exceeds this many quanta is a shock.
const SHOCK_QUANTA: f64 = 3.0;
/// A path that continues: its number and its current Eulerian position [m].
pub(super) type Trail = Option<(usize, f64)>;

/// A wave to be inserted.
pub(super) struct Leaving {
    /// Strength, the change of the compression chi [-].
    pub strength: f64,
    /// Number of fronts that represent the wave.
    pub steps: usize,
    /// State behind the wave.
    pub star: WaveState,
    /// Path that the wave continues.
    pub trail: Trail,
    /// Eulerian position, for paths that start here [m].
    pub place: f64,
}

impl Tracker {
    pub(super) fn new_path(&mut self, x: f64, kind: PathKind, place: f64, flyer: bool) -> usize {
        debug_assert!(x.is_finite());
        let plate = if flyer { Plate::Flyer } else { Plate::Target };
        self.paths.push((plate, kind, vec![[self.time, place]]));
        self.paths.len() - 1
    }

    pub(super) fn edge(
        &self,
        kind: FrontKind,
        family: i8,
        x: f64,
        m: &MieGruneisen,
        right: WaveState,
    ) -> TrackedFront {
        let speed = f64::from(family) * sound_speed(m, &right);
        TrackedFront { family, t: self.time, speed, ..TrackedFront::fixed(kind, x, right) }
    }

    /// Kind of a single front, its path and its position [m]; a shock starts a path.
    pub(super) fn kind_and_path(
        &mut self,
        x: f64,
        dp: f64,
        wave: &Leaving,
        last: usize,
    ) -> (FrontKind, Option<usize>, f64) {
        let strong = dp > SHOCK_QUANTA * self.quantum;
        let kind = if strong { FrontKind::Strong } else { FrontKind::Weak };
        match wave.trail {
            Some((path, place)) => (kind, Some(path), place),
            None if strong => {
                let place = if wave.place.is_nan() { self.eulerian(last, x) } else { wave.place };
                let flyer = self.fronts[last].flyer;
                (kind, Some(self.new_path(x, PathKind::Shock, place, flyer)), place)
            }
            None => (kind, None, x),
        }
    }

    /// Eulerian position of X = `x` [m], which lies in the state after front `last`.
    pub(super) fn eulerian(&self, last: usize, x: f64) -> f64 {
        let faces = self.faces();
        let at = |k: usize| self.fronts[k].at(self.time);
        if self.fronts[last].flyer {
            let (mut place, mut k, mut from) = (faces[0], self.fronts[self.interface].prev, 0.0);
            while k != last && k != NONE {
                place -= (1.0 - self.fronts[k].right.chi) * (from - at(k));
                (from, k) = (at(k), self.fronts[k].prev);
            }
            place - (1.0 - self.fronts[last].right.chi) * (from - x)
        } else {
            let (mut place, mut k) = (faces[1], self.interface);
            while k != last {
                let next = self.fronts[k].next;
                place += (1.0 - self.fronts[k].right.chi) * (at(next) - at(k));
                k = next;
            }
            place + (1.0 - self.fronts[last].right.chi) * (x - at(last))
        }
    }

    /// Inserts a left-going wave after the front `last`; returns the last front inserted.
    pub(super) fn send_left(
        &mut self,
        last: usize,
        m: &MieGruneisen,
        ahead: &WaveState,
        x: f64,
        wave: Leaving,
    ) -> usize {
        let front = TrackedFront {
            family: -1,
            t: self.time,
            ..TrackedFront::fixed(FrontKind::Weak, x, wave.star)
        };
        if wave.steps == 1 {
            let (kind, path, place) = self.kind_and_path(x, wave.star.p - ahead.p, &wave, last);
            let speed = -jump(m, ahead, wave.strength, -1.0).speed;
            return self.insert_after(last, TrackedFront { kind, speed, path, place, ..front });
        }
        let flyer = self.fronts[last].flyer;
        let place = if wave.place.is_nan() { self.eulerian(last, x) } else { wave.place };
        let mut last = last;
        let mut state = *ahead;
        for end in [PathKind::FanHead, PathKind::FanTail] {
            let path = Some(self.new_path(x, end, place, flyer));
            let edge = self.edge(FrontKind::Edge(end), -1, x, m, state);
            last = self.insert_after(last, TrackedFront { path, place, ..edge });
            if end == PathKind::FanTail {
                break;
            }
            for k in 1..=wave.steps {
                let step = jump(m, &state, wave.strength / wave.steps as f64, -1.0);
                state = if k == wave.steps { wave.star } else { step.behind };
                last = self
                    .insert_after(last, TrackedFront { speed: -step.speed, right: state, ..front });
            }
        }
        last
    }

    /// Inserts a right-going wave after the front `last`, whose state becomes that of the wave.
    pub(super) fn send_right(
        &mut self,
        last: usize,
        m: &MieGruneisen,
        ahead: &WaveState,
        x: f64,
        wave: Leaving,
    ) {
        let front = TrackedFront {
            family: 1,
            t: self.time,
            ..TrackedFront::fixed(FrontKind::Weak, x, *ahead)
        };
        if wave.steps == 1 {
            let (kind, path, place) = self.kind_and_path(x, wave.star.p - ahead.p, &wave, last);
            let speed = jump(m, ahead, wave.strength, 1.0).speed;
            self.insert_after(last, TrackedFront { kind, speed, path, place, ..front });
            return;
        }
        let flyer = self.fronts[last].flyer;
        let place = if wave.place.is_nan() { self.eulerian(last, x) } else { wave.place };
        let mut state = *ahead;
        // from the head backwards: each front is inserted directly after `last`
        for end in [PathKind::FanHead, PathKind::FanTail] {
            let path = Some(self.new_path(x, end, place, flyer));
            let edge = self.edge(FrontKind::Edge(end), 1, x, m, state);
            self.insert_after(last, TrackedFront { path, place, ..edge });
            if end == PathKind::FanTail {
                break;
            }
            for k in 1..=wave.steps {
                let step = jump(m, &state, wave.strength / wave.steps as f64, 1.0);
                self.insert_after(last, TrackedFront { speed: step.speed, right: state, ..front });
                state = if k == wave.steps { wave.star } else { step.behind };
            }
        }
    }
}
