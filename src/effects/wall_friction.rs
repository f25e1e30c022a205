//! Walls with friction.
//!
//! At each of its nodes, a wall with friction removes at most the tangential momentum of the node,
//! and at most the friction coefficient times the normal impulse of the wall (Coulomb). It uses
//! lumped masses, so that the law holds to rounding for FLIP, PIC and APIC. XPIC and FMPM remove
//! less momentum from a body that strikes the wall than lumped masses would in a step: the friction
//! is up to 1.9 times that of Coulomb in the first steps of an impact, and 1.1 to 1.3 times over
//! the whole impact.

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
        d.friction_heat();
    }

    fn build<const D: usize>(setup: &mut Setup<'_, D>) -> Box<dyn Effect<D>> {
        Box::new(WallFriction {
            walls: sides_of::<D, _>(setup.scene, |side| side.friction),
            sums: setup.fields.add(2),
        })
    }
}

impl<const D: usize> Effect<D> for WallFriction {
    fn phases(&self) -> &'static [Phase] {
        &[Phase::NodalForce]
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
            let Some(boxes) = s.start_side(patch, axis, wall, wall + 1, e.sums..e.sums + 2) else {
                return;
            };
            e.sum_impulse::<K, D>(s, patch, axis, wall, dt);
            for (layer, part) in boxes.into_iter().enumerate().filter(|(_, p)| !p.is_empty()) {
                for index in part.iter() {
                    let impulse = e.wall_impulse(s, patch, layer, index, axis, end, dt, K);
                    e.apply_at(s, patch, layer, index, axis, coefficient * impulse, dt);
                }
            }
        }
        with_width!(patch.stencils.width, go(patch, (s, self), (axis, end, coefficient), dt));
    }

    /// Sums of mass, and of the normal impulse that would result without the wall, over the
    /// particles near a wall that are not images in it.
    fn sum_impulse<const K: usize, const D: usize>(
        &self,
        s: &Scheme<D>,
        patch: &mut Patch<D>,
        axis: usize,
        wall: i64,
        dt: f64,
    ) {
        let (c, first) = (&s.columns, self.sums);
        let [mut masses, mut impulses] =
            [0, 1].map(|k| std::mem::take(&mut patch.nodes.fields[first + k]));
        let moved = s.moved();
        for r in patch.runs.iter().cloned().flatten() {
            let cell = i64::from(patch.block.cells[r][axis]);
            if !(0..s.cells[axis]).contains(&cell) || (cell - wall).abs() > K as i64 {
                continue;
            }
            let weights = patch.stencils.particle::<K, D>(r);
            let column = |k: usize| patch.block.columns[k][r];
            let m = column(c.mass);
            let pulled = c.forces.iter().map(|k| column(k + axis)).fold(0.0, |sum, f| sum + f);
            let impulse = moved * m * column(c.velocity + axis) + dt * pulled;
            weights.add(&mut masses, weights.values, |n| n * m);
            weights.add(&mut impulses, weights.values, |n| n * impulse);
            if let Some(affine) = c.affine {
                // APIC: m N C (x_i - x_p), as in the momentum sum
                let offset = s.offset(patch, r, weights.first);
                let mc: [f64; D] =
                    std::array::from_fn(|b| m * column(affine + D * axis + b) * s.cell[b]);
                for line in 0..ParticleWeights::<K, D>::LINES {
                    let across =
                        if D == 1 { 0.0 } else { mc[D - 1] * (offset[D - 1] + line as f64) };
                    let terms = std::array::from_fn(|k| {
                        weights.values[line][k] * (across + mc[0] * (offset[0] + k as f64))
                    });
                    add::<K>(&mut impulses, weights.first + line * weights.stride, terms);
                }
            }
            s.add_stress(patch, &weights, r, axis, dt, &mut impulses);
        }
        patch.nodes.fields[first] = masses;
        patch.nodes.fields[first + 1] = impulses;
    }

    /// Normal impulse of a wall in `dt` at one of its nodes on real particles (not images) [N s],
    /// with lumped masses: each node and its image share their impulse.
    // the arguments locate one node; a struct for them would be used only once
    #[expect(clippy::too_many_arguments)]
    fn wall_impulse<const D: usize>(
        &self,
        s: &Scheme<D>,
        patch: &Patch<D>,
        layer: usize,
        index: [i64; D],
        axis: usize,
        end: usize,
        dt: f64,
        width: usize,
    ) -> f64 {
        let (f, nodes) = (&s.fields, &patch.nodes.nodes);
        let outward = if end == 0 { -1 } else { 1 };
        let place = |k: i64| {
            let mut at = index;
            at[axis] += k * outward;
            nodes.contains(at).then(|| layer * nodes.count() + nodes.flat(at))
        };
        let value = |k: usize, at: usize| patch.nodes.fields[k][at];
        let own = |at: usize| value(self.sums + 1, at);
        let mut sum = place(0).map_or(0.0, own);
        for k in 1..=width as i64 {
            let (Some(beyond), Some(before)) = (place(k), place(-k)) else { break };
            let (m, both) = (value(self.sums, beyond), value(f.mass, before));
            if both > s.empty_mass {
                let all = s.moved() * value(f.lumped_velocity + axis, before)
                    + dt * value(f.acceleration + axis, before);
                // the image's part is the reflected value of the node beyond
                let inner = all + own(beyond);
                sum += 2.0 * (m * inner + (both - m) * own(beyond)) / both;
            }
        }
        (outward as f64 * sum).max(0.0)
    }

    // as above
    #[expect(clippy::too_many_arguments)]
    /// Applies friction to a node of a wall; removes at most the momentum `most` [N s] from real
    /// particles (not images).
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
        if patch.nodes.fields[f.mass][at] <= s.empty_mass {
            return;
        }
        let force = std::array::from_fn(|a| {
            let value = |k: usize| patch.nodes.fields[k + a][at];
            // the sums count each particle twice, as itself and as its image
            let held = value(f.lumped_velocity) + dt * value(f.acceleration);
            if a == axis { 0.0 } else { -held.clamp(-2.0 * most, 2.0 * most) / dt }
        });
        s.push(patch, at, index, force, true);
    }
}

#[cfg(test)]
#[path = "tests/wall_friction.rs"]
mod tests;
