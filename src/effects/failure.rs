//! Failure of particles: a failed particle carries neither tension nor shear, a damaged one the
//! part of them that a gradual law leaves.
//!
//! The particle keeps its energy: the elastic energy that it gives up becomes heat. When it is
//! compressed again, it carries pressure as before.

use std::ops::Range;

use decomp::Block;
use smallvec::SmallVec;

use crate::material::constitutive::{ConstitutiveModel, DamageUpdate, FailureModel};
use crate::material::failure::{Carried, DAMAGE};
use crate::scene::CheckedScene;
use crate::solver::Scheme;
use crate::solver::declare::{Declare, Role};
use crate::solver::effect::{Account, Effect, Package, Phase, Setup, StepContext};
use crate::solver::particle_update::bodies;
use crate::solver::patch::Patch;

/// Failure by the failure model of each material.
pub struct FailureEffect {
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
        let released = d.scalar("released_energy", "J", Role::State);
        d.released_energy(released);
        d.output(DAMAGE, "-", "damage");
    }

    fn build<const D: usize>(setup: &mut Setup<'_, D>) -> Box<dyn Effect<D>> {
        let columns = setup.columns;
        Box::new(FailureEffect {
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
        particles: Range<usize>,
        _: [f64; D],
        add: &mut dyn FnMut(Account, &[f64]),
    ) {
        let damage = &block.columns[self.damage][particles.clone()];
        let failed = damage.iter().map(|d| f64::from(u8::from(*d >= 1.0)));
        add(Account::FailedParticles, &failed.collect::<SmallVec<[f64; 128]>>());
        let damaged = damage.iter().map(|d| f64::from(u8::from(*d > 0.0 && *d < 1.0)));
        add(Account::DamagedParticles, &damaged.collect::<SmallVec<[f64; 128]>>());
        add(Account::ReleasedEnergy, &block.columns[self.released][particles]);
    }
}

/// Bodies whose materials can fail, with their particles and failure models.
fn failing<'a, const D: usize>(
    s: &'a Scheme<D>,
    body: &'a [f64],
) -> impl Iterator<Item = (usize, Range<usize>, &'a dyn FailureModel)> {
    bodies(body)
        .filter_map(|(body, particles)| Some((body, particles, s.failures[body].as_deref()?)))
}

impl FailureEffect {
    /// Particles, with their bodies, that carry a part of their stress by a gradual law.
    fn damaged<'a, const D: usize>(
        &self,
        s: &'a Scheme<D>,
        body: &'a [f64],
        damage: &'a [f64],
    ) -> impl Iterator<Item = (usize, usize)> + 'a {
        let gradual = s.failures.iter().flatten().any(|model| model.is_gradual());
        let of_gradual = failing(s, if gradual { body } else { &[] });
        of_gradual.filter(|(_, _, model)| model.is_gradual()).flat_map(|(body, particles, _)| {
            let reduced = particles.filter(|&r| damage[r] > 0.0 && damage[r] < 1.0);
            reduced.map(move |r| (body, r))
        })
    }

    /// Reduces the tension of failed and damaged particles at the middle of the step.
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
            // no tension, also none by viscosity in expansion
            let viscous = c.viscosity.map_or(0.0, column).max(0.0) * volume;
            if stress[r] < viscous {
                stress[r] = viscous;
                if let (Some(p), Some(w)) = (c.pressure_mid, c.compliance) {
                    patch.block.columns[p][r] = 0.0;
                    patch.block.columns[w][r] = 0.0;
                }
            }
        }
        patch.block.columns[c.stress_volume] = stress;
        let body = std::mem::take(&mut patch.block.columns[c.body]);
        let damage = std::mem::take(&mut patch.block.columns[self.damage]);
        for (body, r) in self.damaged(step.scheme, &body[..n], &damage) {
            let carried = step.scheme.carried(body, damage[r]);
            self.reduce_mid_tension(step, patch, (body, r), &carried);
        }
        patch.block.columns[c.body] = body;
        patch.block.columns[self.damage] = damage;
    }

    /// Reduces the tension of a damaged particle at the middle of the step.
    fn reduce_mid_tension<const D: usize>(
        &self,
        step: &StepContext<'_, D>,
        patch: &mut Patch<D>,
        (body, r): (usize, usize),
        carried: &Carried,
    ) {
        let (s, c) = (step.scheme, &step.scheme.columns);
        let column = |k: usize| patch.block.columns[k][r];
        let volume = column(c.volume0) * column(step.jacobian);
        let viscous = c.viscosity.map_or(0.0, column) * volume;
        let whole = (column(c.stress_volume) - viscous) / volume;
        if whole >= 0.0 {
            return;
        }
        let [mut pressure, mut compliance] = [whole, c.compliance.map_or(0.0, column)];
        if carried.opening > 0.0 {
            [pressure, compliance] = s.mid_pressure_between_cracks(patch, body, r, carried.opening);
        }
        if pressure < 0.0 {
            pressure *= carried.tension;
        } else {
            // the cracks are closing
            [pressure, compliance] = [0.0; 2];
        }
        patch.block.columns[c.stress_volume][r] = viscous + pressure * volume;
        if let (Some(p), Some(w)) = (c.pressure_mid, c.compliance) {
            patch.block.columns[p][r] = pressure;
            patch.block.columns[w][r] = compliance;
        }
    }

    /// Reduces the tension of failed and damaged particles at the end of a leapfrog step, and the
    /// work of that tension.
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
        let column = |k: usize| &patch.block.columns[k][..before.len()];
        for (body, r) in self.damaged(scheme, column(c.body), column(self.damage)) {
            if pressure[r] >= 0.0 {
                continue;
            }
            let change = (column(c.jacobian)[r] - before[r]) * column(c.volume0)[r];
            let change = change / column(c.mass)[r];
            energy[r] += 0.5 * pressure[r] * change;
            pressure[r] = scheme.carried_pressure(patch, body, r, energy[r]);
            energy[r] -= 0.5 * pressure[r] * change;
        }
        patch.block.columns[c.pressure] = pressure;
        patch.block.columns[c.energy] = energy;
    }

    /// Updates the damage of the own particles at the end of the step; those that fail lose their
    /// stress, those that are damaged further a part of it.
    fn fail<const D: usize>(&self, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        let s = step.scheme;
        let c = &s.columns;
        let n = patch.block.own();
        let mut damage = std::mem::take(&mut patch.block.columns[self.damage]);
        let mut weakened: SmallVec<[(usize, usize, f64); 8]> = SmallVec::new();
        for (body, particles, model) in failing(s, &patch.block.columns[c.body][..n]) {
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
            let mut note = |r, before| weakened.push((body, particles.start + r, before));
            model.advance(update, &mut note);
        }
        patch.block.columns[self.damage] = damage;
        for (body, r, before) in weakened {
            self.release_stress(s, patch, body, r, before);
        }
    }

    /// Takes the tension and shear from a particle that it no longer carries since its damage was
    /// `before`, and counts their elastic energy as released.
    fn release_stress<const D: usize>(
        &self,
        s: &Scheme<D>,
        patch: &mut Patch<D>,
        body: usize,
        r: usize,
        before: f64,
    ) {
        let c = &s.columns;
        let column = |k: usize| patch.block.columns[k][r];
        let carried = [before, column(self.damage)].map(|damage| s.carried(body, damage));
        let (failed, stress) = (column(self.damage) >= 1.0, column(c.pressure));
        let pressure = match failed {
            true => stress.max(0.0),
            false => s.carried_pressure(patch, body, r, column(c.energy)),
        };
        let components = if D == 1 { 1 } else { 3 };
        let released = self.released_energy(s, patch, body, r, pressure, carried);
        patch.block.columns[self.released][r] += released;
        patch.block.columns[c.pressure][r] = pressure;
        let [had, has] = carried.map(|c| c.shear);
        if let Some(first) = c.deviator {
            for shear in &mut patch.block.columns[first..first + components] {
                shear[r] = if failed { 0.0 } else { shear[r] * (has / had) };
            }
        }
        if let (Some(stress), ConstitutiveModel::Fluid(_)) = (c.stress, &s.models[body]) {
            for k in 0..components {
                let mean = if k == 2 { 0.0 } else { -pressure };
                patch.block.columns[stress + k][r] = match c.deviator {
                    Some(first) if !failed => mean + patch.block.columns[first + k][r],
                    _ => mean,
                };
            }
        }
        if let Some(temperature) = self.temperature {
            let before = patch.block.columns[temperature][r];
            if let Some(t) = s.temperature(patch, body, r, pressure, before) {
                patch.block.columns[temperature][r] = t;
            }
        }
    }

    /// Elastic energy that a particle gives up [J], if its pressure becomes `after` and it carries
    /// the second part in place of the first.
    fn released_energy<const D: usize>(
        &self,
        s: &Scheme<D>,
        patch: &Patch<D>,
        body: usize,
        r: usize,
        after: f64,
        [had, has]: [Carried; 2],
    ) -> f64 {
        let c = &s.columns;
        let column = |k: usize| patch.block.columns[k][r];
        let (j, pressure) = (column(c.jacobian), column(c.pressure));
        let volume = column(c.volume0) * j;
        let at = s.condition(patch, r, j, pressure);
        let shear = s.strengths[body].as_ref().map_or(0.0, |strength| strength.shear_modulus(&at));
        let speed = column(c.sound_speed);
        let mut released = 0.0;
        if pressure < 0.0 {
            // the sound speed is that of the material between the cracks
            let between = column(c.volume0) * (j - had.opening);
            let bulk =
                column(c.mass) / between * speed * speed - 4.0 / 3.0 * shear * (volume / between);
            if bulk > 0.0 {
                let stored = |p: f64| 0.5 * p * p / bulk * between;
                released += stored(pressure) / had.tension;
                if after < 0.0 {
                    released -= stored(after) / has.tension;
                }
            }
        }
        if shear > 0.0 {
            let first = c.deviator.expect("a body with strength has the columns");
            let deviator = s.deviator(patch, first, r..r + 1).at(0);
            let stored = deviator.double_dot(&deviator) / (4.0 * shear) * volume;
            released += stored / had.shear * (1.0 - has.shear / had.shear);
        }
        released
    }
}

#[cfg(test)]
#[path = "tests/failure.rs"]
mod tests;
