//! Friction in the contact plane: Coulomb's law, its impulse and heat.
//!
//! Friction acts on the nodal velocities at the end of a step. The normal impulse of contact N is
//! known then: for any filter and order, the sum over the nodes of a body is the momentum that its
//! particles get from it. With the reduced lumped mass m and the slip s, the difference of the
//! velocities along the contact plane,
//!
//! ```text
//! J = -min(coefficient N, m |s|) s/|s|
//! ```
//!
//! on the first body, and -J on the second (after Bardenhagen, Brackbill & Sulsky 2000): Coulomb's
//! law holds to rounding. If N is negative at a node between bodies that slide, J has the sign of N,
//! so that the law holds for the sum over the nodes. As an impulse on lumped masses, J changes v' by J/m_i, and its work is
//! J.(vL + A v')/2, the first term of the velocity that does the work, so that energy stays exact.

use decomp::Parity;
use smallvec::SmallVec;

use crate::shape::with_width;
use crate::solver::clock::timed;
use crate::solver::contact::vectors::{dot, norm};
use crate::solver::effect::{Phase, StepContext};
use crate::solver::exchange::Nodal;
use crate::solver::parts::StepPart;
use crate::solver::patch::Patch;
use crate::solver::scheme::Scheme;
use crate::transfer::VelocityUpdate;

impl<const D: usize> Scheme<D> {
    /// Applies the friction between bodies and at walls to the velocity at the end of the step.
    /// Collective between neighbours.
    pub(in crate::solver) fn solve_friction(
        &self,
        nodal: &mut Nodal<'_, D>,
        step: &StepContext<'_, D>,
    ) {
        if self.fields.heat.is_none() {
            return;
        }
        let star = self.fields.velocity_star;
        let fields: SmallVec<[(usize, Parity); 2]> =
            (0..D).map(|a| (star + a, Parity::Odd(a))).collect();
        let coefficient = self.contact.and_then(|contact| contact.coefficient).filter(|_| D > 1);
        nodal.each("friction", |patch| {
            if let Some(coefficient) = coefficient {
                timed(StepPart::Contact as usize, patch, |patch| {
                    self.rub(patch, coefficient, step.dt);
                });
            }
            step.effects.act(Phase::EndVelocity, step, patch);
        });
        nodal.refresh(&fields);
        nodal.each("friction", |patch| {
            self.apply_no_slip(patch, &fields);
            step.effects.set_boundary(self, patch, &fields);
            self.begin_work(patch);
        });
    }

    /// Applies the friction between bodies in a step of `dt` to the velocity at its end.
    fn rub(&self, patch: &mut Patch<D>, coefficient: f64, dt: f64) {
        let star = self.fields.velocity_star;
        let moved = self.moved();
        let fields = &mut patch.nodes.fields[star..star + D];
        let contact = &mut patch.contact;
        for constraint in &mut contact.constraints {
            let normal = &constraint.normal;
            let most = -coefficient * dot(&constraint.impulse(moved, dt), normal);
            let [i, j] = constraint.at;
            let apart: [f64; D] = decomp::array::from_fn(|a| fields[a][i] - fields[a][j]);
            let along = dot(&apart, normal);
            let slip: [f64; D] = decomp::array::from_fn(|a| apart[a] - along * normal[a]);
            let speed = norm(&slip);
            // where a filter or the lumped masses let a node pull, its neighbours press too much:
            // what slides there gets the difference back
            if speed <= 0.0 || (most <= 0.0 && !self.slides(speed)) {
                continue;
            }
            let [a, b] = constraint.mass;
            let (reduced, most) = (a * b / (a + b), most / speed);
            let scale = -most.clamp(-reduced, reduced);
            for (k, slip) in slip.into_iter().enumerate() {
                fields[k][i] += scale * slip / a;
                fields[k][j] -= scale * slip / b;
                constraint.friction[k] = scale * slip / dt;
            }
        }
        // where several pairs touch, the friction of one must not separate another
        for group in &contact.multi_body {
            group.join(fields, &mut contact.constraints[group.constraints()], None);
        }
    }

    /// Work of friction in a step of `dt` as heat of the two bodies, half each [J/kg]:
    /// -f.(w_a - w_b) dt, with the first term w of the velocity whose gradient does the work, as
    /// friction acts on lumped masses. A wall takes no heat: a body that slides on it gets the whole
    /// -f.w dt.
    fn find_friction_heat(&self, patch: &mut Patch<D>, dt: f64) {
        let f = &self.fields;
        let Some(field) = f.heat else { return };
        let mut heat = std::mem::take(&mut patch.nodes.fields[field]);
        heat.fill(0.0);
        let fields = &patch.nodes.fields;
        let first = match self.transfer.update {
            VelocityUpdate::Filtered => f.first,
            VelocityUpdate::Blend(_) | VelocityUpdate::Affine => f.work,
        };
        let velocity = |a: usize, at: usize| match self.compatible {
            true => fields[first + a][at],
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

    /// Adds the heat of friction to the energy of the own particles.
    pub(super) fn gather_friction_heat(&self, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Scheme<D>) {
            let (Some(field), Some(total)) = (s.fields.heat, s.columns.friction_heat) else {
                return;
            };
            let n = patch.block.own();
            let columns = &mut patch.block.columns;
            let [energy, total] =
                columns.get_disjoint_mut([s.columns.energy, total]).expect("columns differ");
            for r in 0..n {
                let weights = patch.stencils.particle::<K, D>(r);
                let heat = weights.dot(weights.values, &patch.nodes.fields[field]);
                energy[r] += heat;
                total[r] += heat;
            }
        }
        with_width!(patch.stencils.width, go(patch, self));
    }
}
