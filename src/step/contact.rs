//! Contact in a step: which bodies touch at which nodes, found by each patch for the nodes that it
//! computes, from rows alone; and what they share put into the nodal sums and series.

use decomp::Parity;
use smallvec::SmallVec;

use super::series::Series;
use super::{MOST_NODES, Nodal, Stepper, norm, with_width};
use crate::contact::{
    Booked, Contact, ContactNodes, INSET, Joint, Knot, Member, Point, Touch, logistic_regression,
    volume_gradient,
};
use crate::patch::Patch;
use crate::scene::Normals;
use crate::transfer::Scheme;

/// Bodies without stress touch if their edges are nearer than this [cells].
const CLOSED: f64 = 0.01;

/// Bodies that press on each other stay in contact over a gap as wide as their compression of a
/// cell, up to this [cells]: as a wave passes, the outermost particles' lengths and places are a
/// little out of step.
const HELD: f64 = 0.1;

/// The outermost part of a body at a meeting.
#[derive(Clone, Copy)]
struct Edge {
    /// How far it reaches along the normal, seen from the node [m].
    reach: f64,
    /// p + q there [Pa].
    stress: f64,
}

impl<const D: usize> Stepper<D> {
    /// Finds the pairs of bodies in contact at the nodes that the patch computes, once masses and
    /// momenta are summed up.
    pub(super) fn find_contact(&self, patch: &mut Patch<D>, contact: &Contact, dt: f64) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Stepper<D>,
            contact: &Contact,
            dt: f64,
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
                s.find_joints::<K>(patch, &mut nodes, meeting, contact, dt);
            }
            s.fill_joints(patch, &mut nodes);
            if contact.coefficient.is_some() {
                s.rub(patch, &nodes);
            }
            patch.contact = nodes;
        }
        with_width!(patch.stencils.width, go(patch, self, contact, dt));
    }

    /// The joints of one meeting.
    fn find_joints<const K: usize>(
        &self,
        patch: &Patch<D>,
        nodes: &mut ContactNodes<D>,
        meeting: usize,
        contact: &Contact,
        dt: f64,
    ) {
        let f = &self.fields;
        let fields = &patch.nodes.fields;
        let vector = |k: usize| std::array::from_fn(|a| &fields[k + a][..]);
        let sums = [vector(f.lumped), vector(f.acceleration)];
        let meetings = &nodes.meetings;
        let layers = patch.nodes.layers;
        let mut members = meetings.members(meeting, self.empty_mass, layers, &fields[f.mass], sums);
        let touches = meetings.touches(meeting);
        let filled = self.columns.filled.expect("contact has the column");
        for touch in touches {
            let (r, at) = (touch.row as usize, touch.at as usize);
            let row = patch.stencils.row::<K, D>(r);
            let volume = patch.block.columns[filled][r];
            if let Some(member) = members.iter_mut().find(|m| m.layer == self.layer_of(patch, r)) {
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
                    Normals::VolumeGradient => volume_gradient(&a.gradient, &b.gradient),
                    Normals::LogisticRegression => {
                        self.find_corners(patch, index, touches, pair, &mut nodes.points);
                        logistic_regression(&nodes.points, &self.cell)
                    }
                };
                let Some(normal) = normal else { continue };
                if self.touch(patch, index, touches, pair, &normal) {
                    let (whole, friction) = match contact.coefficient {
                        Some(coefficient) if D > 1 && dt > 0.0 => {
                            self.friction(pair, &normal, coefficient, dt)
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

    /// See [`Joint::share`](crate::contact::Joint::share).
    pub(super) fn share_of(&self, patch: &Patch<D>, index: [i64; D]) -> f64 {
        if !patch.nodes.owned.contains(index) {
            return 0.0;
        }
        let mirrored = |a: usize| {
            let [lower, upper] = self.sides[a].map(|side| side.rigid_velocity().is_some());
            (index[a] == 0 && lower) || (index[a] == self.cells[a] && upper)
        };
        (0..D).filter(|&a| mirrored(a)).fold(1.0, |share, _| 0.5 * share)
    }

    /// The place of a row seen from a node [cells].
    fn place(&self, patch: &Patch<D>, row: usize, index: [i64; D]) -> [f64; D] {
        let cell = patch.block.cells[row];
        std::array::from_fn(|a| {
            let cells = (i64::from(cell[a]) - index[a]) as f64;
            cells + patch.block.columns[self.columns.fraction + a][row]
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

    /// Whether two bodies touch at a node: the gap between the edges of their particles is closed
    /// and they approach, or they press on each other.
    fn touch(
        &self,
        patch: &Patch<D>,
        index: [i64; D],
        touches: &[Touch],
        [a, b]: [&Member<D>; 2],
        normal: &[f64; D],
    ) -> bool {
        let edges = |direction: &[f64; D]| {
            let first = self.edge(patch, index, touches, a.layer, direction)?;
            let second = self.edge(patch, index, touches, b.layer, &direction.map(|n| -n))?;
            Some((first, second))
        };
        let Some((first, second)) = edges(normal) else { return false };
        let cell = self.cell.iter().copied().fold(f64::INFINITY, f64::min);
        let mut gap = -(first.reach + second.reach) / cell;
        // near a corner the normal is between those of two faces, and along it the bodies seem to
        // overlap; a gap along any direction is one
        if D > 1 {
            let faces = [a.gradient, b.gradient.map(|g| -g)];
            let axes = (0..D).map(|k| {
                let mut axis = [0.0; D];
                axis[k] = normal[k].signum();
                axis
            });
            for direction in faces.into_iter().chain(axes) {
                let length = norm(&direction);
                if length > 0.0
                    && let Some((first, second)) = edges(&direction.map(|x| x / length))
                {
                    gap = gap.max(-(first.reach + second.reach) / cell);
                }
            }
        }
        let closing = (0..D).map(|k| (a.velocity[k] - b.velocity[k]) * normal[k]).sum::<f64>();
        let stress = 0.5 * (first.stress + second.stress);
        let strain = stress / self.stiffness[a.layer].min(self.stiffness[b.layer]);
        (gap < CLOSED && closing > 0.0) || (stress > 0.0 && gap < CLOSED + strain.min(HELD))
    }

    /// The edge of the body in `layer` along `normal`, among the rows that touch a node.
    fn edge(
        &self,
        patch: &Patch<D>,
        index: [i64; D],
        touches: &[Touch],
        layer: usize,
        normal: &[f64; D],
    ) -> Option<Edge> {
        let c = &self.columns;
        let column = |k: usize| &patch.block.columns[k];
        let filled = column(c.filled.expect("contact has the column"));
        let mut edge: Option<Edge> = None;
        let rows = touches.iter().map(|t| t.row as usize);
        for r in rows.filter(|&r| self.layer_of(patch, r) == layer) {
            let along = |v: [f64; D]| (0..D).map(|a| v[a] * self.cell[a] * normal[a]).sum::<f64>();
            let centre = along(self.place(patch, r, index));
            let half = match c.half_edges {
                None => along([0.5 * filled[r]; D]).abs(),
                Some(first) => {
                    let edge = |k: usize| {
                        along(std::array::from_fn(|a| column(first + 2 * k + a)[r])).abs()
                    };
                    edge(0) + edge(1)
                }
            };
            let reach = centre + half;
            if edge.is_none_or(|e| reach > e.reach) {
                let around = if self.axisymmetric { self.radius(patch, r).abs() } else { 1.0 };
                let volume = filled[r] * self.cell.iter().product::<f64>() * around;
                edge = Some(Edge { reach, stress: self.pressing(patch, r, normal) / volume });
            }
        }
        edge
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

    /// Whether two bodies stick in a step of `dt`, and if not the force with which the second rubs
    /// the first [N].
    ///
    /// With the velocities that they would have apart at the end of the step, N is the impulse that
    /// makes one of their normal parts, T that which makes one of the others. Coulomb's law: they
    /// stick if T <= coefficient N, else an impulse of coefficient N opposes the slip (Bardenhagen,
    /// Brackbill & Sulsky 2000).
    fn friction(
        &self,
        [a, b]: [&Member<D>; 2],
        normal: &[f64; D],
        coefficient: f64,
        dt: f64,
    ) -> (bool, [f64; D]) {
        let moved = self.moved();
        let mass = a.mass * b.mass / (a.mass + b.mass);
        let apart: [f64; D] = std::array::from_fn(|k| a.velocity[k] - b.velocity[k]);
        let pushed: [f64; D] =
            std::array::from_fn(|k| dt * (a.acceleration[k] - b.acceleration[k]));
        let along = |v: &[f64; D]| (0..D).map(|k| v[k] * normal[k]).sum::<f64>();
        let most = coefficient * mass * (moved * along(&apart) + along(&pushed)).max(0.0);
        let slip: [f64; D] = std::array::from_fn(|k| {
            let across = |v: &[f64; D]| v[k] - along(v) * normal[k];
            across(&apart) + across(&pushed)
        });
        let speed = norm(&slip);
        let sticks = mass * speed <= most;
        if sticks && moved == 1.0 {
            return (true, [0.0; D]);
        }
        // a blend keeps particles' velocities: what holds them must be a force
        let impulse = if sticks { mass * speed } else { most };
        let scale = if speed > 0.0 { -impulse / (dt * speed) } else { 0.0 };
        (false, slip.map(|s| scale * s))
    }

    /// Adds friction to the nodal force.
    fn rub(&self, patch: &mut Patch<D>, nodes: &ContactNodes<D>) {
        for (joint, a) in nodes.joints.iter().flat_map(|j| (0..D).map(move |a| (j, a))) {
            let force = &mut patch.nodes.fields[self.fields.acceleration + a];
            force[joint.at[0]] += joint.friction[a];
            force[joint.at[1]] -= joint.friction[a];
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

    /// The work that friction has taken from the motion in a step of `dt`, as heat of the two
    /// bodies, half each [J/kg]: -f.(w_a - w_b) dt, with the velocity whose gradient does the work.
    /// A wall takes none: what rubs on it has all of -f.w dt.
    fn find_friction_heat(&self, patch: &mut Patch<D>, dt: f64) {
        let f = &self.fields;
        let Some(field) = f.heat else { return };
        let mut heat = std::mem::take(&mut patch.nodes.fields[field]);
        heat.fill(0.0);
        let fields = &patch.nodes.fields;
        let velocity = |a: usize, at: usize| match self.compatible {
            true => fields[f.work + a][at],
            false => 0.5 * (fields[f.velocity + a][at] + fields[f.velocity_star + a][at]),
        };
        for joint in &patch.contact.joints {
            let [i, j] = joint.at;
            let slip = |a: usize| velocity(a, i) - velocity(a, j);
            let power: f64 = (0..D).map(|a| -joint.friction[a] * slip(a)).sum();
            heat[i] += 0.5 * dt * power / joint.mass[0];
            heat[j] += 0.5 * dt * power / joint.mass[1];
        }
        for pushed in patch.side_forces.iter().filter(|p| p.rubs) {
            let power: f64 = (0..D).map(|a| -pushed.force[a] * velocity(a, pushed.at)).sum();
            heat[pushed.at] += dt * power / fields[f.mass][pushed.at];
        }
        patch.nodes.fields[field] = heat;
    }

    /// Brings the heat of friction to all who see its nodes. Collective between neighbours.
    pub(super) fn solve_friction_heat(&self, nodal: &mut Nodal<'_, D>, dt: f64) {
        if let Some(heat) = self.fields.heat {
            nodal.each("friction heat", |patch| self.find_friction_heat(patch, dt));
            nodal.refresh(&[(heat, Parity::Even)]);
        }
    }

    /// Gives the own rows the heat of friction.
    fn gather_friction_heat(&self, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Stepper<D>) {
            let Some(field) = s.fields.heat else { return };
            let n = patch.block.own();
            let energy = &mut patch.block.columns[s.columns.energy][..n];
            for (r, e) in energy.iter_mut().enumerate() {
                let row = patch.stencils.row::<K, D>(r);
                *e += row.dot(row.values, &patch.nodes.fields[field]);
            }
        }
        with_width!(patch.stencils.width, go(patch, self));
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
