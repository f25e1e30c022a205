//! Results of the tracking: profiles, and histories of material points.

use super::super::profile::Plate;
use super::super::profile::{PathKind, ProfilePoint};
use super::super::smoothing::{Step, smooth};
use super::{FrontKind, TrackedFront, Tracker, WaveRecord};

/// Values of one zone for the profile: pressure, velocity, compression, energy.
fn values(front: &TrackedFront) -> [f64; 4] {
    let s = &front.right;
    [s.p, s.u, s.chi, s.e]
}

impl Tracker {
    /// The current state along one plate by Eulerian position, smooth where the solution is smooth.
    pub(in super::super) fn profile(&self, plate: Plate) -> Vec<ProfilePoint> {
        let mut steps: Vec<Step<4>> = Vec::new();
        let mut first = None;
        let mut ends = [0.0; 2];
        let mut in_flyer = true;
        for front in self.row() {
            match front.kind {
                FrontKind::Interface => {
                    if plate == Plate::Flyer {
                        ends[1] = front.x;
                        break;
                    }
                    (in_flyer, first, ends[0]) = (false, Some(values(front)), front.x);
                }
                FrontKind::Rear if plate == Plate::Flyer => {
                    (first, ends[0]) = (Some(values(front)), front.x);
                }
                FrontKind::End => ends[1] = front.x,
                _ if in_flyer != (plate == Plate::Flyer) => {}
                // a probe is not a front, unless a contact has stayed at it
                FrontKind::Probe(_)
                    if steps.last().map(|s| s.after).or(first) == Some(values(front)) => {}
                kind => steps.push(Step {
                    at: front.at(self.time),
                    family: (front.family + 1) as usize,
                    strong: kind == FrontKind::Strong,
                    edge: matches!(kind, FrontKind::Edge(_)),
                    after: values(front),
                }),
            }
        }
        let first = first.unwrap_or_default();
        let corners = smooth(ends[0], ends[1], first, &steps, 0);
        // Eulerian position: the integral of rho0/rho = 1 - chi from the interface
        let [face_l, face_r] = self.faces();
        let rho0 = match plate {
            Plate::Flyer => self.setup.flyer.rho0,
            Plate::Target => self.setup.target.rho0,
        };
        let mut x = 0.0;
        let mut last: Option<(f64, f64)> = None;
        let mut points: Vec<ProfilePoint> = Vec::with_capacity(corners.len());
        for (at, [p, u, chi, e]) in corners {
            if let Some((before, chi_before)) = last {
                x += (at - before) * (1.0 - 0.5 * (chi + chi_before));
            }
            last = Some((at, chi));
            points.push(ProfilePoint { x, p, u, rho: rho0 / (1.0 - chi), e });
        }
        let shift = match plate {
            Plate::Flyer => face_l - x,
            Plate::Target => face_r,
        };
        for point in &mut points {
            point.x += shift;
        }
        points
    }

    /// The paths of shocks and edges of fans up to now.
    pub(in super::super) fn drawn(&self) -> Vec<(Plate, PathKind, Vec<[f64; 2]>)> {
        let mut paths = self.paths.clone();
        for front in self.row() {
            if let Some(path) = front.path {
                paths[path].2.push([self.time, front.place_at(self.time)]);
            }
        }
        paths
    }

    /// Pressure and velocity of a recorded point up to now: corner points of time [s] and [p, u].
    pub(in super::super) fn history(&self, number: usize, first: [f64; 2]) -> Vec<(f64, [f64; 2])> {
        let steps: Vec<Step<2>> = self.records[number]
            .iter()
            .map(|r: &WaveRecord| Step {
                at: r.t,
                family: r.family,
                strong: r.strong,
                edge: r.edge,
                after: r.after,
            })
            .collect();
        // measured by the velocity: the pressure of a free surface does not change
        smooth(0.0, self.time, first, &steps, 1)
    }
}
