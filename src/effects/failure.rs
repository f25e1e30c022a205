//! Failure of particles: a failed particle carries neither tension nor shear.
//!
//! A failed particle keeps its energy: its elastic energy becomes heat. When it is compressed
//! again, it carries pressure as before.

use decomp::Block;
use smallvec::SmallVec;

use crate::material::constitutive::{ConstitutiveModel, DamageUpdate, FailureModel, failure_model};
use crate::scene::CheckedScene;
use crate::solver::Scheme;
use crate::solver::declare::{Declare, Role};
use crate::solver::effect::{Account, Effect, Package, Phase, Setup, StepContext};
use crate::solver::particle_update::bodies;
use crate::solver::patch::Patch;

/// Failure by the failure model of each material.
pub struct FailureEffect {
    /// Failure model of each body.
    models: Vec<Option<Box<dyn FailureModel>>>,
    /// Damage [-].
    damage: usize,
    /// Elastic energy that failure has released as heat [J].
    released: usize,
    /// Plastic strain increment of the step [-].
    plastic_increment: Option<usize>,
    /// Temperature [K].
    temperature: Option<usize>,
}

impl Package for FailureEffect {
    const NAME: &'static str = "failure";

    fn is_active(scene: &CheckedScene) -> bool {
        (0..scene.bodies.len()).any(|i| scene.material_of(i).failure.is_some())
    }

    fn declare(scene: &CheckedScene, d: &mut Declare<'_>) {
        let damage = d.scalar("damage", "", Role::State);
        let bodies = 0..scene.bodies.len();
        let may_fail = bodies.filter(|&body| scene.material_of(body).failure.is_some());
        may_fail.for_each(|body| d.tension_free(body, damage));
        d.scalar("released_energy", "J", Role::State);
        d.output("damage", "-", "damage");
    }

    fn build<const D: usize>(setup: &mut Setup<'_, D>) -> Box<dyn Effect<D>> {
        let bodies = 0..setup.scene.bodies.len();
        let columns = setup.columns;
        Box::new(FailureEffect {
            models: bodies.map(|i| failure_model(setup.scene.material_of(i))).collect(),
            damage: columns.get("damage"),
            released: columns.get("released_energy"),
            plastic_increment: columns.find("plastic_increment"),
            temperature: columns.find("temperature"),
        })
    }
}

impl<const D: usize> Effect<D> for FailureEffect {
    fn phases(&self) -> &'static [Phase] {
        &[Phase::MidStress, Phase::PressureUpdate, Phase::End]
    }

    fn act(&self, phase: Phase, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        match phase {
            Phase::MidStress => self.release_mid_tension(step, patch),
            Phase::PressureUpdate => self.release_tension(step.scheme, patch),
            _ => self.fail(step, patch),
        }
    }

    fn totals(
        &self,
        block: &Block<D>,
        particles: std::ops::Range<usize>,
        _: [f64; D],
        add: &mut dyn FnMut(Account, &[f64]),
    ) {
        let damage = &block.columns[self.damage][particles.clone()];
        let failed = damage.iter().map(|d| f64::from(u8::from(*d >= 1.0)));
        add(Account::FailedParticles, &failed.collect::<SmallVec<[f64; 128]>>());
        add(Account::ReleasedEnergy, &block.columns[self.released][particles]);
    }
}

impl FailureEffect {
    /// Removes the tension of failed particles at the middle of the step.
    fn release_mid_tension<const D: usize>(&self, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        let c = &step.scheme.columns;
        let n = patch.block.own();
        let mut stress = std::mem::take(&mut patch.block.columns[c.stress_volume]);
        for r in 0..n {
            let column = |k: usize| patch.block.columns[k][r];
            if column(self.damage) < 1.0 {
                continue;
            }
            let volume = column(c.volume0) * column(step.jacobian);
            let viscous = c.viscosity.map_or(0.0, column) * volume;
            if stress[r] < viscous {
                stress[r] = viscous;
                if let (Some(p), Some(w)) = (c.pressure_mid, c.compliance) {
                    patch.block.columns[p][r] = 0.0;
                    patch.block.columns[w][r] = 0.0;
                }
            }
        }
        patch.block.columns[c.stress_volume] = stress;
    }

    /// Removes the tension of failed particles at the end of a leapfrog step, and the work of that
    /// tension.
    fn release_tension<const D: usize>(&self, scheme: &Scheme<D>, patch: &mut Patch<D>) {
        let c = &scheme.columns;
        let mut pressure = std::mem::take(&mut patch.block.columns[c.pressure]);
        let mut energy = std::mem::take(&mut patch.block.columns[c.energy]);
        let before = &patch.kept;
        for r in 0..before.len() {
            let column = |k: usize| patch.block.columns[k][r];
            if column(self.damage) >= 1.0 && pressure[r] < 0.0 {
                let change = (column(c.jacobian) - before[r]) * column(c.volume0);
                energy[r] += 0.5 * pressure[r] * change / column(c.mass);
                pressure[r] = 0.0;
            }
        }
        patch.block.columns[c.pressure] = pressure;
        patch.block.columns[c.energy] = energy;
    }

    /// Updates the damage of the own particles at the end of the step; those that fail lose their
    /// stress.
    fn fail<const D: usize>(&self, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        let s = step.scheme;
        let c = &s.columns;
        let n = patch.block.own();
        let mut damage = std::mem::take(&mut patch.block.columns[self.damage]);
        let mut failed: SmallVec<[(usize, usize); 8]> = SmallVec::new();
        for (body, particles) in bodies(&patch.block.columns[c.body][..n]) {
            let Some(model) = &self.models[body] else { continue };
            let column = |k: usize| &patch.block.columns[k][particles.clone()];
            let deviator = c.deviator.filter(|_| s.strengths[body].is_some());
            let particles = particles.clone();
            let update = DamageUpdate {
                dt: step.dt,
                pressure: column(c.pressure),
                deviator: deviator.map(|first| s.deviator(patch, first, particles.clone())),
                plastic_increment: deviator.and(self.plastic_increment).map(column),
                temperature: self.temperature.map(column),
                damage: &mut damage[particles.clone()],
            };
            model.advance(update, &mut |r| failed.push((body, particles.start + r)));
        }
        patch.block.columns[self.damage] = damage;
        for (body, r) in failed {
            self.release_stress(s, patch, body, r);
        }
    }

    /// Removes tension and shear from a particle, and counts their elastic energy as released.
    fn release_stress<const D: usize>(
        &self,
        s: &Scheme<D>,
        patch: &mut Patch<D>,
        body: usize,
        r: usize,
    ) {
        let c = &s.columns;
        let column = |k: usize| patch.block.columns[k][r];
        let (j, pressure) = (column(c.jacobian), column(c.pressure));
        let volume = column(c.volume0) * j;
        let at = s.condition(patch, r, j, pressure);
        let shear = s.strengths[body].as_ref().map_or(0.0, |strength| strength.shear_modulus(&at));
        let speed = column(c.sound_speed);
        let bulk = column(c.mass) / volume * speed * speed - 4.0 / 3.0 * shear;
        let mut released = 0.0;
        if pressure < 0.0 && bulk > 0.0 {
            released += 0.5 * pressure * pressure / bulk * volume;
        }
        if shear > 0.0 {
            let first = c.deviator.expect("a body with strength has the columns");
            let deviator = s.deviator(patch, first, r..r + 1).at(0);
            released += deviator.double_dot(&deviator) / (4.0 * shear) * volume;
        }
        let pressure = pressure.max(0.0);
        patch.block.columns[self.released][r] += released;
        patch.block.columns[c.pressure][r] = pressure;
        let components = if D == 1 { 1 } else { 3 };
        if let Some(first) = c.deviator {
            (0..components).for_each(|k| patch.block.columns[first + k][r] = 0.0);
        }
        if let (Some(stress), ConstitutiveModel::Fluid(_)) = (c.stress, &s.models[body]) {
            for k in 0..components {
                patch.block.columns[stress + k][r] = if k == 2 { 0.0 } else { -pressure };
            }
        }
        if let Some(temperature) = self.temperature {
            let before = patch.block.columns[temperature][r];
            if let Some(t) = s.temperature(patch, body, r, pressure, before) {
                patch.block.columns[temperature][r] = t;
            }
        }
    }
}

#[cfg(test)]
#[path = "tests/failure.rs"]
mod tests;
