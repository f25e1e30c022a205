//! What the row of fronts says: profiles, and histories of material points.

use super::super::profile::{PathKind, Point};
use super::super::smoothing::{Step, smooth};
use super::super::wave_interactions::Plate;
use super::{Front, Kind, Record, Tracker};

/// The values of one zone that are read: pressure, velocity, compression, energy.
fn values(front: &Front) -> [f64; 4] {
    let s = &front.right;
    [s.p, s.u, s.chi, s.e]
}

impl Tracker {
    /// The state along one plate now, by Eulerian place; smooth where the solution is.
    pub(in super::super) fn profile(&self, plate: Plate) -> Vec<Point> {
        let mut steps: Vec<Step<4>> = Vec::new();
        let mut first = None;
        let mut ends = [0.0; 2];
        let mut in_flyer = true;
        for front in self.row() {
            match front.kind {
                Kind::Interface => {
                    if plate == Plate::Flyer {
                        ends[1] = front.x;
                        break;
                    }
                    (in_flyer, first, ends[0]) = (false, Some(values(front)), front.x);
                }
                Kind::Rear if plate == Plate::Flyer => {
                    (first, ends[0]) = (Some(values(front)), front.x);
                }
                Kind::End => ends[1] = front.x,
                _ if in_flyer != (plate == Plate::Flyer) => {}
                // a recorded point is no front, unless a contact stays at it
                Kind::Probe(_)
                    if steps.last().map(|s| s.after).or(first) == Some(values(front)) => {}
                kind => steps.push(Step {
                    at: front.at(self.time),
                    family: (front.family + 1) as usize,
                    strong: kind == Kind::Strong,
                    edge: matches!(kind, Kind::Edge(_)),
                    after: values(front),
                }),
            }
        }
        let first = first.unwrap_or_default();
        let corners = smooth(ends[0], ends[1], first, &steps, 0);
        // Eulerian place: the integral of rho0/rho = 1 - chi from the interface
        let [face_l, face_r] = self.faces();
        let rho0 = match plate {
            Plate::Flyer => self.setup.flyer.rho0,
            Plate::Target => self.setup.target.rho0,
        };
        let mut x = 0.0;
        let mut last: Option<(f64, f64)> = None;
        let mut points: Vec<Point> = Vec::with_capacity(corners.len());
        for (at, [p, u, chi, e]) in corners {
            if let Some((before, chi_before)) = last {
                x += (at - before) * (1.0 - 0.5 * (chi + chi_before));
            }
            last = Some((at, chi));
            points.push(Point { x, p, u, rho: rho0 / (1.0 - chi), e });
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

    /// The paths of shocks and edges of fans until now.
    pub(in super::super) fn drawn(&self) -> Vec<(Plate, PathKind, Vec<[f64; 2]>)> {
        let mut paths = self.paths.clone();
        for front in self.row() {
            if let Some(path) = front.path {
                paths[path].2.push([self.time, front.place_at(self.time)]);
            }
        }
        paths
    }

    /// Pressure and velocity of a recorded point until now: corners of time, [p, u].
    pub(in super::super) fn history(&self, number: usize, first: [f64; 2]) -> Vec<(f64, [f64; 2])> {
        let steps: Vec<Step<2>> = self.records[number]
            .iter()
            .map(|r: &Record| Step {
                at: r.t,
                family: r.family,
                strong: r.strong,
                edge: r.edge,
                after: r.after,
            })
            .collect();
        // by velocity: the pressure of a free surface does not change
        smooth(0.0, self.time, first, &steps, 1)
    }
}
