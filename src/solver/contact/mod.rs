//! Contact in a step: which bodies touch at which nodes, found by each patch for the nodes that it
//! computes, from rows alone; and what they share put into the nodal sums and series.

mod contact_detection;
mod friction;

pub(super) use contact_detection::PULL;

use smallvec::SmallVec;

use super::series::Series;
use super::{MOST_NODES, Stepper, with_width};
use crate::effects::contact::{
    Booked, Contact, ContactNodes, INSET, Joint, Knot, Member, Point, Touch, logistic_regression,
    volume_gradient,
};
use crate::scene::Normals;
use crate::solver::patch::Patch;
use crate::solver::transfer::Scheme;

impl<const D: usize> Stepper<D> {
    /// Finds the pairs of bodies in contact at the nodes that the patch computes, once masses and
    /// momenta are summed up; in a step of `dt`, in which nodal forces are known or not.
    pub(super) fn find_contact(
        &self,
        patch: &mut Patch<D>,
        contact: &Contact,
        dt: f64,
        forces: bool,
    ) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Stepper<D>,
            contact: &Contact,
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

    /// The joints of one meeting, in a step of `dt` and with friction for the time `rubbing`.
    fn find_joints<const K: usize>(
        &self,
        patch: &Patch<D>,
        nodes: &mut ContactNodes<D>,
        meeting: usize,
        contact: &Contact,
        [dt, rubbing]: [f64; 2],
    ) {
        let f = &self.fields;
        let fields = &patch.nodes.fields;
        let vector = |k: usize| std::array::from_fn(|a| &fields[k + a][..]);
        let sums = [vector(f.lumped), vector(f.acceleration)];
        let meetings = &nodes.meetings;
        let layers = patch.nodes.layers;
        let mut members = meetings.members(meeting, self.empty_mass, layers, &fields[f.mass], sums);
        let touches = meetings.touches(meeting);
        let filled = self.columns.room.expect("contact has the column");
        for touch in touches {
            let (r, at) = (touch.row as usize, touch.at as usize);
            let row = patch.stencils.row::<K, D>(r);
            let volume = patch.block.columns[filled][r];
            if let Some(member) = members.iter_mut().find(|m| m.layer == self.layer_of(patch, r)) {
                member.volume += volume * row.values[at / K][at % K];
                for a in 0..D {
                    member.gradient[a] += volume * row.gradient(a)[at / K][at % K];
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
                let normal = match contact.normals {
                    Normals::VolumeGradient => {
                        volume_gradient([a.volume, b.volume], [&a.gradient, &b.gradient])
                    }
                    Normals::LogisticRegression => {
                        self.find_corners(patch, index, touches, pair, &mut nodes.points);
                        logistic_regression(&nodes.points, &self.cell)
                    }
                };
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

    /// The layer that a row stands in.
    fn layer_of(&self, patch: &Patch<D>, row: usize) -> usize {
        patch.block.columns[self.columns.body][row] as usize
    }

    /// The index of a place in a layer.
    fn index_of(&self, patch: &Patch<D>, node: usize) -> [i64; D] {
        let (nodes, stride) = (&patch.nodes.nodes, patch.stencils.stride);
        std::array::from_fn(|a| {
            let at = if D == 1 { node } else { [node % stride, node / stride][a] };
            nodes.lower[a] + at as i64
        })
    }

    /// See [`Joint::share`](crate::effects::contact::Joint::share).
    pub(super) fn share_of(&self, patch: &Patch<D>, index: [i64; D]) -> f64 {
        if !patch.nodes.owned.contains(index) {
            return 0.0;
        }
        let mirrored = |a: usize| {
            let [lower, upper] = [0, 1].map(|end| self.sides[a][end].rigid_velocity().is_some());
            (index[a] == 0 && lower) || (index[a] == self.cells[a] && upper)
        };
        (0..D).filter(|&a| mirrored(a)).fold(1.0, |share, _| 0.5 * share)
    }

    /// The place of a row seen from where a node was at the start [cells].
    fn place(&self, patch: &Patch<D>, row: usize, index: [i64; D]) -> [f64; D] {
        let cell = patch.block.cells[row];
        std::array::from_fn(|a| {
            let cells = (i64::from(cell[a]) - index[a]) as f64;
            let first = cells + patch.block.columns[self.columns.fraction + a][row];
            self.columns.shift.map_or(first, |shift| {
                first + patch.block.columns[shift + a][row] * self.inverse_cell[a]
            })
        })
    }

    /// Corners of the particles of two bodies that touch a node.
    fn find_corners(
        &self,
        patch: &Patch<D>,
        index: [i64; D],
        touches: &[Touch],
        [a, b]: [&Member<D>; 2],
        points: &mut Vec<Point<D>>,
    ) {
        points.clear();
        let Some(edges) = self.columns.half_edges else { return };
        for r in touches.iter().map(|t| t.row as usize) {
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

    /// Shares lumped velocity and acceleration between bodies in contact.
    pub(super) fn join_sums(&self, patch: &mut Patch<D>) {
        let f = &self.fields;
        for (field, booked) in [(f.lumped, Booked::Velocity), (f.acceleration, Booked::Force)] {
            patch.contact.join(&mut patch.nodes.fields[field..field + D], Some(booked));
        }
    }

    /// Shares what a product has just made of a series.
    pub(super) fn join_series(&self, patch: &mut Patch<D>, series: &Series, ends: bool) {
        let f = &self.fields;
        if series.is_scalar() {
            let [weight, sum] = patch.nodes.fields_mut([f.relaxation[0], series.sum]);
            return patch.contact.join_scalar(weight, sum);
        }
        // what the bodies give each other is what the first and the last term jump by
        let booked = match series.sum {
            s if ends && s == f.velocity => Some(Booked::Velocity),
            s if ends && s == f.acceleration => Some(Booked::Force),
            _ => None,
        };
        patch.contact.join(&mut patch.nodes.fields[series.sum..series.sum + D], booked);
    }

    /// Shares the first term of the series of w.
    pub(super) fn join_work(&self, patch: &mut Patch<D>) {
        let f = &self.fields;
        patch.contact.join(&mut patch.nodes.fields[f.work..f.work + D], None);
        if let Scheme::Series { .. } = self.scheme {
            for a in 0..D {
                let [work, first] = patch.nodes.fields_mut([f.work + a, f.first + a]);
                for at in patch.contact.joints.iter().flat_map(|j| j.at) {
                    first[at] = work[at];
                }
            }
        }
    }

    /// The share of a nodal jump of velocity that particles take: a blend leaves a part of theirs
    /// as it was.
    pub(super) fn moved(&self) -> f64 {
        match self.scheme {
            Scheme::Blend(share) => 1.0 - share,
            Scheme::Series { .. } | Scheme::Affine => 1.0,
        }
    }

    /// What a step of `dt` brings from contact: the heat of friction to the own rows, and the
    /// forces between bodies to the books.
    pub(super) fn gather_contact(&self, patch: &mut Patch<D>, dt: f64) {
        self.gather_friction_heat(patch);
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
