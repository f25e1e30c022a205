//! Temperature of the rows of bodies that have one.

use std::ops::Range;

use super::Stepper;
use super::particle_update::bodies;
use crate::solver::patch::{Patch, Phase};

impl<const D: usize> Stepper<D> {
    /// What the plastic work of a step on the rows of `body` does to their temperature, where it
    /// alone heats, or to the part of it that does not.
    pub(super) fn keep_heat(&self, patch: &mut Patch<D>, body: usize, rows: Range<usize>) {
        let c = &self.columns;
        let (Some(thermal), Some(of), Some(strength)) =
            (c.thermal, &self.thermals[body], c.strength)
        else {
            return;
        };
        let work = |r: usize| {
            let column = |k: usize| patch.block.columns[k][r];
            column(strength.plastic_work) * column(c.volume0) * column(c.jacobian) / column(c.mass)
        };
        let (into, share) = match (&of.isentrope, thermal.stored) {
            (None, _) => (thermal.temperature, of.taylor_quinney / of.specific_heat),
            (Some(_), Some(stored)) => (stored, 1.0 - of.taylor_quinney),
            (Some(_), None) => return,
        };
        let added: smallvec::SmallVec<[f64; 64]> = rows.clone().map(|r| share * work(r)).collect();
        for (r, added) in rows.zip(added) {
            patch.block.columns[into][r] += added;
        }
    }

    /// Heat that own particle `r` lacks to absolute zero, per unit mass [J/kg]: cv max(0, -T);
    /// `None` without a temperature.
    pub fn heat_below_zero_kelvin(&self, block: &decomp::Block<D>, r: usize) -> Option<f64> {
        let temperature = block.columns[self.columns.thermal?.temperature][r];
        let thermal = self.thermals[block.columns[self.columns.body][r] as usize].as_ref()?;
        // max() would pass over NaN
        Some(if temperature >= 0.0 { 0.0 } else { -thermal.specific_heat * temperature })
    }

    /// Temperature of the own rows from their energy, where it follows from that.
    pub(super) fn refresh_temperature(&self, patch: &mut Patch<D>, pressure: &[f64]) {
        let Some(thermal) = self.columns.thermal else { return };
        let mut temperature = std::mem::take(&mut patch.block.columns[thermal.temperature]);
        let mut lost = None;
        let body = &patch.block.columns[self.columns.body][..patch.block.own()];
        for (body, rows) in bodies(body) {
            for r in rows {
                if let Some(t) = self.temperature(patch, body, r, pressure[r], temperature[r]) {
                    temperature[r] = t;
                    if lost.is_none() && !t.is_finite() {
                        lost = Some(r);
                    }
                }
            }
        }
        patch.block.columns[thermal.temperature] = temperature;
        if let Some(r) = lost {
            self.fault(patch, Phase::End, r, "its temperature is not a number".into());
        }
    }

    /// Temperature of a row from its energy, if it follows from that; `before` is what its
    /// strength sees [K].
    pub(super) fn temperature(
        &self,
        patch: &Patch<D>,
        body: usize,
        r: usize,
        pressure: f64,
        before: f64,
    ) -> Option<f64> {
        let c = &self.columns;
        let of = self.thermals[body].as_ref()?;
        of.isentrope.as_ref()?;
        let column = |k: usize| patch.block.columns[k][r];
        let j = column(c.jacobian);
        let mut energy = column(c.energy);
        if let (Some(strength), Some(flow)) = (c.strength, &self.flows[body]) {
            let s = self.deviator(patch, strength.deviator, r..r + 1).at(0);
            let at = crate::material::strength::Condition {
                compression: 1.0 / j,
                pressure,
                temperature: before,
            };
            let modulus = flow.shear_modulus(&at);
            if modulus > 0.0 {
                energy -= s.along(&s) * column(c.volume0) * j / (4.0 * modulus * column(c.mass));
            }
        }
        energy -= c.thermal.and_then(|c| c.stored).map_or(0.0, column);
        // what has failed and come apart is stretched no more than it was at rest
        let failed = c.failure.is_some_and(|c| column(c.damage) >= 1.0);
        of.temperature(if failed { j.min(1.0) } else { j }, energy)
    }
}
