//! Contact between bodies with separate velocity fields.
//!
//! The sums of each body (mass, momentum, force, products with the mass matrix) are in a layer of the nodal arrays.
//! Nodes with particles of several bodies are *contact nodes*. A pair of bodies in contact there shares
//! the degree of freedom across the contact plane, that is one normal velocity. With m_i the lumped masses, D their diagonal matrix and Pi the
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
//! not stick. Until a wave presses bodies together they adhere for a short time under tension, as an
//! interface that opened at each oscillation ahead of a shock would scatter it. Afterwards they
//! carry no tension, and part when a release arrives.
//!
//! Friction acts on the velocities at the end of a step, when the normal impulse of contact is
//! known: see [`friction`].
//!
//! Each patch finds the bodies in contact at the nodes that it computes, from particles alone, and
//! applies the projection to the nodal sums and series.

mod contact_constraint;
mod contact_detection;
mod contact_nodes;
mod friction;
mod multi_body_constraint;
mod patch_contact;
mod self_contact;
mod self_contact_search;
mod vectors;

pub use contact_constraint::{ConstraintJump, ContactConstraint};
pub use contact_nodes::{Member, Touch};
pub use multi_body_constraint::MultiBodyConstraint;
pub use patch_contact::PatchContact;
pub use self_contact::SelfContact;

use decomp::array::from_fn;
use smallvec::SmallVec;

use super::scheme::Scheme;
use super::series::ProductSeries;
use crate::contact::{BodyPair, ContactCondition, ContactParticle, ContactPlane};
use crate::shape::with_width;
use crate::solver::clock::timed;
use crate::solver::patch::Patch;

impl<const D: usize> Scheme<D> {
    /// Finds the pairs of bodies in contact at the nodes that the patch computes, after masses and
    /// momenta have been summed, in a step of `dt` [s].
    pub(super) fn find_contact(&self, patch: &mut Patch<D>, contact: &ContactCondition, dt: f64) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            contact: &ContactCondition,
            dt: f64,
        ) {
            let mut found = std::mem::take(&mut patch.contact);
            found.clear();
            let mass = &patch.nodes.fields[s.fields.mass];
            let least = s.empty_mass;
            found.nodes.find::<K>(
                mass,
                least,
                &patch.nodes.nodes,
                &patch.active,
                &patch.stencils,
                &patch.runs,
            );
            for contact_node in 0..found.nodes.len() {
                s.find_constraints::<K>(patch, &mut found, contact_node, contact, dt);
            }
            s.fill_constrained_nodes(patch, &mut found);
            if found.searches_self_contact {
                found.self_contact = s.find_self_contact(patch);
            }
            patch.contact = found;
        }
        with_width!(patch.stencils.width, go(patch, self, contact, dt));
    }

    /// Finds the constraints of a contact node, in a step of `dt` [s].
    fn find_constraints<const K: usize>(
        &self,
        patch: &Patch<D>,
        found: &mut PatchContact<D>,
        contact_node: usize,
        contact: &ContactCondition,
        dt: f64,
    ) {
        let f = &self.fields;
        let fields = &patch.nodes.fields;
        let vector = |k: usize| from_fn(|a| &fields[k + a][..]);
        let sums = [vector(f.lumped_velocity), vector(f.acceleration)];
        let nodes = &found.nodes;
        let layers = patch.nodes.layers;
        let mut members =
            nodes.members(contact_node, self.empty_mass, layers, &fields[f.mass], sums);
        let node = nodes.node(contact_node);
        let index = self.index_of(patch, node);
        let particles = &mut found.particles;
        self.find_particles::<K>(
            patch,
            index,
            nodes.touches(contact_node),
            &mut members,
            particles,
        );
        let first = found.constraints.len();
        let share = self.share_of(patch, index);
        let count = patch.nodes.nodes.count();
        for (i, a) in members.iter().enumerate() {
            for (k, b) in members.iter().enumerate().skip(i + 1) {
                let pair = [a, b];
                let body_pair = BodyPair {
                    volume: pair.map(|m| m.volume),
                    gradient: [&a.gradient, &b.gradient],
                    particles: [&found.particles[i], &found.particles[k]],
                    cell: &self.cell,
                };
                let planes = contact.normals.planes(&body_pair, &mut found.corners);
                let touch =
                    |plane: &ContactPlane<D>| self.touch(patch, index, &body_pair, pair, plane, dt);
                for plane in planes.into_iter().filter(touch) {
                    found.constraints.push(ContactConstraint {
                        at: pair.map(|m| m.layer * count + node),
                        mass: pair.map(|m| m.mass),
                        normal: plane.normal,
                        low: [false; 2],
                        share,
                        given: [[0.0; D]; 2],
                        friction: [0.0; D],
                    });
                }
            }
        }
        if found.constraints.len() > first + 1 {
            found.multi_body.push(MultiBodyConstraint::new(first, &found.constraints[first..]));
        }
    }

    /// Layer of a particle.
    fn layer_of(&self, patch: &Patch<D>, particle: usize) -> usize {
        patch.block.columns[self.columns.body][particle] as usize
    }

    /// Grid index of the node at index `node` in a layer.
    fn index_of(&self, patch: &Patch<D>, node: usize) -> [i64; D] {
        let (nodes, stride) = (&patch.nodes.nodes, patch.stencils.stride);
        from_fn(|a| {
            let at = if D == 1 { node } else { [node % stride, node / stride][a] };
            nodes.lower[a] + at as i64
        })
    }

    /// See [`ContactConstraint::share`].
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
        from_fn(|a| {
            let cells = (i64::from(cell[a]) - index[a]) as f64;
            let first = cells + patch.block.columns[self.columns.fraction + a][particle];
            self.columns.displacement.map_or(first, |shift| {
                first + patch.block.columns[shift + a][particle] * self.inverse_cell[a]
            })
        })
    }

    /// Finds the particles of each body that touch a node, and their sums of filled volume.
    fn find_particles<const K: usize>(
        &self,
        patch: &Patch<D>,
        index: [i64; D],
        touches: &[Touch],
        members: &mut [Member<D>],
        particles: &mut Vec<Vec<ContactParticle<D>>>,
    ) {
        let c = &self.columns;
        let column = |k: usize| &patch.block.columns[k];
        let filled = column(c.current_volume.expect("contact has the column"));
        particles.resize(particles.len().max(members.len()), Vec::new());
        particles.iter_mut().for_each(Vec::clear);
        for touch in touches {
            let (r, at) = (touch.particle as usize, touch.at as usize);
            let layer = self.layer_of(patch, r);
            let Some(k) = members.iter().position(|m| m.layer == layer) else { continue };
            let weights = patch.stencils.particle::<K, D>(r);
            let volume = filled[r] * weights.values[at / K][at % K];
            let member = &mut members[k];
            member.volume += volume;
            for a in 0..D {
                member.gradient[a] += filled[r] * weights.gradient(a)[at / K][at % K];
            }
            let place = self.place(patch, r, index);
            let place = from_fn(|a| place[a] * self.cell[a]);
            let half_edges = match c.half_edges {
                None => [from_fn(|a| 0.5 * filled[r] * self.cell[a]), [0.0; D]],
                Some(first) => {
                    from_fn(|k| from_fn(|a| column(first + 2 * k + a)[r] * self.cell[a]))
                }
            };
            let faces = match c.faces {
                None => [[0.0; 2]; 2],
                Some(first) => from_fn(|k| from_fn(|a| column(first + 2 * k + a)[r])),
            };
            let index = touch.particle;
            particles[k].push(ContactParticle { index, place, half_edges, volume, faces });
        }
    }

    /// With an edge mask, bodies in contact fill a node together.
    fn fill_constrained_nodes(&self, patch: &mut Patch<D>, found: &mut PatchContact<D>) {
        let Some(least) = self.edge_mask else { return };
        let volume = &mut patch.nodes.fields[self.fields.volume];
        let mut grouped = found.multi_body.iter().flat_map(|k| k.constraints()).peekable();
        for (k, constraint) in found.constraints.iter_mut().enumerate() {
            if grouped.next_if_eq(&k).is_none() {
                let own = constraint.at.map(|at| volume[at]);
                constraint.low = own.map(|v| v < least);
                constraint.at.iter().for_each(|&at| volume[at] = own[0] + own[1]);
            }
        }
        for group in &found.multi_body {
            let sum: f64 = group.places().iter().map(|&at| volume[at]).sum();
            group.places().iter().for_each(|&at| volume[at] = sum);
        }
    }

    /// Projects lumped velocity and acceleration at nodes in contact.
    pub(super) fn join_sums(&self, patch: &mut Patch<D>) {
        let f = &self.fields;
        for (field, jump_of) in
            [(f.lumped_velocity, ConstraintJump::Velocity), (f.acceleration, ConstraintJump::Force)]
        {
            patch.contact.join(&mut patch.nodes.fields[field..field + D], Some(jump_of));
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
        let jump_of = match series.sum {
            s if ends && s == f.velocity => Some(ConstraintJump::Velocity),
            s if ends && s == f.acceleration => Some(ConstraintJump::Force),
            _ => None,
        };
        patch.contact.join(&mut patch.nodes.fields[series.sum..series.sum + D], jump_of);
    }

    /// Projects the first term of the series of w.
    pub(super) fn join_work(&self, patch: &mut Patch<D>) {
        let f = &self.fields;
        patch.contact.join(&mut patch.nodes.fields[f.work..f.work + D], None);
        if self.transfer.is_filtered() {
            for a in 0..D {
                let [work, first] = patch.nodes.fields_mut([f.work + a, f.first + a]);
                for at in patch.contact.constraints.iter().flat_map(|j| j.at) {
                    first[at] = work[at];
                }
            }
        }
    }

    /// Share of a jump of the nodal velocity that particles adopt [-]: a blend keeps a part of the
    /// particle velocity.
    pub(crate) fn moved(&self) -> f64 {
        self.transfer.taken_share()
    }

    /// Contact at the end of a step of `dt` [s]: transfers the heat of friction to the own
    /// particles, and records the forces between bodies.
    pub(super) fn gather_contact(&self, patch: &mut Patch<D>, dt: f64) {
        if self.fields.heat.is_some() {
            timed(self.friction_part, patch, |patch| self.gather_friction_heat(patch));
        }
        if self.contact.is_none() {
            return;
        }
        let moved = self.moved();
        let PatchContact { constraints, forces, .. } = &mut patch.contact;
        forces.clear();
        let own = constraints.iter().filter(|j| j.share > 0.0);
        forces.extend(own.map(|constraint| {
            let impulse = constraint.impulse(moved, dt);
            let force: [f64; D] =
                from_fn(|a| constraint.share * (impulse[a] / dt + constraint.friction[a]));
            let along: SmallVec<[f64; 2]> =
                (0..D).map(|a| force[a] * constraint.normal[a]).collect();
            let normal: f64 = along.iter().sum();
            let rest = |a: usize| force[a] - normal * constraint.normal[a];
            let across = (0..D).map(|a| rest(a) * rest(a)).sum::<f64>().sqrt();
            // friction on a node that pulls has the sign of its normal force
            [-normal, if normal > 0.0 { -across } else { across }]
        }));
    }
}
