//! The nodal equations: filtered velocity, acceleration through the full mass matrix, projected
//! pressure, and the velocity whose gradient does the work.
//!
//! With the lumped masses m_i, the mass matrix M and K = 1 - m^-1 M, the series sum_(l<k) K^l
//! approximates (m^-1 M)^-1 (Nairn & Hammerquist 2021). Each product needs the finished values
//! of its neighbours' nodes, which the owners send; sums never cross a border. Series that do not
//! need each other's results advance together, so that their terms travel together.

use decomp::Parity;
use smallvec::SmallVec;

use super::{Nodal, Stepper, conduction, relaxation};
use crate::solver::nodal_fields::ConductionFields;
use crate::solver::patch::Patch;
use crate::solver::transfer::{Scheme, cut};

/// A series s = sum_(l<order) t_l with t_l = K t_(l-1), summed up by Horner's rule,
/// s' = t_0 + K s: one pass over the nodes a term. A vector has one a component, in fields that
/// follow each other.
#[derive(Clone, Copy)]
pub(super) struct Series {
    /// The field of the sum; in the beginning t_0 on the nodes that the patch computes.
    pub(super) sum: usize,
    /// The field that keeps t_0.
    first: usize,
    /// Where the last term is wanted too, what the last product adds to the sum.
    last: Option<usize>,
    order: u32,
    matrix: Matrix,
    mask: Mask,
}

/// The matrix in K.
#[derive(Clone, Copy, PartialEq)]
enum Matrix {
    /// Of masses, for a vector.
    Mass,
    /// Of compliances, for a scalar.
    Compliance,
    /// Of heat capacities, for a scalar.
    Capacity,
}

impl Series {
    /// Whether it is of a scalar.
    pub(super) fn is_scalar(&self) -> bool {
        self.matrix != Matrix::Mass
    }

    /// The same for component `axis`.
    fn component(mut self, axis: usize) -> Self {
        self.sum += axis;
        self.first += axis;
        self.last = self.last.map(|l| l + axis);
        self
    }

    /// Its components and how each behaves in a mirror.
    fn components<const D: usize>(self) -> impl Iterator<Item = (Self, Parity)> {
        let scalar = self.is_scalar();
        let parity = move |axis| if scalar { Parity::Even } else { Parity::Odd(axis) };
        (0..if scalar { 1 } else { D }).map(move |axis| (self.component(axis), parity(axis)))
    }
}

/// Where nodes with little material are taken out: t_l = K chi t_(l-1), or chi K t_(l-1). A node
/// is taken out by the patch that computes it, before others see its value.
#[derive(Clone, Copy, PartialEq)]
enum Mask {
    No,
    Before,
    After,
}

/// Series of one matrix whose next terms are found together, so that it is looked up once.
struct Together {
    series: SmallVec<[Series; 2]>,
    /// Their components.
    vectors: SmallVec<[Series; 4]>,
    /// Terms that they have then.
    terms: u32,
}

impl Together {
    /// Those of `all` that have as many terms as `terms`, a matrix after the other.
    fn all<const D: usize>(all: &[Series], terms: u32) -> SmallVec<[Self; 2]> {
        let of = |matrix: Matrix| {
            let some = all.iter().filter(|s| s.matrix == matrix && s.order >= terms);
            let series: SmallVec<[Series; 2]> = some.copied().collect();
            let components = series.iter().flat_map(|s| s.components::<D>());
            Together { vectors: components.map(|(vector, _)| vector).collect(), series, terms }
        };
        let together = [Matrix::Mass, Matrix::Compliance, Matrix::Capacity].map(of);
        together.into_iter().filter(|together| !together.series.is_empty()).collect()
    }

    /// Whether these are the last terms of a series.
    fn ends(&self, series: &Series) -> bool {
        series.order == self.terms
    }
}

/// The last term of a series, from its sum and the sum before, which `last` holds.
fn find_last<const D: usize>(patch: &mut Patch<D>, sum: usize, last: usize) {
    let [sum, last] = patch.nodes.fields_mut([sum, last]);
    for span in &patch.span_lines {
        for (sum, last) in sum[span.clone()].iter().zip(&mut last[span.clone()]) {
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
    /// Notes the nodes that a patch computes and the mask takes out, so that no field has to be looked
    /// through: chi = 0 where the filled fraction of the node's volume is below the edge mask. Nodes
    /// without material hold zeros anyway.
    pub(super) fn find_edge(&self, patch: &mut Patch<D>) {
        let Some(least) = self.edge_mask else { return };
        let [volume, inverse] = patch.nodes.fields_mut([self.fields.volume, self.fields.inverse]);
        let nodes = patch.active_lines.iter().cloned().flatten();
        patch.edge.clear();
        patch.edge.extend(nodes.filter(|&i| volume[i] < least && inverse[i] > 0.0));
    }

    /// Takes nodes with little material out of a sum: what a product has just made becomes t_0 there,
    /// or 0.
    fn mask(&self, patch: &mut Patch<D>, series: &Series) {
        if self.edge_mask.is_none() {
            return;
        }
        for (series, _) in series.components::<D>() {
            let [sum, first] = patch.nodes.fields_mut([series.sum, series.first]);
            for &i in &patch.edge {
                sum[i] = if series.mask == Mask::After { first[i] } else { 0.0 };
            }
        }
        if self.contact.is_some() {
            let first = (series.mask == Mask::After).then_some(series.first);
            patch.contact.mask(&mut patch.nodes.fields, first, series.sum);
        }
    }

    /// The sums of series of one matrix with one more term, on the nodes that the patch computes;
    /// beyond them they are what the next exchange makes of them.
    fn next_sums(&self, patch: &mut Patch<D>, together: &Together) {
        match together.vectors[..] {
            [a] => self.next_terms(patch, [a]),
            [a, b] => self.next_terms(patch, [a, b]),
            [a, b, c, d] => self.next_terms(patch, [a, b, c, d]),
            _ => unreachable!("one or two series, of one or two components"),
        }
        for (vector, scratch) in together.vectors.iter().zip(self.fields.scratch..) {
            // nodes without material hold zeros in both
            patch.nodes.fields.swap(vector.sum, scratch);
            if let (true, Some(last)) = (together.ends(vector), vector.last) {
                patch.nodes.fields.swap(scratch, last);
            }
        }
        for series in &together.series {
            // bodies in contact exchange no heat
            if self.contact.is_some() && series.matrix != Matrix::Capacity {
                self.join_series(patch, series, together.ends(series));
            }
            // the sum itself is not masked, what the next product takes from it is
            let goes_on = !together.ends(series);
            if series.mask == Mask::After || (series.mask == Mask::Before && goes_on) {
                self.mask(patch, series);
            }
        }
    }

    /// The next sums of series of one matrix, one a vector, into as many scratches.
    fn next_terms<const V: usize>(&self, patch: &mut Patch<D>, all: [Series; V]) {
        let (band, inverse) = match all[0].matrix {
            Matrix::Mass => (&patch.band, self.fields.inverse),
            Matrix::Compliance => (&patch.compliance_band, self.fields.relaxation[1]),
            Matrix::Capacity => {
                let fields = self.fields.conduction.expect("the matrix comes with its fields");
                (&patch.capacity_band, fields.inverse)
            }
        };
        let fields = &mut patch.nodes.fields;
        let mut next: [Vec<f64>; V] =
            std::array::from_fn(|v| std::mem::take(&mut fields[self.fields.scratch + v]));
        let (x, t) = (all.map(|s| &fields[s.sum][..]), all.map(|s| &fields[s.first][..]));
        for line in &patch.active_lines {
            let y = next.each_mut().map(|y| &mut y[..]);
            band.next_sums(x, &fields[inverse], t, line.clone(), y);
        }
        for (v, next) in next.into_iter().enumerate() {
            fields[self.fields.scratch + v] = next;
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
            let components = going().flat_map(|s| s.components::<D>());
            fields.extend(components.map(|(s, parity)| (s.sum, parity)));
            nodal.refresh(&fields);
            let finished: SmallVec<[Series; 8]> = going()
                .filter(|s| s.order == l + 1)
                .flat_map(|s| s.components::<D>())
                .map(|(vector, _)| vector)
                .collect();
            let next = Together::all::<D>(all, l + 2);
            nodal.each(name, |patch| {
                self.hold(patch, &fields);
                if self.conduction.is_some() {
                    self.hold_temperature(patch, &fields);
                }
                for vector in &finished {
                    if let Some(last) = vector.last {
                        find_last(patch, vector.sum, last);
                    }
                }
                for together in &next {
                    self.next_sums(patch, together);
                }
                if l + 1 == rounds {
                    last(patch);
                }
            });
        }
    }

    /// The nodal temperature of `fields` projected, halos included, and then `last`. Collective
    /// between neighbours.
    pub(super) fn project_temperature(
        &self,
        nodal: &mut Nodal<'_, D>,
        fields: ConductionFields,
        last: impl Fn(&mut Patch<D>) + Send + Sync,
    ) {
        let series = Series {
            sum: fields.projected,
            first: fields.temperature,
            last: None,
            order: conduction::ORDER,
            matrix: Matrix::Capacity,
            mask: Mask::No,
        };
        let others = [(fields.inverse, Parity::Even), (fields.temperature, Parity::Even)];
        self.sum_series(nodal, "heat series", &others, &[series], last);
    }

    /// The series of velocity and force: v = sum_(l<k) K^l vL; b = sum_(l<k) t_l with t_0 = f/m
    /// and t_l = K chi t_(l-1), or b = f/m where the scheme lumps the force.
    fn velocity_series(&self) -> [Series; 2] {
        let f = &self.fields;
        let (order, force_order) = match self.scheme {
            Scheme::Series { order, force } => (order, if force { order } else { 1 }),
            Scheme::Blend(_) | Scheme::Affine => (1, 1),
        };
        let velocity = Series {
            sum: f.velocity,
            first: f.lumped,
            // what the filter's heat is counted from
            last: f.remainder,
            order,
            matrix: Matrix::Mass,
            mask: Mask::No,
        };
        let force = Series {
            sum: f.acceleration,
            first: f.first,
            last: None,
            order: force_order,
            mask: Mask::Before,
            ..velocity
        };
        [velocity, force]
    }

    /// The first terms of the series of velocity and force, from lumped velocity and f/m.
    pub(super) fn start_series(&self, patch: &mut Patch<D>) {
        let [velocity, force] = self.velocity_series();
        for axis in 0..D {
            let (velocity, force) = (velocity.component(axis), force.component(axis));
            copy(patch, velocity.first, velocity.sum);
            if force.order > 1 {
                copy(patch, force.sum, force.first);
            }
        }
        if force.order > 1 {
            self.mask(patch, &force);
        }
    }

    /// From the first terms of the series to velocity, acceleration and end-of-step velocity
    /// v' = v + dt b, halos included, and with `relax` to the nodal pressure as well. Collective
    /// between neighbours.
    pub(super) fn solve_velocity(&self, nodal: &mut Nodal<'_, D>, dt: f64, relax: bool) {
        let f = &self.fields;
        let mut all: SmallVec<[Series; 3]> = self.velocity_series().into_iter().collect();
        if relax {
            let [_, _, sum, first] = f.relaxation;
            all.push(Series {
                sum,
                first,
                last: Some(first),
                order: relaxation::ORDER,
                matrix: Matrix::Compliance,
                mask: Mask::No,
            });
        }
        let mut others: SmallVec<[(usize, Parity); 2]> = SmallVec::new();
        others.push((f.inverse, Parity::Even));
        // particles compare their volumes with the space at all of their nodes
        if self.volume_relaxation.is_some() {
            others.push((f.volume, Parity::Even));
        }
        // pressure may have more terms than velocity
        self.sum_series(nodal, "series", &others, &all, |patch| {
            let still = self.still_speed;
            for span in &patch.span_lines {
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
                if self.contact.is_some() {
                    self.join_work(patch);
                }
            }
        });
    }

    /// What [`solve_work`](Self::solve_work) starts from, on the nodes that the patch computes:
    /// (vL + A v')/2 with A = m^-1 M, or with a blend w itself.
    fn start_work(&self, patch: &mut Patch<D>, axis: usize) {
        let f = &self.fields;
        let (star, lumped) = (f.velocity_star + axis, f.lumped + axis);
        let (work, first) = (f.work + axis, f.first + axis);
        let lines = &patch.active_lines;
        match self.scheme {
            Scheme::Series { .. } => {
                let [inverse, star, lumped, w, first] =
                    patch.nodes.fields_mut([f.inverse, star, lumped, work, first]);
                w.fill(0.0);
                for line in lines {
                    patch.band.product(star, line.clone(), w);
                    for i in line.clone() {
                        w[i] = 0.5 * (lumped[i] + inverse[i] * w[i]);
                        first[i] = w[i];
                    }
                }
            }
            Scheme::Blend(a) => {
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
                    for i in line.clone() {
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
        let series = Series {
            sum: self.fields.work,
            first: self.fields.first,
            last: None,
            order,
            matrix: Matrix::Mass,
            mask: Mask::After,
        };
        self.sum_series(nodal, "work", &[], &[series], |_| {});
    }
}
