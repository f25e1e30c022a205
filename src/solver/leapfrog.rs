//! Leapfrog stepping, the standard MPM step: stress and shape functions at the start of the step,
//! stress updated last (USL), first (USF), or last with the velocity mapped to the grid again
//! (MUSL; all three: Bardenhagen 2002, "Energy conservation error in the material point method").

use decomp::ParticleError;

use super::World;
use super::stepper::Stepper;
use crate::scene::StressUpdate;
use crate::solver::effect::Phase;

impl<const D: usize> Stepper<D> {
    /// One step of `dt` from `start` [s]. Collective.
    ///
    /// USF and MUSL exchange the particles a second time, as the data of ghosts change within the
    /// step.
    pub(super) fn advance_leapfrog(
        &self,
        world: &mut World<'_, D>,
        start: f64,
        dt: f64,
    ) -> Result<(), ParticleError> {
        let jacobian = self.columns.jacobian;
        let step = self.context([start, start], dt, jacobian);
        world.each("start", |patch| {
            patch.block.drop_ghosts();
            self.current_stress(patch);
            self.invert_deformation(patch, 0.0, jacobian);
            self.find_contact_impulse(patch, jacobian, dt);
            self.effects.act(Phase::ParticleForce, &step, patch);
            self.find_cells(patch, 0.0, jacobian);
            self.find_active(patch, &self.effects);
        });
        if self.stress_update == StressUpdate::First {
            world.exchange_particles(|nodal| {
                nodal.each("scatter", |patch| self.scatter(patch, false, &step));
                // no force yet: the sums of the acceleration are zero
                self.solve_velocity(nodal, &self.effects, 0.0, false);
                nodal.each("update stress", |patch| {
                    self.gather_gradient(patch);
                    self.update_stress(patch, &step);
                    self.current_stress(patch);
                });
            })?;
        }
        let last = self.stress_update == StressUpdate::Last;
        world.exchange_particles(|nodal| {
            nodal.each("scatter", |patch| {
                self.scatter(patch, true, &step);
                self.effects.act(Phase::NodalStart, &step, patch);
            });
            self.solve_velocity(nodal, &self.effects, dt, false);
            self.solve_friction(nodal, &step);
            self.effects.solve(&step, nodal);
            self.solve_friction_heat(nodal, dt);
            nodal.each("gather", |patch| {
                self.effects.act(Phase::Gather, &step, patch);
                self.gather_contact(patch, dt);
                self.gather_leapfrog(patch, dt, last);
                self.effects.act(Phase::Gathered, &step, patch);
                self.accumulate_side_forces(patch, dt);
                if last {
                    self.update_stress(patch, &step);
                }
            });
        })?;
        if self.stress_update == StressUpdate::ModifiedLast {
            world.exchange_particles(|nodal| {
                nodal.each("scatter again", |patch| {
                    self.scatter_particles(patch, false, true);
                    self.divide_by_mass(patch);
                    self.start_series(patch);
                });
                // no force yet: the sums of the acceleration are zero
                self.solve_velocity(nodal, &self.effects, 0.0, false);
                nodal.each("update stress", |patch| {
                    self.gather_gradient(patch);
                    self.update_stress(patch, &step);
                });
            })?;
        }
        world.each("refresh", |patch| self.end_step(patch, &step));
        Ok(())
    }
}
