//! Forces of the domain's sides on nodes, and no-slip walls.
//!
//! Particles at a no-slip wall have images with opposite velocity in every direction and opposite
//! forces; nodes on the wall are at rest, and nodes beyond it move as the images do. The velocity
//! then vanishes all along the wall, exactly for fields that are linear there.

use decomp::{IndexBox, Parity};

use super::scheme::Scheme;
use crate::scene::{CheckedScene, SideProperties};
use crate::shape::with_width;
use crate::solver::particle_weights::{Distances, ParticleWeights};
use crate::solver::patch::{BoundaryWork, Patch, SideForce};

/// Location relative to the mirrors of one direction.
#[derive(Clone, Copy, PartialEq)]
enum MirrorLocation {
    Itself,
    /// Beyond an odd number of no-slip walls.
    Turned,
    /// On a no-slip wall.
    OnWall,
}

/// The sides of a scene whose properties `of` accepts: direction, end and the result of `of`.
pub(crate) fn sides_of<const D: usize, T>(
    scene: &CheckedScene,
    of: impl Fn(&SideProperties) -> Option<T>,
) -> Vec<(usize, usize, T)> {
    let sides = scene.side_properties::<D>();
    let all = (0..D).flat_map(|axis| [(axis, 0), (axis, 1)]);
    all.filter_map(|(axis, end)| Some((axis, end, of(&sides[axis][end])?))).collect()
}

impl<const D: usize> Scheme<D> {
    /// Computed nodes of a patch whose index along `axis` is in a range, one box per layer; `None`
    /// if there are none. If there are some, sets the fields `sums` to zero.
    pub(crate) fn start_side(
        &self,
        patch: &mut Patch<D>,
        axis: usize,
        from: i64,
        to: i64,
        sums: std::ops::Range<usize>,
    ) -> Option<Vec<IndexBox<D>>> {
        let boxes: Vec<IndexBox<D>> = (patch.active.iter())
            .map(|active| {
                let mut part = *active;
                part.lower[axis] = part.lower[axis].max(from);
                part.upper[axis] = part.upper[axis].min(to);
                part
            })
            .collect();
        if boxes.iter().all(IndexBox::is_empty) {
            return None;
        }
        for field in &mut patch.nodes.fields[sums] {
            field.fill(0.0);
        }
        Some(boxes)
    }

    /// Adds the force of a side [N] to the force on a node, and records it.
    pub(crate) fn push(&self, patch: &mut Patch<D>, at: usize, index: [i64; D], force: [f64; D]) {
        for (a, force) in force.iter().enumerate() {
            patch.nodes.fields[self.fields.acceleration + a][at] += force;
        }
        self.record_side_force(patch, at, index, force, false);
    }

    /// Records the force of a side on a node [N], for its work and impulse.
    pub(crate) fn record_side_force(
        &self,
        patch: &mut Patch<D>,
        at: usize,
        index: [i64; D],
        force: [f64; D],
        has_friction: bool,
    ) {
        if force != [0.0; D] {
            let share = self.share_of(patch, index);
            patch.side_forces.push(SideForce { at, share, force, has_friction });
        }
    }

    /// Adds `scale` times the internal force of a particle along `axis` [N] to the nodes of
    /// `field`.
    #[inline(always)]
    pub(crate) fn add_stress<const K: usize>(
        &self,
        patch: &Patch<D>,
        weights: &ParticleWeights<'_, K, D>,
        r: usize,
        axis: usize,
        scale: f64,
        field: &mut [f64],
    ) {
        let s = |k: usize| scale * patch.block.columns[self.columns.stress_volume + k][r];
        if self.tensor_stress() {
            let along = [[s(0), s(2)], [s(2), s(1)]][axis];
            for (b, s) in along.into_iter().enumerate() {
                weights.add(field, weights.gradient(b), |g| g * s);
            }
        } else {
            weights.add(field, weights.gradient(axis), |g| g * s(0));
        }
        if self.axisymmetric && axis == 0 {
            let hoop = s(if self.tensor_stress() { 3 } else { 0 }) / self.radius(patch, r);
            weights.add(field, weights.values, |n| n * hoop);
        }
    }

    /// Adds up the work and impulse of the sides on the own nodes in a step of `dt` [s].
    pub(crate) fn accumulate_side_forces(&self, patch: &mut Patch<D>, dt: f64) {
        let f = &self.fields;
        let fields = &patch.nodes.fields;
        let own = patch.side_forces.iter().filter(|p| p.share > 0.0);
        patch.boundary_work.extend(own.map(|pushed| {
            let scale = pushed.share * dt;
            let power = (0..D).map(|a| {
                let velocity = match self.compatible {
                    true => fields[f.work + a][pushed.at],
                    false => {
                        0.5 * (fields[f.velocity + a][pushed.at]
                            + fields[f.velocity_star + a][pushed.at])
                    }
                };
                pushed.force[a] * velocity
            });
            let work = if pushed.has_friction { 0.0 } else { scale * power.sum::<f64>() };
            BoundaryWork { work, impulse: pushed.force.map(|force| scale * force) }
        }));
    }

    /// Location of the position `place` along `axis`, in half cells, relative to no-slip walls.
    fn seen(&self, axis: usize, place: i64) -> MirrorLocation {
        let whole = 2 * self.cells[axis];
        let holds = |wall: i64| self.sides[axis][wall.rem_euclid(2) as usize].no_slip;
        if place % whole == 0 && holds(place / whole) {
            return MirrorLocation::OnWall;
        }
        // walls between the position and the domain: lower and upper side alternate
        let walls = match place < 0 {
            true => place.div_euclid(whole) + 1..=0,
            false => 1..=(place - 1).div_euclid(whole),
        };
        match walls.filter(|&wall| holds(wall)).count() % 2 {
            0 => MirrorLocation::Itself,
            _ => MirrorLocation::Turned,
        }
    }

    /// Whether a particle is an image in no-slip walls normal to `axis`.
    fn is_turned(&self, patch: &Patch<D>, particle: usize, axis: usize) -> bool {
        self.seen(axis, 2 * i64::from(patch.block.cells[particle][axis]) + 1)
            == MirrorLocation::Turned
    }

    /// Reverses the velocity of ghosts beyond no-slip walls along these walls: the mirrors of the
    /// decomposition reverse only the normal component. To be called after the exchange of ghosts.
    pub(crate) fn reflect_ghosts(&self, patch: &mut Patch<D>) {
        let c = &self.columns;
        for axis in (0..D).filter(|&a| self.no_slip[a]) {
            for particle in patch.block.own()..patch.block.particles() {
                if !self.is_turned(patch, particle, axis) {
                    continue;
                }
                for a in (0..D).filter(|&a| a != axis) {
                    let affine = c.affine.map(|k| k + D * a..k + D * (a + 1));
                    let forces = c.forces.iter();
                    let vectors = std::iter::once(c.velocity + a).chain(forces.map(|k| k + a));
                    for k in vectors.chain(affine.into_iter().flatten()) {
                        patch.block.columns[k][particle] *= -1.0;
                    }
                }
            }
        }
    }

    /// `distances` of the nodes of a particle with spin. An image beyond a no-slip wall has all its
    /// vectors reversed along the wall. The component of phi along the wall is proportional to the
    /// distance across the wall, so that the sign of this distance is changed.
    #[inline(always)]
    pub(crate) fn reflect_spin(
        &self,
        patch: &Patch<D>,
        particle: usize,
        mut distances: Distances,
    ) -> Distances {
        let is_ghost = particle >= patch.block.own();
        for axis in (0..D).filter(|&a| is_ghost && self.no_slip[a]) {
            if self.is_turned(patch, particle, axis) {
                distances.first[axis] = -distances.first[axis];
                distances.cell[axis] = -distances.cell[axis];
            }
        }
        distances
    }

    /// Reverses the internal force of particles beyond no-slip walls along these walls, after it
    /// has been summed.
    pub(crate) fn turn_forces(&self, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Scheme<D>, axis: usize) {
            for a in (0..D).filter(|&a| a != axis) {
                let field = s.fields.acceleration + a;
                let mut force = std::mem::take(&mut patch.nodes.fields[field]);
                for r in patch.runs.iter().cloned().flatten() {
                    if r >= patch.block.own() && s.is_turned(patch, r, axis) {
                        let weights = patch.stencils.particle::<K, D>(r);
                        s.add_stress(patch, &weights, r, a, -2.0, &mut force);
                    }
                }
                patch.nodes.fields[field] = force;
            }
        }
        for axis in (0..D).filter(|&a| self.no_slip[a]) {
            with_width!(patch.stencils.width, go(patch, self, axis));
        }
    }

    /// Sets the vectors among `fields`, which have just been exchanged, to zero on no-slip walls,
    /// and reverses them beyond.
    pub(crate) fn apply_no_slip(&self, patch: &mut Patch<D>, fields: &[(usize, Parity)]) {
        for axis in (0..D).filter(|&a| self.no_slip[a]) {
            let all = patch.nodes.nodes;
            for index in all.lower[axis]..all.upper[axis] {
                let seen = self.seen(axis, 2 * index);
                if seen == MirrorLocation::Itself {
                    continue;
                }
                let mut line = all;
                (line.lower[axis], line.upper[axis]) = (index, index + 1);
                let along =
                    fields.iter().filter(|(_, p)| matches!(p, Parity::Odd(a) if *a != axis));
                for (field, _) in along {
                    let values = &mut patch.nodes.fields[*field];
                    for layer in values.chunks_mut(all.count()) {
                        for value in line.lines_in(&all).flatten() {
                            let turned = -layer[value];
                            layer[value] =
                                if seen == MirrorLocation::OnWall { 0.0 } else { turned };
                        }
                    }
                }
            }
        }
    }
}
