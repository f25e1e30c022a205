//! Grid to particles at the end of a mid-point step, for own particles only.

use decomp::array::{from_fn, sum};

use super::gather::{OwnTensor, own, own_tensor, put, take_tensor, take_vector, tensor_of, trace};
use super::scheme::Scheme;
use super::solid::put_back;
use crate::shape::with_width;
use crate::solver::clock::timed;
use crate::solver::particle_weights::ParticleWeights;
use crate::solver::parts::StepPart;
use crate::solver::patch::Patch;
use crate::transfer::VelocityUpdate;

/// Product of two lines of nodes.
#[inline(always)]
fn times<const K: usize>(a: &[f64; K], b: &[f64; K]) -> [f64; K] {
    from_fn(|k| a[k] * b[k])
}

/// Mean of two lines of nodes.
#[inline(always)]
fn half_sum<const K: usize>(a: &[f64; K], b: &[f64; K]) -> [f64; K] {
    from_fn(|k| 0.5 * (a[k] + b[k]))
}

/// Values of a nodal vector at the nodes of a particle: component, line of nodes, node.
type Windows<const K: usize, const L: usize, const D: usize> = [[[f64; K]; L]; D];

/// Scales the velocity gradient of a particle, if it exists, by `share`, the ratio of the volumes at
/// the middle and the end of the step. Relative to the end, it gives the volume at the middle of the
/// next step to second order in time.
#[inline(always)]
fn scale(gradient: &mut OwnTensor<'_>, particle: usize, share: f64) {
    for component in gradient.iter_mut().flatten() {
        component[particle] *= share;
    }
}

impl<const D: usize> Scheme<D> {
    /// Updates the own particles at the end of a mid-point step: volume and energy from the
    /// gradients of the mean velocity and of w, heat of the filter, velocity, position and domain.
    pub(super) fn gather_midpoint(&self, patch: &mut Patch<D>, dt: f64) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Scheme<D>, dt: f64) {
            if const { D == 1 } {
                s.gather_particles::<K, 1, false>(patch, dt);
            } else {
                match s.tensor_stress() {
                    false => s.gather_particles::<K, K, false>(patch, dt),
                    true => s.gather_particles::<K, K, true>(patch, dt),
                }
            }
            if let Some(affine) = s.columns.affine {
                timed(StepPart::Affine as usize, patch, |patch| {
                    s.gather_affine::<K>(patch, affine)
                });
            }
            s.gather_limiter::<K>(patch);
        }
        with_width!(patch.stencils.width, go(patch, self, dt));
    }

    fn gather_particles<const K: usize, const L: usize, const TENSOR: bool>(
        &self,
        patch: &mut Patch<D>,
        dt: f64,
    ) {
        let (c, f) = (&self.columns, &self.fields);
        let n = patch.block.own();
        let fields = &patch.nodes.fields;
        // slices of equal length, so that the bounds of a window are checked only once
        let nodes = fields[f.mass].len();
        let vector = |k: usize| from_fn::<&[f64], D, _>(|a| &fields[k + a][..nodes]);
        let (lumped, start, star) =
            (vector(f.lumped_velocity), vector(f.velocity), vector(f.velocity_star));
        let work = vector(f.work);
        let remainder = f.filter_residual.filter(|_| self.filter_heat).map(vector);
        let columns = &mut patch.block.columns;
        let [mut x, mut v] = [c.position, c.velocity].map(|k| take_vector::<D>(columns, k));
        let [mut j, mut e, mut d] =
            [c.jacobian, c.energy, c.divergence].map(|k| std::mem::take(&mut columns[k]));
        let [mut deformation, mut gradient] =
            [c.deformation, c.velocity_gradient].map(|k| take_tensor(columns, k, D * D));
        let (own_x, own_v) = (&mut own::<D>(&mut x, n), &mut own::<D>(&mut v, n));
        let [own_j, own_e, own_d] = [&mut j, &mut e, &mut d].map(|column| &mut column[..n]);
        let mut own_deformation = own_tensor(&mut deformation, n);
        let mut own_gradient = own_tensor(&mut gradient, n);
        let column = |k: usize| &patch.block.columns[k][..n];
        let mid = c.jacobian_mid.expect("mid-point stepping has the column");
        let (mass, j_mid, stress) = (column(c.mass), column(mid), column(c.stress_volume));
        for (r, weights) in patch.stencils.particles::<K, D>(0..n).enumerate() {
            // fetched once, as several sums use them
            let (mut means, star) = (weights.windows::<L, D>(start), weights.windows::<L, D>(star));
            let mut filtered = [0.0; D];
            if remainder.is_some() {
                for a in 0..D {
                    filtered[a] = weights.sum(weights.values, |line| means[a][line]);
                }
            }
            for a in 0..D {
                for line in 0..L {
                    means[a][line] = half_sum(&means[a][line], &star[a][line]);
                }
            }
            let old = from_fn(|a| own_v[a][r]);
            let (new, heat) =
                self.end_velocity(&weights, old, &filtered, [&means, &star], lumped, remainder);
            let tensors = (&mut own_deformation, &mut own_gradient);
            let [plane, end] = self.end_strain(&weights, r, [&means, &star], tensors, dt);
            let divergence = self.with_hoop(patch, &weights, r, plane, |l| means[0][l]);
            let does = if self.compatible { weights.windows::<L, D>(work) } else { means };
            let work_done = self
                .work_done::<K, L, TENSOR>(patch, &weights, r, &does, divergence, stress[r], dt);
            for a in 0..D {
                own_x[a][r] += match self.transfer.update {
                    // with the grid: the particles' own velocities would break up the tiling
                    VelocityUpdate::Blend(_) => dt * weights.sum(weights.values, |l| means[a][l]),
                    _ => 0.5 * dt * (own_v[a][r] + new[a]),
                };
                own_v[a][r] = new[a];
            }
            own_j[r] += dt * j_mid[r] * divergence;
            own_e[r] += heat - work_done / mass[r];
            own_d[r] = self.with_hoop(patch, &weights, r, end, |l| star[0][l]);
            if !self.total_lagrangian {
                let share = j_mid[r] / own_j[r];
                own_d[r] *= share;
                scale(&mut own_gradient, r, share);
            }
        }
        let columns = &mut patch.block.columns;
        put_back(columns, c.position, x);
        put_back(columns, c.velocity, v);
        columns[c.jacobian] = j;
        columns[c.energy] = e;
        columns[c.divergence] = d;
        for (first, taken) in [(c.deformation, deformation), (c.velocity_gradient, gradient)] {
            if let Some(first) = first {
                put_back(columns, first, taken);
            }
        }
    }

    /// Velocity of a particle at the end of a step [m/s] from its `old` one, and the heat of the
    /// filter per unit mass [J/kg].
    #[inline(always)]
    fn end_velocity<const K: usize, const L: usize>(
        &self,
        weights: &ParticleWeights<'_, K, D>,
        old: [f64; D],
        filtered: &[f64; D],
        [means, star]: [&Windows<K, L, D>; 2],
        lumped: [&[f64]; D],
        remainder: Option<[&[f64]; D]>,
    ) -> ([f64; D], f64) {
        let (mut heat, mut new) = (0.0, [0.0; D]);
        for a in 0..D {
            let old = old[a];
            new[a] = weights.sum(weights.values, |line| star[a][line]);
            match self.transfer.update {
                VelocityUpdate::Filtered => {
                    if let Some(lost) = remainder {
                        let [lost] = weights.windows::<L, 1>([lost[a]]);
                        let both = |l: usize| times(&lost[l], &means[a][l]);
                        let rest = old - filtered[a];
                        heat += 0.5 * rest * rest
                            + (weights.sum(weights.values, both)
                                - weights.sum(weights.values, |l| lost[l])
                                    * weights.sum(weights.values, |l| means[a][l]));
                    }
                }
                VelocityUpdate::Blend(share) => {
                    let [lumped] = weights.windows::<L, 1>([lumped[a]]);
                    let on_grid = weights.sum(weights.values, |l| lumped[l]);
                    let change = new[a] - on_grid;
                    if self.filter_heat {
                        let square = |l: usize| times(&lumped[l], &lumped[l]);
                        let rest = old - on_grid;
                        heat += 0.5 * (1.0 - share * share) * rest * rest
                            + (1.0 - share)
                                * (weights.sum(weights.values, square) - on_grid * on_grid);
                    }
                    new[a] = share * old + (1.0 - share) * on_grid + change;
                }
                VelocityUpdate::Affine => {}
            }
        }
        (new, heat)
    }

    /// Deformation and velocity gradient of a particle at the end of a step; returns the divergence
    /// in the plane, of the mean velocity and of v' [1/s].
    #[inline(always)]
    fn end_strain<const K: usize, const L: usize>(
        &self,
        weights: &ParticleWeights<'_, K, D>,
        r: usize,
        [means, star]: [&Windows<K, L, D>; 2],
        (deformation, gradient): (&mut OwnTensor<'_>, &mut OwnTensor<'_>),
        dt: f64,
    ) -> [f64; 2] {
        // if domains deform the full gradients are needed, otherwise only their traces
        let plane = match (&mut *deformation, &*gradient) {
            (Some(deformation), Some(gradient)) => {
                let during = tensor_of(weights, |a, l| means[a][l]);
                if self.total_lagrangian {
                    deform_linearly(deformation, gradient, r, &during, dt);
                } else {
                    deform(deformation, r, &during, dt);
                }
                trace(&during)
            }
            _ => sum::<D>(|a| weights.sum(weights.gradient(a), |l| means[a][l])),
        };
        let end = match gradient {
            Some(gradient) => {
                let end = tensor_of(weights, |a, l| star[a][l]);
                put(gradient, 0, r, &end);
                trace(&end)
            }
            None => sum::<D>(|a| weights.sum(weights.gradient(a), |l| star[a][l])),
        };
        [plane, end]
    }

    /// Work that the stress of a particle does in a step with the velocity `does` [J].
    #[expect(clippy::too_many_arguments)]
    #[inline(always)]
    fn work_done<const K: usize, const L: usize, const TENSOR: bool>(
        &self,
        patch: &Patch<D>,
        weights: &ParticleWeights<'_, K, D>,
        r: usize,
        does: &Windows<K, L, D>,
        divergence: f64,
        stress: f64,
        dt: f64,
    ) -> f64 {
        if TENSOR {
            dt * self.stress_power(patch, weights, r, |a, line| does[a][line])
        } else {
            let working = if self.compatible {
                let along = |a: usize| weights.sum(weights.gradient(a), |line| does[a][line]);
                self.with_hoop(patch, weights, r, sum::<D>(along), |line| does[0][line])
            } else {
                divergence
            };
            stress * dt * working
        }
    }
}

/// Deformation gradient F of a particle in `columns` after `dt` with the velocity gradient `l`, by
/// Cayley's form (1 - dt/2 l)^-1 (1 + dt/2 l) F, which keeps a rotation free of stretching.
#[inline(always)]
fn deform<const D: usize>(
    columns: &mut [&mut [f64]; 4],
    particle: usize,
    l: &[[f64; D]; D],
    dt: f64,
) {
    let half = 0.5 * dt;
    let [xx, xy, yx, yy] = [l[0][0], l[0][D - 1], l[D - 1][0], l[D - 1][D - 1]].map(|l| half * l);
    let inverse = 1.0 / ((1.0 - xx) * (1.0 - yy) - xy * yx);
    for k in [0, 1] {
        let (x, y) = (columns[k][particle], columns[k + 2][particle]);
        let (x, y) = (x + xx * x + xy * y, y + yx * x + yy * y);
        columns[k][particle] = inverse * ((1.0 - yy) * x + xy * y);
        columns[k + 2][particle] = inverse * (yx * x + (1.0 - xx) * y);
    }
}

/// F + dt l F_h of a particle, with the deformation at the middle of the step F_h = (1 + dt/2 L) F,
/// which has pushed the velocity gradient `l` forward, and L the gradient in `before`: F then
/// follows from the displacements of the grid.
#[inline(always)]
fn deform_linearly<const D: usize>(
    columns: &mut [&mut [f64]; 4],
    before: &[&mut [f64]; 4],
    particle: usize,
    l: &[[f64; D]; D],
    dt: f64,
) {
    let half = 0.5 * dt;
    for k in [0, 1] {
        let (x, y) = (columns[k][particle], columns[k + 2][particle]);
        let at = |a: usize| half * (before[2 * a][particle] * x + before[2 * a + 1][particle] * y);
        let (mid_x, mid_y) = (x + at(0), y + at(1));
        columns[k][particle] = x + dt * (l[0][0] * mid_x + l[0][D - 1] * mid_y);
        columns[k + 2][particle] = y + dt * (l[D - 1][0] * mid_x + l[D - 1][D - 1] * mid_y);
    }
}
