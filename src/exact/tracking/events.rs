//! Interactions of fronts: collisions, reflections, contact and separation of the plates.

use super::super::ExactError;
use super::super::wave::{WaveState, jump};
use super::super::wave_collision::{Outgoing, collide, set_free};
use super::wave_emission::{Leaving, Trail};
use super::{
    END_RECORD, FLYER_FACE_RECORD, FrontKind, INTERFACE_RECORD, NONE, REAR_RECORD, TrackedFront,
    Tracker, WaveRecord,
};
use crate::material::MieGruneisen;

/// Two small fronts merge if their sum is below this many quanta.
const MERGED_QUANTA: f64 = 0.75;

impl Tracker {
    /// Processes the collision of the neighbouring fronts `a` and `b` at the current time.
    pub(super) fn collision(&mut self, a: usize, b: usize) -> Result<(), ExactError> {
        let (ka, kb) = (self.fronts[a].kind, self.fronts[b].kind);
        if kb == FrontKind::End {
            if self.reached_end.is_none() {
                self.reached_end = Some((self.time, self.events));
            }
            if !self.setup.free_rear {
                self.trail(a);
                return Err(ExactError::RearNotFree);
            }
            return self.reflect_at_end(a, b);
        }
        if ka == FrontKind::Rear {
            return self.reflect_at_rear(a, b);
        }
        if a == self.interface {
            return self.meet_at_interface(None, Some(b));
        }
        if b == self.interface {
            return self.meet_at_interface(Some(a), None);
        }
        let before = self.fronts[a].prev;
        let after = self.fronts[b].next;
        if matches!(ka, FrontKind::Edge(_)) || matches!(kb, FrontKind::Edge(_)) {
            self.pass_edge(a, b);
        } else {
            self.cross(a, b)?;
        }
        self.foresee_range(before, after);
        Ok(())
    }

    fn foresee_range(&mut self, from: usize, to: usize) {
        let mut k = from;
        while k != to && k != NONE {
            self.foresee(k);
            k = self.fronts[k].next;
        }
    }

    fn no_convergence(&self, place: f64) -> ExactError {
        ExactError::NoConvergence { time: self.time, place }
    }

    /// Appends the front's current position to its path, if it draws one.
    fn trail(&mut self, k: usize) -> Trail {
        let front = &self.fronts[k];
        let path = front.path?;
        let place = front.place_at(self.time);
        self.paths[path].2.push([self.time, place]);
        Some((path, place))
    }

    fn record(&mut self, number: usize, family: usize, incoming: FrontKind, after: &WaveState) {
        self.records[number].push(WaveRecord {
            t: self.time,
            family,
            strong: incoming == FrontKind::Strong,
            edge: matches!(incoming, FrontKind::Edge(_)),
            after: [after.p, after.u],
        });
    }

    /// The edge of a fan meets a front that is not a boundary: it passes through, or disappears in
    /// a wave of its own family.
    fn pass_edge(&mut self, a: usize, b: usize) {
        let (fa, fb) = (self.fronts[a], self.fronts[b]);
        let a_is_edge = matches!(fa.kind, FrontKind::Edge(_));
        if fa.family == fb.family {
            let (lost, other) = if a_is_edge { (a, b) } else { (b, a) };
            let trail = self.trail(lost);
            // the path ends here
            if let (Some((path, _)), FrontKind::Weak) = (trail, self.fronts[other].kind) {
                self.steepened.push(path);
            }
            self.remove(lost);
            return;
        }
        let (edge, other) = if a_is_edge { (a, b) } else { (b, a) };
        let trail = self.trail(edge);
        let front = self.fronts[edge];
        let x =
            if self.fronts[other].family == 0 { self.fronts[other].x } else { fa.at(self.time) };
        if let FrontKind::Probe(number) = self.fronts[other].kind {
            let after = self.fronts[other].right;
            self.record(number, if a_is_edge { 2 } else { 0 }, front.kind, &after);
        }
        let before = fa.prev;
        self.remove(edge);
        let right = if a_is_edge { fb.right } else { self.fronts[before].right };
        let m = *self.material_of(other);
        let mut passed = self.edge(front.kind, front.family, x, &m, right);
        (passed.path, passed.place) = trail.map_or((None, x), |(k, place)| (Some(k), place));
        self.insert_after(if a_is_edge { other } else { before }, passed);
    }

    /// Material that contains a front (not the interface).
    fn material_of(&self, front: usize) -> &MieGruneisen {
        if self.fronts[front].flyer { &self.setup.flyer } else { &self.setup.target }
    }

    /// Collision of two waves, or of a wave and a contact, in one material.
    fn cross(&mut self, a: usize, b: usize) -> Result<(), ExactError> {
        let (fa, fb) = (self.fronts[a], self.fronts[b]);
        let x = if fa.family == 0 {
            fa.x
        } else if fb.family == 0 {
            fb.x
        } else {
            0.5 * (fa.at(self.time) + fb.at(self.time))
        };
        let m = *self.material_of(a);
        let before = fa.prev;
        let (left, middle, right) = (self.fronts[before].right, fa.right, fb.right);
        let (mut guess, mut incoming) = ((0.0, 0.0), [false; 2]);
        for (f, l, r) in [(&fa, &left, &middle), (&fb, &middle, &right)] {
            if f.family < 0 {
                guess.0 += r.chi - l.chi;
                incoming[0] = true;
            } else if f.family > 0 {
                guess.1 += l.chi - r.chi;
                incoming[1] = true;
            }
        }
        let split = fa.kind == FrontKind::Strong || fb.kind == FrontKind::Strong;
        let quantum = if split { self.quantum } else { f64::INFINITY };
        let out = collide((&m, &left), (&m, &right), guess, quantum, self.tolerance)
            .ok_or_else(|| self.no_convergence(x))?;
        let goes_left = incoming[0] || (out.left_star.p - left.p).abs() > self.least;
        let goes_right = incoming[1] || (out.right_star.p - right.p).abs() > self.least;
        let (mut trails, mut marker) = ([None, None], None);
        for (k, f) in [(a, &fa), (b, &fb)] {
            if f.family == 0 {
                marker = Some(f.kind);
            } else if f.path.is_some() {
                let side = usize::from(f.family > 0);
                let trail = self.trail(k);
                // a shock's path has priority over another path
                if trails[side].is_none() || f.kind == FrontKind::Strong {
                    trails[side] = trail;
                }
            }
        }
        let Outgoing { mut left_star, mut right_star, .. } = out;
        if !goes_left {
            left_star = left;
        }
        if !goes_right {
            right_star = right;
        }
        let jump_kept = 1e-5 * self.quantum / (m.rho0 * m.c0 * m.c0);
        if marker.is_none() && (left_star.chi - right_star.chi).abs() > jump_kept {
            marker = Some(FrontKind::Contact);
        }
        if marker.is_none() {
            let mean = |f: fn(&WaveState) -> f64| 0.5 * (f(&left_star) + f(&right_star));
            let both = WaveState {
                chi: mean(|s| s.chi),
                p: mean(|s| s.p),
                u: mean(|s| s.u),
                e: mean(|s| s.e),
            };
            left_star = if goes_left { both } else { left };
            right_star = if goes_right { left_star } else { right };
            if !goes_right {
                left_star = right;
            }
        }
        if let Some(FrontKind::Probe(number)) = marker {
            let came = if fa.family > 0 { (2, fa.kind) } else { (0, fb.kind) };
            self.record(number, came.0, came.1, &right_star);
        }
        self.remove(a);
        self.remove(b);
        let mut last = before;
        if goes_left {
            let (strength, steps) = out.left;
            let wave =
                Leaving { strength, steps, star: left_star, trail: trails[0], place: f64::NAN };
            last = self.send_left(last, &m, &left, x, wave);
        }
        if let Some(kind) = marker {
            let fixed = TrackedFront { t: self.time, ..TrackedFront::fixed(kind, x, right_star) };
            last = self.insert_after(last, fixed);
        }
        if goes_right {
            let (strength, steps) = out.right;
            let wave =
                Leaving { strength, steps, star: right_star, trail: trails[1], place: f64::NAN };
            self.send_right(last, &m, &right, x, wave);
        }
        Ok(())
    }

    /// A left-going front reaches the flyer's free rear.
    fn reflect_at_rear(&mut self, rear: usize, b: usize) -> Result<(), ExactError> {
        let front = self.fronts[b];
        let after = front.next;
        let place = self.fronts[rear].place_at(self.time);
        self.fronts[rear].place = place;
        self.fronts[rear].t = self.time;
        let x = self.fronts[rear].x;
        let m = self.setup.flyer;
        self.trail(b);
        self.remove(b);
        if let FrontKind::Edge(kind) = front.kind {
            let path = Some(self.new_path(x, kind, place, true));
            let edge = self.edge(front.kind, 1, x, &m, front.right);
            self.insert_after(rear, TrackedFront { path, place, ..edge });
            self.fronts[rear].right = front.right;
        } else {
            let split = front.kind == FrontKind::Strong;
            let quantum = if split { self.quantum } else { f64::INFINITY };
            let (strength, steps, star) = set_free(&m, &front.right, 1.0, quantum, self.tolerance)
                .ok_or_else(|| self.no_convergence(x))?;
            self.fronts[rear].right = star;
            let wave = Leaving { strength, steps, star, trail: None, place };
            self.send_right(rear, &m, &front.right, x, wave);
        }
        let star = self.fronts[rear].right;
        self.record(REAR_RECORD, 0, front.kind, &star);
        self.foresee_range(rear, after);
        Ok(())
    }

    /// A right-going front reaches the target's free rear.
    fn reflect_at_end(&mut self, a: usize, end: usize) -> Result<(), ExactError> {
        let front = self.fronts[a];
        let before = front.prev;
        let behind = self.fronts[before].right;
        let x = self.fronts[end].x;
        let m = self.setup.target;
        self.trail(a);
        self.remove(a);
        let place = self.eulerian(before, x);
        let mut star = behind;
        if let FrontKind::Edge(kind) = front.kind {
            let path = Some(self.new_path(x, kind, place, false));
            let edge = self.edge(front.kind, -1, x, &m, behind);
            self.insert_after(before, TrackedFront { path, place, ..edge });
        } else {
            let split = front.kind == FrontKind::Strong;
            let quantum = if split { self.quantum } else { f64::INFINITY };
            let (strength, steps, free) = set_free(&m, &behind, -1.0, quantum, self.tolerance)
                .ok_or_else(|| self.no_convergence(x))?;
            star = free;
            let wave = Leaving { strength, steps, star, trail: None, place };
            self.send_left(before, &m, &behind, x, wave);
        }
        self.fronts[end].right = star;
        self.record(END_RECORD, 2, front.kind, &star);
        self.foresee_range(before, end);
        Ok(())
    }

    /// Handles fronts that reach the interface from the flyer (`a`) or from the target (`b`); if
    /// neither is given, the plates come into contact.
    pub(super) fn meet_at_interface(
        &mut self,
        a: Option<usize>,
        b: Option<usize>,
    ) -> Result<(), ExactError> {
        let i = self.interface;
        self.faces.x = self.faces();
        self.faces.t = self.time;
        self.fronts[i].t = self.time;
        let (flyer, target) = (self.setup.flyer, self.setup.target);
        let came = a.or(b).map_or(FrontKind::Strong, |k| self.fronts[k].kind);
        let family = if a.is_some() {
            2
        } else if b.is_some() {
            0
        } else {
            1
        };
        let [mut left, mut right] = self.facing();
        let mut after = self.fronts[i].next;
        if let Some(a) = a {
            left = self.fronts[self.fronts[a].prev].right;
            self.trail(a);
            self.remove(a);
        }
        if let Some(b) = b {
            right = self.fronts[b].right;
            after = self.fronts[b].next;
            self.trail(b);
            self.remove(b);
            self.fronts[i].right = right;
        }
        let before = self.fronts[i].prev;
        let mut parted = false;
        let [place_l, place_r] = self.faces.x;
        if let FrontKind::Edge(kind) = came {
            if a.is_some() || !self.faces.open {
                let path = Some(self.new_path(0.0, kind, place_l, true));
                let edge = self.edge(came, -1, 0.0, &flyer, left);
                self.insert_after(before, TrackedFront { path, place: place_l, ..edge });
            }
            if b.is_some() || !self.faces.open {
                let path = Some(self.new_path(0.0, kind, place_r, false));
                let edge = self.edge(came, 1, 0.0, &target, right);
                self.insert_after(i, TrackedFront { path, place: place_r, ..edge });
            }
        } else {
            let split = came == FrontKind::Strong;
            let quantum = if split { self.quantum } else { f64::INFINITY };
            let failed = self.no_convergence(0.0);
            let mut waves = None;
            if !self.faces.open {
                let out = collide(
                    (&flyer, &left),
                    (&target, &right),
                    (0.0, 0.0),
                    quantum,
                    self.tolerance,
                );
                let least = -1e-6 * self.quantum * self.setup.wavelets as f64;
                match out {
                    Some(out) if out.right_star.p >= least => {
                        waves = Some((
                            Some((out.left, out.left_star)),
                            Some((out.right, out.right_star)),
                        ));
                    }
                    // if no state between them exists, the plates separate only if their free faces
                    // do
                    None if !self.free_faces_part(&left, &right, quantum) => return Err(failed),
                    _ => {
                        self.faces.open = true;
                        parted = true;
                        let t = match out {
                            Some(out) => self.parting_time(right.p, out.right_star.p),
                            None => self.time,
                        };
                        self.separation_time.get_or_insert(t);
                    }
                }
            }
            let (l, r) = match waves {
                Some(waves) => waves,
                None => {
                    let free = |m, state, side| {
                        let out = set_free(m, state, side, quantum, self.tolerance);
                        out.map(|(d, n, star)| ((d, n), star)).ok_or(failed.clone())
                    };
                    let l = if left.p != 0.0 { Some(free(&flyer, &left, -1.0)?) } else { None };
                    let r = if right.p != 0.0 { Some(free(&target, &right, 1.0)?) } else { None };
                    (l, r)
                }
            };
            if let Some(((strength, steps), star)) = l
                && (a.is_none() || (star.p - left.p).abs() > self.least)
            {
                let wave = Leaving { strength, steps, star, trail: None, place: place_l };
                self.send_left(before, &flyer, &left, 0.0, wave);
            }
            if let Some(((strength, steps), star)) = r
                && (b.is_none() || (star.p - right.p).abs() > self.least)
            {
                self.fronts[i].right = star;
                let wave = Leaving { strength, steps, star, trail: None, place: place_r };
                self.send_right(i, &target, &right, 0.0, wave);
            }
        }
        let [flyer_star, star] = self.facing();
        let both = !self.faces.open || parted;
        if b.is_some() || both {
            self.record(INTERFACE_RECORD, family, came, &star);
        }
        if a.is_some() || both {
            self.record(FLYER_FACE_RECORD, family, came, &flyer_star);
        }
        self.foresee_closing();
        self.foresee_range(before, after);
        Ok(())
    }

    /// Whether the faces of the plates move apart if each is released to P = 0 from its state.
    fn free_faces_part(&self, left: &WaveState, right: &WaveState, quantum: f64) -> bool {
        let free = |m, state, side| set_free(m, state, side, quantum, self.tolerance);
        let l = free(&self.setup.flyer, left, -1.0);
        let r = free(&self.setup.target, right, 1.0);
        l.zip(r).is_some_and(|(l, r)| l.2.u < r.2.u)
    }

    /// Time at which the pressure on the interface reached 0 [s], if the current front would change
    /// it from `before` to `after` < 0. The true pressure is half-way at each front.
    fn parting_time(&self, before: f64, after: f64) -> f64 {
        let now = 0.5 * (before + after);
        let earlier = &self.records[INTERFACE_RECORD];
        let [.., start, last] = earlier.as_slice() else { return self.time };
        let then = 0.5 * (start.after[0] + last.after[0]);
        let smooth = !last.strong && !last.edge && last.t < self.time && then > now;
        if smooth { last.t + (self.time - last.t) * then / (then - now) } else { self.time }
    }

    /// Queues the time at which the separated plates meet again.
    fn foresee_closing(&mut self) {
        self.faces.version = self.faces.version.wrapping_add(1);
        if !self.faces.open {
            return;
        }
        let [l, r] = self.facing();
        let rate = l.u - r.u;
        if rate > 1e-12 * self.setup.speed {
            let gap = (self.faces.x[1] - self.faces.x[0]).max(0.0);
            self.heap.push(super::Meeting {
                t: self.time + gap / rate,
                fronts: [self.interface, NONE],
                stamps: [self.faces.version, 0],
            });
        }
    }

    /// Closes the gap between the plates.
    pub(super) fn close(&mut self) -> Result<(), ExactError> {
        let x = self.faces();
        self.faces.x = [0.5 * (x[0] + x[1]); 2];
        self.faces.t = self.time;
        self.faces.open = false;
        self.meet_at_interface(None, None)
    }

    /// Merges neighbours of one family that are small even together, so that waves weakened by
    /// reflections consist of fewer fronts.
    pub(super) fn merge_small(&mut self) {
        let reach = 0.02 * self.setup.thickness;
        let mut a = self.fronts[self.rear].next;
        while a != NONE {
            let b = self.fronts[a].next;
            if b == NONE {
                break;
            }
            let (fa, fb) = (self.fronts[a], self.fronts[b]);
            let small = |f: &TrackedFront| f.kind == FrontKind::Weak && f.path.is_none();
            let left = self.fronts[fa.prev].right;
            let (da, db) = (fa.right.p - left.p, fb.right.p - fa.right.p);
            let (xa, xb) = (fa.at(self.time), fb.at(self.time));
            let merges = fa.family == fb.family
                && small(&fa)
                && small(&fb)
                && da * db > 0.0
                && (da + db).abs() < MERGED_QUANTA * self.quantum
                && xb - xa < reach;
            if !merges {
                a = b;
                continue;
            }
            let m = *self.material_of(a);
            let side = f64::from(fa.family);
            let (ahead, behind) = if side > 0.0 { (fb.right, left) } else { (left, fb.right) };
            let speed = side * jump(&m, &ahead, behind.chi - ahead.chi, side).speed;
            let x = (da * xa + db * xb) / (da + db);
            let before = fa.prev;
            self.remove(a);
            self.remove(b);
            let merged = TrackedFront { x, t: self.time, speed, ..fb };
            let k = self.insert_after(before, TrackedFront { path: None, ..merged });
            self.foresee(before);
            self.foresee(k);
            a = self.fronts[k].next;
        }
    }
}
