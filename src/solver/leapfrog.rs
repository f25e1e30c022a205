//! Leapfrog stepping, the textbook form: stress and shape functions at the start of the step,
//! stress updated last (USL), first (USF) or last from the velocity mapped again (MUSL; all
//! three: Bardenhagen 2002, "Energy conservation error in the material point method").

use decomp::RowError;

use super::{Stepper, World};
use crate::effects::Effect;
use crate::scene::StressUpdate;
use crate::solver::clock::spend;

impl<const D: usize> Stepper<D> {
    /// One step from `time`. Collective.
    ///
    /// Stress first and modified last send the rows a second time, for what a ghost carries has
    /// changed within the step.
    pub(super) fn advance_leapfrog(
        &self,
        world: &mut World<'_, D>,
        time: f64,
        dt: f64,
    ) -> Result<(), RowError> {
        world.each("start", |patch| {
            patch.block.drop_ghosts();
            self.current_stress(patch);
            self.find_push(patch, 0.0, self.columns.jacobian);
            self.find_pressed(patch, self.columns.jacobian, dt);
            self.find_body_force(patch, time);
            self.find_inertia(patch, time, dt);
            self.find_impedance(patch, self.columns.jacobian);
            self.find_loaded_volume(patch, self.columns.jacobian);
            self.find_conductance(patch, self.columns.jacobian);
            self.locate(patch, 0.0, self.columns.jacobian);
            self.find_active(patch);
        });
        if self.stress_update == StressUpdate::First {
            world.exchange_rows(|nodal| {
                nodal.each("scatter", |patch| self.scatter(patch, false, time, dt));
                // no force yet: the acceleration's sums are zero
                self.solve_velocity(nodal, 0.0, false);
                nodal.each("update stress", |patch| {
                    self.gather_gradient(patch);
                    self.update_stress(patch, dt);
                    self.current_stress(patch);
                });
            })?;
        }
        let last = self.stress_update == StressUpdate::Last;
        world.exchange_rows(|nodal| {
            nodal.each("scatter", |patch| {
                self.scatter(patch, true, time, dt);
                self.scatter_heat(patch);
            });
            self.solve_velocity(nodal, dt, false);
            self.conduct(nodal, dt);
            self.solve_friction_heat(nodal, dt);
            nodal.each("gather", |patch| {
                self.gather_contact(patch, dt);
                self.gather_leapfrog(patch, dt, last);
                self.book_body_force(patch, dt);
                self.book_inertia(patch, time, dt);
                self.book_sides(patch, dt);
                if last {
                    self.update_stress(patch, dt);
                }
            });
        })?;
        if self.stress_update == StressUpdate::ModifiedLast {
            world.exchange_rows(|nodal| {
                nodal.each("scatter again", |patch| {
                    self.scatter_rows(patch, false, true);
                    self.divide_by_mass(patch);
                    self.start_series(patch);
                });
                // no force yet: the acceleration's sums are zero
                self.solve_velocity(nodal, 0.0, false);
                nodal.each("update stress", |patch| {
                    self.gather_gradient(patch);
                    self.update_stress(patch, dt);
                });
            })?;
        }
        world.each("refresh", |patch| {
            self.burn(patch, time + dt, self.columns.jacobian);
            if self.erosion.is_some() {
                spend(Effect::Erosion, patch, |patch| self.erode(patch));
            }
            self.refresh(patch);
            if self.columns.failure.is_some() {
                spend(Effect::Failure, patch, |patch| self.fail(patch, dt));
            }
        });
        Ok(())
    }
}
