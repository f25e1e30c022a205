//! What a scene with a solid adds to a step: stress as a tensor, in all of its rows.
//!
//! ```text
//! F_h = (1 + dt/2 L) F          L: gradient of the last v'; at the middle of the step
//! S = (q 1 - sigma) V           q: artificial viscosity; S is positive in compression
//! f_i = sum S G_i
//! e += -dt S : grad w/m
//! ```
//!
//! A fluid's S is (p + q) V 1, less what its strength bears, s V. On a line S is a scalar, which a fluid's loops take as it is;
//! about an axis its component zz pushes outward, as a fluid's pressure does.

use std::ops::Range;

use super::particle_update::bodies;
use super::{MOST_NODES, Stepper, with_width};
use crate::material::Symmetric;
use crate::material::constitutive::{Matter, PlaneStrain, Strain, TensorRows};
use crate::solver::patch::Patch;
use crate::solver::transfer::Row;

/// The columns of a tensor, out of their block: xx, yy, xy, zz, those that there are.
pub(super) type Taken = smallvec::SmallVec<[Vec<f64>; 4]>;

/// Rows of a tensor's columns.
fn tensor_rows(columns: &mut Taken, rows: Range<usize>) -> TensorRows<'_> {
    let mut all = columns.iter_mut();
    let mut next = || all.next().map(|column| &mut column[rows.clone()]);
    let xx = next().expect("a tensor has a component");
    let plane = next().zip(next()).map(|(yy, xy)| [yy, xy]);
    TensorRows { xx, plane, across: next() }
}

/// Takes `count` columns from `first` on out of a block, `rows` long.
fn take(columns: &mut [Vec<f64>], first: usize, count: usize, rows: usize) -> Taken {
    let mut taken = Taken::new();
    for column in &mut columns[first..first + count] {
        let mut column = std::mem::take(column);
        column.resize(rows, 0.0);
        taken.push(column);
    }
    taken
}

/// Puts columns back.
pub(super) fn put_back(
    columns: &mut [Vec<f64>],
    first: usize,
    taken: impl IntoIterator<Item = Vec<f64>>,
) {
    for (k, column) in taken.into_iter().enumerate() {
        columns[first + k] = column;
    }
}

impl<const D: usize> Stepper<D> {
    /// Whether the rows' stress is a tensor.
    pub(super) fn tensor_stress(&self) -> bool {
        D > 1 && self.columns.stress.is_some()
    }

    /// F of `rows`, in a plane `ahead` of its columns, with the volume ratios `jacobian`.
    fn strain<'a>(
        &self,
        patch: &'a Patch<D>,
        rows: Range<usize>,
        ahead: f64,
        jacobian: &'a [f64],
    ) -> Strain<'a> {
        let c = &self.columns;
        let tensor = |first: usize| -> [&'a [f64]; 4] {
            std::array::from_fn(|k| &patch.block.columns[first + k][rows.clone()])
        };
        let (Some(deformation), Some(gradient)) = (c.deformation, c.velocity_gradient) else {
            return Strain::Line(&jacobian[rows]);
        };
        let plane =
            PlaneStrain { deformation: tensor(deformation), gradient: tensor(gradient), ahead };
        match self.axisymmetric {
            true => Strain::Axis(plane, &jacobian[rows]),
            false => Strain::Plane(plane),
        }
    }

    /// S of own rows at volume ratio `jacobian` (a column) and `ahead` of their deformation, once
    /// that of the fluids, a scalar, is in the column of xx; what strength bears stands in the
    /// columns from `deviator` on.
    pub(super) fn find_solid_stress(
        &self,
        patch: &mut Patch<D>,
        ahead: f64,
        jacobian: usize,
        deviator: Option<usize>,
    ) {
        let c = &self.columns;
        if c.stress.is_none() {
            return;
        }
        let n = patch.block.own();
        let mut s = take(&mut patch.block.columns, c.stress_volume, c.stress_volumes, n);
        let column = |k: usize| &patch.block.columns[k][..n];
        let (volume0, j) = (column(c.volume0), column(jacobian));
        for (body, rows) in bodies(column(c.body)) {
            match &self.models[body] {
                Matter::Fluid(_) => {
                    for r in rows.clone() {
                        for k in 1..s.len() {
                            s[k][r] = if k == 2 { 0.0 } else { s[0][r] };
                        }
                    }
                    let Some(first) = deviator.filter(|_| self.flows[body].is_some()) else {
                        continue;
                    };
                    let stress = self.deviator(patch, first, rows.clone());
                    for (k, r) in rows.enumerate() {
                        let (shear, volume) = (stress.at(k), volume0[r] * j[r]);
                        let parts = [shear.xx, shear.yy, shear.xy, shear.zz];
                        s.iter_mut().zip(parts).for_each(|(s, part)| s[r] -= part * volume);
                    }
                }
                Matter::Solid(solid) => {
                    let strain = self.strain(patch, rows.clone(), ahead, j);
                    let out = tensor_rows(&mut s, rows.clone());
                    solid.stress_volume(strain, &volume0[rows.clone()], out);
                    let Some(q) = c.viscosity.map(column) else { continue };
                    // no shear
                    for (_, s) in s.iter_mut().enumerate().filter(|(k, _)| *k != 2) {
                        rows.clone().for_each(|r| s[r] += q[r] * volume0[r] * j[r]);
                    }
                }
            }
        }
        put_back(&mut patch.block.columns, c.stress_volume, s);
    }

    /// Stress, pressure and sound speed of the own rows of solids, and the stress of the fluids
    /// from their pressure; tells the first row that is at fault.
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
        for (body, rows) in bodies(&patch.block.columns[c.body][..n]) {
            let mut out = tensor_rows(&mut s, rows.clone());
            match &self.models[body] {
                Matter::Fluid(_) => {
                    let first = c.strength.filter(|_| self.flows[body].is_some());
                    let shear = first.map(|c| self.deviator(patch, c.deviator, rows.clone()));
                    for (k, r) in rows.enumerate() {
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
                Matter::Solid(solid) => {
                    let j = &patch.block.columns[c.jacobian];
                    let strain = self.strain(patch, rows.clone(), 0.0, j);
                    let (p, speed) = (&mut pressure[rows.clone()], &mut speed[rows.clone()]);
                    let told = solid.refresh(strain, out, p, speed);
                    if let (None, Some((row, what))) = (&found, told) {
                        found = Some((rows.start + row, what));
                    }
                }
            }
        }
        put_back(&mut patch.block.columns, stress, s);
        found
    }

    /// Energy of the own rows of solids after `dt` at the gradient in its columns, from the
    /// volume ratios `before` to those of now.
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
        // a scratch that is found anew before it is needed
        let mut work = std::mem::take(&mut patch.block.columns[c.stress_volume]);
        work.resize(n, 0.0);
        let column = |k: usize| &patch.block.columns[k][..n];
        let (mass, volume0, after) = (column(c.mass), column(c.volume0), column(c.jacobian));
        for (body, rows) in bodies(column(c.body)) {
            let Matter::Solid(solid) = &self.models[body] else { continue };
            let from = self.strain(patch, rows.clone(), 0.0, before);
            let to = self.strain(patch, rows.clone(), dt, after);
            solid.work(from, to, &volume0[rows.clone()], &mut work[rows.clone()]);
            for r in rows {
                let q = c.viscosity.map_or(0.0, |q| patch.block.columns[q][r]);
                energy[r] += (work[r] - q * (after[r] - before[r]) * volume0[r]) / mass[r];
            }
        }
        patch.block.columns[c.stress_volume] = work;
    }

    /// n.S n of a row, what it presses with along a normal [J].
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

    /// The internal force of all rows, f_i = sum S G_i, onto the nodes.
    pub(super) fn scatter_stress(&self, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Stepper<D>) {
            let c = &s.columns;
            let mut force: [Vec<f64>; D] = std::array::from_fn(|a| {
                std::mem::take(&mut patch.nodes.fields[s.fields.acceleration + a])
            });
            let column = |k: usize| &patch.block.columns[c.stress_volume + k][..];
            let (xx, yy, xy) = (column(0), column(1), column(2));
            for r in patch.runs.iter().cloned().flatten() {
                let row = patch.stencils.row::<K, D>(r);
                let (gx, gy) = (row.gradient(0), row.gradient(D - 1));
                for (a, [sx, sy]) in [[xx[r], xy[r]], [xy[r], yy[r]]].into_iter().enumerate() {
                    row.add(&mut force[a], gx, |g| g * sx);
                    row.add(&mut force[a], gy, |g| g * sy);
                }
                if s.axisymmetric {
                    let hoop = column(3)[r] / s.radius(patch, r);
                    row.add(&mut force[0], row.values, |n| n * hoop);
                }
            }
            for (a, force) in force.into_iter().enumerate() {
                patch.nodes.fields[s.fields.acceleration + a] = force;
            }
        }
        with_width!(patch.stencils.width, go(patch, self));
    }

    /// S : grad w of a row [J/s], w the nodal velocity in the fields `w`.
    #[inline(always)]
    pub(super) fn stress_power<const K: usize>(
        &self,
        patch: &Patch<D>,
        row: &Row<'_, K, D>,
        r: usize,
        w: impl Fn(usize, usize) -> [f64; K],
    ) -> f64 {
        let s = |k: usize| patch.block.columns[self.columns.stress_volume + k][r];
        let along = |a: usize, b: usize| row.sum(row.gradient(b), |line| w(a, line));
        let (x, y) = (0, D - 1);
        let plane = s(0) * along(x, x) + s(1) * along(y, y) + s(2) * (along(x, y) + along(y, x));
        match self.axisymmetric {
            true => plane + s(3) * row.sum(row.values, |line| w(x, line)) / self.radius(patch, r),
            false => plane,
        }
    }
}
