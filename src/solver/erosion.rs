//! Rows that are taken out of the run at a limit of strain or volume: see
//! [`Erosion`](crate::material::constitutive::Erosion).
//!
//! They go at the end of a step, before its end is looked at: what they are no longer bounds the
//! time step, and is no fault.

use super::Stepper;
use super::particle_update::bodies;
use crate::solver::patch::Patch;

impl<const D: usize> Stepper<D> {
    /// Takes out the own rows that have reached a limit of their material.
    pub(super) fn erode(&self, patch: &mut Patch<D>) {
        let Some(limits) = &self.erosion else { return };
        let c = &self.columns;
        let n = patch.block.own();
        let column = |k: usize| &patch.block.columns[k][..n];
        let (jacobian, strain) = (column(c.jacobian), c.strength.map(|c| column(c.plastic_strain)));
        let mut gone = Vec::new();
        for (body, rows) in bodies(column(c.body)) {
            let Some(limit) = limits[body] else { continue };
            let goes = |r: &usize| limit.takes(strain.map_or(0.0, |s| s[*r]), jacobian[*r]);
            gone.extend(rows.filter(goes));
        }
        if !gone.is_empty() {
            patch.block.drop_ghosts();
            self.depart(patch, &gone, true);
        }
    }
}
