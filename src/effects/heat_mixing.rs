//! Mixing of internal energy in compression, against wall heating.
//!
//! A strong shock that starts at a wall or an interface leaves too much internal energy, and too
//! little density, in the first cells behind it (Noh 1987, J. Comput. Phys. 72, 78). Noh's remedy is a
//! flux of heat where the material is compressed. Here each step moves the energy of a particle
//! towards the mean on the grid,
//!
//! ```text
//! theta = min(1/2, coefficient dt max(0, -div v))
//! ebar_i = sum m theta N e / sum m theta N        over the particles of one material
//! e += theta (sum N ebar_i - e)
//! ```
//!
//! with the energies at the start of the step. The sum of m e does not change, because the weights N
//! of a particle sum to 1.
//!
//! Elastic solids and explosives with a burn front are left out: their energy is not a function of a
//! smooth state.

use decomp::Parity;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::material::ParameterError;
use crate::scene::{Burn, CheckedScene, EffectKey, EffectOptions};
use crate::shape::with_width;
use crate::solver::Scheme;
use crate::solver::declare::{Declare, Role};
use crate::solver::effect::{Effect, Package, Phase, Setup, StepContext};
use crate::solver::exchange::Nodal;
use crate::solver::patch::Patch;

/// Mixing of the internal energy of neighbouring particles of one material where it is compressed,
/// which reduces the heating at walls and interfaces where shocks start. Energy is conserved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "HeatMixing")]
pub struct HeatMixingOptions {
    /// Rate of mixing over the rate of compression [-]. A larger value mixes more: 10 reduces the
    /// error of the density in the first cell of `noh_planar.json` from 46 to 8 %, and the L1 error of
    /// the pressure behind shocks grows slowly with it.
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 1000.0))]
    pub coefficient: f64,
}

impl EffectOptions for HeatMixingOptions {
    const KEY: &'static str = "heat_mixing";
    const ABSENT: &'static str =
        "that of the method's preset if all bodies are gases and one moves, else none; null: none";

    fn check(&self, scene: &CheckedScene) -> Result<(), ParameterError> {
        if (0..scene.bodies.len()).any(|body| mixes(scene, body)) {
            return Ok(());
        }
        let reason = "no body can mix its energy; allowed: to leave heat_mixing out, or a body that is \
                      neither an elastic solid nor an explosive with a burn front";
        Err(ParameterError::new("coefficient", self.coefficient, reason))
    }
}

/// Whether the energy of `body` may be mixed.
fn mixes(scene: &CheckedScene, body: usize) -> bool {
    let eos = &scene.material_of(body).eos;
    !eos.is_solid() && !matches!(eos.burn(), Some(Burn::Front(_)))
}

/// Mixing of internal energy.
pub struct HeatMixing {
    /// Rate of mixing over the rate of compression [-].
    coefficient: f64,
    /// Number of each body's material among those that mix; none if it does not mix.
    materials: Vec<Option<usize>>,
    /// Mass times theta [kg].
    mass: usize,
    /// Mass times theta times energy at the start of the step [J].
    energy: usize,
    /// Nodal fields of the means of all materials [J/kg], then of their weights [kg].
    fields: usize,
}

impl HeatMixing {
    /// Number of materials that mix.
    fn count(&self) -> usize {
        self.materials.iter().flatten().max().map_or(0, |last| last + 1)
    }
}

impl Package for HeatMixing {
    const NAME: &'static str = "heat mixing";

    fn key() -> Option<EffectKey> {
        Some(EffectKey::of::<HeatMixingOptions>())
    }

    fn is_active(scene: &CheckedScene) -> bool {
        scene.options::<HeatMixingOptions>().is_some()
    }

    fn declare(_: &CheckedScene, d: &mut Declare<'_>) {
        d.ghost_bodies();
        d.scalar("mixing_mass", "kg", Role::GhostScratch);
        d.scalar("mixing_energy", "J", Role::GhostScratch);
    }

    fn build<const D: usize>(setup: &mut Setup<'_, D>) -> Box<dyn Effect<D>> {
        let (scene, columns) = (setup.scene, setup.columns);
        let options = scene.options::<HeatMixingOptions>().expect("the scene has the key");
        let mut known: Vec<usize> = Vec::new();
        let mut number = |material: usize| {
            known.iter().position(|&k| k == material).unwrap_or_else(|| {
                known.push(material);
                known.len() - 1
            })
        };
        let bodies = scene.bodies.iter().enumerate();
        let materials: Vec<Option<usize>> = bodies
            .map(|(body, checked)| mixes(scene, body).then(|| number(checked.material)))
            .collect();
        Box::new(HeatMixing {
            coefficient: options.coefficient,
            mass: columns.get("mixing_mass"),
            energy: columns.get("mixing_energy"),
            fields: setup.fields.add(2 * known.len()),
            materials,
        })
    }
}

impl<const D: usize> Effect<D> for HeatMixing {
    fn phases(&self) -> &'static [Phase] {
        &[Phase::ParticleForce, Phase::NodalStart, Phase::Solve, Phase::Gathered]
    }

    fn act(&self, phase: Phase, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        match phase {
            Phase::ParticleForce => self.find_weights(step, patch),
            Phase::NodalStart => self.find_means(step.scheme, patch),
            _ => self.mix(step.scheme, patch),
        }
    }

    /// Gives the means at nodes of other patches to the patches whose particles touch them.
    fn solve(&self, _: &StepContext<'_, D>, nodal: &mut Nodal<'_, D>) {
        let means: Vec<_> = (0..self.count()).map(|k| (self.fields + k, Parity::Even)).collect();
        nodal.refresh(&means);
    }
}

impl HeatMixing {
    /// Weights m theta of the own particles, and their products with the energies.
    fn find_weights<const D: usize>(&self, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        let c = &step.scheme.columns;
        let n = patch.block.own();
        let [mut mass, mut energy] = [self.mass, self.energy].map(|k| {
            let mut column = std::mem::take(&mut patch.block.columns[k]);
            column.resize(n, 0.0);
            column
        });
        let column = |k: usize| &patch.block.columns[k][..n];
        let (body, divergence) = (column(c.body), column(c.divergence));
        for r in 0..n {
            let theta = match self.materials[body[r] as usize] {
                Some(_) => (self.coefficient * step.dt * (-divergence[r]).max(0.0)).min(0.5),
                None => 0.0,
            };
            mass[r] = column(c.mass)[r] * theta;
            energy[r] = mass[r] * column(c.energy)[r];
        }
        patch.block.columns[self.mass] = mass;
        patch.block.columns[self.energy] = energy;
    }

    /// Mean energies on the nodes that the patch computes.
    fn find_means<const D: usize>(&self, s: &Scheme<D>, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Scheme<D>, e: &HeatMixing) {
            let count = e.count();
            for k in 0..count {
                let [mean, weight] = patch.nodes.fields_mut([e.fields + k, e.fields + count + k]);
                mean.fill(0.0);
                weight.fill(0.0);
            }
            let column = |k: usize| &patch.block.columns[k];
            let (mass, energy, body) = (column(e.mass), column(e.energy), column(s.columns.body));
            for r in patch.runs.iter().cloned().flatten().filter(|&r| mass[r] > 0.0) {
                let Some(k) = e.materials[body[r] as usize] else { continue };
                let weights = patch.stencils.particle::<K, D>(r);
                let [mean, weight] = patch.nodes.fields_mut([e.fields + k, e.fields + count + k]);
                weights.add(mean, weights.values, |n| n * energy[r]);
                weights.add(weight, weights.values, |n| n * mass[r]);
            }
            for k in 0..count {
                let [mean, weight] = patch.nodes.fields_mut([e.fields + k, e.fields + count + k]);
                for i in patch.active_lines.iter().cloned().flatten().filter(|&i| weight[i] > 0.0) {
                    mean[i] /= weight[i];
                }
            }
        }
        with_width!(patch.stencils.width, go(patch, s, self));
    }

    /// Moves the energies of the own particles towards the means.
    fn mix<const D: usize>(&self, s: &Scheme<D>, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Scheme<D>, e: &HeatMixing) {
            let c = &s.columns;
            let n = patch.block.own();
            let mut energy = std::mem::take(&mut patch.block.columns[c.energy]);
            let column = |k: usize| &patch.block.columns[k][..n];
            let (mass, mixing, before) = (column(c.mass), column(e.mass), column(e.energy));
            let body = column(c.body);
            for r in (0..n).filter(|&r| mixing[r] > 0.0) {
                let Some(k) = e.materials[body[r] as usize] else { continue };
                let weights = patch.stencils.particle::<K, D>(r);
                let mean = weights.dot(weights.values, &patch.nodes.fields[e.fields + k]);
                energy[r] += (mixing[r] * mean - before[r]) / mass[r];
            }
            patch.block.columns[c.energy] = energy;
        }
        with_width!(patch.stencils.width, go(patch, s, self));
    }
}

#[cfg(test)]
#[path = "tests/heat_mixing.rs"]
mod tests;
