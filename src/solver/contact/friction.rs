//! Friction in the contact plane: Coulomb's law, friction force and heat.

use decomp::Parity;

use crate::shape::with_width;
use crate::solver::contact::vectors::norm;
use crate::solver::contact::{Member, PatchContact};
use crate::solver::exchange::Nodal;
use crate::solver::patch::Patch;
use crate::solver::scheme::Scheme;

impl<const D: usize> Scheme<D> {
    /// Whether two bodies stick in a step of `dt`, and if not the friction force of the second on
    /// the first [N].
    ///
    /// For the velocities at the end of a step without contact, N is the impulse that makes their
    /// normal components equal, and T the impulse that makes their tangential components equal.
    /// Coulomb's law: the bodies stick if T <= coefficient N, otherwise an impulse of coefficient N
    /// opposes the slip (Bardenhagen, Brackbill & Sulsky 2000).
    pub(super) fn friction(
        &self,
        [a, b]: [&Member<D>; 2],
        normal: &[f64; D],
        coefficient: f64,
        dt: f64,
    ) -> (bool, [f64; D]) {
        let moved = self.moved();
        let mass = a.mass * b.mass / (a.mass + b.mass);
        let apart: [f64; D] = decomp::array::from_fn(|k| a.velocity[k] - b.velocity[k]);
        let pushed: [f64; D] =
            decomp::array::from_fn(|k| dt * (a.acceleration[k] - b.acceleration[k]));
        let along = |v: &[f64; D]| (0..D).map(|k| v[k] * normal[k]).sum::<f64>();
        let most = coefficient * mass * (moved * along(&apart) + along(&pushed)).max(0.0);
        let slip: [f64; D] = decomp::array::from_fn(|k| {
            let across = |v: &[f64; D]| v[k] - along(v) * normal[k];
            across(&apart) + across(&pushed)
        });
        let speed = norm(&slip);
        let sticks = mass * speed <= most;
        if sticks && moved == 1.0 {
            return (true, [0.0; D]);
        }
        // a blend keeps a part of the particle velocities: sticking then needs a force
        let impulse = if sticks { mass * speed } else { most };
        let scale = if speed > 0.0 { -impulse / (dt * speed) } else { 0.0 };
        (false, slip.map(|s| scale * s))
    }

    /// Adds the friction forces to the nodal forces.
    pub(super) fn rub(&self, patch: &mut Patch<D>, nodes: &PatchContact<D>) {
        for (constraint, a) in nodes.constraints.iter().flat_map(|j| (0..D).map(move |a| (j, a))) {
            let force = &mut patch.nodes.fields[self.fields.acceleration + a];
            force[constraint.at[0]] += constraint.friction[a];
            force[constraint.at[1]] -= constraint.friction[a];
        }
    }

    /// Work of friction in a step of `dt` as heat of the two bodies, half each [J/kg]:
    /// -f.(w_a - w_b) dt, with the velocity whose gradient does the work. A wall takes no heat: a
    /// body that slides on it gets the whole -f.w dt.
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
        for constraint in &patch.contact.constraints {
            let [i, j] = constraint.at;
            let slip = |a: usize| velocity(a, i) - velocity(a, j);
            let power: f64 = (0..D).map(|a| -constraint.friction[a] * slip(a)).sum();
            heat[i] += 0.5 * dt * power / constraint.mass[0];
            heat[j] += 0.5 * dt * power / constraint.mass[1];
        }
        for pushed in patch.side_forces.iter().filter(|p| p.has_friction) {
            let power: f64 = (0..D).map(|a| -pushed.force[a] * velocity(a, pushed.at)).sum();
            heat[pushed.at] += dt * power / fields[f.mass][pushed.at];
        }
        patch.nodes.fields[field] = heat;
    }

    /// Computes the heat of friction and exchanges it between the patches of a node. Collective
    /// between neighbours.
    pub(in crate::solver) fn solve_friction_heat(&self, nodal: &mut Nodal<'_, D>, dt: f64) {
        if let Some(heat) = self.fields.heat {
            nodal.count_as(Some(self.friction_part));
            nodal.each("friction heat", |patch| self.find_friction_heat(patch, dt));
            nodal.count_as(None);
            nodal.refresh(&[(heat, Parity::Even)]);
        }
    }

    /// Transfers the heat of friction to the own particles.
    pub(super) fn gather_friction_heat(&self, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Scheme<D>) {
            let Some(field) = s.fields.heat else { return };
            let n = patch.block.own();
            let energy = &mut patch.block.columns[s.columns.energy][..n];
            for (r, e) in energy.iter_mut().enumerate() {
                let weights = patch.stencils.particle::<K, D>(r);
                *e += weights.dot(weights.values, &patch.nodes.fields[field]);
            }
        }
        with_width!(patch.stencils.width, go(patch, self));
    }
}
