//! Removal of particles at a limit of strain or volume: see
//! [`ErosionCriterion`].
//!
//! Particles are removed at the end of a step, before its final pressure and checks: they no longer
//! limit the time step and are not an error.

use crate::material::constitutive::{ErosionCriterion, erosion_of};
use crate::scene::CheckedScene;
use crate::solver::effect::{Effect, Package, Phase, Setup, StepContext};
use crate::solver::particle_update::bodies;
use crate::solver::patch::Patch;

/// Erosion of particles.
pub struct ErosionEffect {
    /// Erosion limits of each body.
    limits: Vec<Option<ErosionCriterion>>,
    /// Equivalent plastic strain [-].
    plastic_strain: Option<usize>,
}

impl Package for ErosionEffect {
    const NAME: &'static str = "erosion";

    fn is_active(scene: &CheckedScene) -> bool {
        scene.erodes()
    }

    fn build<const D: usize>(setup: &mut Setup<'_, D>) -> Box<dyn Effect<D>> {
        let bodies = 0..setup.scene.bodies.len();
        Box::new(ErosionEffect {
            limits: bodies.map(|i| erosion_of(setup.scene.material_of(i))).collect(),
            plastic_strain: setup.columns.find("plastic_strain"),
        })
    }
}

impl<const D: usize> Effect<D> for ErosionEffect {
    fn phases(&self) -> &'static [Phase] {
        &[Phase::EndState]
    }

    fn act(&self, _: Phase, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        let c = &step.scheme.columns;
        let n = patch.block.own();
        let column = |k: usize| &patch.block.columns[k][..n];
        let (jacobian, strain) = (column(c.jacobian), self.plastic_strain.map(column));
        let mut gone = Vec::new();
        for (body, particles) in bodies(column(c.body)) {
            let Some(limit) = self.limits[body] else { continue };
            let goes = |r: &usize| limit.takes(strain.map_or(0.0, |s| s[*r]), jacobian[*r]);
            gone.extend(particles.filter(goes));
        }
        if !gone.is_empty() {
            patch.block.drop_ghosts();
            step.scheme.remove_particles(patch, &gone, true);
        }
    }
}

#[cfg(test)]
#[path = "tests/erosion.rs"]
mod tests;
