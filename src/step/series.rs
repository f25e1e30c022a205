//! The nodal equations: filtered velocity, acceleration through the full mass matrix, and the
//! velocity whose gradient does the work.
//!
//! With the lumped masses m_i, the mass matrix M and K = 1 - m^-1 M, the series sum_(l<k) K^l
//! approximates (m^-1 M)^-1 (Nairn & Hammerquist 2021). Each product needs the finished values
//! of its neighbours' nodes, which the owners send; sums never cross a border.

use decomp::Parity;

use super::{Nodal, ODD, Stepper};
use crate::patch::Patch;
use crate::transfer::{Scheme, cut};

/// field = K field on the nodes that the patch computes; beyond them it is what the next exchange
/// makes of it.
fn apply_k(s: &Stepper, patch: &mut Patch<1>, field: usize) {
    let f = &s.fields;
    let [inverse, x, y] = patch.nodes.fields_mut([f.inverse, field, f.scratch]);
    patch.band.next_term(x, inverse, patch.active.clone(), y);
    // nodes without material hold zeros in both
    patch.nodes.fields.swap(field, f.scratch);
}

/// Adds one field to another.
fn accumulate(patch: &mut Patch<1>, sum: usize, term: usize) {
    let [sum, term] = patch.nodes.fields_mut([sum, term]);
    for (sum, term) in sum.iter_mut().zip(term) {
        *sum += *term;
    }
}

fn copy(patch: &mut Patch<1>, from: usize, to: usize) {
    let [from, to] = patch.nodes.fields_mut([from, to]);
    to.copy_from_slice(from);
}

impl Stepper {
    /// Takes nodes with little material out of a field: chi = 0 where the filled fraction of the
    /// node's volume is below the edge mask.
    fn mask(&self, patch: &mut Patch<1>, field: usize) {
        let Some(least) = self.edge_mask else { return };
        let [volume, values] = patch.nodes.fields_mut([self.fields.volume, field]);
        for (value, volume) in values.iter_mut().zip(volume) {
            if *volume < least {
                *value = 0.0;
            }
        }
    }

    /// From lumped velocity and force to velocity, acceleration and end-of-step velocity, halos
    /// included: v = sum_(l<k) K^l vL, b = sum_(l<k) t_l with t_0 = f/m and t_l = K chi t_(l-1),
    /// v' = v + dt b. Collective between neighbours.
    pub(super) fn solve_velocity(&self, nodal: &mut Nodal<'_>, dt: f64) {
        let f = &self.fields;
        let volume = (f.volume, Parity::Even);
        let sums = [(f.inverse, Parity::Even), (f.lumped, ODD), (f.acceleration, ODD), volume];
        nodal.refresh(if self.edge_mask.is_some() { &sums } else { &sums[..3] });
        let (order, force) = match self.scheme {
            Scheme::Series { order, force } => (order, force),
            Scheme::Blend(_) | Scheme::Affine => (1, false),
        };
        let term = f.scratch2;
        // each phase ends with the next term, which the exchange then completes
        let next_term = |patch: &mut Patch<1>| {
            apply_k(self, patch, f.remainder);
            if force {
                self.mask(patch, term);
                apply_k(self, patch, term);
            }
        };
        let advance = |patch: &mut Patch<1>| {
            let [v, b, star] =
                patch.nodes.fields_mut([f.velocity, f.acceleration, f.velocity_star]);
            for i in 0..v.len() {
                v[i] = cut(v[i], self.still_speed);
                star[i] = cut(v[i] + dt * b[i], self.still_speed);
            }
        };
        nodal.each("start series", |patch| {
            copy(patch, f.lumped, f.velocity);
            if matches!(self.scheme, Scheme::Series { .. }) {
                copy(patch, f.lumped, f.remainder);
                copy(patch, f.acceleration, term);
            }
            if order > 1 { next_term(patch) } else { advance(patch) }
        });
        for l in 1..order {
            match force {
                true => nodal.refresh(&[(f.remainder, ODD), (term, ODD)]),
                false => nodal.refresh(&[(f.remainder, ODD)]),
            }
            nodal.each("series", |patch| {
                accumulate(patch, f.velocity, f.remainder);
                if force {
                    accumulate(patch, f.acceleration, term);
                }
                if l + 1 < order { next_term(patch) } else { advance(patch) }
            });
        }
    }

    /// The velocity w with which f.w is the exact change of kinetic energy, so that the work
    /// done on the particles adds up with it to rounding. Collective between neighbours.
    ///
    /// Series: w = sum_(l<k) (chi K)^l (vL + A v')/2 (l = 0 alone where the force is lumped);
    /// blend: w = a vL + A ((1 - a) vL + dt b/2); A = m^-1 M.
    pub(super) fn solve_work(&self, nodal: &mut Nodal<'_>) {
        let f = &self.fields;
        match self.scheme {
            Scheme::Series { order, force } => {
                nodal.each("start work", |patch| {
                    let [inverse, star, lumped, y, w] = patch.nodes.fields_mut([
                        f.inverse,
                        f.velocity_star,
                        f.lumped,
                        f.scratch,
                        f.scratch2,
                    ]);
                    patch.band.product(star, patch.active.clone(), y);
                    for i in patch.active.clone() {
                        w[i] = 0.5 * (lumped[i] + inverse[i] * y[i]);
                    }
                });
                let terms = if force { order } else { 1 };
                for l in 0..terms {
                    nodal.refresh(&[(f.scratch2, ODD)]);
                    nodal.each("work", |patch| {
                        match l {
                            0 => copy(patch, f.scratch2, f.work),
                            _ => accumulate(patch, f.work, f.scratch2),
                        }
                        if l + 1 < terms {
                            apply_k(self, patch, f.scratch2);
                            self.mask(patch, f.scratch2);
                        }
                    });
                }
            }
            Scheme::Blend(a) => {
                nodal.each("work", |patch| {
                    let [lumped, star, x] =
                        patch.nodes.fields_mut([f.lumped, f.velocity_star, f.scratch2]);
                    for i in 0..x.len() {
                        x[i] = (1.0 - a) * lumped[i] + 0.5 * (star[i] - lumped[i]);
                    }
                    let [inverse, lumped, x, y, w] = patch
                        .nodes
                        .fields_mut([f.inverse, f.lumped, f.scratch2, f.scratch, f.work]);
                    patch.band.product(x, patch.active.clone(), y);
                    for i in patch.active.clone() {
                        w[i] = a * lumped[i] + inverse[i] * y[i];
                    }
                });
                nodal.refresh(&[(f.work, ODD)]);
            }
            Scheme::Affine => unreachable!("the scene check refuses compatible energy with APIC"),
        }
    }

    /// Lumped velocity through the series, halos included, for velocities that were mapped
    /// again within a step. Collective between neighbours.
    pub(super) fn filter_velocity(&self, nodal: &mut Nodal<'_>) {
        // no force: the acceleration's sums are zero
        self.solve_velocity(nodal, 0.0);
    }
}
