//! Strength: the stress deviator at the middle and at the end of a step.
//!
//! ```text
//! s_h from s by dt/2 at the gradient of the last v'         S = (p + q) V 1 - s_h V
//! s' from s by dt at the gradient of the mean velocity      in the gather
//! ```
//!
//! The energy used for the pressure at the middle of the step includes the shear work of the first
//! half step; the work of the whole step is in S : grad w.

use std::ops::Range;

use crate::material::Symmetric;
use crate::material::constitutive::{StrengthUpdate, TensorColumns, VelocityGradients};
use crate::material::strength::Rate;
use crate::scene::CheckedScene;
use crate::shape::with_width;
use crate::solver::Scheme;
use crate::solver::declare::{Declare, Role};
use crate::solver::effect::{Effect, Package, Phase, Setup, StepContext};
use crate::solver::gather::{put, tensor_of, trace};
use crate::solver::particle_update::bodies;
use crate::solver::patch::Patch;

/// Strength of materials, in addition to their equations of state.
pub struct StrengthEffect {
    /// Deviator of the Cauchy stress [Pa]: xx; in a plane also yy and xy.
    deviator: usize,
    /// Equivalent plastic strain [-].
    plastic_strain: usize,
    /// Velocity gradient during the step [1/s], a tensor; with axial symmetry also its divergence.
    rate: usize,
    /// Specific internal energy at the middle of the step without the pressure work [J/kg].
    energy_mid: usize,
    /// Plastic strain after the step, later its increment over the step [-].
    plastic_increment: usize,
    /// Plastic work of the step per unit volume [J/m3].
    plastic_work: usize,
    /// Stress [Pa]; these columns hold the new deviator until it is final.
    stress: usize,
    midpoint: bool,
}

impl Package for StrengthEffect {
    const NAME: &'static str = "strength";

    fn is_active(scene: &CheckedScene) -> bool {
        (0..scene.bodies.len()).any(|i| scene.material_of(i).strength.is_some())
    }

    fn declare(scene: &CheckedScene, d: &mut Declare<'_>) {
        let names = ["deviator_xx", "deviator_yy", "deviator_xy"];
        let deviator = d.symmetric(names, "Pa", Role::State);
        d.deviator(deviator);
        let plastic_strain = d.scalar("plastic_strain", "", Role::State);
        d.plastic_strain(plastic_strain);
        d.tensor(["rate_xx", "rate_xy", "rate_yx", "rate_yy"], "1/s", Role::Scratch);
        if scene.axisymmetric() {
            d.scalar("rate_divergence", "1/s", Role::Scratch);
        }
        let energy_mid = d.scalar("energy_mid", "J/kg", Role::Scratch);
        d.energy_mid(energy_mid);
        d.scalar("plastic_increment", "", Role::Scratch);
        d.scalar("plastic_work", "J/m3", Role::Scratch);
        d.output("plastic_strain", "-", "plastic_strain");
    }

    fn build<const D: usize>(setup: &mut Setup<'_, D>) -> Box<dyn Effect<D>> {
        let columns = setup.columns;
        Box::new(StrengthEffect {
            deviator: columns.get("deviator_xx"),
            plastic_strain: columns.get("plastic_strain"),
            rate: columns.get("rate_xx"),
            energy_mid: columns.get("energy_mid"),
            plastic_increment: columns.get("plastic_increment"),
            plastic_work: columns.get("plastic_work"),
            stress: columns.stress.expect("a body with strength has a stress tensor"),
            midpoint: columns.jacobian_mid.is_some(),
        })
    }
}

impl<const D: usize> Effect<D> for StrengthEffect {
    fn phases(&self) -> &'static [Phase] {
        match self.midpoint {
            true => &[Phase::MidState, Phase::Gather, Phase::Gathered, Phase::EndSoundSpeed],
            false => &[Phase::StressUpdate, Phase::EndSoundSpeed],
        }
    }

    fn act(&self, phase: Phase, step: &StepContext<'_, D>, patch: &mut Patch<D>) {
        let s = step.scheme;
        match phase {
            Phase::MidState => self.shear_to_middle(s, patch, 0.5 * step.dt, step.jacobian),
            Phase::Gather => self.gather_rate(s, patch),
            Phase::Gathered => {
                self.advance(s, patch, By::Mean, step.dt, s.columns.jacobian);
                self.take_over(s, patch);
            }
            Phase::StressUpdate => self.shear_and_heat(s, patch, step.dt),
            _ => self.add_shear_wave_speed(s, patch),
        }
    }
}

/// Choice of the velocity gradient that shears the particles.
#[derive(Clone, Copy)]
enum By {
    /// Gradient at the end of the last step.
    Last,
    /// Gradient of the mean velocity of this step.
    Mean,
}

/// Double contraction of a stress with the rate of strain.
#[inline(always)]
fn power(stress: &Symmetric, rate: &Rate) -> f64 {
    let [xx, xy, yx, yy] = rate.plane;
    stress.double_dot(&Symmetric { xx, yy, xy: 0.5 * (xy + yx), zz: rate.across })
}

impl StrengthEffect {
    fn rate<'a, const D: usize>(
        &self,
        s: &Scheme<D>,
        patch: &'a Patch<D>,
        by: By,
        particles: Range<usize>,
    ) -> VelocityGradients<'a> {
        let c = &s.columns;
        let whole = c.velocity_gradient.unwrap_or(c.divergence);
        let (first, divergence) = match by {
            By::Last => (whole, c.divergence),
            By::Mean => (self.rate, self.rate + D * D),
        };
        let column = |k: usize| &patch.block.columns[k][particles.clone()];
        match (D, s.axisymmetric) {
            (1, _) => VelocityGradients::Line(column(first)),
            (_, false) => VelocityGradients::Plane(decomp::array::from_fn(|k| column(first + k))),
            (_, true) => VelocityGradients::Axis(
                decomp::array::from_fn(|k| column(first + k)),
                column(divergence),
            ),
        }
    }

    /// Writes the gradient of the mean velocity at the own particles to its columns.
    fn gather_rate<const D: usize>(&self, s: &Scheme<D>, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Scheme<D>, first: usize) {
            let n = patch.block.own();
            let count = D * D + usize::from(D > 1 && s.axisymmetric);
            let mut out: Vec<Vec<f64>> = (first..first + count)
                .map(|k| {
                    let mut column = std::mem::take(&mut patch.block.columns[k]);
                    column.resize(n, 0.0);
                    column
                })
                .collect();
            let vector =
                |k: usize| decomp::array::from_fn::<&[f64], D, _>(|a| &patch.nodes.fields[k + a]);
            let (start, star) = (vector(s.fields.velocity), vector(s.fields.velocity_star));
            for r in 0..n {
                let weights = patch.stencils.particle::<K, D>(r);
                let mean = |a: usize, line: usize| -> [f64; K] {
                    let (v0, v1) = (weights.line(start[a], line), weights.line(star[a], line));
                    decomp::array::from_fn(|k| 0.5 * (v0[k] + v1[k]))
                };
                let rate = tensor_of(&weights, mean);
                put(&mut out, 0, r, &rate);
                if let Some(divergence) = out.get_mut(D * D) {
                    divergence[r] = s.with_hoop(patch, &weights, r, trace(&rate), |l| mean(0, l));
                }
            }
            for (k, column) in out.into_iter().enumerate() {
                patch.block.columns[first + k] = column;
            }
        }
        with_width!(patch.stencils.width, go(patch, s, self.rate));
    }

    /// Shears the own particles by `dt`: writes the new deviator to the columns of the stress, and
    /// plastic strain and work to their scratch columns. Failed particles carry no shear.
    fn advance<const D: usize>(
        &self,
        s: &Scheme<D>,
        patch: &mut Patch<D>,
        by: By,
        dt: f64,
        jacobian: usize,
    ) {
        let c = &s.columns;
        let n = patch.block.own();
        let components = if D == 1 { 1 } else { 3 };
        let mut take = |k: usize| {
            let mut column = std::mem::take(&mut patch.block.columns[k]);
            column.resize(n, 0.0);
            column
        };
        let mut out: [Vec<f64>; 3] =
            decomp::array::from_fn(
                |k| {
                    if k < components { take(self.stress + k) } else { Vec::new() }
                },
            );
        let [mut strain, mut work] = [take(self.plastic_increment), take(self.plastic_work)];
        for (body, particles) in bodies(&patch.block.columns[c.body][..n]) {
            let column = |k: usize| &patch.block.columns[k][particles.clone()];
            let Some(strength) = &s.strengths[body] else {
                strain[particles.clone()].fill(0.0);
                work[particles.clone()].fill(0.0);
                continue;
            };
            let mut out_of = |particles: Range<usize>, advance: &dyn Fn(StrengthUpdate<'_>)| {
                let column = |k: usize| &patch.block.columns[k][particles.clone()];
                let [xx, yy, xy] = &mut out;
                let plane =
                    (D > 1).then(|| [&mut yy[particles.clone()], &mut xy[particles.clone()]]);
                advance(StrengthUpdate {
                    dt,
                    rate: self.rate(s, patch, by, particles.clone()),
                    jacobian: column(jacobian),
                    pressure: column(c.pressure),
                    temperature: c.temperature.map(column),
                    deviator: s.deviator(patch, self.deviator, particles.clone()),
                    plastic_strain: column(self.plastic_strain),
                    deviator_after: TensorColumns {
                        xx: &mut xx[particles.clone()],
                        plane,
                        across: None,
                    },
                    plastic_strain_after: &mut strain[particles.clone()],
                    plastic_work: &mut work[particles.clone()],
                });
            };
            out_of(particles.clone(), &|update| strength.advance(update));
            if let (Some(failure), Some(damage)) = (s.gradual_failure(body), c.tension_free[body]) {
                let damage = &patch.block.columns[damage];
                for r in particles.clone().filter(|&r| damage[r] > 0.0 && damage[r] < 1.0) {
                    let share = failure.carried(damage[r]).shear;
                    out_of(r..r + 1, &|update| strength.advance_weakened(share, update));
                }
            }
            if let Some(damage) = c.tension_free[body] {
                let (damage, before) = (column(damage), column(self.plastic_strain));
                for (k, r) in particles.clone().enumerate().filter(|(k, _)| damage[*k] >= 1.0) {
                    out[..components].iter_mut().for_each(|s| s[r] = 0.0);
                    (strain[r], work[r]) = (before[k], 0.0);
                }
            }
        }
        for (k, column) in out.into_iter().enumerate().take(components) {
            patch.block.columns[self.stress + k] = column;
        }
        patch.block.columns[self.plastic_increment] = strain;
        patch.block.columns[self.plastic_work] = work;
    }

    /// Adds the shear work over `dt` at the volume ratio `jacobian` to `energy` [J/kg]; the
    /// deviator changes from its old value to that in the columns of the stress.
    fn add_shear_work<const D: usize>(
        &self,
        s: &Scheme<D>,
        patch: &Patch<D>,
        dt: f64,
        jacobian: impl Fn(usize) -> f64,
        energy: &mut [f64],
    ) {
        let c = &s.columns;
        let n = patch.block.own();
        let column = |k: usize| &patch.block.columns[k][..n];
        let (mass, volume0) = (column(c.mass), column(c.volume0));
        for (body, particles) in bodies(column(c.body)) {
            if s.strengths[body].is_none() {
                continue;
            }
            let rate = self.rate(s, patch, By::Last, particles.clone());
            let before = s.deviator(patch, self.deviator, particles.clone());
            let after = s.deviator(patch, self.stress, particles.clone());
            for (k, r) in particles.enumerate() {
                let rate = rate.at(k);
                let both = power(&before.at(k), &rate) + power(&after.at(k), &rate);
                energy[r] += 0.5 * dt * both * volume0[r] * jacobian(r) / mass[r];
            }
        }
    }

    /// Deviator after `half` a step, in the columns of the stress, and the energy there without the
    /// pressure work.
    fn shear_to_middle<const D: usize>(
        &self,
        s: &Scheme<D>,
        patch: &mut Patch<D>,
        half: f64,
        mid: usize,
    ) {
        self.advance(s, patch, By::Last, half, mid);
        let mut energy = std::mem::take(&mut patch.block.columns[self.energy_mid]);
        energy.clear();
        energy.extend_from_slice(&patch.block.columns[s.columns.energy]);
        let jacobian = |r: usize| patch.block.columns[mid][r];
        self.add_shear_work(s, patch, half, jacobian, &mut energy);
        patch.block.columns[self.energy_mid] = energy;
    }

    /// Deviator at the end of a leapfrog step of `dt`, and its work.
    fn shear_and_heat<const D: usize>(&self, s: &Scheme<D>, patch: &mut Patch<D>, dt: f64) {
        let c = &s.columns;
        self.advance(s, patch, By::Last, dt, c.jacobian);
        let mut energy = std::mem::take(&mut patch.block.columns[c.energy]);
        let (before, after) = (&patch.kept, &patch.block.columns[c.jacobian]);
        let middle = |r: usize| 0.5 * (before[r] + after[r]);
        self.add_shear_work(s, patch, dt, middle, &mut energy);
        patch.block.columns[c.energy] = energy;
        self.take_over(s, patch);
    }

    /// Takes the deviator and the plastic strain found by [`Self::advance`] as the state of the
    /// particles.
    fn take_over<const D: usize>(&self, s: &Scheme<D>, patch: &mut Patch<D>) {
        let n = patch.block.own();
        let body = std::mem::take(&mut patch.block.columns[s.columns.body]);
        for (_, particles) in bodies(&body[..n]).filter(|(body, _)| s.strengths[*body].is_some()) {
            let components = if D == 1 { 1 } else { 3 };
            let pairs = (0..components).map(|k| [self.stress + k, self.deviator + k]);
            for pair in pairs {
                let [from, to] =
                    patch.block.columns.get_disjoint_mut(pair).expect("columns differ");
                to[particles.clone()].copy_from_slice(&from[particles.clone()]);
            }
            let [strain, increment] = patch
                .block
                .columns
                .get_disjoint_mut([self.plastic_strain, self.plastic_increment])
                .expect("columns differ");
            for r in particles {
                let after = increment[r];
                increment[r] = after - strain[r];
                strain[r] = after;
            }
        }
        patch.block.columns[s.columns.body] = body;
    }

    /// Sets the sound speed of own particles with shear stiffness to that of longitudinal waves.
    fn add_shear_wave_speed<const D: usize>(&self, s: &Scheme<D>, patch: &mut Patch<D>) {
        let c = &s.columns;
        let n = patch.block.own();
        let mut speed = std::mem::take(&mut patch.block.columns[c.sound_speed]);
        let column = |k: usize| &patch.block.columns[k][..n];
        let (mass, volume0, j) = (column(c.mass), column(c.volume0), column(c.jacobian));
        let pressure = column(c.pressure);
        for (body, particles) in bodies(column(c.body)) {
            let Some(strength) = &s.strengths[body] else { continue };
            for r in particles {
                let at = s.condition(patch, r, j[r], pressure[r]);
                let square = strength.shear_modulus(&at) * volume0[r] * j[r] / mass[r];
                speed[r] = (speed[r] * speed[r] + 4.0 / 3.0 * square).sqrt();
            }
        }
        patch.block.columns[c.sound_speed] = speed;
    }
}

#[cfg(test)]
#[path = "tests/strength.rs"]
mod tests;
