//! Walls with friction.
//!
//! At each of its nodes, a wall with friction removes at most the tangential momentum of the node,
//! and at most the friction coefficient times the normal impulse of the wall (Coulomb). It acts on
//! the velocity v' at the end of the step, when the normal impulse is known. With the lumped masses
//! m and the mass matrix M of the particles themselves (not their images), their momentum p and
//! force f, and r = r_v + dt (a r_b + (1 - a) b) with the last terms r_v and r_b of the series of v
//! and b and the share a of the full mass matrix (see [`Fields`]),
//!
//! ```text
//! P = sum (m r + M (v' - r) - p - dt f)
//! ```
//!
//! over the nodes on the normal through a node of the wall is the impulse that the particles get
//! there: beyond the reach of images each term vanishes, and the sum over all nodes is the change of
//! the particles' momentum, for any filter and order.
//!
//! [`Fields`]: crate::solver::nodal_fields::Fields

use crate::scene::CheckedScene;
use crate::shape::with_width;
use crate::solver::Scheme;
use crate::solver::declare::Declare;
use crate::solver::effect::{Effect, Package, Phase, Setup, StepContext};
use crate::solver::particle_weights::{ParticleWeights, add};
use crate::solver::patch::Patch;
use crate::solver::sides::sides_of;

/// Walls with friction.
pub struct WallFriction {
    /// Direction, end and friction coefficient of each wall.
    walls: Vec<(usize, usize, f64)>,
    /// Index of the first of the nodal sums.
    sums: usize,
}

impl Package for WallFriction {
    const NAME: &'static str = "wall friction";

    fn is_active(scene: &CheckedScene) -> bool {
        scene.has_frictional_wall()
    }

    fn declare(_: &CheckedScene, d: &mut Declare<'_>) {
        d.wall_friction_heat();
    }

    fn build<const D: usize>(setup: &mut Setup<'_, D>) -> Box<dyn Effect<D>> {
        Box::new(WallFriction {
            walls: sides_of::<D, _>(setup.scene, |side| side.friction),
            sums: setup.fields.add(3),
        })
    }
}

impl<const D: usize> Effect<D> for WallFriction {
    fn phases(&self) -> &'static [Phase] {
        &[Phase::EndVelocity]
    }

    fn act(&self, _: Phase, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        for &wall in &self.walls {
            self.apply(step.scheme, patch, wall, step.dt);
        }
    }
}

impl WallFriction {
    /// Applies the friction of a wall to its nodes.
    fn apply<const D: usize>(
        &self,
        s: &Scheme<D>,
        patch: &mut Patch<D>,
        (axis, end, coefficient): (usize, usize, f64),
        dt: f64,
    ) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            (s, e): (&Scheme<D>, &WallFriction),
            (axis, end, coefficient): (usize, usize, f64),
            dt: f64,
        ) {
            let wall = if end == 0 { 0 } else { s.cells[axis] };
            let Some(boxes) = s.start_side(patch, axis, wall, wall + 1, e.sums..e.sums + 3) else {
                return;
            };
            e.find_inner_sums(s, patch, axis, dt);
            e.sum_impulse::<K, D>(s, patch, axis, wall, dt);
            e.leave_contact_out(s, patch, axis, dt);
            for (layer, part) in boxes.into_iter().enumerate().filter(|(_, p)| !p.is_empty()) {
                for index in part.iter() {
                    let impulse = e.wall_impulse(s, patch, layer, index, axis, end, K);
                    e.apply_at(s, patch, layer, index, axis, coefficient * impulse, dt);
                }
            }
        }
        with_width!(patch.stencils.width, go(patch, (s, self), (axis, end, coefficient), dt));
    }

    /// Normal component of v' - r: the sums of the series of v and dt b before their last terms, that
    /// of b times the share of the full mass matrix.
    /// Without a filter r = v' - a vL, with the share a of their velocity that particles keep.
    fn find_inner_sums<const D: usize>(
        &self,
        s: &Scheme<D>,
        patch: &mut Patch<D>,
        axis: usize,
        dt: f64,
    ) {
        let f = &s.fields;
        let mut inner = std::mem::take(&mut patch.nodes.fields[self.sums + 2]);
        let field = |k: usize| &patch.nodes.fields[k + axis][..];
        match (f.filter_residual, f.force_residual) {
            (Some(velocity), Some(force)) => {
                let (star, velocity, force) =
                    (field(f.velocity_star), field(velocity), field(force));
                let acceleration = field(f.acceleration);
                let (full, lumped) = (s.full_share, 1.0 - s.full_share);
                for span in patch.span_lines.iter().cloned().flatten() {
                    let rest = full * force[span] + lumped * acceleration[span];
                    inner[span] = star[span] - velocity[span] - dt * rest;
                }
            }
            _ => {
                let lumped = field(f.lumped_velocity);
                inner.iter_mut().zip(lumped).for_each(|(x, v)| *x = (1.0 - s.moved()) * v);
            }
        }
        patch.nodes.fields[self.sums + 2] = inner;
    }

    /// Sums over the particles near a wall that are not images in it: mass, and the impulse of the
    /// wall's nodes without the part of the last terms, M (v' - r) - p - dt f.
    fn sum_impulse<const K: usize, const D: usize>(
        &self,
        s: &Scheme<D>,
        patch: &mut Patch<D>,
        axis: usize,
        wall: i64,
        dt: f64,
    ) {
        let (c, first) = (&s.columns, self.sums);
        let [mut masses, mut impulses, inner] =
            [0, 1, 2].map(|k| std::mem::take(&mut patch.nodes.fields[first + k]));
        let (moved, filtered) = (s.moved(), s.fields.force_residual.is_some());
        for r in patch.runs.iter().cloned().flatten() {
            let cell = i64::from(patch.block.cells[r][axis]);
            if !(0..s.cells[axis]).contains(&cell) || (cell - wall).abs() > K as i64 {
                continue;
            }
            let weights = patch.stencils.particle::<K, D>(r);
            let column = |k: usize| patch.block.columns[k][r];
            let m = column(c.mass);
            let pulled = c.forces.iter().map(|k| column(k + axis)).fold(0.0, |sum, f| sum + f);
            let kept = if filtered { m * weights.dot(weights.values, &inner) } else { 0.0 };
            let impulse = kept - moved * m * column(c.velocity + axis) - dt * pulled;
            weights.add(&mut masses, weights.values, |n| n * m);
            weights.add(&mut impulses, weights.values, |n| n * impulse);
            if let Some(affine) = c.affine {
                // APIC: m N C (x_i - x_p), as in the momentum sum
                let offset = s.offset(patch, r);
                let mc: [f64; D] =
                    std::array::from_fn(|b| -m * column(affine + D * axis + b) * s.cell[b]);
                for line in 0..ParticleWeights::<K, D>::LINES {
                    let across = if D == 1 { 0.0 } else { mc[D - 1] * offset.at(D - 1, line) };
                    let terms = std::array::from_fn(|k| {
                        weights.values[line][k] * (across + mc[0] * offset.at(0, k))
                    });
                    add::<K>(&mut impulses, weights.first + line * weights.stride, terms);
                }
            }
            s.add_stress(patch, &weights, r, axis, -dt, &mut impulses);
        }
        for (k, field) in [masses, impulses, inner].into_iter().enumerate() {
            patch.nodes.fields[first + k] = field;
        }
    }

    /// Takes the impulse of other bodies out of the sums of the wall.
    fn leave_contact_out<const D: usize>(
        &self,
        s: &Scheme<D>,
        patch: &mut Patch<D>,
        axis: usize,
        dt: f64,
    ) {
        let [masses, impulses] = patch.nodes.fields_mut([self.sums, self.sums + 1]);
        for constraint in &patch.contact.constraints {
            let impulse = constraint.impulse(s.moved(), dt)[axis];
            for ((at, mass), impulse) in
                constraint.at.into_iter().zip(constraint.mass).zip([impulse, -impulse])
            {
                impulses[at] -= masses[at] / mass * impulse;
            }
        }
    }

    /// Impulse of a wall towards the domain at one of its nodes [N s].
    #[expect(clippy::too_many_arguments, reason = "the arguments locate one node")]
    fn wall_impulse<const D: usize>(
        &self,
        s: &Scheme<D>,
        patch: &Patch<D>,
        layer: usize,
        index: [i64; D],
        axis: usize,
        end: usize,
        width: usize,
    ) -> f64 {
        let nodes = &patch.nodes.nodes;
        let outward = if end == 0 { -1 } else { 1 };
        let place = |k: i64| {
            let mut at = index;
            at[axis] += k * outward;
            nodes.contains(at).then(|| layer * nodes.count() + nodes.flat(at))
        };
        let value = |k: usize, at: usize| patch.nodes.fields[k][at];
        let own = |at: usize| {
            let last = value(s.fields.velocity_star + axis, at) - value(self.sums + 2, at);
            value(self.sums, at) * last + value(self.sums + 1, at)
        };
        let mut sum = place(0).map_or(0.0, own);
        for k in 1..=width as i64 {
            let (Some(beyond), Some(before)) = (place(k), place(-k)) else { break };
            // where no image reaches, nothing is added
            if value(self.sums, beyond) == 0.0 {
                break;
            }
            sum += own(beyond) + own(before);
        }
        (-outward as f64 * sum).max(0.0)
    }

    /// Applies friction to a node of a wall; removes at most the momentum `most` [N s] from real
    /// particles (not images).
    #[expect(clippy::too_many_arguments, reason = "the arguments locate one node")]
    fn apply_at<const D: usize>(
        &self,
        s: &Scheme<D>,
        patch: &mut Patch<D>,
        layer: usize,
        index: [i64; D],
        axis: usize,
        most: f64,
        dt: f64,
    ) {
        let f = &s.fields;
        let at = layer * patch.nodes.nodes.count() + patch.nodes.nodes.flat(index);
        let mass = patch.nodes.fields[f.mass][at];
        if mass <= s.empty_mass {
            return;
        }
        let mut force = [0.0; D];
        for a in (0..D).filter(|&a| a != axis) {
            // the sums count each particle twice, as itself and as its image
            let star = &mut patch.nodes.fields[f.velocity_star + a][at];
            let impulse = -(mass * *star).clamp(-2.0 * most, 2.0 * most);
            *star += impulse / mass;
            force[a] = impulse / dt;
        }
        s.record_side_force(patch, at, index, force, true);
    }
}

#[cfg(test)]
#[path = "tests/wall_friction.rs"]
mod tests;
