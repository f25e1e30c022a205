//! Relaxation of the pressure towards its projection on the grid, and of particle volumes towards
//! the available space.
//!
//! Updated-Lagrangian schemes have a null space of stress: patterns of pressure that cause no nodal
//! force and so are never damped. Each relaxation removes the fraction r of the part that the grid
//! cannot represent. With the compliance w_p = V^2/(m (c^2 + (h D)^2) + S V), a reference ratio s_p
//! and the weights w_p/s_p, P = sum_(l<4) K^l P_L is the nodal pressure by the series of four
//! terms, u = K^3 P_L its last term and Pbar = N P; with the mean s_i of s_p on the grid and Y_i = s_i P_i
//!
//! ```text
//! dV = r w_p (p - Pbar)
//! e += (-(N Y) dV/s + r w_p/s (N(u Y) - (N u)(N Y)))/m
//! ```
//!
//! p is the pressure at the middle of the step. Energy is conserved exactly, and so is the sum of
//! dV/s; a material interface needs no special treatment.
//!
//! s is J: the volume of a particle grows by a factor, as the space around it does, so that a change
//! of ln J stays while a shock compresses both. The sum of V0 dln J is conserved, J multiplied by
//! exp(dV/V) to third order. Were the sum of dV conserved, the volume taken from a compressed
//! particle and given to one ahead would shrink in the shock, and particles would no longer tile the
//! space behind it: their pressure would be wrong by an amount that does not fall with the cells.
//! On a line in the total-Lagrangian frame volumes grow by sums: there s is 1 and the sum of dV is
//! conserved. So it is in scenes with gases: at their contact discontinuities J may jump by a factor
//! of 5, and s = J gives Sod's shock tube 15 % more error in density.
//!
//! r is `rate` in a step of Courant number 0.4 and in proportion to the length of shorter steps, so
//! that a result does not depend on the number of steps in which a shock crosses a cell. In longer
//! steps, which are less accurate, a larger r would only add to the error.
//!
//! In a smooth flow w_p is -dV/dp of an isentrope. The term (h D)^2, with the divergence D and the
//! cell edge h, keeps it bounded at the foot of a strong shock in a cold gas, where neighbouring
//! pressures differ by orders of magnitude and c^2 alone would change volumes without bound. S,
//! 2^-30 of the stiffness of the scene, keeps it bounded where pressures are only rounding errors.
//!
//! Nothing ties the volume of a strongly sheared particle to the space around it: J is the integral
//! of divergences that cancel only on average. In an ideal gas the product p V in the nodal force
//! depends only on the energy, so that volumes may drift without a restoring force. With
//! Phi_i = sum V N/V_i the filled fraction of a node's volume and Phi_p = N Phi,
//!
//! ```text
//! J += r (1/Phi_p - 1) J
//! ```
//!
//! for particles all of whose nodes are filled, so that a free surface has no effect. Energy,
//! momentum and mass do not change.

use std::ops::Range;

use decomp::array::{from_fn, map, part, part_mut};
use wide::f64x4;

use super::nodal_matrix::NodalMatrix;
use super::nodal_sums::BLOCK;
use super::particle_update::bodies;
use super::scheme::Scheme;
use crate::material::constitutive::ConstitutiveModel;
use crate::shape::{LANES, fours, with_width};
use crate::solver::clock::timed;
use crate::solver::packed::{WindowPlace, add_to, dot, totals, with_packed};
use crate::solver::particle_weights::{NARROW, ParticleWeights, cut};
use crate::solver::parts::StepPart;
use crate::solver::patch::Patch;
use crate::solver::shape_weights::Stencils;

/// Number of terms in the series of the projection.
pub const ORDER: u32 = 4;

/// Fraction of a node's volume above which the node counts as filled: nodes at a surface hold less.
const INNER: f64 = 0.8;

/// Fraction of a particle's greatest weight above which it counts as touching a node.
const TOUCHES: f64 = 1e-3;

/// Columns of all particles, ghosts included, that the projection of the pressure reads.
struct ProjectedColumns<'a> {
    /// Pressure [Pa].
    pressure: &'a [f64],
    /// Compliance w [m3/Pa].
    compliance: &'a [f64],
    /// Volume ratio s [-], if weights are relative to the current volume.
    ratio: Option<&'a [f64]>,
}

/// Nodal sums of the relaxation: weights, weights times pressure, and weights times volume ratio, if
/// weights are relative to the current volume.
struct PressureSums<'a> {
    weight: &'a mut [f64],
    pressure: &'a mut [f64],
    ratio: Option<&'a mut [f64]>,
}

impl PressureSums<'_> {
    /// Adds a particle with a `share`, a `pressure` and a `compliance`.
    #[inline(always)]
    fn add<const K: usize, const D: usize>(
        &mut self,
        weights: &ParticleWeights<'_, K, D>,
        [share, pressure, compliance]: [f64; 3],
    ) {
        if let Some(ratio) = &mut self.ratio {
            weights.add(ratio, weights.values, |n| n * compliance);
        }
        let product = share * pressure;
        weights.add(self.weight, weights.values, |n| n * share);
        weights.add(self.pressure, weights.values, |n| n * product);
    }

    /// Adds particles with the same window; `shares` are the weights of all particles.
    #[inline(always)]
    fn add_group<const K: usize, const V: usize, const D: usize>(
        &mut self,
        stencils: &Stencils,
        group: Range<usize>,
        (of, shares): (&ProjectedColumns<'_>, &[f64]),
    ) {
        let place = stencils.place(group.start);
        let mut weight = place.nodes::<K, V>(self.weight);
        let mut pressure = place.nodes::<K, V>(self.pressure);
        let mut ratio = pressure;
        if let Some(field) = &self.ratio {
            ratio = place.nodes::<K, V>(field);
        }
        for r in group {
            let (values, share) = (stencils.packed_values::<K, V, D>(r), shares[r]);
            add_to(&mut weight, &values, share);
            add_to(&mut pressure, &values, share * of.pressure[r]);
            add_to(&mut ratio, &values, of.compliance[r]);
        }
        place.put::<K, V>(self.weight, &weight);
        place.put::<K, V>(self.pressure, &pressure);
        if let Some(field) = &mut self.ratio {
            place.put::<K, V>(field, &ratio);
        }
    }
}

/// Adds particles one by one to the sums and to the matrix.
#[inline(always)]
fn add_particles<const K: usize, const D: usize>(
    stencils: &Stencils,
    particles: Range<usize>,
    matrix: &mut NodalMatrix,
    of: &ProjectedColumns<'_>,
    sums: &mut PressureSums<'_>,
) {
    // empty if weights are not relative to the current volume
    let ratio = of.ratio.map_or(&[][..], |ratio| &ratio[particles.clone()]);
    let pressures = of.pressure[particles.clone()].iter();
    let columns = pressures.zip(&of.compliance[particles.clone()]).enumerate();
    for ((k, (&pressure, &compliance)), weights) in
        columns.zip(stencils.particles::<K, D>(particles))
    {
        let share = ratio.get(k).map_or(compliance, |ratio| compliance / ratio);
        sums.add(&weights, [share, pressure, compliance]);
        matrix.add(&weights, share);
    }
}

/// Nodal fields of the relaxation that a particle takes.
#[derive(Clone, Copy)]
struct Projected<'a> {
    /// Projected pressure P and the last term of its series u [Pa].
    pressure: &'a [f64],
    last: &'a [f64],
    /// Mean volume ratio s, if weights are relative to the current volume.
    ratio: Option<&'a [f64]>,
}

/// Sums at one particle: N P, N s P, N u, N (u s P).
type ProjectedSums = [f64; 4];

impl Projected<'_> {
    /// Sums over a window of any width, on a line over four nodes in vectors; `RATIO` says whether there
    /// is a volume ratio.
    #[inline(always)]
    fn sums<const K: usize, const D: usize, const RATIO: bool>(
        &self,
        weights: &ParticleWeights<'_, K, D>,
    ) -> ProjectedSums {
        if const { D == 1 && K == NARROW } {
            let nodes = |field: &[f64]| fours(weights.line(field, 0), 0);
            let (n, pressure, last) =
                (fours(&weights.values[0], 0), nodes(self.pressure), nodes(self.last));
            let work = self.ratio.filter(|_| RATIO).map_or(pressure, |r| nodes(r) * pressure);
            return totals::<K>([n * pressure, n * work, n * last, n * (last * work)]);
        }
        let n = weights.values;
        // work of a change of volume: P, or the product of P and s
        let work = |line: usize| -> [f64; K] {
            let nodal = weights.line(self.pressure, line);
            let Some(ratio) = self.ratio.filter(|_| RATIO) else { return *nodal };
            let ratio = weights.line(ratio, line);
            from_fn(|k| ratio[k] * nodal[k])
        };
        let product = weights.sum(n, |line| {
            let (u, work) = (weights.line(self.last, line), work(line));
            from_fn(|k| u[k] * work[k])
        });
        [weights.dot(n, self.pressure), weights.sum(n, work), weights.dot(n, self.last), product]
    }

    /// P, s P, u and u s P on a window in vectors.
    #[inline(always)]
    fn fetch<const K: usize, const V: usize, const D: usize>(
        &self,
        place: WindowPlace,
    ) -> [[f64x4; V]; 4] {
        let pressure = place.nodes::<K, V>(self.pressure);
        let last = place.nodes::<K, V>(self.last);
        let (mut work, mut product) = (pressure, last);
        if let Some(ratio) = self.ratio {
            let ratio = place.nodes::<K, V>(ratio);
            (0..V).for_each(|l| work[l] = ratio[l] * pressure[l]);
        }
        (0..V).for_each(|l| product[l] = last[l] * work[l]);
        [pressure, work, last, product]
    }
}

/// Columns of the own particles that the relaxation of the pressure reads or writes.
struct RelaxedColumns<'a> {
    /// Volume ratio [-].
    j: &'a mut [f64],
    /// Specific internal energy [J/kg].
    e: &'a mut [f64],
    /// Mass [kg].
    mass: &'a [f64],
    /// Volume at J = 1 [m3].
    volume0: &'a [f64],
    /// Pressure [Pa].
    p: &'a [f64],
    /// Compliance [m3/Pa].
    w: &'a [f64],
    /// Volume ratio at the middle of the step [-], if weights are relative to the current volume.
    j_mid: Option<&'a [f64]>,
    /// Rate r of this step [-].
    rate: f64,
}

impl RelaxedColumns<'_> {
    /// The columns of `count` particles from `first` on.
    #[inline(always)]
    fn part(&mut self, first: usize, count: usize) -> RelaxedColumns<'_> {
        let these = first..first + count;
        RelaxedColumns {
            j: &mut self.j[these.clone()],
            e: &mut self.e[these.clone()],
            mass: &self.mass[these.clone()],
            volume0: &self.volume0[these.clone()],
            p: &self.p[these.clone()],
            w: &self.w[these.clone()],
            j_mid: self.j_mid.map(|j_mid| &j_mid[these]),
            rate: self.rate,
        }
    }

    /// Relaxes the particles with their sums.
    #[inline(always)]
    fn update(&mut self, sums: &[[f64; 4]]) {
        let (whole, rest) = sums.as_chunks::<LANES>();
        for (k, four) in whole.iter().enumerate() {
            let columns = f64x4::transpose(map(four, f64x4::from));
            self.update_some(LANES * k, &map(&columns, |sums: f64x4| sums.to_array()));
        }
        for (k, one) in rest.iter().enumerate() {
            self.update_some(LANES * whole.len() + k, &map(one, |sum| [sum]));
        }
    }

    /// [`Self::update`] for fewer particles than a block.
    #[inline(never)]
    fn update_last(&mut self, sums: &[[f64; 4]]) {
        self.update(sums);
    }

    /// Relaxes `L` particles from `r` on with their sums.
    #[inline(always)]
    fn update_some<const L: usize>(&mut self, r: usize, sums: &[[f64; L]; 4]) {
        let [mean, mean_work, last, product] = sums;
        let [w, p, volume0, mass] =
            map(&[self.w, self.p, self.volume0, self.mass], |column| *part::<L>(column, r));
        // r w/s
        let relaxed: [f64; L] = match self.j_mid {
            Some(j_mid) => {
                let j_mid = part::<L>(j_mid, r);
                from_fn(|i| self.rate * w[i] / j_mid[i])
            }
            None => from_fn(|i| self.rate * w[i]),
        };
        let change: [f64; L] = from_fn(|i| relaxed[i] * (p[i] - mean[i]) / volume0[i]);
        let j = part_mut::<L>(self.j, r);
        *j = match self.j_mid {
            Some(_) => from_fn(|i| j[i] * ((1.0 + 0.5 * change[i]) / (1.0 - 0.5 * change[i]))),
            None => from_fn(|i| j[i] + change[i]),
        };
        let e = part_mut::<L>(self.e, r);
        *e = from_fn(|i| {
            let work = relaxed[i] * (product[i] - last[i] * mean_work[i]);
            e[i] + (work - mean_work[i] * change[i] * volume0[i]) / mass[i]
        });
    }
}

impl<const D: usize> Scheme<D> {
    /// First term of the series of the pressure, P_L, on the nodes that the patch computes.
    pub(super) fn start_pressure(&self, patch: &mut Patch<D>) {
        fn packed<const K: usize, const V: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
        ) {
            s.scatter_pressure::<K>(patch, |stencils, _, matrix, of, sums| {
                for group in &stencils.groups {
                    let (count, particles) = (group.packed_count(), group.particles());
                    if count == 0 {
                        add_particles::<K, D>(stencils, particles, matrix, of, sums);
                    } else {
                        // in a plane the matrix has the weights
                        let of = (of, &matrix.particles.weights[..]);
                        sums.add_group::<K, V, D>(stencils, particles, of);
                    }
                }
            });
        }
        fn single<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Scheme<D>) {
            s.scatter_pressure::<K>(patch, |stencils, runs, matrix, of, sums| {
                for run in runs {
                    add_particles::<K, D>(stencils, run.clone(), matrix, of, sums);
                }
            });
        }
        let width = patch.stencils.width;
        with_packed!(width, packed(patch, self), with_width!(width, single(patch, self)));
    }

    /// The same with the sums over the particles by `add`, in windows of `K` nodes along each
    /// direction.
    #[inline(always)]
    fn scatter_pressure<const K: usize>(
        &self,
        patch: &mut Patch<D>,
        add: impl FnOnce(
            &Stencils,
            &[Range<usize>],
            &mut NodalMatrix,
            &ProjectedColumns<'_>,
            &mut PressureSums<'_>,
        ),
    ) {
        let [weight, inverse, sum, term] = self.fields.relaxation;
        let particles = patch.block.particles();
        let (Some(p), Some(w)) = (self.columns.pressure_mid, self.columns.compliance) else {
            return;
        };
        let column = |k: usize| &patch.block.columns[k][..particles];
        let (pressure, compliance) = (column(p), column(w));
        let j_mid = self.fields.relaxed_ratio.and(self.columns.jacobian_mid).map(column);
        let of = ProjectedColumns { pressure, compliance, ratio: j_mid };
        let mut ratio = self.fields.relaxed_ratio.map(|field| {
            let mut ratio = std::mem::take(&mut patch.nodes.fields[field]);
            ratio.fill(0.0);
            ratio
        });
        let nodes = patch.nodes.layers * patch.nodes.nodes.count();
        let matrix = &mut patch.compliance_matrix;
        match j_mid {
            Some(ratio) => {
                let shares = compliance.iter().zip(ratio).map(|(w, ratio)| w / ratio);
                matrix.start::<K, D>(nodes, shares);
            }
            None => matrix.start::<K, D>(nodes, compliance.iter().copied()),
        }
        let [weight, inverse, sum, term] = patch.nodes.fields_mut([weight, inverse, sum, term]);
        weight.fill(0.0);
        inverse.fill(0.0);
        term.fill(0.0);
        let mut sums = PressureSums { weight, pressure: term, ratio: ratio.as_deref_mut() };
        add(&patch.stencils, &patch.runs, &mut patch.compliance_matrix, &of, &mut sums);
        patch.compliance_matrix.finish::<D>();
        for line in &patch.active_lines {
            let (inverse, term) = (&mut inverse[line.clone()], &mut term[line.clone()]);
            for ((inverse, term), &weight) in
                inverse.iter_mut().zip(term).zip(&weight[line.clone()])
            {
                *inverse = if weight > 0.0 { 1.0 / weight } else { 0.0 };
                *term = cut(*term * *inverse, self.still_pressure);
            }
            if let Some(ratio) = &mut ratio {
                let ratio = &mut ratio[line.clone()];
                ratio.iter_mut().zip(inverse).for_each(|(ratio, inverse)| *ratio *= *inverse);
            }
        }
        if self.contact.is_some() {
            patch.contact.join_scalar(weight, term);
            if let Some(ratio) = &mut ratio {
                patch.contact.join_scalar(weight, ratio);
            }
        }
        sum.copy_from_slice(term);
        if let (Some(ratio), Some(field)) = (ratio, self.fields.relaxed_ratio) {
            patch.nodes.fields[field] = ratio;
        }
    }

    /// Relaxes the pressure of the own particles at the rate `pressure` [-], if this step relaxes,
    /// then their volumes.
    pub(super) fn relax(&self, patch: &mut Patch<D>, pressure: Option<f64>) {
        if pressure.is_none() && self.volume_relaxation.is_none() {
            return;
        }
        timed(StepPart::Relaxation as usize, patch, |patch| {
            if let Some(rate) = pressure {
                self.relax_pressure(patch, rate);
            }
            if let Some(rate) = self.volume_relaxation {
                self.relax_volume(patch, rate);
            }
        });
    }

    /// Relaxes volume and energy of the own particles.
    fn relax_pressure(&self, patch: &mut Patch<D>, rate: f64) {
        fn packed<const K: usize, const V: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            rate: f64,
        ) {
            let (mut window, mut at) = ([[f64x4::ZERO; V]; 4], u32::MAX);
            patch.with_stencils(|patch, stencils| {
                s.relax_particles(patch, rate, |r, nodal| {
                    if !stencils.is_narrow::<K>(r) {
                        let weights = stencils.particle::<K, D>(r);
                        return match nodal.ratio {
                            Some(_) => nodal.sums::<K, D, true>(&weights),
                            None => nodal.sums::<K, D, false>(&weights),
                        };
                    }
                    if stencils.first[r] != at {
                        at = stencils.first[r];
                        window = nodal.fetch::<K, V, D>(stencils.place(r));
                    }
                    let values = stencils.packed_values::<K, V, D>(r);
                    totals::<K>(from_fn(|k| dot(&values, &window[k])))
                });
            });
        }
        fn with_ratio<const K: usize, const D: usize, const RATIO: bool>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            rate: f64,
        ) {
            patch.with_stencils(|patch, stencils| {
                let mut all = stencils.particles::<K, D>(0..patch.block.own());
                s.relax_particles(patch, rate, |_, nodal| {
                    nodal.sums::<K, D, RATIO>(&all.next().expect("those of each own particle"))
                });
            });
        }
        fn single<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Scheme<D>, rate: f64) {
            match s.fields.relaxed_ratio {
                Some(_) => with_ratio::<K, D, true>(patch, s, rate),
                None => with_ratio::<K, D, false>(patch, s, rate),
            }
        }
        let width = patch.stencils.width;
        with_packed!(
            width,
            packed(patch, self, rate),
            with_width!(width, single(patch, self, rate))
        );
    }

    /// The same with the `sums` over the nodes of each particle, asked for in their order by the index.
    #[inline(always)]
    fn relax_particles(
        &self,
        patch: &mut Patch<D>,
        rate: f64,
        mut sums: impl FnMut(usize, &Projected<'_>) -> ProjectedSums,
    ) {
        let [_, _, sum, term] = self.fields.relaxation;
        let c = &self.columns;
        let (Some(p), Some(w), Some(mid)) = (c.pressure_mid, c.compliance, c.jacobian_mid) else {
            return;
        };
        let fields = &patch.nodes.fields;
        let nodal = Projected {
            pressure: &fields[sum],
            last: &fields[term],
            ratio: self.fields.relaxed_ratio.map(|ratio| &fields[ratio][..]),
        };
        let n = patch.block.own();
        let columns = [c.jacobian, c.energy, c.mass, c.volume0, p, w, mid];
        let [j, e, mass, volume0, p, w, mid] =
            patch.block.columns_mut(columns).map(|column| &mut column[..n]);
        let j_mid = nodal.ratio.map(|_| &*mid);
        let mut all = RelaxedColumns { j, e, mass, volume0, p, w, j_mid, rate };
        let mut block = [[0.0; 4]; BLOCK];
        for first in (0..n).step_by(BLOCK) {
            let count = BLOCK.min(n - first);
            let particles = first..first + count;
            block.iter_mut().zip(particles).for_each(|(one, r)| *one = sums(r, &nodal));
            match count {
                // with a length known at compile time the compiler removes the bounds checks
                BLOCK => all.part(first, BLOCK).update(&block),
                _ => all.part(first, count).update_last(&block[..count]),
            }
        }
    }

    /// Relaxes the volumes of the own particles of fluids towards the space available to them.
    fn relax_volume(&self, patch: &mut Patch<D>, rate: f64) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Scheme<D>, rate: f64) {
            let c = &s.columns;
            let filled = &patch.nodes.fields[s.fields.volume][..];
            let mut j = std::mem::take(&mut patch.block.columns[c.jacobian]);
            let divergence = &patch.block.columns[c.divergence];
            for (body, particles) in bodies(&patch.block.columns[c.body][..j.len()]) {
                if matches!(s.models[body], ConstitutiveModel::Solid(_)) {
                    continue;
                }
                for r in particles {
                    let weights = patch.stencils.particle::<K, D>(r);
                    let values = weights.values.as_flattened();
                    let touched = TOUCHES * values.iter().copied().fold(0.0, f64::max);
                    let mut least = f64::INFINITY;
                    for (line, values) in weights.values.iter().enumerate() {
                        for (&n, &filled) in values.iter().zip(weights.line(filled, line)) {
                            least = if n > touched { least.min(filled) } else { least };
                        }
                    }
                    // there is no drift at rest, where patches may be quiescent
                    if least >= INNER && divergence[r] != 0.0 {
                        j[r] *= 1.0 + rate * (1.0 / weights.dot(weights.values, filled) - 1.0);
                    }
                }
            }
            patch.block.columns[c.jacobian] = j;
        }
        with_width!(patch.stencils.width, go(patch, self, rate));
    }
}
