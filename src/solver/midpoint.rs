//! Mid-point stepping: stress and shape functions at the middle of the step.
//!
//! ```text
//! x_h = x + dt/2 v_p,  J_h = J (1 + dt/2 D)      D: gradient of the last v'
//! p_h from J_h and the energy of the middle,  s = p_h + q
//! f_i = sum V0 J_h s G_i
//! v = sum K^l vL,  v' = v + dt sum K^l f/m
//! v_p' = N v',  x += dt/2 (v_p + v_p')  (FLIP: dt N (v + v')/2),  J += dt J_h G (v + v')/2
//! e += -s V0 J_h dt (G w)/m + heat
//! ```
//!
//! With w of [`Stepper::solve_work`] and the filter's heat, kinetic and internal energy add up
//! to rounding.

use decomp::RowError;

use super::{Stepper, World};
use crate::effects::Effect::{
    AcceleratedGrid, BodyForce, Conduction, Contact, Erosion, Failure, LoadedSides, Relaxation,
    Strength, Stress, TransmittingSides, Viscosity,
};
use crate::solver::clock::spend;

impl<const D: usize> Stepper<D> {
    /// One step from `time`; `relax` is the rate of pressure relaxation if this step has it. Collective.
    pub(super) fn advance_midpoint(
        &self,
        world: &mut World<'_, D>,
        time: f64,
        dt: f64,
        relax: Option<f64>,
    ) -> Result<(), RowError> {
        let mid = self.columns.jacobian_mid.expect("mid-point stepping has the column");
        world.each("start", |patch| {
            patch.block.drop_ghosts();
            self.half_step_volume(patch, dt);
            self.find_push(patch, 0.5 * dt, mid);
            spend(Viscosity, patch, |patch| self.find_viscosity(patch, mid));
            if self.columns.strength.is_some() {
                spend(Strength, patch, |patch| self.shear_to_middle(patch, 0.5 * dt, mid));
            }
            self.burn(patch, time + 0.5 * dt, mid);
            self.mid_step_stress(patch, relax.is_some());
            if self.columns.failure.is_some() {
                spend(Failure, patch, |patch| self.bear_no_tension(patch, mid));
            }
            if self.columns.stress.is_some() {
                let deviator = self.columns.stress;
                let ahead = 0.5 * dt;
                spend(Stress, patch, |p| self.find_solid_stress(p, ahead, mid, deviator));
            }
            if self.columns.pressed.is_some() {
                spend(Contact, patch, |patch| self.find_pressed(patch, mid, dt));
            }
            if self.columns.body_force.is_some() {
                spend(BodyForce, patch, |patch| self.find_body_force(patch, time + 0.5 * dt));
            }
            if self.columns.frame_force.is_some() {
                spend(AcceleratedGrid, patch, |patch| self.find_inertia(patch, time, dt));
            }
            if self.columns.side.is_some() {
                spend(TransmittingSides, patch, |patch| self.find_impedance(patch, mid));
            }
            if self.columns.load.is_some() {
                spend(LoadedSides, patch, |patch| self.find_loaded_volume(patch, mid));
            }
            if self.conduction.is_some() {
                spend(Conduction, patch, |patch| self.find_conductance(patch, mid));
            }
            self.locate(patch, 0.5 * dt, mid);
            self.find_active(patch);
        });
        world.exchange_rows(|nodal| {
            nodal.each("scatter", |patch| {
                self.scatter(patch, true, time + 0.5 * dt, dt);
                if relax.is_some() {
                    spend(Relaxation, patch, |patch| self.start_pressure(patch));
                }
                if self.conduction.is_some() {
                    spend(Conduction, patch, |patch| self.scatter_heat(patch));
                }
            });
            self.solve_velocity(nodal, dt, relax.is_some());
            if self.compatible {
                self.solve_work(nodal);
            }
            self.conduct(nodal, dt);
            self.solve_friction_heat(nodal, dt);
            nodal.each("gather", |patch| {
                if self.columns.strength.is_some() {
                    spend(Strength, patch, |patch| self.gather_rate(patch));
                }
                self.gather_midpoint(patch, dt);
                if self.columns.strength.is_some() {
                    spend(Strength, patch, |patch| self.shear(patch, dt));
                }
                self.book_body_force(patch, dt);
                self.book_inertia(patch, time, dt);
                self.book_sides(patch, dt);
                if let Some(rate) = relax {
                    spend(Relaxation, patch, |patch| self.relax_pressure(patch, rate));
                }
                if let Some(rate) = self.volume_relaxation {
                    spend(Relaxation, patch, |patch| self.relax_volume(patch, rate));
                }
                self.burn(patch, time + dt, self.columns.jacobian);
                if self.erosion.is_some() {
                    spend(Erosion, patch, |patch| self.erode(patch));
                }
                self.refresh(patch);
                if self.columns.failure.is_some() {
                    spend(Failure, patch, |patch| self.fail(patch, dt));
                }
            });
        })
    }

    /// The gradient of the starting velocity, which the first step needs: a step of no length
    /// that moves nothing. Collective.
    pub(super) fn prime_gradient(&self, world: &mut World<'_, D>) -> Result<(), RowError> {
        let jacobian = self.columns.jacobian;
        world.each("start", |patch| {
            self.current_stress(patch);
            self.find_push(patch, 0.0, jacobian);
            self.locate(patch, 0.0, jacobian);
            // ghosts carry every declared column
            for (spec, column) in self.columns.specs.iter().zip(&mut patch.block.columns) {
                if spec.ghost {
                    column.resize(patch.block.ids.len(), 0.0);
                }
            }
        });
        world.exchange_rows(|nodal| {
            nodal.each("scatter", |patch| self.scatter(patch, false, 0.0, 0.0));
            self.solve_velocity(nodal, 0.0, false);
            nodal.each("gather", |patch| {
                self.gather_gradient(patch);
            });
        })
    }
}
