//! Flux limiter of the FMPM series on a line: no tension ahead of shocks.
//!
//! The inverse of the mass matrix overshoots at a front: ahead of a shock it accelerates material
//! towards the front. With y = sum_(l<k-1) K^l vL and z = sum_(l<k-1) K'^l f/m the last
//! product of each series is a sum of fluxes between pairs of nodes,
//!
//! ```text
//! v = vL + K_a y,  b = f/m + K_a z,  (K_a y)_i = (1/m_i) sum_j a_ij M_ij (y_i - y_j)
//! ```
//!
//! with shares a_ij = a_ji of 1 in the unlimited series. As in flux-corrected transport (Zalesak
//! 1979; Kuzmin, Loehner & Turek 2012) the shares are reduced such that b stays between 2.5 times
//! the extrema of f/m at neighbouring nodes and 0, and v + dt b between the extrema of vL + dt f/m;
//! smooth extrema widen the bounds. Momentum is conserved for any symmetric a. With the work velocity
//!
//! ```text
//! w = g + sum_(l<k-1) K'^l K'_a g,  g = (vL + A v')/2,  a of the force,
//! ```
//!
//! and the heat of the filter with v - y in place of its last term plus
//! sum_(i<j) (1 - a_ij) N_i N_j (y_i - y_j) (m_i - m_j), m = (v + v')/2, a of the velocity, energy is
//! conserved to rounding too.
//!
//! Not limited are nodes where the stress is concave, at the top of a front, and nodes near a free
//! surface, where reflected waves would broaden.

use decomp::Parity;
use smallvec::SmallVec;

use super::effect::Effects;
use super::exchange::Nodal;
use super::scheme::Scheme;
use crate::shape::with_width;
use crate::solver::nodal_fields::LimiterFields;
use crate::solver::patch::Patch;

/// Multiple of the extrema of the lumped acceleration that bounds the acceleration.
const GROWTH: f64 = 2.5;

/// Distance of nodes from a free surface at which nothing is limited, over two [nodes].
const NEAR: usize = 2;

/// Series that is limited.
#[derive(Clone, Copy, PartialEq)]
enum Limited {
    Force,
    Velocity,
}

/// Shares of the fluxes to and from a node: mean and half difference of the share of positive and
/// of negative fluxes, an even and an odd field in a mirror.
struct Shares<'a> {
    mean: &'a [f64],
    difference: &'a [f64],
}

impl Shares<'_> {
    /// Share of the flux between nodes i and j, with the difference of the series s_i - s_j.
    #[inline(always)]
    fn of(&self, i: usize, j: usize, difference: f64) -> f64 {
        let positive = |i: usize| self.mean[i] + self.difference[i];
        let negative = |i: usize| self.mean[i] - self.difference[i];
        match difference > 0.0 {
            true => positive(i).min(negative(j)),
            false => negative(i).min(positive(j)),
        }
    }
}

/// The smallest of three values of the same sign, or 0.
#[inline(always)]
fn minmod([a, b, c]: [f64; 3]) -> f64 {
    if a > 0.0 && b > 0.0 && c > 0.0 {
        a.min(b).min(c)
    } else if a < 0.0 && b < 0.0 && c < 0.0 {
        a.max(b).max(c)
    } else {
        0.0
    }
}

/// Extrema of q over the nodes up to `around` away from i, widened by half of a curvature that three
/// neighbouring nodes share.
#[inline(always)]
fn extrema(q: impl Fn(usize) -> f64, i: usize, around: usize) -> [f64; 2] {
    let (mut least, mut most) = (q(i), q(i));
    for j in i - around..=i + around {
        (least, most) = (least.min(q(j)), most.max(q(j)));
    }
    let curvature = |j: usize| q(j + 1) - 2.0 * q(j) + q(j - 1);
    let room = 0.5 * minmod([curvature(i - 1), curvature(i), curvature(i + 1)]).abs();
    [least - room, most + room]
}

/// Largest shares of positive and of negative fluxes to a node for which the sums of the fluxes
/// `[positive, negative]` stay within `room`.
#[inline(always)]
fn shares([positive, negative]: [f64; 2], [below, above]: [f64; 2]) -> [f64; 2] {
    let sum = positive + negative;
    let up = if sum > above { ((above - negative) / positive).clamp(0.0, 1.0) } else { 1.0 };
    let down = if sum < below { ((below - positive) / negative).clamp(0.0, 1.0) } else { 1.0 };
    [up, down]
}

impl<const D: usize> Scheme<D> {
    /// Sums that the limiter needs: mean stress of the nodes, and the nodes at an edge.
    pub(super) fn start_limiter(&self, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            mean: &mut [f64],
        ) {
            let c = &s.columns;
            let column = |k: usize| &patch.block.columns[k][..patch.block.particles()];
            let (mass, stress, length) =
                (column(c.mass), column(c.stress_volume), column(c.domain));
            let scale = s.inverse_cell[0];
            for r in patch.runs.iter().cloned().flatten() {
                let weights = patch.stencils.particle::<K, D>(r);
                let value = mass[r] * stress[r] * scale / length[r];
                weights.add(mean, weights.values, |n| n * value);
            }
        }
        let Some(limiter) = &self.fields.limiter else { return };
        let mut mean = std::mem::take(&mut patch.nodes.fields[limiter.stress]);
        mean.fill(0.0);
        with_width!(patch.stencils.width, go(patch, self, &mut mean));
        let inverse = &patch.nodes.fields[self.fields.inverse];
        mean.iter_mut().zip(inverse).for_each(|(mean, inverse)| *mean *= inverse);
        patch.nodes.fields[limiter.stress] = mean;
        let mut edge = std::mem::take(&mut patch.nodes.fields[limiter.edge]);
        edge.fill(0.0);
        let inverse = &patch.nodes.fields[self.fields.inverse];
        let nodes = patch.nodes.owned.grow(patch.extra_ghost_layers);
        for line in nodes.intersect(&patch.nodes.nodes).lines_in(&patch.nodes.nodes) {
            for i in line {
                edge[i] = if inverse[i] == 0.0 { 1.0 } else { 0.0 };
            }
        }
        patch.edge.iter().for_each(|&i| edge[i] = 1.0);
        patch.nodes.fields[limiter.edge] = edge;
    }

    /// Fields whose halos the limiter needs, with their parity in a mirror.
    pub(super) fn limiter_halos(&self) -> SmallVec<[(usize, Parity); 8]> {
        let f = &self.fields;
        let Some(limiter) = &f.limiter else { return SmallVec::new() };
        [
            (limiter.stress, Parity::Even),
            (limiter.edge, Parity::Even),
            (f.first, Parity::Odd(0)),
            (f.lumped_velocity, Parity::Odd(0)),
        ]
        .into_iter()
        .collect()
    }

    /// Limits acceleration [m/s2] and velocity [m/s], halos included, after their series in a step
    /// of `dt` [s]. Collective between neighbours.
    pub(super) fn limit_fluxes(&self, nodal: &mut Nodal<'_, D>, effects: &Effects<D>, dt: f64) {
        let f = &self.fields;
        let Some(limiter) = f.limiter.clone() else { return };
        let halo = |nodal: &mut Nodal<'_, D>,
                    name,
                    fields: &[(usize, Parity)],
                    phase: &(dyn Fn(&mut Patch<D>) + Sync)| {
            nodal.refresh(fields);
            nodal.each(name, |patch| {
                self.apply_no_slip(patch, fields);
                effects.set_boundary(self, patch, fields);
                phase(patch);
            });
        };
        nodal.each("limiter", |patch| {
            // z = b minus the last term of its series
            for span in patch.span_lines.clone() {
                let [b, z] = patch.nodes.fields_mut([f.acceleration, limiter.series]);
                for i in span {
                    z[i] = b[i] - z[i];
                }
            }
            self.spread_edge(patch, &limiter);
        });
        let [force, velocity] = limiter.shares;
        let of =
            |[mean, difference]: [usize; 2]| [(mean, Parity::Even), (difference, Parity::Odd(0))];
        halo(nodal, "limiter", &[(limiter.edge, Parity::Even)], &|patch| {
            self.find_shares(patch, &limiter, Limited::Force, dt);
        });
        halo(nodal, "limiter", &of(force), &|patch| {
            self.correct(patch, &limiter, Limited::Force, &[f.acceleration]);
            self.find_shares(patch, &limiter, Limited::Velocity, dt);
        });
        let [mean, difference] = of(velocity);
        halo(nodal, "limiter", &[(f.acceleration, Parity::Odd(0)), mean, difference], &|patch| {
            let residual = f.filter_residual.expect("FMPM has a filter");
            self.correct(patch, &limiter, Limited::Velocity, &[f.velocity, residual]);
        });
        let residual = f.filter_residual.expect("FMPM has a filter");
        nodal.refresh(&[(f.velocity, Parity::Odd(0)), (residual, Parity::Odd(0))]);
    }

    /// Marks the nodes near an edge.
    fn spread_edge(&self, patch: &mut Patch<D>, limiter: &LimiterFields) {
        let mut near = vec![0.0; patch.nodes.fields[limiter.edge].len()];
        let edge = &patch.nodes.fields[limiter.edge];
        for i in patch.active_lines.iter().cloned().flatten() {
            near[i] = edge[i - NEAR..=i + NEAR].iter().copied().fold(0.0, f64::max);
        }
        for span in &patch.span_lines {
            for i in span.clone() {
                near[i] = near[i].max(edge[i]);
            }
        }
        patch.nodes.fields[limiter.edge] = near;
    }

    /// Shares of the fluxes to and from the nodes that the patch computes.
    fn find_shares(
        &self,
        patch: &mut Patch<D>,
        limiter: &LimiterFields,
        limited: Limited,
        dt: f64,
    ) {
        let f = &self.fields;
        let [mean, difference] = limiter.shares[limited as usize];
        let [mut mean_of, mut difference_of] =
            [mean, difference].map(|k| std::mem::take(&mut patch.nodes.fields[k]));
        mean_of.fill(1.0);
        difference_of.fill(0.0);
        let fields = &patch.nodes.fields;
        let (mass, stress, edge) =
            (&fields[f.mass], &fields[limiter.stress], &fields[limiter.edge]);
        let (lumped, force) = (&fields[f.lumped_velocity], &fields[f.first]);
        let (b, v) = (&fields[f.acceleration], &fields[f.velocity]);
        let (z, u) = (&fields[limiter.series], &fields[f.filter_residual.expect("a filter")]);
        let series = |i: usize| match limited {
            Limited::Force => z[i],
            Limited::Velocity => v[i] - u[i],
        };
        for i in patch.active_lines.iter().cloned().flatten() {
            if edge[i - NEAR..=i + NEAR].iter().any(|&near| near > 0.0) {
                continue;
            }
            let (mut fluxes, mut curvature) = ([0.0; 2], 0.0);
            let here = series(i);
            patch.mass_matrix.band.each_neighbour(i, |j, m| {
                let flux = m * (here - series(j));
                fluxes[usize::from(flux < 0.0)] += flux;
                curvature += m * (stress[j] - stress[i]);
            });
            if curvature <= 0.0 {
                continue;
            }
            let room = match limited {
                Limited::Force => {
                    let [least, most] = extrema(|j| force[j], i, limiter.neighbours);
                    let (least, most) = (GROWTH * least.min(0.0), GROWTH * most.max(0.0));
                    [(least - force[i]).min(0.0), (most - force[i]).max(0.0)]
                }
                Limited::Velocity => {
                    let star = |j: usize| lumped[j] + dt * force[j];
                    let [least, most] = extrema(star, i, limiter.neighbours);
                    let now = lumped[i] + dt * b[i];
                    [(least - now).min(0.0), (most - now).max(0.0)]
                }
            };
            let [up, down] = shares(fluxes, room.map(|room| mass[i] * room));
            mean_of[i] = 0.5 * (up + down);
            difference_of[i] = 0.5 * (up - down);
        }
        patch.nodes.fields[mean] = mean_of;
        patch.nodes.fields[difference] = difference_of;
    }

    /// Subtracts the fluxes that are taken away from `fields` at the nodes that the patch computes.
    fn correct(
        &self,
        patch: &mut Patch<D>,
        limiter: &LimiterFields,
        limited: Limited,
        fields: &[usize],
    ) {
        let f = &self.fields;
        let source = match limited {
            Limited::Force => patch.nodes.fields[limiter.series].clone(),
            Limited::Velocity => {
                let (v, u) = (f.velocity, f.filter_residual.expect("a filter"));
                let (v, u) = (&patch.nodes.fields[v], &patch.nodes.fields[u]);
                v.iter().zip(u).map(|(v, u)| v - u).collect()
            }
        };
        let taken = self.taken(patch, limiter, limited, &source, &source);
        for &field in fields {
            for i in patch.active_lines.iter().cloned().flatten() {
                patch.nodes.fields[field][i] -= taken[i];
            }
        }
    }

    /// sum_j (1 - a_ij) M_ij (x_i - x_j)/m_i at the nodes that the patch computes, with the shares of
    /// the fluxes of `series`.
    fn taken(
        &self,
        patch: &Patch<D>,
        limiter: &LimiterFields,
        limited: Limited,
        series: &[f64],
        x: &[f64],
    ) -> Vec<f64> {
        let shares = self.shares_of(patch, limiter, limited);
        let inverse = &patch.nodes.fields[self.fields.inverse];
        let mut taken = vec![0.0; x.len()];
        for i in patch.active_lines.iter().cloned().flatten() {
            let mut sum = 0.0;
            patch.mass_matrix.band.each_neighbour(i, |j, m| {
                let share = shares.of(i, j, series[i] - series[j]);
                if share < 1.0 {
                    sum += (1.0 - share) * m * (x[i] - x[j]);
                }
            });
            taken[i] = sum * inverse[i];
        }
        taken
    }

    fn shares_of<'a>(
        &self,
        patch: &'a Patch<D>,
        limiter: &LimiterFields,
        limited: Limited,
    ) -> Shares<'a> {
        let [mean, difference] = limiter.shares[limited as usize];
        let fields = &patch.nodes.fields;
        Shares { mean: &fields[mean], difference: &fields[difference] }
    }

    /// First term of the series of the work, K'_a g, from g in the field of the work, halos included;
    /// keeps g. The edge mask has set g to 0 at the nodes that it removes.
    pub(super) fn start_limited_work(&self, patch: &mut Patch<D>, limiter: &LimiterFields) {
        let f = &self.fields;
        let g = patch.nodes.fields[f.work].clone();
        let series = &patch.nodes.fields[limiter.series];
        let taken = self.taken(patch, limiter, Limited::Force, series, &g);
        let mut product = vec![0.0; g.len()];
        for line in &patch.active_lines {
            patch.mass_matrix.band.product([&g[..]], line.clone(), [&mut product[..]]);
        }
        let inverse = &patch.nodes.fields[f.inverse];
        for i in patch.active_lines.iter().cloned().flatten() {
            product[i] = g[i] - inverse[i] * product[i] - taken[i];
        }
        let kept: SmallVec<[(usize, f64); 8]> =
            patch.edge.iter().map(|&i| (i, patch.nodes.fields[f.first][i])).collect();
        patch.nodes.fields[limiter.work] = g;
        patch.nodes.fields[f.work] = product;
        Self::leave_edge_out(patch, f.work, limiter.work, 1.0);
        let [work, first] = patch.nodes.fields_mut([f.work, f.first]);
        first.copy_from_slice(work);
        // on the nodes that the edge mask removes, w is g, which the last sum of the series takes
        // from its first term
        let is_last = self.transfer.force_order() == 2;
        for (i, kept) in kept {
            first[i] = kept;
            work[i] = if is_last { kept } else { 0.0 };
        }
    }

    /// Heat of the fluxes that are taken away, for the own particles.
    pub(super) fn gather_limiter_heat(&self, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(
            patch: &Patch<D>,
            s: &Scheme<D>,
            limiter: &LimiterFields,
            energy: &mut [f64],
        ) {
            let f = &s.fields;
            let shares = s.shares_of(patch, limiter, Limited::Velocity);
            let fields = &patch.nodes.fields;
            let (v, star) = (&fields[f.velocity], &fields[f.velocity_star]);
            let u = &fields[f.filter_residual.expect("a filter")];
            let series = |i: usize| v[i] - u[i];
            for (r, energy) in energy.iter_mut().enumerate() {
                let weights = patch.stencils.particle::<K, D>(r);
                let n = weights.values[0];
                let at = |k: usize| weights.first + k;
                for k in 0..K {
                    for l in k + 1..K {
                        let (i, j) = (at(k), at(l));
                        let share = shares.of(i, j, series(i) - series(j));
                        if share < 1.0 {
                            let mean = |i: usize| 0.5 * (v[i] + star[i]);
                            *energy += (1.0 - share)
                                * (n[k] * n[l])
                                * (series(i) - series(j))
                                * (mean(i) - mean(j));
                        }
                    }
                }
            }
        }
        let Some(limiter) = self.fields.limiter.clone().filter(|_| self.filter_heat) else {
            return;
        };
        let own = patch.block.own();
        let mut energy = std::mem::take(&mut patch.block.columns[self.columns.energy]);
        with_width!(patch.stencils.width, go(patch, self, &limiter, &mut energy[..own]));
        patch.block.columns[self.columns.energy] = energy;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fluxes_stay_within_the_room() {
        // 3 - 1 into a node with room for 1: a third of a half of the flux must go
        let [up, down] = shares([3.0, -1.0], [-4.0, 1.0]);
        assert!((up - 2.0 / 3.0).abs() < 1e-15 && down == 1.0);
        assert!((up * 3.0 - 1.0 - 1.0).abs() < 1e-15);
        let [up, down] = shares([1.0, -3.0], [-0.5, 1.0]);
        assert!(up == 1.0 && (down - 0.5).abs() < 1e-15);
        assert_eq!(shares([1.0, -3.0], [-2.0, 0.0]), [1.0, 1.0]);
    }

    #[test]
    fn smooth_extrema_widen_the_bounds() {
        let q = [0.0, 3.0, 4.0, 3.0, 0.0];
        assert_eq!(extrema(|i| q[i], 2, 1), [2.0, 5.0]);
        let kink = [0.0, 0.0, 0.0, 1.0, 2.0];
        assert_eq!(extrema(|i| kink[i], 2, 1), [0.0, 1.0]);
    }

    #[test]
    fn a_share_is_that_of_both_nodes() {
        let shares = Shares { mean: &[0.75, 0.5], difference: &[0.25, -0.5] };
        // positive shares 1 and 0, negative shares 0.5 and 1
        assert_eq!(shares.of(0, 1, 2.0), 1.0);
        assert_eq!(shares.of(0, 1, -2.0), 0.0);
        assert_eq!(shares.of(1, 0, 2.0), 0.0);
    }
}
