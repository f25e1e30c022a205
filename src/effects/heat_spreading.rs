//! Spreading of the numerical heat of a step over the particles that share nodes.
//!
//! The internal energy of a particle changes by the work of its stress at the mean nodal velocity,
//! and by numerical heat: the kinetic energy that the filter of the transfer removes, with the
//! corrections for spin and for the flux limiter, and the difference between the works at w and at
//! the mean velocity. Kinetic energy is lost between particles that share nodes, and
//! conservation alone does not decide which of them is heated. If each keeps the heat d that is
//! computed for it, single particles at the rims of plates and in jets get far too hot. Here each
//! step spreads a heat h over the particles of one velocity field,
//!
//! ```text
//! hbar_i = sum m N h / m_i,   g = sum N hbar_i
//! e += g - h
//! h = d + (1 - 1/steps) g
//! ```
//!
//! so that each amount of heat is spread `steps` times on average. The sum of m e
//! does not change, because the weights N of a particle sum to 1. We know of no publication of this
//! method.

use decomp::Parity;

use crate::scene::CheckedScene;
use crate::shape::with_width;
use crate::solver::Scheme;
use crate::solver::declare::{Declare, Role};
use crate::solver::effect::{Effect, Package, Phase, Setup, StepContext};
use crate::solver::exchange::Nodal;
use crate::solver::particle_weights::cut;
use crate::solver::patch::Patch;

/// Spreading of numerical heat.
pub struct HeatSpreading {
    /// Share of the heat that the next step spreads again [-].
    share: f64,
    /// Heat h that the next step spreads [J/kg], a column.
    heat: usize,
    /// Heat g that the last step has spread [J/kg], a column.
    spread: usize,
    /// Mean heat [J/kg], a nodal field.
    mean: usize,
}

impl Package for HeatSpreading {
    const NAME: &'static str = "heat spreading";

    fn is_active(scene: &CheckedScene) -> bool {
        scene.scene.method.heat_spreading.is_some()
    }

    fn declare(_: &CheckedScene, d: &mut Declare<'_>) {
        let heat = d.scalar("numerical_heat", "J/kg", Role::GhostState);
        d.zero_at_rest(heat);
        d.scalar("spread_heat", "J/kg", Role::Scratch);
        d.mean_work_energy(heat);
    }

    fn build<const D: usize>(setup: &mut Setup<'_, D>) -> Box<dyn Effect<D>> {
        let options = setup.scene.scene.method.heat_spreading.expect("the scene has the key");
        let [heat, spread] = ["numerical_heat", "spread_heat"].map(|name| setup.columns.get(name));
        Box::new(HeatSpreading {
            share: 1.0 - 1.0 / options.steps,
            heat,
            spread,
            mean: setup.fields.add(1),
        })
    }
}

impl<const D: usize> Effect<D> for HeatSpreading {
    fn phases(&self) -> &'static [Phase] {
        &[Phase::NodalStart, Phase::Solve, Phase::Gather, Phase::Gathered]
    }

    fn act(&self, phase: Phase, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        match phase {
            Phase::NodalStart => self.find_means(step.scheme, patch),
            Phase::Gather => self.spread(step.scheme, patch),
            _ => self.find_heat(step.scheme, patch),
        }
    }

    /// Gives the means at nodes of other patches to the patches whose particles touch them.
    fn solve(&self, _: &StepContext<'_, D>, nodal: &mut Nodal<'_, D>) {
        nodal.refresh(&[(self.mean, Parity::Even)]);
    }
}

impl HeatSpreading {
    /// Means of the heat on the nodes that the patch computes.
    fn find_means<const D: usize>(&self, s: &Scheme<D>, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            e: &HeatSpreading,
        ) {
            let [mean, inverse] = patch.nodes.fields_mut([e.mean, s.fields.inverse]);
            mean.fill(0.0);
            let column = |k: usize| &patch.block.columns[k];
            let (mass, heat) = (column(s.columns.mass), column(e.heat));
            for r in patch.runs.iter().cloned().flatten() {
                let weights = patch.stencils.particle::<K, D>(r);
                let heat = mass[r] * heat[r];
                weights.add(mean, weights.values, |n| n * heat);
            }
            for i in patch.active_lines.iter().cloned().flatten() {
                mean[i] *= inverse[i];
            }
        }
        with_width!(patch.stencils.width, go(patch, s, self));
    }

    /// Replaces the heat of the own particles in their energies by that of the means.
    fn spread<const D: usize>(&self, s: &Scheme<D>, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            e: &HeatSpreading,
        ) {
            let n = patch.block.own();
            let [heat, spread, energy] = patch
                .block
                .columns
                .get_disjoint_mut([e.heat, e.spread, s.columns.energy])
                .expect("columns differ");
            spread.resize(n, 0.0);
            let mean = &patch.nodes.fields[e.mean];
            for r in 0..n {
                let weights = patch.stencils.particle::<K, D>(r);
                spread[r] = weights.dot(weights.values, mean);
                energy[r] += spread[r] - heat[r];
            }
        }
        with_width!(patch.stencils.width, go(patch, s, self));
    }

    /// Heat for the next step. Its column has the energy that a particle would have without the
    /// numerical heat of this step.
    fn find_heat<const D: usize>(&self, s: &Scheme<D>, patch: &mut Patch<D>) {
        let n = patch.block.own();
        let [heat, spread, energy] = patch
            .block
            .columns
            .get_disjoint_mut([self.heat, self.spread, s.columns.energy])
            .expect("columns differ");
        let (heat, spread, energy) = (&mut heat[..n], &spread[..n], &energy[..n]);
        let still = s.still_heat();
        for r in 0..n {
            // a remainder stays where it is, so that particles can come to rest
            heat[r] = cut(energy[r] - heat[r] + self.share * spread[r], still);
        }
    }
}

#[cfg(test)]
#[path = "tests/heat_spreading.rs"]
mod tests;
