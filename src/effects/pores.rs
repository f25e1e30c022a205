//! Pore compaction (P-alpha): the distension alpha = v/v_solid is the history variable of the
//! equation of state ([`crate::material::eos`]), which solves for it together with the pressure.

use crate::scene::{CheckedScene, Eos};
use crate::solver::declare::{Declare, Role};
use crate::solver::effect::{Effect, NewParticle, Package, Phase, Setup};

/// Distension of porous materials.
pub struct Pores {
    distension: usize,
}

fn is_porous(scene: &CheckedScene, body: usize) -> bool {
    matches!(scene.material_of(body).eos, Eos::PAlpha(_))
}

impl Package for Pores {
    const NAME: &'static str = "pores";

    fn is_active(scene: &CheckedScene) -> bool {
        (0..scene.bodies.len()).any(|body| is_porous(scene, body))
    }

    fn declare(scene: &CheckedScene, d: &mut Declare<'_>) {
        let distension = d.scalar("distension", "", Role::State);
        for body in (0..scene.bodies.len()).filter(|&body| is_porous(scene, body)) {
            d.history(body, distension);
        }
        d.output("distension", "-", "distension");
    }

    fn build<const D: usize>(setup: &mut Setup<'_, D>) -> Box<dyn Effect<D>> {
        Box::new(Pores { distension: setup.columns.get("distension") })
    }
}

impl<const D: usize> Effect<D> for Pores {
    fn phases(&self) -> &'static [Phase] {
        &[]
    }

    fn initialize(&self, particle: &NewParticle<'_, D>, values: &mut [f64]) {
        values[self.distension] = particle.scene.material_of(particle.body).distension();
    }
}

#[cfg(test)]
#[path = "tests/pores.rs"]
mod tests;
