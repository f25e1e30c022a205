//! What strength adds to a step: the deviator of the stress, at its middle and at its end.
//!
//! ```text
//! s_h from s by dt/2 at the gradient of the last v'         S = (p + q) V 1 - s_h V
//! s' from s by dt at the gradient of the mean velocity      as rows gather
//! ```
//!
//! The energy that pressure at the middle of the step sees has the work of the shear up to there;
//! that of the whole step comes with S : grad w.

use std::ops::Range;

use super::gather::{put, tensor_of, trace};
use super::particle_update::bodies;
use super::{MOST_NODES, Stepper, with_width};
use crate::material::Symmetric;
use crate::material::constitutive::{DeviatorRows, FlowRows, RateRows, TensorRows};
use crate::material::strength::{Condition, Rate};
use crate::solver::patch::Patch;

/// Which gradient of the velocity rows are sheared by.
#[derive(Clone, Copy)]
enum By {
    /// That of the end of the last step.
    Last,
    /// That of the mean velocity of this one.
    Mean,
}

/// The double product of a stress and the rate of strain.
#[inline(always)]
fn power(stress: &Symmetric, rate: &Rate) -> f64 {
    let [xx, xy, yx, yy] = rate.plane;
    stress.along(&Symmetric { xx, yy, xy: 0.5 * (xy + yx), zz: rate.across })
}

impl<const D: usize> Stepper<D> {
    /// Columns of the deviator from `first` on.
    pub(super) fn deviator<'a>(
        &self,
        patch: &'a Patch<D>,
        first: usize,
        rows: Range<usize>,
    ) -> DeviatorRows<'a> {
        let column = |k: usize| &patch.block.columns[first + k][rows.clone()];
        DeviatorRows { xx: column(0), plane: (D > 1).then(|| [column(1), column(2)]) }
    }

    fn rate<'a>(&self, patch: &'a Patch<D>, by: By, rows: Range<usize>) -> RateRows<'a> {
        let c = &self.columns;
        let strength = c.strength.expect("a flow has the columns");
        let whole = c.velocity_gradient.unwrap_or(c.gradient);
        let (first, divergence) = match by {
            By::Last => (whole, c.gradient),
            By::Mean => (strength.rate, strength.rate + D * D),
        };
        let column = |k: usize| &patch.block.columns[k][rows.clone()];
        match (D, self.axisymmetric) {
            (1, _) => RateRows::Line(column(first)),
            (_, false) => RateRows::Plane(std::array::from_fn(|k| column(first + k))),
            (_, true) => {
                RateRows::Axis(std::array::from_fn(|k| column(first + k)), column(divergence))
            }
        }
    }

    /// What a row's strength depends on, at volume ratio `jacobian` and `pressure` [Pa].
    pub(super) fn condition(
        &self,
        patch: &Patch<D>,
        r: usize,
        jacobian: f64,
        pressure: f64,
    ) -> Condition {
        let temperature = self.columns.thermal.map_or(f64::NAN, |c| {
            // the row has been written: it is part of the state
            patch.block.columns[c.temperature][r]
        });
        Condition { compression: 1.0 / jacobian, pressure, temperature }
    }

    /// The gradient of the mean velocity at the own rows, into its columns.
    pub(super) fn gather_rate(&self, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Stepper<D>, first: usize) {
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
                |k: usize| std::array::from_fn::<&[f64], D, _>(|a| &patch.nodes.fields[k + a]);
            let (start, star) = (vector(s.fields.velocity), vector(s.fields.velocity_star));
            for r in 0..n {
                let row = patch.stencils.row::<K, D>(r);
                let mean = |a: usize, line: usize| -> [f64; K] {
                    let (v0, v1) = (row.line(start[a], line), row.line(star[a], line));
                    std::array::from_fn(|k| 0.5 * (v0[k] + v1[k]))
                };
                let rate = tensor_of(&row, mean);
                put(&mut out, 0, r, &rate);
                if let Some(divergence) = out.get_mut(D * D) {
                    divergence[r] = s.with_hoop(patch, &row, r, trace(&rate), |l| mean(0, l));
                }
            }
            for (k, column) in out.into_iter().enumerate() {
                patch.block.columns[first + k] = column;
            }
        }
        let Some(strength) = self.columns.strength else { return };
        with_width!(patch.stencils.width, go(patch, self, strength.rate));
    }

    /// Shears the own rows by `dt`: their new deviator goes to the columns of the stress, plastic
    /// strain and work to their scratch. What has failed bears no shear.
    fn flow(&self, patch: &mut Patch<D>, by: By, dt: f64, jacobian: usize) {
        let c = &self.columns;
        let (Some(strength), Some(stress)) = (c.strength, c.stress) else { return };
        let n = patch.block.own();
        let components = if D == 1 { 1 } else { 3 };
        let mut take = |k: usize| {
            let mut column = std::mem::take(&mut patch.block.columns[k]);
            column.resize(n, 0.0);
            column
        };
        let mut out: [Vec<f64>; 3] =
            std::array::from_fn(|k| if k < components { take(stress + k) } else { Vec::new() });
        let mut strain = take(strength.plastic_increment);
        let mut work = take(strength.plastic_work);
        for (body, rows) in bodies(&patch.block.columns[c.body][..n]) {
            let column = |k: usize| &patch.block.columns[k][rows.clone()];
            let Some(flow) = &self.flows[body] else {
                strain[rows.clone()].fill(0.0);
                work[rows.clone()].fill(0.0);
                continue;
            };
            let [xx, yy, xy] = &mut out;
            let plane = (D > 1).then(|| [&mut yy[rows.clone()], &mut xy[rows.clone()]]);
            flow.advance(FlowRows {
                dt,
                rate: self.rate(patch, by, rows.clone()),
                jacobian: column(jacobian),
                pressure: column(c.pressure),
                temperature: c.thermal.map(|c| column(c.temperature)),
                deviator: self.deviator(patch, strength.deviator, rows.clone()),
                plastic_strain: column(strength.plastic_strain),
                deviator_after: TensorRows { xx: &mut xx[rows.clone()], plane, across: None },
                plastic_strain_after: &mut strain[rows.clone()],
                plastic_work: &mut work[rows.clone()],
            });
            if let Some(failure) = c.failure {
                let (damage, before) = (column(failure.damage), column(strength.plastic_strain));
                for (k, r) in rows.clone().enumerate().filter(|(k, _)| damage[*k] >= 1.0) {
                    out[..components].iter_mut().for_each(|s| s[r] = 0.0);
                    (strain[r], work[r]) = (before[k], 0.0);
                }
            }
        }
        for (k, column) in out.into_iter().enumerate().take(components) {
            patch.block.columns[stress + k] = column;
        }
        patch.block.columns[strength.plastic_increment] = strain;
        patch.block.columns[strength.plastic_work] = work;
    }

    /// Adds the work of the shear over `dt` at volume ratio `jacobian`, from the deviator before
    /// to that in the columns of the stress, to `energy` [J/kg].
    fn add_shear_work(
        &self,
        patch: &Patch<D>,
        dt: f64,
        jacobian: impl Fn(usize) -> f64,
        energy: &mut [f64],
    ) {
        let c = &self.columns;
        let (Some(strength), Some(stress)) = (c.strength, c.stress) else { return };
        let n = patch.block.own();
        let column = |k: usize| &patch.block.columns[k][..n];
        let (mass, volume0) = (column(c.mass), column(c.volume0));
        for (body, rows) in bodies(column(c.body)) {
            if self.flows[body].is_none() {
                continue;
            }
            let rate = self.rate(patch, By::Last, rows.clone());
            let before = self.deviator(patch, strength.deviator, rows.clone());
            let after = self.deviator(patch, stress, rows.clone());
            for (k, r) in rows.enumerate() {
                let rate = rate.at(k);
                let both = power(&before.at(k), &rate) + power(&after.at(k), &rate);
                energy[r] += 0.5 * dt * both * volume0[r] * jacobian(r) / mass[r];
            }
        }
    }

    /// The deviator at the middle of the step, in the columns of the stress, and the energy there
    /// but for the work of pressure.
    pub(super) fn shear_to_middle(&self, patch: &mut Patch<D>, half: f64, mid: usize) {
        let Some(strength) = self.columns.strength else { return };
        self.flow(patch, By::Last, half, mid);
        let mut energy = std::mem::take(&mut patch.block.columns[strength.energy_mid]);
        energy.clear();
        energy.extend_from_slice(&patch.block.columns[self.columns.energy]);
        let jacobian = |r: usize| patch.block.columns[mid][r];
        self.add_shear_work(patch, half, jacobian, &mut energy);
        patch.block.columns[strength.energy_mid] = energy;
    }

    /// The deviator at the end of a mid-point step.
    pub(super) fn shear(&self, patch: &mut Patch<D>, dt: f64) {
        if self.columns.strength.is_some() {
            self.flow(patch, By::Mean, dt, self.columns.jacobian);
            self.keep_shear(patch);
        }
    }

    /// The deviator at the end of a leapfrog step from volume ratios `before`, and its work.
    pub(super) fn shear_and_heat(&self, patch: &mut Patch<D>, before: &[f64], dt: f64) {
        if self.columns.strength.is_none() {
            return;
        }
        let c = &self.columns;
        self.flow(patch, By::Last, dt, c.jacobian);
        let mut energy = std::mem::take(&mut patch.block.columns[c.energy]);
        let after = &patch.block.columns[c.jacobian];
        let middle = |r: usize| 0.5 * (before[r] + after[r]);
        self.add_shear_work(patch, dt, middle, &mut energy);
        patch.block.columns[c.energy] = energy;
        self.keep_shear(patch);
    }

    /// Takes over what [`Self::flow`] has found.
    fn keep_shear(&self, patch: &mut Patch<D>) {
        let c = &self.columns;
        let (Some(strength), Some(stress)) = (c.strength, c.stress) else { return };
        let n = patch.block.own();
        let all: Vec<_> = bodies(&patch.block.columns[c.body][..n]).collect();
        for (body, rows) in all {
            if self.flows[body].is_none() {
                continue;
            }
            let components = if D == 1 { 1 } else { 3 };
            let pairs = (0..components).map(|k| (stress + k, strength.deviator + k));
            for (from, to) in pairs {
                let [from, to] =
                    patch.block.columns.get_disjoint_mut([from, to]).expect("columns differ");
                to[rows.clone()].copy_from_slice(&from[rows.clone()]);
            }
            let [strain, increment] = patch
                .block
                .columns
                .get_disjoint_mut([strength.plastic_strain, strength.plastic_increment])
                .expect("columns differ");
            for r in rows.clone() {
                let after = increment[r];
                increment[r] = after - strain[r];
                strain[r] = after;
            }
            self.keep_heat(patch, body, rows);
        }
    }

    /// Sound speed of the own rows that shear: that of longitudinal waves.
    pub(super) fn stiffen(&self, patch: &Patch<D>, pressure: &[f64], speed: &mut [f64]) {
        let c = &self.columns;
        if c.strength.is_none() {
            return;
        }
        let n = patch.block.own();
        let column = |k: usize| &patch.block.columns[k][..n];
        let (mass, volume0, j) = (column(c.mass), column(c.volume0), column(c.jacobian));
        for (body, rows) in bodies(column(c.body)) {
            let Some(flow) = &self.flows[body] else { continue };
            for r in rows {
                let at = self.condition(patch, r, j[r], pressure[r]);
                let square = flow.shear_modulus(&at) * volume0[r] * j[r] / mass[r];
                speed[r] = (speed[r] * speed[r] + 4.0 / 3.0 * square).sqrt();
            }
        }
    }
}
