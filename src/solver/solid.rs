//! Solids: the stress tensor of all particles of a scene with a solid.
//!
//! ```text
//! F_h = (1 + dt/2 L) F          L: gradient of the last v'; at the middle of the step
//! S = (q 1 - sigma) V           q: artificial viscosity; S is positive in compression
//! f_i = sum S G_i
//! e += -dt S : grad w/m
//! ```
//!
//! For a fluid, S is (p + q) V 1 minus the deviator of its strength s V. On a line S is a scalar,
//! used directly by the kernels of fluids. With axial symmetry the component zz pushes outward, as
//! the pressure of a fluid does.

use std::ops::Range;

use decomp::Block;

use super::particle_update::bodies;
use super::scheme::Scheme;
use crate::material::Symmetric;
use crate::material::constitutive::{ConstitutiveModel, PlaneStrain, Strain, TensorColumns};
use crate::shape::with_width;
use crate::solver::clock::timed;
use crate::solver::parts::StepPart;
use crate::solver::patch::Patch;

/// Columns of a tensor taken out of their block: those of xx, yy, xy and zz that exist.
pub(super) type Taken = smallvec::SmallVec<[Vec<f64>; 4]>;

/// Given particles of the columns of a tensor.
fn tensor_columns(columns: &mut Taken, particles: Range<usize>) -> TensorColumns<'_> {
    let mut all = columns.iter_mut();
    let mut next = || all.next().map(|column| &mut column[particles.clone()]);
    let xx = next().expect("a tensor has a component");
    let plane = next().zip(next()).map(|(yy, xy)| [yy, xy]);
    TensorColumns { xx, plane, across: next() }
}

/// Takes `count` columns from `first` on out of a block, resized to `particles`.
fn take(columns: &mut [Vec<f64>], first: usize, count: usize, particles: usize) -> Taken {
    let mut taken = Taken::new();
    for column in &mut columns[first..first + count] {
        let mut column = std::mem::take(column);
        column.resize(particles, 0.0);
        taken.push(column);
    }
    taken
}

/// Returns columns to their block.
pub(super) fn put_back(
    columns: &mut [Vec<f64>],
    first: usize,
    taken: impl IntoIterator<Item = Vec<f64>>,
) {
    for (k, column) in taken.into_iter().enumerate() {
        columns[first + k] = column;
    }
}

impl<const D: usize> Scheme<D> {
    /// Whether the stress of the particles is a tensor.
    pub(super) fn tensor_stress(&self) -> bool {
        D > 1 && self.columns.stress.is_some()
    }

    /// Deformation of `particles`: in a plane F extrapolated by the time `ahead` [s], otherwise the
    /// volume ratios `jacobian`.
    pub(super) fn strain<'a>(
        &self,
        block: &'a Block<D>,
        particles: Range<usize>,
        ahead: f64,
        jacobian: &'a [f64],
    ) -> Strain<'a> {
        let c = &self.columns;
        let tensor = |first: usize| -> [&'a [f64]; 4] {
            decomp::array::from_fn(|k| &block.columns[first + k][particles.clone()])
        };
        let (Some(deformation), Some(gradient)) = (c.deformation, c.velocity_gradient) else {
            return Strain::Line(&jacobian[particles]);
        };
        let plane =
            PlaneStrain { deformation: tensor(deformation), gradient: tensor(gradient), ahead };
        match self.axisymmetric {
            true => Strain::Axis(plane, &jacobian[particles]),
            false => Strain::Plane(plane),
        }
    }

    /// S of own particles at the volume ratio in column `jacobian` and the time `ahead` [s] of
    /// their deformation. The scalar S of fluids must be in the column of xx. The deviator of
    /// strength is in the columns from `deviator` on.
    pub(super) fn find_solid_stress(
        &self,
        patch: &mut Patch<D>,
        ahead: f64,
        jacobian: usize,
        deviator: Option<usize>,
    ) {
        if self.columns.stress.is_some() {
            timed(StepPart::StressTensor as usize, patch, |patch| {
                self.fill_solid_stress(patch, ahead, jacobian, deviator);
            });
        }
    }

    fn fill_solid_stress(
        &self,
        patch: &mut Patch<D>,
        ahead: f64,
        jacobian: usize,
        deviator: Option<usize>,
    ) {
        let c = &self.columns;
        let n = patch.block.own();
        let mut s = take(&mut patch.block.columns, c.stress_volume, c.stress_volumes, n);
        let column = |k: usize| &patch.block.columns[k][..n];
        let (volume0, j) = (column(c.volume0), column(jacobian));
        for (body, particles) in bodies(column(c.body)) {
            match &self.models[body] {
                ConstitutiveModel::Fluid(_) => {
                    for r in particles.clone() {
                        for k in 1..s.len() {
                            s[k][r] = if k == 2 { 0.0 } else { s[0][r] };
                        }
                    }
                    let Some(first) = deviator.filter(|_| self.strengths[body].is_some()) else {
                        continue;
                    };
                    let stress = self.deviator(patch, first, particles.clone());
                    for (k, r) in particles.enumerate() {
                        let (shear, volume) = (stress.at(k), volume0[r] * j[r]);
                        let parts = [shear.xx, shear.yy, shear.xy, shear.zz];
                        s.iter_mut().zip(parts).for_each(|(s, part)| s[r] -= part * volume);
                    }
                }
                ConstitutiveModel::Solid(solid) => {
                    let strain = self.strain(&patch.block, particles.clone(), ahead, j);
                    let out = tensor_columns(&mut s, particles.clone());
                    solid.stress_volume(strain, &volume0[particles.clone()], out);
                    let Some(q) = c.viscosity.map(column) else { continue };
                    // not the shear component
                    for (_, s) in s.iter_mut().enumerate().filter(|(k, _)| *k != 2) {
                        particles.clone().for_each(|r| s[r] += q[r] * volume0[r] * j[r]);
                    }
                }
            }
        }
        put_back(&mut patch.block.columns, c.stress_volume, s);
    }

    /// Stress, pressure and sound speed of the own particles of solids, and the stress of fluids
    /// from their pressure; returns the first particle with a fault.
    pub(super) fn refresh_solids(
        &self,
        patch: &mut Patch<D>,
        pressure: &mut [f64],
        speed: &mut [f64],
    ) -> Option<(usize, String)> {
        let c = &self.columns;
        let stress = c.stress?;
        let n = patch.block.own();
        let mut found = None;
        let mut s = take(&mut patch.block.columns, stress, if D == 1 { 1 } else { 3 }, n);
        for (body, particles) in bodies(&patch.block.columns[c.body][..n]) {
            let mut out = tensor_columns(&mut s, particles.clone());
            match &self.models[body] {
                ConstitutiveModel::Fluid(_) => {
                    let first = c.deviator.filter(|_| self.strengths[body].is_some());
                    let shear = first.map(|first| self.deviator(patch, first, particles.clone()));
                    for (k, r) in particles.enumerate() {
                        let mut all = Symmetric::isotropic(-pressure[r]);
                        if let Some(shear) = shear.map(|s| s.at(k)) {
                            all.xx += shear.xx;
                            all.yy += shear.yy;
                            all.xy += shear.xy;
                            all.zz += shear.zz;
                        }
                        out.set(k, &all, 1.0);
                    }
                }
                ConstitutiveModel::Solid(solid) => {
                    let j = &patch.block.columns[c.jacobian];
                    let strain = self.strain(&patch.block, particles.clone(), 0.0, j);
                    let (p, speed) =
                        (&mut pressure[particles.clone()], &mut speed[particles.clone()]);
                    let fault = solid.refresh(strain, out, p, speed);
                    if let (None, Some((particle, what))) = (&found, fault) {
                        found = Some((particles.start + particle, what));
                    }
                }
            }
        }
        put_back(&mut patch.block.columns, stress, s);
        found
    }

    /// Energy of the own particles of solids [J/kg] after `dt` [s] with the velocity gradient in
    /// its columns, from the volume ratios `before` to the current ones.
    pub(super) fn work_on_solids(
        &self,
        patch: &mut Patch<D>,
        dt: f64,
        before: &[f64],
        energy: &mut [f64],
    ) {
        let c = &self.columns;
        if c.stress.is_none() {
            return;
        }
        let n = before.len();
        // scratch memory here; the column is recomputed before its next use
        let mut work = std::mem::take(&mut patch.block.columns[c.stress_volume]);
        work.resize(n, 0.0);
        let column = |k: usize| &patch.block.columns[k][..n];
        let (mass, volume0, after) = (column(c.mass), column(c.volume0), column(c.jacobian));
        for (body, particles) in bodies(column(c.body)) {
            let ConstitutiveModel::Solid(solid) = &self.models[body] else { continue };
            let from = self.strain(&patch.block, particles.clone(), 0.0, before);
            let to = self.strain(&patch.block, particles.clone(), dt, after);
            solid.work(from, to, &volume0[particles.clone()], &mut work[particles.clone()]);
            for r in particles {
                let q = c.viscosity.map_or(0.0, |q| patch.block.columns[q][r]);
                energy[r] += (work[r] - q * (after[r] - before[r]) * volume0[r]) / mass[r];
            }
        }
        patch.block.columns[c.stress_volume] = work;
    }

    /// Normal component n.S n of a particle [J].
    #[inline(always)]
    pub(super) fn pressing(&self, patch: &Patch<D>, r: usize, normal: &[f64; D]) -> f64 {
        let s = |k: usize| patch.block.columns[self.columns.stress_volume + k][r];
        match self.tensor_stress() {
            false => s(0),
            true => {
                let [x, y] = [normal[0], normal[D - 1]];
                s(0) * x * x + s(1) * y * y + 2.0 * s(2) * x * y
            }
        }
    }

    /// Adds the internal force of all particles, f_i = sum S G_i, to the nodes.
    pub(super) fn scatter_stress(&self, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Scheme<D>) {
            let c = &s.columns;
            let mut force: [Vec<f64>; D] = decomp::array::from_fn(|a| {
                std::mem::take(&mut patch.nodes.fields[s.fields.acceleration + a])
            });
            let column = |k: usize| &patch.block.columns[c.stress_volume + k][..];
            let (xx, yy, xy) = (column(0), column(1), column(2));
            for r in patch.runs.iter().cloned().flatten() {
                let weights = patch.stencils.particle::<K, D>(r);
                let (gx, gy) = (weights.gradient(0), weights.gradient(D - 1));
                for (a, [sx, sy]) in [[xx[r], xy[r]], [xy[r], yy[r]]].into_iter().enumerate() {
                    weights.add(&mut force[a], gx, |g| g * sx);
                    weights.add(&mut force[a], gy, |g| g * sy);
                }
                if s.axisymmetric {
                    let hoop = column(3)[r] / s.radius(patch, r);
                    weights.add(&mut force[0], weights.values, |n| n * hoop);
                }
            }
            for (a, force) in force.into_iter().enumerate() {
                patch.nodes.fields[s.fields.acceleration + a] = force;
            }
        }
        with_width!(patch.stencils.width, go(patch, self));
    }
}
