//! Nodal equations: filtered velocity, acceleration through the full mass matrix, projected
//! pressure, and the velocity whose gradient does the work.
//!
//! With the lumped masses m_i, the mass matrix M and K = 1 - m^-1 M, the series sum_(l<k) K^l
//! approximates (m^-1 M)^-1 (Nairn & Hammerquist 2021). With a K in place of K the matrix is
//! a M + (1 - a) m, between the full and the lumped one, as in the matched schemes of Krieg & Key
//! (1973): central differences in time make short waves too fast, lumped masses make them too slow.
//! Each product needs final values at
//! neighbour nodes, which their owners send; partial sums are never sent. Independent series
//! advance together, so that their terms share messages.

use std::ops::Range;

use decomp::Parity;
use smallvec::SmallVec;

use super::effect::Effects;
use super::exchange::Nodal;
use super::relaxation;
use super::scheme::Scheme;
use crate::solver::particle_weights::cut;
use crate::solver::patch::Patch;
use crate::transfer::VelocityUpdate;

/// Series s = sum_(l<order) t_l with t_l = a K t_(l-1), evaluated by Horner's rule, s' = t_0 + a K s:
/// one pass over the nodes per term. For a vector, one series per component, in consecutive fields.
#[derive(Clone, Copy)]
pub(super) struct ProductSeries {
    /// Field of the sum; initially t_0 on the nodes that the patch computes.
    pub(super) sum: usize,
    /// Field that keeps t_0.
    first: usize,
    /// Field for the last term, if it is needed: the change of the sum by the last product.
    last: Option<usize>,
    order: u32,
    matrix: Matrix,
    /// Share of the full matrix, a: the rest is its row sums [-].
    share: f64,
    mask: Mask,
}

/// Edge mask of a series.
#[derive(Clone, Copy, PartialEq)]
enum Mask {
    No,
    /// That of the force.
    Force,
    /// That of the work: the adjoint of the mask of the force.
    Work,
}

/// Matrix in K.
#[derive(Clone, Copy, PartialEq)]
enum Matrix {
    /// Mass matrix, for a vector.
    Mass,
    /// Compliance matrix, for a scalar.
    Compliance,
    /// Matrix of an effect, for a scalar: its number, and the field of its inverse row sums.
    Effect(usize, usize),
}

/// Series of a scalar with a matrix of an effect.
#[derive(Clone, Copy)]
pub struct ScalarSeries {
    /// Field of the sum; initially t_0 on the nodes that the patch computes.
    pub sum: usize,
    /// Field that keeps t_0.
    pub first: usize,
    /// Number of terms.
    pub order: u32,
    /// Number of the matrix.
    pub matrix: usize,
    /// Field of its inverse row sums.
    pub inverse: usize,
}

impl ProductSeries {
    /// Whether the series is of a scalar.
    pub(super) fn is_scalar(&self) -> bool {
        self.matrix != Matrix::Mass
    }

    /// The series of component `axis`.
    fn component(mut self, axis: usize) -> Self {
        self.sum += axis;
        self.first += axis;
        self.last = self.last.map(|l| l + axis);
        self
    }

    /// Series of all components, each with its parity in a mirror.
    fn components<const D: usize>(self) -> impl Iterator<Item = (Self, Parity)> {
        let scalar = self.is_scalar();
        let parity = move |axis| if scalar { Parity::Even } else { Parity::Odd(axis) };
        (0..if scalar { 1 } else { D }).map(move |axis| (self.component(axis), parity(axis)))
    }
}

/// Series with the same matrix, whose next terms are computed together.
struct Together {
    series: SmallVec<[ProductSeries; 2]>,
    /// Components of these series.
    vectors: SmallVec<[ProductSeries; 4]>,
    /// Number of terms after the pass.
    terms: u32,
}

impl Together {
    /// Series in `all` with at least `terms` terms, grouped by matrix.
    fn all<const D: usize>(all: &[ProductSeries], terms: u32) -> SmallVec<[Self; 2]> {
        let mut matrices: SmallVec<[Matrix; 2]> = SmallVec::new();
        for series in all {
            if !matrices.contains(&series.matrix) {
                matrices.push(series.matrix);
            }
        }
        let of = |matrix: Matrix| {
            let some = all.iter().filter(|s| s.matrix == matrix && s.order >= terms);
            let series: SmallVec<[ProductSeries; 2]> = some.copied().collect();
            let components = series.iter().flat_map(|s| s.components::<D>());
            Together { vectors: components.map(|(vector, _)| vector).collect(), series, terms }
        };
        let together = matrices.into_iter().map(of);
        together.filter(|together| !together.series.is_empty()).collect()
    }

    /// Whether this pass computes the last term of a series.
    fn ends(&self, series: &ProductSeries) -> bool {
        series.order == self.terms
    }
}

/// Last term of a series: the sum minus the previous sum, which is in `last`.
fn find_last<const D: usize>(patch: &mut Patch<D>, sum: usize, last: usize) {
    let [sum, last] = patch.nodes.fields_mut([sum, last]);
    for span in &patch.span_lines {
        for (sum, last) in sum[span.clone()].iter().zip(&mut last[span.clone()]) {
            *last = sum - *last;
        }
    }
}

/// Nodes that [`few_nodes`] tests at a time.
const TESTED: usize = 32;

/// Nodes in `lines` for whose values in two fields `holds` is true. The test has no branches, so
/// that many nodes are tested at a time: mostly it holds for none of them.
fn few_nodes<'a>(
    lines: &'a [Range<usize>],
    [first, second]: [&'a [f64]; 2],
    holds: impl Fn(f64, f64) -> bool + Copy + 'a,
) -> impl Iterator<Item = usize> + 'a {
    let parts = lines.iter().flat_map(|line| {
        let part = |start| start..line.end.min(start + TESTED);
        line.clone().step_by(TESTED).map(part)
    });
    let has_any = move |part: &Range<usize>| {
        let pairs = first[part.clone()].iter().zip(&second[part.clone()]);
        pairs.fold(false, |any, (a, b)| any | holds(*a, *b))
    };
    parts.filter(has_any).flatten().filter(move |&i| holds(first[i], second[i]))
}

fn copy<const D: usize>(patch: &mut Patch<D>, from: usize, to: usize) {
    if from != to {
        let [from, to] = patch.nodes.fields_mut([from, to]);
        to.copy_from_slice(from);
    }
}

impl<const D: usize> Scheme<D> {
    /// Lists the computed nodes that the edge mask removes, so that later passes need not search
    /// the fields: those of which the filled fraction of the volume is below the edge mask. Nodes
    /// without material hold zeros anyway.
    pub(super) fn find_edge(&self, patch: &mut Patch<D>) {
        let Some(least) = self.edge_mask else { return };
        let f = &self.fields;
        let [volume, inverse, edge] = patch.nodes.fields_mut([f.volume, f.inverse, f.edge]);
        let is_edge = |volume: f64, inverse: f64| (volume < least) & (inverse > 0.0);
        patch.edge.clear();
        patch.edge.extend(few_nodes(&patch.active_lines, [volume, inverse], is_edge));
        edge.fill(0.0);
        patch.edge.iter().for_each(|&i| edge[i] = 1.0);
    }

    /// Lists the nodes beside the edge, once the values of `edge` beyond the patch are known.
    fn find_beside_edge(&self, patch: &mut Patch<D>) {
        let mut product = [std::mem::take(&mut patch.nodes.fields[self.fields.scratch])];
        let fields = &patch.nodes.fields;
        let (edge, inverse) = (&fields[self.fields.edge], &fields[self.fields.inverse]);
        let context = patch.product_context();
        patch.mass_matrix.products::<D>(context, &[edge], &mut product);
        let [mut product] = product;
        let is_beside = |product: f64, edge: f64| (product > 0.0) & (edge == 0.0);
        let nodes = few_nodes(&patch.active_lines, [&product, edge], is_beside);
        let shares = nodes.map(|i| (i, product[i] * inverse[i]));
        patch.beside_edge.clear();
        patch.beside_edge.extend(shares.filter(|(_, share)| *share > 0.0));
        product.fill(0.0);
        patch.nodes.fields[self.fields.scratch] = product;
    }

    /// Masks the first term of a series.
    fn mask_first(&self, patch: &mut Patch<D>, series: &ProductSeries) {
        if series.order > 1 && (self.masks_pairs || series.mask == Mask::Force) {
            self.mask(patch, series, false);
        }
    }

    /// Masks a new sum of a series, the final one if it `ends`.
    fn mask_sum(&self, patch: &mut Patch<D>, series: &ProductSeries, ends: bool) {
        match (self.masks_pairs, series.mask) {
            (true, _) => self.mask(patch, series, ends),
            (false, Mask::Force) if ends => {}
            (false, mask) => self.mask(patch, series, mask == Mask::Work),
        }
    }

    /// Sets the nodes that the edge mask removes to t_0 in a sum if `keeps_first`, else to 0, so that
    /// the next product leaves them out.
    fn mask(&self, patch: &mut Patch<D>, series: &ProductSeries, keeps_first: bool) {
        if self.edge_mask.is_none() || series.mask == Mask::No {
            return;
        }
        for (series, _) in series.components::<D>() {
            let [sum, first] = patch.nodes.fields_mut([series.sum, series.first]);
            for &i in &patch.edge {
                sum[i] = if keeps_first { first[i] } else { 0.0 };
            }
        }
        if self.contact.is_some() {
            let first = keeps_first.then_some(series.first);
            patch.contact.mask(&mut patch.nodes.fields, first, series.sum);
        }
    }

    /// Takes the pairs with a node that the edge mask removes out of a new sum; `before` holds the
    /// previous one, and `full_share` is the share of the full matrix.
    pub(super) fn leave_edge_out(patch: &mut Patch<D>, sum: usize, before: usize, full_share: f64) {
        let [sum, before] = patch.nodes.fields_mut([sum, before]);
        for &(i, share) in &patch.beside_edge {
            sum[i] -= full_share * share * before[i];
        }
    }

    /// Sums of series of one matrix with one more term, on the nodes that the patch computes;
    /// values beyond come from the next exchange.
    fn next_sums(&self, patch: &mut Patch<D>, together: &Together) {
        match together.vectors[..] {
            [a] => self.next_terms(patch, [a]),
            [a, b] => self.next_terms(patch, [a, b]),
            [a, b, c, d] => self.next_terms(patch, [a, b, c, d]),
            _ => unreachable!("one or two series, of one or two components"),
        }
        for (vector, scratch) in together.vectors.iter().zip(self.fields.scratch..) {
            // nodes without material hold zeros in both fields
            patch.nodes.fields.swap(vector.sum, scratch);
            if vector.mask != Mask::No && self.masks_pairs {
                Self::leave_edge_out(patch, vector.sum, scratch, vector.share);
            }
            if let (true, Some(last)) = (together.ends(vector), vector.last) {
                patch.nodes.fields.swap(scratch, last);
            }
        }
        for series in &together.series {
            // bodies in contact share only velocity and pressure
            if self.contact.is_some() && !matches!(series.matrix, Matrix::Effect(..)) {
                self.join_series(patch, series, together.ends(series));
            }
            self.mask_sum(patch, series, together.ends(series));
        }
    }

    /// Next sums of series of one matrix, each vector into its own scratch field.
    fn next_terms<const V: usize>(&self, patch: &mut Patch<D>, all: [ProductSeries; V]) {
        let fields = &mut patch.nodes.fields;
        let mut next: [Vec<f64>; V] =
            decomp::array::from_fn(|v| std::mem::take(&mut fields[self.fields.scratch + v]));
        let fields = &patch.nodes.fields;
        let (x, t) = (all.map(|s| &fields[s.sum][..]), all.map(|s| &fields[s.first][..]));
        let (matrix, inverse) = match all[0].matrix {
            Matrix::Mass => (&patch.mass_matrix, self.fields.inverse),
            Matrix::Compliance => (&patch.compliance_matrix, self.fields.relaxation[1]),
            Matrix::Effect(number, inverse) => (&patch.matrices[number], inverse),
        };
        let shares = all.map(|s| s.share);
        let (context, inverse) = (patch.product_context(), &fields[inverse]);
        matrix.next_sums::<D, V>(context, x, inverse, t, shares, &mut next);
        for (v, next) in next.into_iter().enumerate() {
            patch.nodes.fields[self.fields.scratch + v] = next;
        }
    }

    /// Evaluates `all` series including halos, exchanges the halos of the fields `others` with
    /// them, then runs `last`. Collective between neighbours.
    fn sum_series(
        &self,
        nodal: &mut Nodal<'_, D>,
        effects: &Effects<D>,
        name: &'static str,
        others: &[(usize, Parity)],
        all: &[ProductSeries],
        last: impl Fn(&mut Patch<D>) + Send + Sync,
    ) {
        let rounds = all.iter().map(|s| s.order).max().unwrap_or(0);
        let mut next = Together::all::<D>(all, 2);
        for l in 0..rounds {
            let going = || all.iter().filter(move |s| s.order > l);
            let mut fields: SmallVec<[(usize, Parity); 8]> = SmallVec::new();
            fields.extend(others.iter().copied().filter(|_| l == 0));
            let components = going().flat_map(|s| s.components::<D>());
            fields.extend(components.map(|(s, parity)| (s.sum, parity)));
            nodal.refresh(&fields);
            let finished: SmallVec<[ProductSeries; 8]> = going()
                .filter(|s| s.order == l + 1)
                .flat_map(|s| s.components::<D>())
                .map(|(vector, _)| vector)
                .collect();
            nodal.each(name, |patch| {
                if l == 0 && others.contains(&(self.fields.edge, Parity::Even)) {
                    self.find_beside_edge(patch);
                }
                self.apply_no_slip(patch, &fields);
                effects.set_boundary(self, patch, &fields);
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
            // the same series in the next pass, but for those that have ended
            if all.iter().any(|s| s.order == l + 2) {
                next = Together::all::<D>(all, l + 3);
            } else {
                next.iter_mut().for_each(|together| together.terms += 1);
            }
        }
    }

    /// Evaluates a series of an effect including halos, exchanges the halos of the fields `others`
    /// with it, then runs `last`. Collective between neighbours.
    pub(crate) fn sum_scalar(
        &self,
        nodal: &mut Nodal<'_, D>,
        effects: &Effects<D>,
        name: &'static str,
        others: &[(usize, Parity)],
        series: ScalarSeries,
        last: impl Fn(&mut Patch<D>) + Send + Sync,
    ) {
        let ScalarSeries { sum, first, order, matrix, inverse } = series;
        let matrix = Matrix::Effect(matrix, inverse);
        let series =
            ProductSeries { sum, first, last: None, order, matrix, share: 1.0, mask: Mask::No };
        self.sum_series(nodal, effects, name, others, &[series], last);
    }

    /// Series of velocity and force: v = sum_(l<k) K^l vL; b = sum_(l<k) (a K')^l f/m with the edge
    /// mask in K' and the share a of the full mass matrix, or b = f/m if the scheme lumps the force.
    fn velocity_series(&self) -> [ProductSeries; 2] {
        let f = &self.fields;
        let (order, force_order) = (self.transfer.order, self.transfer.force_order());
        let velocity = ProductSeries {
            sum: f.velocity,
            first: f.lumped_velocity,
            // the heat of the filter is computed from it
            last: f.filter_residual,
            order,
            matrix: Matrix::Mass,
            share: 1.0,
            mask: Mask::No,
        };
        let force = ProductSeries {
            sum: f.acceleration,
            first: f.first,
            // a flux limiter acts on a line, friction of walls in a plane
            last: f.limiter.as_ref().map(|limiter| limiter.series).or(f.force_residual),
            order: force_order,
            share: self.full_share,
            mask: Mask::Force,
            ..velocity
        };
        [velocity, force]
    }

    /// First terms of the series of velocity and force: lumped velocity and f/m.
    pub(super) fn start_series(&self, patch: &mut Patch<D>) {
        let [velocity, force] = self.velocity_series();
        for axis in 0..D {
            let (velocity, force) = (velocity.component(axis), force.component(axis));
            copy(patch, velocity.first, velocity.sum);
            if force.order > 1 {
                copy(patch, force.sum, force.first);
            }
        }
        self.mask_first(patch, &force);
    }

    /// From the first terms of the series, computes velocity [m/s], acceleration b [m/s2] and the
    /// velocity at the end of the step v' = v + dt b, halos included; with `relax` also the nodal
    /// pressure [Pa]. Collective between neighbours.
    pub(super) fn solve_velocity(
        &self,
        nodal: &mut Nodal<'_, D>,
        effects: &Effects<D>,
        dt: f64,
        relax: bool,
    ) {
        let f = &self.fields;
        let mut all: SmallVec<[ProductSeries; 3]> = self.velocity_series().into_iter().collect();
        if relax {
            let [_, _, sum, first] = f.relaxation;
            all.push(ProductSeries {
                sum,
                first,
                last: Some(first),
                order: relaxation::ORDER,
                matrix: Matrix::Compliance,
                share: 1.0,
                mask: Mask::No,
            });
        }
        let mut others: SmallVec<[(usize, Parity); 8]> = SmallVec::new();
        others.push((f.inverse, Parity::Even));
        if self.edge_mask.is_some() && self.transfer.force_order() > 1 && self.masks_pairs {
            others.push((f.edge, Parity::Even));
        }
        others.extend(f.relaxed_ratio.filter(|_| relax).map(|ratio| (ratio, Parity::Even)));
        // particles compare their volumes with the space at all their nodes
        if self.volume_relaxation.is_some() {
            others.push((f.volume, Parity::Even));
        }
        others.extend(self.limiter_halos());
        let finish = |patch: &mut Patch<D>| self.finish_velocity(patch, dt);
        if f.limiter.is_none() {
            // the pressure series may have more terms than the velocity series
            return self.sum_series(nodal, effects, "series", &others, &all, finish);
        }
        self.sum_series(nodal, effects, "series", &others, &all, |_| {});
        self.limit_fluxes(nodal, effects, dt);
        nodal.each("limiter", finish);
    }

    /// Velocity at the end of the step from velocity and acceleration, and the start of the series of
    /// the work.
    fn finish_velocity(&self, patch: &mut Patch<D>, dt: f64) {
        let f = &self.fields;
        let still = self.quiescent_speed;
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
        // friction still changes the velocity at the end of the step
        if f.heat.is_none() {
            self.begin_work(patch);
        }
    }

    /// First term of the velocity that does the work, if the scheme needs it.
    pub(super) fn begin_work(&self, patch: &mut Patch<D>) {
        if self.compatible {
            self.start_work(patch);
            if self.contact.is_some() {
                self.join_work(patch);
            }
            self.mask_first(patch, &self.work_series());
        }
    }

    /// Start of [`solve_work`](Self::solve_work) on the nodes that the patch computes: (vL + A
    /// v')/2 with A = m^-1 M, or for a blend w itself.
    fn start_work(&self, patch: &mut Patch<D>) {
        match self.transfer.update {
            VelocityUpdate::Filtered => self.start_filtered_work(patch),
            VelocityUpdate::Blend(share) => {
                (0..D).for_each(|axis| self.blended_work(patch, axis, share));
            }
            VelocityUpdate::Affine => {
                unreachable!("the scene check refuses compatible energy with APIC")
            }
        }
    }

    fn start_filtered_work(&self, patch: &mut Patch<D>) {
        let f = &self.fields;
        let fields = &mut patch.nodes.fields;
        let mut work: [Vec<f64>; D] =
            decomp::array::from_fn(|a| std::mem::take(&mut fields[f.work + a]));
        let fields = &patch.nodes.fields;
        let star: [&[f64]; D] = decomp::array::from_fn(|a| &fields[f.velocity_star + a][..]);
        patch.mass_matrix.products::<D>(patch.product_context(), &star, &mut work);
        for (a, work) in work.into_iter().enumerate() {
            patch.nodes.fields[f.work + a] = work;
            let [inverse, lumped, w, first] =
                patch.nodes.fields_mut([f.inverse, f.lumped_velocity + a, f.work + a, f.first + a]);
            for line in &patch.active_lines {
                // slices of one length: no checks in the loop
                let [w, first] = [&mut *w, &mut *first].map(|field| &mut field[line.clone()]);
                let [lumped, inverse] = [&*lumped, &*inverse].map(|field| &field[line.clone()]);
                for i in 0..w.len() {
                    w[i] = 0.5 * (lumped[i] + inverse[i] * w[i]);
                }
                first.copy_from_slice(w);
            }
        }
    }

    fn blended_work(&self, patch: &mut Patch<D>, axis: usize, a: f64) {
        let f = &self.fields;
        let (star, lumped) = (f.velocity_star + axis, f.lumped_velocity + axis);
        let [lumped, star, x] = patch.nodes.fields_mut([lumped, star, f.first + axis]);
        for i in 0..x.len() {
            x[i] = (1.0 - a) * lumped[i] + 0.5 * (star[i] - lumped[i]);
        }
        let mut product = [std::mem::take(&mut patch.nodes.fields[f.work + axis])];
        let x = &patch.nodes.fields[f.first + axis][..];
        patch.mass_matrix.products::<D>(patch.product_context(), &[x], &mut product);
        let [product] = product;
        patch.nodes.fields[f.work + axis] = product;
        let [inverse, lumped, w] =
            patch.nodes.fields_mut([f.inverse, f.lumped_velocity + axis, f.work + axis]);
        for i in patch.active_lines.iter().cloned().flatten() {
            w[i] = a * lumped[i] + inverse[i] * w[i];
        }
    }

    /// The series of w.
    fn work_series(&self) -> ProductSeries {
        ProductSeries {
            sum: self.fields.work,
            first: self.fields.first,
            last: None,
            order: self.transfer.force_order(),
            matrix: Matrix::Mass,
            share: self.full_share,
            mask: Mask::Work,
        }
    }

    /// Velocity w for which f.w is the exact change of kinetic energy, so that the work on the
    /// particles and this change add up to rounding. Collective between neighbours.
    ///
    /// Series: w = sum_(l<k) (a K')^l (vL + A v')/2 (only l = 0 if the force is lumped);
    /// blend: w = a vL + A ((1 - a) vL + dt b/2); A = m^-1 M.
    pub(super) fn solve_work(&self, nodal: &mut Nodal<'_, D>, effects: &Effects<D>) {
        let series = self.work_series();
        let Some(limiter) = &self.fields.limiter else {
            return self.sum_series(nodal, effects, "work", &[], &[series], |_| {});
        };
        nodal.refresh(&[(series.sum, Parity::Odd(0))]);
        nodal.each("work", |patch| self.start_limited_work(patch, limiter));
        let rest = ProductSeries { order: series.order - 1, ..series };
        self.sum_series(nodal, effects, "work", &[], &[rest], |patch| {
            for span in patch.span_lines.clone() {
                let [work, first] = patch.nodes.fields_mut([series.sum, limiter.work]);
                for i in span {
                    work[i] += first[i];
                }
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_nodes_are_all_for_which_the_test_holds_within_the_lines() {
        let first: Vec<f64> = (0..200).map(f64::from).collect();
        let second: Vec<f64> = (0..200).map(|i| f64::from(i % 2)).collect();
        // the first line has a part without such nodes, the last one is shorter than a part
        let lines = [0..90, 100..100, 120..125];
        let wanted = [40.0, 42.0, 89.0, 95.0, 121.0, 123.0, 130.0];
        let holds = |a: f64, b: f64| wanted.contains(&a) & (b == 1.0);
        assert_eq!(few_nodes(&lines, [&first, &second], holds).collect::<Vec<_>>(), [89, 121, 123]);
    }
}
