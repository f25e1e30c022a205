//! Rows that fail: from then on they bear neither tension nor shear.
//!
//! A failed row keeps its energy: what was elastic of it is heat from then on. Pressed together
//! again it bears pressure as before.

use super::Stepper;
use super::particle_update::bodies;
use crate::material::Symmetric;
use crate::material::constitutive::{Loaded, Matter, Model};
use crate::solver::patch::Patch;

/// Ranges of rows that have failed, or have not.
fn runs(damage: &[f64]) -> impl Iterator<Item = (bool, std::ops::Range<usize>)> + '_ {
    let mut at = 0;
    std::iter::from_fn(move || {
        let failed = *damage.get(at)? >= 1.0;
        let start = at;
        at += damage[at..].iter().take_while(|&&d| (d >= 1.0) == failed).count();
        Some((failed, start..at))
    })
}

/// Pressure and sound speed of rows some of which may have failed. A failed row in tension is
/// debris: without pressure, and no fault of its equation of state.
pub(super) fn refresh(
    (model, damage): (&dyn Model, &[f64]),
    (jacobian, energy): (&[f64], &[f64]),
    mut history: Option<&mut [f64]>,
    (pressure, speed): (&mut [f64], &mut [f64]),
) -> Option<(usize, String)> {
    let mut found = None;
    for (failed, rows) in runs(damage) {
        if !failed {
            let (p, c) = (&mut pressure[rows.clone()], &mut speed[rows.clone()]);
            let history = history.as_mut().map(|h| &mut h[rows.clone()]);
            let (j, e) = (&jacobian[rows.clone()], &energy[rows.clone()]);
            let told = model.refresh(j, e, history, p, c);
            if let (None, Some((row, what))) = (&found, told) {
                found = Some((rows.start + row, what));
            }
            continue;
        }
        for r in rows {
            let (p, c) = (&mut pressure[r..=r], &mut speed[r..=r]);
            let history = history.as_mut().map(|h| &mut h[r..=r]);
            let told = model.refresh(&jacobian[r..=r], &energy[r..=r], history, p, c);
            let apart = p[0] < 0.0 && jacobian[r] > 0.0 && energy[r].is_finite();
            if p[0] < 0.0 {
                p[0] = 0.0;
            }
            if apart && (c[0].is_nan() || c[0] == 0.0) {
                c[0] = model.sound_speed_at(0.0);
            }
            if let (None, Some((_, what)), false) = (&found, told, apart) {
                found = Some((r, what));
            }
        }
    }
    found
}

impl<const D: usize> Stepper<D> {
    /// Takes the tension away that the middle of the step would have in failed rows, at volume
    /// ratio `jacobian` (a column).
    pub(super) fn bear_no_tension(&self, patch: &mut Patch<D>, jacobian: usize) {
        let c = &self.columns;
        let Some(failure) = c.failure else { return };
        let n = patch.block.own();
        let mut stress = std::mem::take(&mut patch.block.columns[c.stress_volume]);
        for r in 0..n {
            let column = |k: usize| patch.block.columns[k][r];
            if column(failure.damage) < 1.0 {
                continue;
            }
            let volume = column(c.volume0) * column(jacobian);
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

    /// The same at the end of a leapfrog step from volume ratios `before`; what is not borne does
    /// no work.
    pub(super) fn release_tension(
        &self,
        patch: &Patch<D>,
        before: &[f64],
        pressure: &mut [f64],
        energy: &mut [f64],
    ) {
        let c = &self.columns;
        let Some(failure) = c.failure else { return };
        for r in 0..before.len() {
            let column = |k: usize| patch.block.columns[k][r];
            if column(failure.damage) >= 1.0 && pressure[r] < 0.0 {
                let change = (column(c.jacobian) - before[r]) * column(c.volume0);
                energy[r] += 0.5 * pressure[r] * change / column(c.mass);
                pressure[r] = 0.0;
            }
        }
    }

    /// Damage of the own rows at the end of a step of `dt`; those that fail let go.
    pub(super) fn fail(&self, patch: &mut Patch<D>, dt: f64) {
        let c = &self.columns;
        let Some(failure) = c.failure else { return };
        let n = patch.block.own();
        let all: Vec<_> = bodies(&patch.block.columns[c.body][..n]).collect();
        for (body, rows) in all {
            let Some(criterion) = &self.criteria[body] else { continue };
            let flow = self.flows[body].as_ref();
            for r in rows {
                let column = |k: usize| patch.block.columns[k][r];
                let before = column(failure.damage);
                if before >= 1.0 {
                    continue;
                }
                let strength = c.strength.filter(|_| flow.is_some());
                let deviator = strength.map_or(Symmetric::default(), |c| {
                    self.deviator(patch, c.deviator, r..r + 1).at(0)
                });
                let pressure = column(c.pressure);
                let damage = criterion.damage(
                    before,
                    &Loaded {
                        pressure,
                        deviator,
                        plastic_strain: strength.map_or(0.0, |c| column(c.plastic_increment)),
                        dt,
                        temperature: c.thermal.map_or(f64::NAN, |c| column(c.temperature)),
                    },
                );
                patch.block.columns[failure.damage][r] = damage;
                if damage >= 1.0 {
                    self.let_go(patch, body, r, &deviator);
                }
            }
        }
    }

    /// Takes tension and shear from a row, and books their elastic energy.
    fn let_go(&self, patch: &mut Patch<D>, body: usize, r: usize, deviator: &Symmetric) {
        let c = &self.columns;
        let column = |k: usize| patch.block.columns[k][r];
        let (j, pressure) = (column(c.jacobian), column(c.pressure));
        let volume = column(c.volume0) * j;
        let at = self.condition(patch, r, j, pressure);
        let shear = self.flows[body].as_ref().map_or(0.0, |flow| flow.shear_modulus(&at));
        let speed = column(c.sound_speed);
        let bulk = column(c.mass) / volume * speed * speed - 4.0 / 3.0 * shear;
        let mut released = 0.0;
        if pressure < 0.0 && bulk > 0.0 {
            released += 0.5 * pressure * pressure / bulk * volume;
        }
        if shear > 0.0 {
            released += deviator.along(deviator) / (4.0 * shear) * volume;
        }
        let pressure = pressure.max(0.0);
        if let Some(failure) = c.failure {
            patch.block.columns[failure.released][r] += released;
        }
        patch.block.columns[c.pressure][r] = pressure;
        let components = if D == 1 { 1 } else { 3 };
        if let Some(strength) = c.strength {
            (0..components).for_each(|k| patch.block.columns[strength.deviator + k][r] = 0.0);
        }
        if let (Some(stress), Matter::Fluid(_)) = (c.stress, &self.models[body]) {
            for k in 0..components {
                patch.block.columns[stress + k][r] = if k == 2 { 0.0 } else { -pressure };
            }
        }
        if let Some(thermal) = c.thermal {
            let before = patch.block.columns[thermal.temperature][r];
            if let Some(t) = self.temperature(patch, body, r, pressure, before) {
                patch.block.columns[thermal.temperature][r] = t;
            }
        }
    }
}
