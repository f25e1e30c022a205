//! The impact of two plates in the coordinates of a scene: which body strikes which, the position
//! and time of contact, and the true solution at the requested times.
//!
//! In the frame of `super::tracking` and [`super::wave_interactions`] the flyer is on the left, the
//! target is at rest at x >= 0, and contact is at t = 0. Here the flyer may come from either side,
//! both bodies may move, and there may be a gap. Profiles are scored until the target's shock
//! reaches its rear; the waves are also followed after their reflection from the free rear.

use super::profile::Plate;
use super::profile::{History, HistoryPoint, Landmarks, Path, PathKind, Profile, ProfilePoint};
use super::release::Release;
use super::tracking::{
    END_RECORD, FIRST_PROBE, FLYER_FACE_RECORD, INTERFACE_RECORD, REAR_RECORD, Tracker,
    TrackingSetup,
};
use super::wave_interactions::Chain;
use super::{ExactError, finite};
use crate::material::MieGruneisen;

/// A plate at time 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImpactBody {
    /// Material of the plate.
    pub material: MieGruneisen,
    /// Lower face [m].
    pub lower: f64,
    /// Upper face [m].
    pub upper: f64,
    /// Velocity [m/s].
    pub velocity: f64,
}

/// Resolution of the waves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Accuracy {
    /// Number of fronts of a fan that falls from P2 to 0. The error is proportional to its inverse
    /// square, the cost to its square.
    pub wavelets: usize,
}

impl Default for Accuracy {
    fn default() -> Accuracy {
        Accuracy { wavelets: 240 }
    }
}

/// A material point whose history is requested.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TracedPoint {
    /// Plate that contains the point.
    pub plate: Plate,
    /// Position at time 0 [m].
    pub x: f64,
}

/// The solution at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Time [s].
    pub time: f64,
    /// Both plates, sorted by x; `None` once the shock has reached the target's rear.
    pub profile: Option<Profile>,
    /// Both plates, sorted by x, also after the shock has reached the target's rear; `None` once
    /// the waves are no longer followed ([`Solution::stopped`]).
    pub whole: Option<Profile>,
    /// The target alone.
    pub target: Option<Profile>,
    /// Features of the target's profile; `None` before contact, and where the profile is `None`.
    pub landmarks: Option<Landmarks>,
}

/// The true solution of an impact.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// One snapshot per requested time, in the order of the request.
    pub snapshots: Vec<Snapshot>,
    /// The target's impact face.
    pub interface: History,
    /// The flyer's impact face; it leaves the target's once the plates separate.
    pub flyer_face: History,
    /// The flyer's free rear.
    pub flyer_rear: History,
    /// The target's free rear.
    pub target_rear: History,
    /// One history per tracer, in the order of the request.
    pub tracers: Vec<History>,
    /// Paths in the x-t diagram.
    pub paths: Vec<Path>,
    /// States and times that need no tracking; times count from contact, velocities are relative to
    /// the target.
    pub release: Release,
    /// Time at which the plates first separate [s].
    pub separation_time: Option<f64>,
    /// Time at which the shock reaches the target's rear [s]; infinite if that is after the last
    /// requested time.
    pub valid_until: f64,
    /// Time from which the waves are no longer followed [s], and the reason; `None` if they are
    /// followed to the last requested time. Histories and paths end there.
    pub stopped: Option<(f64, ExactError)>,
    /// Number of wave interactions followed.
    pub interactions: usize,
}

/// The impact of a flyer on a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// The striking body.
    pub flyer: ImpactBody,
    /// The struck body, which is scored.
    pub target: ImpactBody,
    /// Whether the flyer comes from the side of +x.
    pub mirrored: bool,
    /// Closing speed [m/s].
    pub speed: f64,
    /// Time of contact [s].
    pub contact_time: f64,
    /// Time before which no shock is at the target's rear [s]; see [`Solution::valid_until`].
    pub valid_until: f64,
    /// Whether the target's rear is a free surface; otherwise the waves are followed only until one
    /// of them reaches it.
    pub free_rear: bool,
}

impl Impact {
    /// The impact of two bodies that approach each other, with or without a gap.
    ///
    /// # Errors
    ///
    /// If a body has no thickness, if the bodies overlap or do not approach each other, or if a
    /// material cannot reach the impact state.
    pub fn new(flyer: ImpactBody, target: ImpactBody) -> Result<Impact, ExactError> {
        for body in [&flyer, &target] {
            finite("a body's lower face", body.lower)?;
            finite("a body's upper face", body.upper)?;
            finite("a body's velocity", body.velocity)?;
            if body.upper <= body.lower {
                return Err(ExactError::NoImpact("a body has no thickness"));
            }
        }
        let mirrored = flyer.lower + flyer.upper > target.lower + target.upper;
        let (gap, speed) = if mirrored {
            (flyer.lower - target.upper, target.velocity - flyer.velocity)
        } else {
            (target.lower - flyer.upper, flyer.velocity - target.velocity)
        };
        let size = (flyer.upper - flyer.lower).min(target.upper - target.lower);
        if gap < -1e-9 * size {
            return Err(ExactError::NoImpact("the bodies overlap"));
        }
        if speed <= 0.0 {
            return Err(ExactError::NoImpact("the bodies do not approach each other"));
        }
        // a gap within rounding of the faces' coordinates counts as contact
        let gap = if gap < 1e-9 * size { 0.0 } else { gap };
        let mut impact = Impact {
            flyer,
            target,
            mirrored,
            speed,
            contact_time: gap / speed,
            valid_until: f64::INFINITY,
            free_rear: true,
        };
        let shock = impact.release(4)?.target_shock;
        impact.valid_until = impact.contact_time + (target.upper - target.lower) / shock;
        Ok(impact)
    }

    /// Thickness of the flyer [m].
    pub fn thickness(&self) -> f64 {
        self.flyer.upper - self.flyer.lower
    }

    /// The chain of Burghardt (2010) in its own frame; see [`Impact::to_lab_x`].
    ///
    /// # Errors
    ///
    /// If a material cannot reach a state of the chain.
    pub fn chain(&self, last_state: usize) -> Result<Chain, ExactError> {
        let (f, t) = (self.flyer.material, self.target.material);
        Chain::new(f, t, self.speed, self.thickness(), last_state)
    }

    /// States and times of the true solution, in the frame of the target at rest.
    ///
    /// # Errors
    ///
    /// If a material cannot reach a state of the release.
    pub fn release(&self, last_state: usize) -> Result<Release, ExactError> {
        let (f, t) = (self.flyer.material, self.target.material);
        Release::new(f, t, self.speed, self.thickness(), last_state)
    }

    fn sign(&self) -> f64 {
        if self.mirrored { -1.0 } else { 1.0 }
    }

    /// The target's impact face at time 0 [m].
    fn face(&self) -> f64 {
        if self.mirrored { self.target.upper } else { self.target.lower }
    }

    /// Position in the scene [m] at the scene's time `t` [s] of a point at `x` in the frame of the
    /// target at rest.
    pub fn to_lab_x(&self, t: f64, x: f64) -> f64 {
        self.face() + self.target.velocity * t + self.sign() * x
    }

    /// Velocity in the scene [m/s] of a point that has the velocity `u` in the frame of the target
    /// at rest.
    pub fn to_lab_u(&self, u: f64) -> f64 {
        self.target.velocity + self.sign() * u
    }

    /// The profile point in the coordinates of the scene, at the scene's time `t`.
    fn lab_point(&self, t: f64, q: &ProfilePoint) -> ProfilePoint {
        ProfilePoint { x: self.to_lab_x(t, q.x), u: self.to_lab_u(q.u), ..*q }
    }

    fn profile_to_lab(&self, t: f64, points: &[ProfilePoint]) -> Profile {
        let mut points: Vec<_> = points.iter().map(|q| self.lab_point(t, q)).collect();
        if self.mirrored {
            points.reverse();
        }
        Profile { points }
    }

    /// The profile of the chain over the whole target at the time `t` of the scene [s]: the black
    /// line of figure 4 of Burghardt (2010). `None` before contact, and when the chain no longer
    /// holds.
    pub fn chain_profile(&self, chain: &Chain, t: f64) -> Option<Profile> {
        let since = t - self.contact_time;
        if t > self.valid_until {
            return None;
        }
        let mut profile = chain.shock_profile(since)?;
        let end = self.target.upper - self.target.lower;
        if let Some(last) = profile.points.last_mut() {
            last.x = end;
        }
        Some(self.profile_to_lab(t, &profile.points))
    }

    /// The true solution at `times` [s] (in any order) and for the `tracers`. Histories and paths
    /// extend to the last of the times, or to [`Solution::stopped`].
    ///
    /// # Errors
    ///
    /// If a time is not finite, if a material cannot reach a state, or if there are too many waves.
    pub fn solve(
        &self,
        times: &[f64],
        tracers: &[TracedPoint],
        accuracy: Accuracy,
    ) -> Result<Solution, ExactError> {
        for &t in times {
            finite("a time", t)?;
        }
        let release = self.release(6)?;
        let flyer_face = if self.mirrored { self.flyer.lower } else { self.flyer.upper };
        let probe = |tracer: &TracedPoint| match tracer.plate {
            Plate::Flyer => self.sign() * (tracer.x - flyer_face),
            Plate::Target => self.sign() * (tracer.x - self.face()),
        };
        let probes: Vec<(Plate, f64)> = tracers.iter().map(|t| (t.plate, probe(t))).collect();
        let setup = TrackingSetup {
            flyer: self.flyer.material,
            target: self.target.material,
            speed: self.speed,
            thickness: self.thickness(),
            target_thickness: self.target.upper - self.target.lower,
            wavelets: accuracy.wavelets,
            free_rear: self.free_rear,
        };
        let mut tracker = Tracker::new(setup, &probes)?;
        let mut order: Vec<usize> = (0..times.len()).collect();
        order.sort_by(|&a, &b| times[a].total_cmp(&times[b]));
        let mut snapshots: Vec<Option<Snapshot>> = vec![None; times.len()];
        for k in order {
            snapshots[k] = Some(self.snapshot(times[k], &mut tracker, &release));
        }
        let thickness = self.thickness();
        let interface = self.history(&tracker, INTERFACE_RECORD, Plate::Target, 0.0);
        let flyer_face = self.history(&tracker, FLYER_FACE_RECORD, Plate::Flyer, 0.0);
        let flyer_rear = self.history(&tracker, REAR_RECORD, Plate::Flyer, -thickness);
        let target_rear = self.history(&tracker, END_RECORD, Plate::Target, setup.target_thickness);
        let lines = [
            (&interface, Plate::Target, PathKind::Interface),
            (&flyer_rear, Plate::Flyer, PathKind::FreeSurface),
            (&target_rear, Plate::Target, PathKind::FreeSurface),
        ];
        let paths = self.paths(&tracker, lines);
        let of_probe = |(k, &(plate, x)): (usize, &(Plate, f64))| {
            self.history(&tracker, FIRST_PROBE + k, plate, x)
        };
        Ok(Solution {
            snapshots: snapshots.into_iter().flatten().collect(),
            tracers: probes.iter().enumerate().map(of_probe).collect(),
            interface,
            flyer_face,
            flyer_rear,
            target_rear,
            paths,
            release,
            separation_time: tracker.separation_time.map(|t| t + self.contact_time),
            valid_until: tracker.reached_end.map_or(f64::INFINITY, |end| end.0 + self.contact_time),
            interactions: tracker.events,
            stopped: tracker.stopped.take().map(|why| (tracker.time + self.contact_time, why)),
        })
    }

    fn snapshot(&self, time: f64, tracker: &mut Tracker, release: &Release) -> Snapshot {
        let since = time - self.contact_time;
        tracker.advance(since.max(0.0));
        if tracker.stopped.is_some() {
            return Snapshot { time, profile: None, whole: None, target: None, landmarks: None };
        }
        let (mut flyer, mut target) = if since <= 0.0 {
            (self.untouched(Plate::Flyer, since), self.untouched(Plate::Target, 0.0))
        } else {
            (tracker.profile(Plate::Flyer), tracker.profile(Plate::Target))
        };
        let scored = tracker.reached_end.is_none();
        let landmarks = (scored && since > 0.0).then(|| self.landmarks(time, &target, release));
        let target_profile = self.profile_to_lab(time, &target);
        flyer.append(&mut target);
        let whole = self.profile_to_lab(time, &flyer);
        Snapshot {
            time,
            profile: scored.then(|| whole.clone()),
            whole: Some(whole),
            target: scored.then_some(target_profile),
            landmarks,
        }
    }

    /// End points of the undisturbed plate, at the time `since` after contact.
    fn untouched(&self, plate: Plate, since: f64) -> Vec<ProfilePoint> {
        let (ends, u, rho) = match plate {
            Plate::Flyer => {
                let face = self.speed * since;
                ([face - self.thickness(), face], self.speed, self.flyer.material.rho0)
            }
            Plate::Target => {
                ([0.0, self.target.upper - self.target.lower], 0.0, self.target.material.rho0)
            }
        };
        ends.map(|x| ProfilePoint { x, u, rho, ..ProfilePoint::default() }).to_vec()
    }

    /// Features of the target's profile `points` (frame of the target at rest).
    fn landmarks(&self, time: f64, points: &[ProfilePoint], release: &Release) -> Landmarks {
        let since = time - self.contact_time;
        let (rho2, e2) = release.plateau(Plate::Target);
        let (rho2_flyer, e2_flyer) = release.plateau(Plate::Flyer);
        let p2 = release.states[0].p;
        let front = points.iter().rev().find(|q| q.p > 1e-7 * p2);
        let interface = points.first().map_or(0.0, |q| q.x);
        let lab = |x: f64| self.to_lab_x(time, x);
        let lab_range = |a: f64, b: f64| {
            let (a, b) = (lab(a), lab(b));
            [a.min(b), a.max(b)]
        };
        let plateau = front.filter(|_| since < release.catch_up_time).map(|front| {
            let head = release.target_head * (since - release.head_time);
            let behind = release.target_shock * since - head;
            let compressed = self.target.material.rho0 / rho2;
            let from =
                if since <= release.head_time { interface } else { front.x - behind * compressed };
            lab_range(from, front.x)
        });
        // the second plateau: the pressure stays at that of state 4, behind the fan
        let p4 = release.state(4).map(|s| s.p);
        let second_plateau = p4.and_then(|p4| {
            let near = |q: &ProfilePoint| (q.p - p4).abs() < 3e-3 * p2;
            let until_front = points.iter().take_while(|q| front.is_some_and(|f| q.x < f.x));
            let points: Vec<&ProfilePoint> = until_front.collect();
            let last = points.iter().rposition(|q| near(q))?;
            let first = points[..last].iter().rposition(|q| !near(q)).map_or(0, |k| k + 1);
            (first < last).then(|| {
                // interpolate each end between the last point inside and the next one outside
                let cross = |inside: &ProfilePoint, outside: &ProfilePoint| {
                    let level = p4 + (3e-3 * p2).copysign(outside.p - p4);
                    let w = (level - inside.p) / (outside.p - inside.p);
                    inside.x + w.clamp(0.0, 1.0) * (outside.x - inside.x)
                };
                let lower = match first.checked_sub(1) {
                    Some(k) => cross(points[first], points[k]),
                    None => points[first].x,
                };
                let upper = match points.get(last + 1) {
                    Some(q) => cross(points[last], q),
                    None => points[last].x,
                };
                lab_range(lower, upper)
            })
        });
        Landmarks {
            direction: self.sign(),
            interface: lab(interface),
            far_end: lab(self.target.upper - self.target.lower),
            shock: front.map(|q| lab(q.x)),
            plateau,
            p2,
            rho2,
            e2,
            rho2_flyer,
            e2_flyer,
            second_plateau,
            p4: p4.filter(|_| second_plateau.is_some()),
            behind_shock: front.map_or(0.0, |q| q.p),
        }
    }

    /// History of a recorded point that is at `x` (frame of the target at rest) at contact.
    fn history(&self, tracker: &Tracker, number: usize, plate: Plate, x: f64) -> History {
        let u0 = match plate {
            Plate::Flyer => self.speed,
            Plate::Target => 0.0,
        };
        let mut place = x;
        let mut points: Vec<HistoryPoint> = Vec::new();
        let mut last: Option<(f64, f64)> = None;
        let mut push = |since: f64, p: f64, u: f64, place: f64| {
            let t = since + self.contact_time;
            points.push(HistoryPoint { t, x: self.to_lab_x(t, place), u: self.to_lab_u(u), p });
        };
        if self.contact_time > 0.0 {
            push(-self.contact_time, 0.0, u0, x - u0 * self.contact_time);
        }
        for (since, [p, u]) in tracker.history(number, [0.0, u0]) {
            if let Some((before, u_before)) = last {
                place += 0.5 * (u + u_before) * (since - before);
            }
            last = Some((since, u));
            push(since, p, u, place);
        }
        History { points }
    }

    /// Paths of the x-t diagram up to the tracker's time.
    fn paths(&self, tracker: &Tracker, histories: [(&History, Plate, PathKind); 3]) -> Vec<Path> {
        let lab = |&[since, x]: &[f64; 2]| {
            let t = since + self.contact_time;
            [t, self.to_lab_x(t, x)]
        };
        let mut paths: Vec<Path> = histories
            .into_iter()
            .map(|(history, plate, kind)| {
                let points = history.points.iter().map(|h| [h.t, h.x]).collect();
                Path { plate, kind, points, steepened: false }
            })
            .collect();
        for (number, (plate, kind, points)) in tracker.drawn().into_iter().enumerate() {
            let points = points.iter().map(lab).collect();
            let steepened = tracker.steepened.contains(&number);
            paths.push(Path { plate, kind, points, steepened });
        }
        paths
    }
}

#[cfg(test)]
mod tests;
