//! Relaxation of the pressure towards its projection on the grid, and of volumes towards the space
//! that there is.
//!
//! Updated-Lagrangian schemes leave a null space of stress: patterns of pressure that give no
//! nodal force and so are never damped. Each relaxation takes the fraction r of what the grid
//! cannot see. With the compliance w_p = V^2/(m (c^2 + (h D)^2) + S V) as the weight, P = sum_(l<4)
//! K^l P_L the nodal pressure by the series of four terms, u = K^3 P_L its last term and Pbar = N P,
//!
//! ```text
//! dV = r w_p (p - Pbar),  J += dV/V0
//! e += (-Pbar dV + r w_p (N(u P) - (N u) Pbar))/m
//! ```
//!
//! Volume and energy are kept exactly, and a material interface is no special case. p is the
//! pressure at the middle of the step. In a smooth flow w_p is -dV/dp of an isentrope; (h D)^2, D
//! the divergence and h a cell's edge, keeps it bounded at a strong shock's foot in a cold gas,
//! where neighbouring pressures differ by orders of magnitude and c^2 alone would move volumes
//! without bound, and S, 2^-30 of the scene's stiffness, where there is but rounding.
//!
//! Nothing ties the volume of a particle that has been sheared far to the space around it: J is the
//! integral of divergences that cancel in the mean only, and in an ideal gas the product p V of the
//! nodal force depends on the energy alone, so that volumes may drift without a force that would
//! bring them back. With Phi_i = sum V N/V_i the filled part of a node's volume and Phi_p = N Phi,
//!
//! ```text
//! J += r (1/Phi_p - 1) J
//! ```
//!
//! for particles all of whose nodes are filled, so that a free surface pulls on none. Energy,
//! momentum and mass are not touched.

use super::particle_update::bodies;
use super::{MOST_NODES, Stepper, with_width};
use crate::material::constitutive::Matter;
use crate::solver::patch::Patch;
use crate::solver::transfer::cut;

/// Terms of the projection's series.
pub const ORDER: u32 = 4;

/// Part of a node's volume from which it counts as filled: nodes beside a surface hold less.
const INNER: f64 = 0.8;

/// Share of a particle's greatest weight above which it counts as touching a node.
const TOUCHES: f64 = 1e-3;

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
            for (r, row) in run.clone().zip(patch.stencils.rows::<K, D>(run.clone())) {
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
            for (r, row) in patch.stencils.rows::<K, D>(0..n).enumerate() {
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

    /// Moves the volumes of the own rows of fluids towards the space that there is for them.
    pub(super) fn relax_volume(&self, patch: &mut Patch<D>, rate: f64) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Stepper<D>, rate: f64) {
            let c = &s.columns;
            let filled = &patch.nodes.fields[s.fields.volume][..];
            let mut j = std::mem::take(&mut patch.block.columns[c.jacobian]);
            let divergence = &patch.block.columns[c.gradient];
            for (body, rows) in bodies(&patch.block.columns[c.body][..j.len()]) {
                if matches!(s.models[body], Matter::Solid(_)) {
                    continue;
                }
                for r in rows {
                    let row = patch.stencils.row::<K, D>(r);
                    let values = row.values.as_flattened();
                    let touched = TOUCHES * values.iter().copied().fold(0.0, f64::max);
                    let mut least = f64::INFINITY;
                    for (line, values) in row.values.iter().enumerate() {
                        for (&n, &filled) in values.iter().zip(row.line(filled, line)) {
                            least = if n > touched { least.min(filled) } else { least };
                        }
                    }
                    // nothing drifts at rest, where patches may sleep
                    if least >= INNER && divergence[r] != 0.0 {
                        j[r] *= 1.0 + rate * (1.0 / row.dot(row.values, filled) - 1.0);
                    }
                }
            }
            patch.block.columns[c.jacobian] = j;
        }
        with_width!(patch.stencils.width, go(patch, self, rate));
    }
}
