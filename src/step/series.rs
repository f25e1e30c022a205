//! The nodal equations: filtered velocity, acceleration through the full mass matrix, projected
//! pressure, and the velocity whose gradient does the work.
//!
//! With the lumped masses m_i, the mass matrix M and K = 1 - m^-1 M, the series sum_(l<k) K^l
//! approximates (m^-1 M)^-1 (Nairn & Hammerquist 2021). Each product needs the finished values
//! of its neighbours' nodes, which the owners send; sums never cross a border. Series that do not
//! need each other's results advance together, so that their terms travel together.

use decomp::Parity;
use smallvec::SmallVec;

use super::{Nodal, Stepper, relaxation};
use crate::patch::Patch;
use crate::transfer::{Scheme, cut};

/// A series s = sum_(l<order) t_l with t_l = K t_(l-1), summed up by Horner's rule,
/// s' = t_0 + K s: one pass over the nodes a term.
#[derive(Clone, Copy)]
struct Series {
    /// The field of the sum; in the beginning t_0 on the patch's own nodes.
    sum: usize,
    /// The field that keeps t_0.
    first: usize,
    /// Where the last term is wanted too, what the last product adds to the sum.
    last: Option<usize>,
    order: u32,
    matrix: Matrix,
    mask: Mask,
    parity: Parity,
}

/// The matrix in K.
#[derive(Clone, Copy)]
enum Matrix {
    Mass,
    Compliance,
}

/// Where nodes with little material are taken out: t_l = K chi t_(l-1), or chi K t_(l-1).
#[derive(Clone, Copy, PartialEq)]
enum Mask {
    No,
    Before,
    After,
}

/// The last term of a series, from its sum and the sum before, which `last` holds.
fn find_last<const D: usize>(patch: &mut Patch<D>, sum: usize, last: usize) {
    for span in patch.span_lines() {
        let [sum, last] = patch.nodes.fields_mut([sum, last]);
        for (sum, last) in sum[span.clone()].iter().zip(&mut last[span]) {
            *last = sum - *last;
        }
    }
}

fn copy<const D: usize>(patch: &mut Patch<D>, from: usize, to: usize) {
    if from != to {
        let [from, to] = patch.nodes.fields_mut([from, to]);
        to.copy_from_slice(from);
    }
}

impl<const D: usize> Stepper<D> {
    /// Takes nodes with little material out of a field: chi = 0 where the filled fraction of the
    /// node's volume is below the edge mask.
    fn mask(&self, patch: &mut Patch<D>, field: usize) {
        let Some(least) = self.edge_mask else { return };
        if !patch.has_edge {
            return;
        }
        let [volume, values] = patch.nodes.fields_mut([self.fields.volume, field]);
        for (value, volume) in values.iter_mut().zip(volume) {
            if *volume < least {
                *value = 0.0;
            }
        }
    }

    /// Notes whether a patch sees a node that the mask takes out: where none is, no field has to
    /// be looked through. Nodes without material hold zeros anyway.
    fn find_edge(&self, patch: &mut Patch<D>) {
        let Some(least) = self.edge_mask else { return };
        let [volume, inverse] = patch.nodes.fields_mut([self.fields.volume, self.fields.inverse]);
        patch.has_edge = volume.iter().zip(inverse).any(|(v, i)| *v < least && *i > 0.0);
    }

    /// The sum of a series with one more term, on the nodes that the patch computes; beyond them
    /// it is what the next exchange makes of it. `ends` tells that it is the last term.
    fn next_sum(&self, patch: &mut Patch<D>, series: &Series, ends: bool) {
        let Series { sum, first, .. } = *series;
        if series.mask == Mask::Before {
            self.mask(patch, sum);
        }
        let (band, inverse) = match series.matrix {
            Matrix::Mass => (&patch.band, self.fields.inverse),
            Matrix::Compliance => (&patch.compliance_band, self.fields.relaxation[1]),
        };
        let scratch = self.fields.scratch;
        let lines = patch.active_lines();
        let [inverse, x, t, y] = patch.nodes.fields_mut([inverse, sum, first, scratch]);
        lines.for_each(|line| band.next_sum(x, inverse, t, line, y));
        // nodes without material hold zeros in both
        patch.nodes.fields.swap(sum, scratch);
        if series.mask == Mask::After {
            self.mask_product(patch, series);
        }
        if let (true, Some(last)) = (ends, series.last) {
            patch.nodes.fields.swap(scratch, last);
        }
    }

    /// Takes nodes with little material out of what a product has just made: t_0 stays.
    fn mask_product(&self, patch: &mut Patch<D>, series: &Series) {
        let Some(least) = self.edge_mask.filter(|_| patch.has_edge) else { return };
        let lines = patch.active_lines();
        let [volume, sum, first] =
            patch.nodes.fields_mut([self.fields.volume, series.sum, series.first]);
        for i in lines.flatten() {
            if volume[i] < least {
                sum[i] = first[i];
            }
        }
    }

    /// Sums up `all` series, halos included, together with the halos of the fields `others`, and
    /// then runs `last`. Collective between neighbours.
    fn sum_series(
        &self,
        nodal: &mut Nodal<'_, D>,
        name: &'static str,
        others: &[(usize, Parity)],
        all: &[Series],
        last: impl Fn(&mut Patch<D>) + Send + Sync,
    ) {
        let rounds = all.iter().map(|s| s.order).max().unwrap_or(0);
        for l in 0..rounds {
            let going = || all.iter().filter(move |s| s.order > l);
            let mut fields: SmallVec<[(usize, Parity); 8]> = SmallVec::new();
            fields.extend(others.iter().copied().filter(|_| l == 0));
            fields.extend(going().map(|s| (s.sum, s.parity)));
            nodal.refresh(&fields);
            nodal.each(name, |patch| {
                if l == 0 && !others.is_empty() {
                    self.find_edge(patch);
                }
                for series in going() {
                    if l + 1 < series.order {
                        self.next_sum(patch, series, l + 2 == series.order);
                    } else if let Some(last) = series.last {
                        find_last(patch, series.sum, last);
                    }
                }
                if l + 1 == rounds {
                    last(patch);
                }
            });
        }
    }

    /// The series of a component of velocity and force: v = sum_(l<k) K^l vL; b = sum_(l<k) t_l
    /// with t_0 = f/m and t_l = K chi t_(l-1), or b = f/m where the scheme lumps the force.
    fn velocity_series(&self, axis: usize) -> [Series; 2] {
        let f = &self.fields;
        let (order, force_order) = match self.scheme {
            Scheme::Series { order, force } => (order, if force { order } else { 1 }),
            Scheme::Blend(_) | Scheme::Affine => (1, 1),
        };
        let velocity = Series {
            sum: f.velocity + axis,
            first: f.lumped + axis,
            // what the filter's heat is counted from
            last: f.remainder.map(|r| r + axis),
            order,
            matrix: Matrix::Mass,
            mask: Mask::No,
            parity: Parity::Odd(axis),
        };
        let force = Series {
            sum: f.acceleration + axis,
            first: f.first + axis,
            last: None,
            order: force_order,
            mask: Mask::Before,
            ..velocity
        };
        [velocity, force]
    }

    /// The first terms of the series of velocity and force, from lumped velocity and f/m.
    pub(super) fn start_series(&self, patch: &mut Patch<D>) {
        for axis in 0..D {
            let [velocity, force] = self.velocity_series(axis);
            copy(patch, velocity.first, velocity.sum);
            if force.order > 1 {
                copy(patch, force.sum, force.first);
            }
        }
    }

    /// From the first terms of the series to velocity, acceleration and end-of-step velocity
    /// v' = v + dt b, halos included, and with `relax` to the nodal pressure as well. Collective
    /// between neighbours.
    pub(super) fn solve_velocity(&self, nodal: &mut Nodal<'_, D>, dt: f64, relax: bool) {
        let f = &self.fields;
        let mut all: SmallVec<[Series; 5]> =
            (0..D).flat_map(|axis| self.velocity_series(axis)).collect();
        if relax {
            let [_, _, sum, first] = f.relaxation;
            all.push(Series {
                sum,
                first,
                last: Some(first),
                order: relaxation::ORDER,
                matrix: Matrix::Compliance,
                mask: Mask::No,
                parity: Parity::Even,
            });
        }
        let others = [(f.inverse, Parity::Even), (f.volume, Parity::Even)];
        let others = if self.edge_mask.is_some() { &others[..] } else { &others[..1] };
        // pressure may have more terms than velocity
        self.sum_series(nodal, "series", others, &all, |patch| {
            let still = self.still_speed;
            for span in patch.span_lines() {
                for a in 0..D {
                    let [v, b, star] = patch.nodes.fields_mut([
                        f.velocity + a,
                        f.acceleration + a,
                        f.velocity_star + a,
                    ]);
                    let (v, b, star) =
                        (&mut v[span.clone()], &b[span.clone()], &mut star[span.clone()]);
                    for i in 0..v.len() {
                        v[i] = cut(v[i], still);
                        star[i] = cut(v[i] + dt * b[i], still);
                    }
                }
            }
            if self.compatible {
                (0..D).for_each(|axis| self.start_work(patch, axis));
            }
        });
    }

    /// What [`solve_work`](Self::solve_work) starts from, on the nodes that the patch computes:
    /// (vL + A v')/2 with A = m^-1 M, or with a blend w itself.
    fn start_work(&self, patch: &mut Patch<D>, axis: usize) {
        let f = &self.fields;
        let (star, lumped) = (f.velocity_star + axis, f.lumped + axis);
        let (work, first) = (f.work + axis, f.first + axis);
        let lines = || patch.active.lines_in(&patch.nodes.nodes);
        match self.scheme {
            Scheme::Series { .. } => {
                let lines = lines();
                let [inverse, star, lumped, w, first] =
                    patch.nodes.fields_mut([f.inverse, star, lumped, work, first]);
                w.fill(0.0);
                for line in lines {
                    patch.band.product(star, line.clone(), w);
                    for i in line {
                        w[i] = 0.5 * (lumped[i] + inverse[i] * w[i]);
                        first[i] = w[i];
                    }
                }
            }
            Scheme::Blend(a) => {
                let lines = lines();
                let [lumped, star, x] = patch.nodes.fields_mut([lumped, star, first]);
                for i in 0..x.len() {
                    x[i] = (1.0 - a) * lumped[i] + 0.5 * (star[i] - lumped[i]);
                }
                let [inverse, lumped, x, y, w] = patch.nodes.fields_mut([
                    f.inverse,
                    f.lumped + axis,
                    f.first + axis,
                    f.scratch,
                    work,
                ]);
                w.fill(0.0);
                for line in lines {
                    patch.band.product(x, line.clone(), y);
                    for i in line {
                        w[i] = a * lumped[i] + inverse[i] * y[i];
                    }
                }
            }
            Scheme::Affine => unreachable!("the scene check refuses compatible energy with APIC"),
        }
    }

    /// The velocity w with which f.w is the exact change of kinetic energy, so that the work
    /// done on the particles adds up with it to rounding. Collective between neighbours.
    ///
    /// Series: w = sum_(l<k) (chi K)^l (vL + A v')/2 (l = 0 alone where the force is lumped);
    /// blend: w = a vL + A ((1 - a) vL + dt b/2); A = m^-1 M.
    pub(super) fn solve_work(&self, nodal: &mut Nodal<'_, D>) {
        let order = match self.scheme {
            Scheme::Series { order, force: true } => order,
            _ => 1,
        };
        let series: [Series; D] = std::array::from_fn(|axis| Series {
            sum: self.fields.work + axis,
            first: self.fields.first + axis,
            last: None,
            order,
            matrix: Matrix::Mass,
            mask: Mask::After,
            parity: Parity::Odd(axis),
        });
        self.sum_series(nodal, "work", &[], &series, |_| {});
    }
}
