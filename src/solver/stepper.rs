//! Complete steps of a scene: its scheme and its effects.

use std::ops::Deref;

use super::body_models::BodyModels;
use super::columns::Columns;
use super::effect::{Effects, Registry, Setup, StepContext};
use super::exchange::World;
use super::nodal_fields::{Fields, Wanted};
use super::scheme::{EffectLimits, Scheme, relaxes_ratio};
use crate::material::constitutive::CustomModel;
use crate::scene::{CheckedScene, Stepping};

/// Scheme and effects of a scene, prepared for time stepping.
pub struct Stepper<const D: usize> {
    scheme: Scheme<D>,
    /// Effects of the scene.
    pub effects: Effects<D>,
}

impl<const D: usize> Deref for Stepper<D> {
    type Target = Scheme<D>;

    fn deref(&self) -> &Scheme<D> {
        &self.scheme
    }
}

impl<const D: usize> Stepper<D> {
    /// Stepper of `scene`, with the effects of `R`.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn new<R: Registry>(scene: &CheckedScene) -> Self {
        Self::with_models::<R>(scene, &|_| None).expect("there is nothing to replace")
    }

    /// Stepper of `scene`, with custom models from `outside` in place of the models of the scene;
    /// `outside` is called with the material name once per body.
    ///
    /// # Errors
    ///
    /// Name of the material, and the reason why it cannot use the custom model.
    pub fn with_models<R: Registry>(
        scene: &CheckedScene,
        outside: &dyn Fn(&str) -> Option<CustomModel>,
    ) -> Result<Self, (String, String)> {
        let models = BodyModels::new(scene, outside)?;
        let columns = Columns::new::<R>(scene);
        let method = &scene.scene.method;
        let wanted = Wanted {
            series: method.transfer.plan().series(),
            masked: method.edge_mask.is_some(),
            relaxed: method.pressure_relaxation.is_some(),
            relaxes_ratio: relaxes_ratio(scene),
            has_friction: columns.friction_heat.is_some(),
            has_wall_friction: columns.wall_friction_part.is_some(),
            limiter: method.flux_limiter.map(|limiter| limiter.neighbours as usize),
        };
        let mut fields = Fields::new(D, wanted);
        let mut setup = Setup { scene, columns: &columns, fields: &mut fields, matrices: 0 };
        let effects = Effects::new(R::build(&mut setup));
        let matrices = setup.matrices;
        let limits = EffectLimits {
            diffusion_step: effects
                .iter()
                .map(|e| e.diffusion_step())
                .fold(f64::INFINITY, f64::min),
            products: effects.iter().map(|e| e.products()).max().unwrap_or(0),
            matrices,
            any: effects.iter().next().is_some(),
        };
        Ok(Stepper { scheme: Scheme::new(scene, models, columns, fields, limits), effects })
    }

    /// Context of a step of `dt` from `start` with the stress and the forces at `time` [s], at the
    /// volume ratio in column `jacobian`.
    pub(super) fn context(
        &self,
        [start, time]: [f64; 2],
        dt: f64,
        jacobian: usize,
    ) -> StepContext<'_, D> {
        StepContext { scheme: &self.scheme, effects: &self.effects, start, time, dt, jacobian }
    }
}

impl<const D: usize> Stepper<D> {
    /// Completes the initial state: pressure, sound speed and, if the scheme needs it, the gradient
    /// of the initial velocity. Collective.
    ///
    /// # Errors
    ///
    /// If a particle has moved past the neighbours of its patch.
    pub fn prime(&self, world: &mut World<'_, D>) -> Result<(), decomp::ParticleError> {
        let jacobian = self.columns.jacobian;
        let step = self.context([0.0, 0.0], 0.0, jacobian);
        world.each("refresh", |patch| self.refresh(patch, &step));
        if self.stepping == Stepping::Midpoint {
            self.prime_gradient(world)?;
            world.each("refresh", |patch| self.refresh(patch, &step));
        }
        Ok(())
    }

    /// Advances all patches from `time` by `dt` [s]; `stable` is the step at a Courant number of 1
    /// [s], and `step` numbers the steps from 1. Collective.
    ///
    /// # Errors
    ///
    /// If a particle has moved past the neighbours of its patch.
    pub fn advance(
        &self,
        world: &mut World<'_, D>,
        time: f64,
        dt: f64,
        stable: f64,
        step: u64,
    ) -> Result<(), decomp::ParticleError> {
        match self.stepping {
            Stepping::Midpoint => {
                self.advance_midpoint(world, time, dt, self.relaxes(step, dt / stable))
            }
            Stepping::Leapfrog => self.advance_leapfrog(world, time, dt),
        }
    }
}
