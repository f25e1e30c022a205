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
//! With w of [`Scheme::solve_work`](super::Scheme) and the heat of the filter, the sum of kinetic and internal
//! energy is constant to rounding.

use decomp::ParticleError;

use super::World;
use super::stepper::Stepper;
use crate::solver::clock::timed;
use crate::solver::effect::Phase;
use crate::solver::parts::StepPart;

impl<const D: usize> Stepper<D> {
    /// One step of `dt` from `start` [s]; `relax` is the rate of pressure relaxation, if this step
    /// relaxes. Collective.
    pub(super) fn advance_midpoint(
        &self,
        world: &mut World<'_, D>,
        start: f64,
        dt: f64,
        relax: Option<f64>,
    ) -> Result<(), ParticleError> {
        let jacobian = self.columns.jacobian_mid.expect("mid-point stepping has the column");
        let step = self.context([start, start + 0.5 * dt], dt, jacobian);
        world.each("start", |patch| {
            patch.block.drop_ghosts();
            self.half_step_volume(patch, dt);
            self.invert_deformation(patch, 0.5 * dt, jacobian);
            self.find_viscosity(patch, jacobian);
            self.effects.act(Phase::MidState, &step, patch);
            self.mid_step_stress(patch, relax.is_some());
            self.effects.act(Phase::MidStress, &step, patch);
            self.find_solid_stress(patch, 0.5 * dt, jacobian, self.columns.stress);
            self.find_contact_impulse(patch, jacobian, dt);
            self.effects.act(Phase::ParticleForce, &step, patch);
            self.find_cells(patch, 0.5 * dt, jacobian);
            self.find_active(patch, &self.effects);
        });
        world.exchange_particles(|nodal| {
            nodal.each("scatter", |patch| {
                self.scatter(patch, true, &step);
                self.start_limiter(patch);
                if relax.is_some() {
                    timed(StepPart::Relaxation as usize, patch, |patch| self.start_pressure(patch));
                }
                self.effects.act(Phase::NodalStart, &step, patch);
            });
            self.solve_velocity(nodal, &self.effects, dt, relax.is_some());
            self.solve_friction(nodal, &step);
            if self.compatible {
                self.solve_work(nodal, &self.effects);
            }
            self.effects.solve(&step, nodal);
            self.solve_friction_heat(nodal, dt);
            nodal.each("gather", |patch| {
                self.effects.act(Phase::Gather, &step, patch);
                self.gather_contact(patch, dt);
                self.gather_midpoint(patch, dt);
                self.gather_spin(patch, false);
                self.gather_limiter_heat(patch);
                self.effects.act(Phase::Gathered, &step, patch);
                self.accumulate_side_forces(patch, dt);
                self.relax(patch, relax);
                self.end_step(patch, &step);
            });
        })
    }

    /// Gradient of the initial velocity for the first step, by a step of zero length that moves
    /// nothing. Collective.
    pub(super) fn prime_gradient(&self, world: &mut World<'_, D>) -> Result<(), ParticleError> {
        let jacobian = self.columns.jacobian;
        let step = self.context([0.0, 0.0], 0.0, jacobian);
        world.each("start", |patch| {
            self.current_stress(patch);
            self.invert_deformation(patch, 0.0, jacobian);
            self.find_cells(patch, 0.0, jacobian);
            // ghosts must have every declared column
            for (spec, column) in self.columns.specs.iter().zip(&mut patch.block.columns) {
                if spec.ghost {
                    column.resize(patch.block.ids.len(), 0.0);
                }
            }
        });
        world.exchange_particles(|nodal| {
            nodal.each("scatter", |patch| self.scatter(patch, false, &step));
            self.solve_velocity(nodal, &self.effects, 0.0, false);
            nodal.each("gather", |patch| {
                self.gather_gradient(patch);
                self.gather_spin(patch, true);
            });
        })
    }
}
