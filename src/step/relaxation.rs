//! Relaxation of the pressure towards its projection on the grid.
//!
//! Updated-Lagrangian schemes leave a null space of stress: patterns of pressure that give no
//! nodal force and so are never damped. Each relaxation takes the fraction r of what the grid
//! cannot see. With the compliance w_p = -dV/dp = V^2/(m c^2) as the weight, P = sum_(l<4) K^l
//! P_L the nodal pressure by the series of four terms, u = K^3 P_L its last term and Pbar = N P,
//!
//! ```text
//! dV = r w_p (p - Pbar),  J += dV/V0
//! e += (-Pbar dV + r w_p (N(u P) - (N u) Pbar))/m
//! ```
//!
//! Volume and energy are kept exactly, and a material interface is no special case. p is the
//! pressure at the middle of the step.

use super::{MOST_NODES, Stepper, with_width};
use crate::patch::Patch;
use crate::transfer::cut;

/// Terms of the projection's series.
pub const ORDER: u32 = 4;

impl<const D: usize> Stepper<D> {
    /// The first term of the pressure's series, P_L, on the nodes that the patch computes.
    pub(super) fn start_pressure(&self, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Stepper<D>) {
            s.scatter_pressure::<K>(patch);
        }
        with_width!(patch.stencils.width, go(patch, self));
    }

    fn scatter_pressure<const K: usize>(&self, patch: &mut Patch<D>) {
        let [weight, inverse, sum, term] = self.fields.relaxation;
        let rows = patch.block.rows();
        let (Some(p), Some(w)) = (self.columns.pressure_mid, self.columns.compliance) else {
            return;
        };
        let (p, w) = (&patch.block.columns[p][..rows], &patch.block.columns[w][..rows]);
        let (nodes, stride) =
            (patch.nodes.layers * patch.nodes.nodes.count(), patch.nodes.nodes.extent(0));
        patch.compliance_band.clear(nodes, K, D, stride);
        let [weight, inverse, sum, term] = patch.nodes.fields_mut([weight, inverse, sum, term]);
        weight.fill(0.0);
        inverse.fill(0.0);
        term.fill(0.0);
        for run in &patch.runs {
            for r in run.clone() {
                let row = patch.stencils.row::<K, D>(r);
                let wp = w[r] * p[r];
                row.add(weight, row.values, |n| n * w[r]);
                row.add(term, row.values, |n| n * wp);
                patch.compliance_band.add(&row, w[r]);
            }
        }
        patch.compliance_band.finish();
        for i in patch.active_lines.iter().cloned().flatten() {
            inverse[i] = if weight[i] > 0.0 { 1.0 / weight[i] } else { 0.0 };
            term[i] = cut(term[i] * inverse[i], self.still_pressure);
        }
        if self.contact.is_some() {
            patch.contact.join_scalar(weight, term);
        }
        sum.copy_from_slice(term);
    }

    /// Moves volume and energy of the own rows.
    pub(super) fn relax_pressure(&self, patch: &mut Patch<D>, rate: f64) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Stepper<D>, rate: f64) {
            let [_, _, sum, term] = s.fields.relaxation;
            let c = &s.columns;
            let (Some(p), Some(w)) = (c.pressure_mid, c.compliance) else { return };
            let (projected, last) = (&patch.nodes.fields[sum][..], &patch.nodes.fields[term][..]);
            let n = patch.block.own();
            let [j, e, mass, volume0, p, w] =
                patch.block.columns_mut([c.jacobian, c.energy, c.mass, c.volume0, p, w]);
            for r in 0..n {
                let row = patch.stencils.row::<K, D>(r);
                let mean = row.dot(row.values, projected);
                let product = row.sum(row.values, |line| {
                    let (u, nodal) = (row.line(last, line), row.line(projected, line));
                    std::array::from_fn(|k| u[k] * nodal[k])
                });
                let share = rate * w[r];
                let dv = share * (p[r] - mean);
                j[r] += dv / volume0[r];
                e[r] +=
                    (share * (product - row.dot(row.values, last) * mean) - mean * dv) / mass[r];
            }
        }
        with_width!(patch.stencils.width, go(patch, self, rate));
    }
}
