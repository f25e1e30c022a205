//! Contact between bodies with separate velocity fields.
//!
//! The sums of each body (mass, momentum, force, mass matrix) are in a layer of the nodal arrays.
//! Nodes with particles of several bodies are *meetings*. A pair of bodies in contact there shares
//! the degrees of freedom across the contact plane, that is one normal velocity (and the whole
//! velocity while friction holds). With m_i the lumped masses, D their diagonal matrix and Pi the
//! projection onto the velocities shared in this way, orthogonal in the scalar product of D, the
//! matrix K = 1 - D^-1 M of one body becomes
//!
//! ```text
//! Pi K = Pi (1 - D^-1 M)
//! ```
//!
//! on shared velocities: every division by mass and every product with M is followed by Pi, at the
//! cost of a few nodes. All one-body formulas (filters, inverse for the force, exact energy,
//! pressure relaxation) then hold unchanged, momentum is conserved exactly, and the energy lost
//! when two bodies become one at a node is heat of the particles there.
//!
//! Bodies are in contact if the edges of their particles, at the middle of the step, leave no gap,
//! and if the bodies would overlap by its end without contact. So contact does not start a cell
//! early, as it does if only the grid decides (Bardenhagen, Brackbill & Sulsky 2000), and bodies do
//! not stick. Bodies that were pressed together adhere for a short time under tension, as an
//! interface that opened at each oscillation ahead of a shock would scatter it.
//!
//! Each patch finds the bodies in contact at the nodes that it computes, from particles alone, and
//! applies the projection to the nodal sums and series.

mod contact_constraint;
mod contact_detection;
mod contact_nodes;
mod friction;
mod multi_body_constraint;

pub use contact_constraint::{Booked, ContactNodes, Joint};
pub(super) use contact_detection::PULL;
pub use contact_nodes::{Member, Touch};
pub use multi_body_constraint::Knot;

use smallvec::SmallVec;

use super::Stepper;
use super::series::ProductSeries;
use crate::contact::{BodyPair, BoundaryPoint, ContactCondition, INSET};
use crate::shape::with_width;
use crate::solver::clock::timed;
use crate::solver::patch::Patch;

impl<const D: usize> Stepper<D> {
    /// Finds the pairs of bodies in contact at the nodes that the patch computes, after masses and
    /// momenta have been summed, in a step of `dt`; `forces` tells whether nodal forces are known.
    pub(super) fn find_contact(
        &self,
        patch: &mut Patch<D>,
        contact: &ContactCondition,
        dt: f64,
        forces: bool,
    ) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Stepper<D>,
            contact: &ContactCondition,
            [dt, rubbing]: [f64; 2],
        ) {
            let mut nodes = std::mem::take(&mut patch.contact);
            nodes.clear();
            let mass = &patch.nodes.fields[s.fields.mass];
            let least = s.empty_mass;
            nodes.meetings.find::<K>(
                mass,
                least,
                &patch.nodes.nodes,
                &patch.active,
                &patch.stencils,
                &patch.runs,
            );
            for meeting in 0..nodes.meetings.len() {
                s.find_joints::<K>(patch, &mut nodes, meeting, contact, [dt, rubbing]);
            }
            s.fill_joints(patch, &mut nodes);
            if contact.coefficient.is_some() {
                s.rub(patch, &nodes);
            }
            patch.contact = nodes;
        }
        let rubbing = if forces { dt } else { 0.0 };
        with_width!(patch.stencils.width, go(patch, self, contact, [dt, rubbing]));
    }

    /// Finds the joints of a meeting, in a step of `dt` and with friction over the time `rubbing`.
    fn find_joints<const K: usize>(
        &self,
        patch: &Patch<D>,
        nodes: &mut ContactNodes<D>,
        meeting: usize,
        contact: &ContactCondition,
        [dt, rubbing]: [f64; 2],
    ) {
        let f = &self.fields;
        let fields = &patch.nodes.fields;
        let vector = |k: usize| std::array::from_fn(|a| &fields[k + a][..]);
        let sums = [vector(f.lumped_velocity), vector(f.acceleration)];
        let meetings = &nodes.meetings;
        let layers = patch.nodes.layers;
        let mut members = meetings.members(meeting, self.empty_mass, layers, &fields[f.mass], sums);
        let touches = meetings.touches(meeting);
        let filled = self.columns.current_volume.expect("contact has the column");
        for touch in touches {
            let (r, at) = (touch.particle as usize, touch.at as usize);
            let weights = patch.stencils.particle::<K, D>(r);
            let volume = patch.block.columns[filled][r];
            if let Some(member) = members.iter_mut().find(|m| m.layer == self.layer_of(patch, r)) {
                member.volume += volume * weights.values[at / K][at % K];
                for a in 0..D {
                    member.gradient[a] += volume * weights.gradient(a)[at / K][at % K];
                }
            }
        }
        let node = meetings.node(meeting);
        let index = self.index_of(patch, node);
        let first = nodes.joints.len();
        let share = self.share_of(patch, index);
        let count = patch.nodes.nodes.count();
        for (i, a) in members.iter().enumerate() {
            for b in &members[i + 1..] {
                let pair = [a, b];
                if contact.normals.uses_corners() {
                    self.find_corners(patch, index, touches, pair, &mut nodes.points);
                }
                let normal = contact.normals.normal(&BodyPair {
                    volume: [a.volume, b.volume],
                    gradient: [&a.gradient, &b.gradient],
                    corners: &nodes.points,
                    cell: &self.cell,
                });
                let Some(normal) = normal else { continue };
                if self.touch(patch, index, touches, pair, &normal, dt) {
                    let (whole, friction) = match contact.coefficient {
                        Some(coefficient) if D > 1 && rubbing > 0.0 => {
                            self.friction(pair, &normal, coefficient, rubbing)
                        }
                        _ => (false, [0.0; D]),
                    };
                    nodes.joints.push(Joint {
                        at: pair.map(|m| m.layer * count + node),
                        mass: pair.map(|m| m.mass),
                        normal,
                        whole,
                        low: [false; 2],
                        share,
                        given: [[0.0; D]; 2],
                        friction,
                    });
                }
            }
        }
        if nodes.joints.len() > first + 1 {
            nodes.knots.push(Knot::new(first, &nodes.joints[first..]));
        }
    }

    /// Layer of a particle.
    fn layer_of(&self, patch: &Patch<D>, particle: usize) -> usize {
        patch.block.columns[self.columns.body][particle] as usize
    }

    /// Grid index of the node at index `node` in a layer.
    fn index_of(&self, patch: &Patch<D>, node: usize) -> [i64; D] {
        let (nodes, stride) = (&patch.nodes.nodes, patch.stencils.stride);
        std::array::from_fn(|a| {
            let at = if D == 1 { node } else { [node % stride, node / stride][a] };
            nodes.lower[a] + at as i64
        })
    }

    /// See [`Joint::share`].
    pub(crate) fn share_of(&self, patch: &Patch<D>, index: [i64; D]) -> f64 {
        if !patch.nodes.owned.contains(index) {
            return 0.0;
        }
        let mirrored = |a: usize| {
            let [lower, upper] = [0, 1].map(|end| self.sides[a][end].is_rigid());
            (index[a] == 0 && lower) || (index[a] == self.cells[a] && upper)
        };
        (0..D).filter(|&a| mirrored(a)).fold(1.0, |share, _| 0.5 * share)
    }

    /// Position of a particle relative to the initial position of a node [cells].
    fn place(&self, patch: &Patch<D>, particle: usize, index: [i64; D]) -> [f64; D] {
        let cell = patch.block.cells[particle];
        std::array::from_fn(|a| {
            let cells = (i64::from(cell[a]) - index[a]) as f64;
            let first = cells + patch.block.columns[self.columns.fraction + a][particle];
            self.columns.displacement.map_or(first, |shift| {
                first + patch.block.columns[shift + a][particle] * self.inverse_cell[a]
            })
        })
    }

    /// Finds the corners of the particles of two bodies that touch a node.
    fn find_corners(
        &self,
        patch: &Patch<D>,
        index: [i64; D],
        touches: &[Touch],
        [a, b]: [&Member<D>; 2],
        points: &mut Vec<BoundaryPoint<D>>,
    ) {
        points.clear();
        let Some(edges) = self.columns.half_edges else { return };
        for r in touches.iter().map(|t| t.particle as usize) {
            let layer = self.layer_of(patch, r);
            if layer != a.layer && layer != b.layer {
                continue;
            }
            let x = self.place(patch, r, index);
            let edge = |k: usize, a: usize| patch.block.columns[edges + 2 * k + a][r];
            for (s, t) in [(-INSET, -INSET), (INSET, -INSET), (-INSET, INSET), (INSET, INSET)] {
                let corner = std::array::from_fn(|a| x[a] + s * edge(0, a) + t * edge(1, a));
                points.push((corner, layer == b.layer));
            }
        }
    }

    /// With an edge mask, bodies in contact fill a node together.
    fn fill_joints(&self, patch: &mut Patch<D>, nodes: &mut ContactNodes<D>) {
        let Some(least) = self.edge_mask else { return };
        let volume = &mut patch.nodes.fields[self.fields.volume];
        let mut knotted = nodes.knots.iter().flat_map(|k| k.joints()).peekable();
        for (k, joint) in nodes.joints.iter_mut().enumerate() {
            if knotted.next_if_eq(&k).is_none() {
                let own = joint.at.map(|at| volume[at]);
                joint.low = own.map(|v| v < least);
                joint.at.iter().for_each(|&at| volume[at] = own[0] + own[1]);
            }
        }
        for knot in &nodes.knots {
            let sum: f64 = knot.places().iter().map(|&at| volume[at]).sum();
            knot.places().iter().for_each(|&at| volume[at] = sum);
        }
    }

    /// Projects lumped velocity and acceleration at nodes in contact.
    pub(super) fn join_sums(&self, patch: &mut Patch<D>) {
        let f = &self.fields;
        for (field, booked) in
            [(f.lumped_velocity, Booked::Velocity), (f.acceleration, Booked::Force)]
        {
            patch.contact.join(&mut patch.nodes.fields[field..field + D], Some(booked));
        }
    }

    /// Projects the new sums of a series after a product.
    pub(super) fn join_series(&self, patch: &mut Patch<D>, series: &ProductSeries, ends: bool) {
        let f = &self.fields;
        if series.is_scalar() {
            let [weight, sum] = patch.nodes.fields_mut([f.relaxation[0], series.sum]);
            return patch.contact.join_scalar(weight, sum);
        }
        // the impulse and force between bodies are the jumps of the first and the last term
        let booked = match series.sum {
            s if ends && s == f.velocity => Some(Booked::Velocity),
            s if ends && s == f.acceleration => Some(Booked::Force),
            _ => None,
        };
        patch.contact.join(&mut patch.nodes.fields[series.sum..series.sum + D], booked);
    }

    /// Projects the first term of the series of w.
    pub(super) fn join_work(&self, patch: &mut Patch<D>) {
        let f = &self.fields;
        patch.contact.join(&mut patch.nodes.fields[f.work..f.work + D], None);
        if self.transfer.is_filtered() {
            for a in 0..D {
                let [work, first] = patch.nodes.fields_mut([f.work + a, f.first + a]);
                for at in patch.contact.joints.iter().flat_map(|j| j.at) {
                    first[at] = work[at];
                }
            }
        }
    }

    /// Share of a jump of the nodal velocity that particles adopt: a blend keeps a part of the
    /// particle velocity.
    pub(crate) fn moved(&self) -> f64 {
        self.transfer.taken_share()
    }

    /// Contact at the end of a step of `dt`: transfers the heat of friction to the own particles,
    /// and records the forces between bodies.
    pub(super) fn gather_contact(&self, patch: &mut Patch<D>, dt: f64) {
        if self.fields.heat.is_some() {
            timed(self.friction_part, patch, |patch| self.gather_friction_heat(patch));
        }
        if self.contact.is_none() {
            return;
        }
        let moved = self.moved();
        let ContactNodes { joints, told, .. } = &mut patch.contact;
        told.clear();
        let own = joints.iter().filter(|j| j.share > 0.0);
        told.extend(own.map(|joint| {
            let [momentum, force] = joint.given;
            let force: [f64; D] =
                std::array::from_fn(|a| moved * momentum[a] / dt + force[a] + joint.friction[a])
                    .map(|f: f64| joint.share * f);
            let along: SmallVec<[f64; 2]> = (0..D).map(|a| force[a] * joint.normal[a]).collect();
            let normal: f64 = along.iter().sum();
            let rest = |a: usize| force[a] - normal * joint.normal[a];
            let across = (0..D).map(|a| rest(a) * rest(a)).sum::<f64>().sqrt();
            [-normal, across]
        }));
    }
}
