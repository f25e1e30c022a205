//! Temperature of bodies with thermal properties: from the energy if an isentrope is given,
//! otherwise from plastic work and heat alone.

use crate::scene::CheckedScene;
use crate::solver::declare::{Declare, Role};
use crate::solver::effect::{Effect, NewParticle, Package, Phase, Setup, StepContext};
use crate::solver::particle_update::bodies;
use crate::solver::patch::{FaultPhase, Patch};

/// Temperature of particles.
pub struct Temperature {
    /// Temperature [K].
    temperature: usize,
    /// Plastic work that is stored and does not heat [J/kg].
    stored: Option<usize>,
    /// Plastic work of a step per unit volume [J/m3].
    plastic_work: Option<usize>,
    midpoint: bool,
}

impl Package for Temperature {
    const NAME: &'static str = "temperature";

    fn is_active(scene: &CheckedScene) -> bool {
        (0..scene.bodies.len()).any(|i| scene.material_of(i).thermal.is_some())
    }

    fn declare(scene: &CheckedScene, d: &mut Declare<'_>) {
        let role = if scene.conducts() { Role::GhostState } else { Role::State };
        let temperature = d.scalar("temperature", "K", role);
        d.temperature(temperature);
        if (0..scene.bodies.len()).any(|i| scene.material_of(i).stores_work()) {
            let stored = d.scalar("stored_work", "J/kg", Role::State);
            d.stored_work(stored);
        }
        d.output("temperature", "K", "temperature");
    }

    fn build<const D: usize>(setup: &mut Setup<'_, D>) -> Box<dyn Effect<D>> {
        Box::new(Temperature {
            temperature: setup.columns.get("temperature"),
            stored: setup.columns.stored_work,
            plastic_work: setup.columns.find("plastic_work"),
            midpoint: setup.columns.jacobian_mid.is_some(),
        })
    }
}

impl<const D: usize> Effect<D> for Temperature {
    fn phases(&self) -> &'static [Phase] {
        match self.midpoint {
            true => &[Phase::Gathered, Phase::EndTemperature],
            false => &[Phase::StressUpdate, Phase::EndTemperature],
        }
    }

    fn act(&self, phase: Phase, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        match phase {
            Phase::EndTemperature => self.find_temperature(step, patch),
            _ => self.heat_by_plastic_work(step, patch),
        }
    }

    fn initialize(&self, particle: &NewParticle<'_, D>, values: &mut [f64]) {
        let scene = particle.scene;
        if let Some(thermal) = &scene.material_of(particle.body).thermal {
            let own = scene.scene.bodies[particle.body].temperature;
            values[self.temperature] = own.unwrap_or(thermal.reference_temperature);
        }
    }
}

impl Temperature {
    /// Adds the heating part of the plastic work of a step to the temperature of the own particles,
    /// or, if their temperature follows from the energy, the rest of it to the stored work.
    fn heat_by_plastic_work<const D: usize>(
        &self,
        step: &StepContext<'_, D>,
        patch: &mut Patch<D>,
    ) {
        let (s, c) = (step.scheme, &step.scheme.columns);
        let Some(plastic_work) = self.plastic_work else { return };
        let n = patch.block.own();
        let body = std::mem::take(&mut patch.block.columns[c.body]);
        for (body, particles) in bodies(&body[..n]) {
            let (Some(thermal), Some(_)) = (&s.thermals[body], &s.strengths[body]) else {
                continue;
            };
            let (into, share) = match (&thermal.isentrope, self.stored) {
                (None, _) => (self.temperature, thermal.taylor_quinney / thermal.specific_heat),
                (Some(_), Some(stored)) => (stored, 1.0 - thermal.taylor_quinney),
                (Some(_), None) => continue,
            };
            for r in particles {
                let column = |k: usize| patch.block.columns[k][r];
                let work =
                    column(plastic_work) * column(c.volume0) * column(c.jacobian) / column(c.mass);
                patch.block.columns[into][r] += share * work;
            }
        }
        patch.block.columns[c.body] = body;
    }

    /// Temperature of the own particles whose temperature follows from their energy.
    fn find_temperature<const D: usize>(&self, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        let (s, c) = (step.scheme, &step.scheme.columns);
        let mut temperature = std::mem::take(&mut patch.block.columns[self.temperature]);
        let pressure = &patch.block.columns[c.pressure];
        let mut lost = None;
        let body = &patch.block.columns[c.body][..patch.block.own()];
        for (body, particles) in bodies(body) {
            for r in particles {
                if let Some(t) = s.temperature(patch, body, r, pressure[r], temperature[r]) {
                    temperature[r] = t;
                    if lost.is_none() && !t.is_finite() {
                        lost = Some(r);
                    }
                }
            }
        }
        patch.block.columns[self.temperature] = temperature;
        if let Some(r) = lost {
            s.fault(patch, FaultPhase::End, r, "its temperature is not a number".into());
        }
    }
}

#[cfg(test)]
#[path = "tests/temperature.rs"]
mod tests;
