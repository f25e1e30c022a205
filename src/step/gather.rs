//! Grid to particles: own rows alone.

use super::{MOST_NODES, Stepper, with_width};
use crate::patch::Patch;
use crate::scene::Limiter;
use crate::transfer::{Scheme, dot, window};
use crate::viscosity;

impl Stepper {
    /// New velocity of the own rows, and the velocity itself in the old rows' place:
    /// v_p' by the scheme; returns nothing, writes the columns of velocity and affine part.
    pub(super) fn gather_velocity(&self, patch: &mut Patch<1>) {
        fn go<const K: usize>(patch: &mut Patch<1>, s: &Stepper) {
            let (c, f) = (&s.columns, &s.fields);
            let n = patch.block.own();
            let lumped = &patch.nodes.fields[f.lumped][..];
            let star = &patch.nodes.fields[f.velocity_star][..];
            let velocity = &mut patch.block.columns[c.velocity][..n];
            match s.scheme {
                Scheme::Blend(a) => {
                    for (r, v) in velocity.iter_mut().enumerate() {
                        let (first, values, _) = patch.stencils.row::<K>(r);
                        let old = dot(values, window(lumped, first));
                        let new = dot(values, window(star, first));
                        *v = a * *v + (1.0 - a) * old + (new - old);
                    }
                }
                Scheme::Series { .. } | Scheme::Affine => {
                    for (r, v) in velocity.iter_mut().enumerate() {
                        let (first, values, _) = patch.stencils.row::<K>(r);
                        *v = dot(values, window(star, first));
                    }
                }
            }
            if let Some(affine) = c.affine {
                s.gather_affine::<K>(patch, affine);
            }
        }
        with_width!(patch.stencils.width, go(patch, self));
    }

    /// C = B/D with B = sum N v' (x_i - x_p) and D = sum N (x_i - x_p)^2 (Jiang et al. 2015).
    fn gather_affine<const K: usize>(&self, patch: &mut Patch<1>, affine: usize) {
        let lower = patch.nodes.nodes.lower[0];
        let star = &patch.nodes.fields[self.fields.velocity_star][..];
        let n = patch.block.own();
        let [affine, fraction] = patch
            .block
            .columns
            .get_disjoint_mut([affine, self.columns.fraction])
            .expect("columns differ");
        for r in 0..n {
            let (first, values, gradients) = patch.stencils.row::<K>(r);
            let offset =
                (first as i64 + lower - patch.block.cells[r][0] as i64) as f64 - fraction[r];
            let v: &[f64; K] = window(star, first);
            let (mut b, mut d) = (0.0, 0.0);
            for k in 0..K {
                let apart = offset + k as f64;
                b += values[k] * v[k] * apart;
                d += values[k] * apart * apart;
            }
            // on a node of hat functions both vanish, and their ratio tends to the gradient
            affine[r] = if d > 1e-9 { b / d * self.inverse_cell } else { dot(gradients, v) };
        }
    }

    /// Divergence of `field` (a nodal velocity) at the own rows, and the limiter from it.
    pub(super) fn gather_gradient(&self, patch: &mut Patch<1>, field: usize) {
        fn go<const K: usize>(patch: &mut Patch<1>, s: &Stepper, field: usize) {
            let n = patch.block.own();
            let nodal = &patch.nodes.fields[field][..];
            let gradient = &mut patch.block.columns[s.columns.gradient][..n];
            for (r, d) in gradient.iter_mut().enumerate() {
                let (first, _, g) = patch.stencils.row::<K>(r);
                *d = dot(g, window(nodal, first));
            }
            s.gather_limiter::<K>(patch, field);
        }
        with_width!(patch.stencils.width, go(patch, self, field));
    }

    fn gather_limiter<const K: usize>(&self, patch: &mut Patch<1>, field: usize) {
        let (Some(limiter), Some(column)) =
            (self.viscosity.and_then(|v| v.limiter), self.columns.limiter)
        else {
            return;
        };
        let velocity = &patch.nodes.fields[field][..];
        let inverse = &patch.nodes.fields[self.fields.inverse][..];
        let lower = patch.nodes.nodes.lower[0];
        let n = patch.block.own();
        let [phi, gradient] = patch
            .block
            .columns
            .get_disjoint_mut([column, self.columns.gradient])
            .expect("columns differ");
        for r in 0..n {
            // without compression there is no viscosity to limit
            phi[r] = if gradient[r] >= 0.0 {
                0.0
            } else {
                match limiter {
                    Limiter::Christensen => {
                        let node = (patch.block.cells[r][0] as i64 - lower) as usize;
                        viscosity::christensen(velocity, inverse, node)
                    }
                    Limiter::Nodal => {
                        let (first, values, _) = patch.stencils.row::<K>(r);
                        let scale = 0.5 * self.inverse_cell;
                        viscosity::nodal(velocity, inverse, first, values, gradient[r], scale)
                    }
                }
            };
        }
    }

    /// All that the end of a mid-point step brings the own rows: volume and energy from the
    /// gradients of the mean velocity and of w, the filter's heat, velocity and position.
    pub(super) fn gather_midpoint(&self, patch: &mut Patch<1>, dt: f64) {
        fn go<const K: usize>(patch: &mut Patch<1>, s: &Stepper, dt: f64) {
            let (c, f) = (&s.columns, &s.fields);
            let n = patch.block.own();
            let nodal = |k: usize| &patch.nodes.fields[k][..];
            let (lumped, start, star) =
                (nodal(f.lumped), nodal(f.velocity), nodal(f.velocity_star));
            let (remainder, work) = (f.remainder.map(nodal), nodal(f.work));
            let mid = c.jacobian_mid.expect("mid-point stepping has the column");
            let [x, v, j, e, d, mass, j_mid, stress] = patch.block.columns_mut([
                c.position,
                c.velocity,
                c.jacobian,
                c.energy,
                c.gradient,
                c.mass,
                mid,
                c.stress_volume,
            ]);
            for r in 0..n {
                let (first, values, g) = patch.stencils.row::<K>(r);
                let (v0, v1): (&[f64; K], &[f64; K]) = (window(start, first), window(star, first));
                let mean: [f64; K] = std::array::from_fn(|k| 0.5 * (v0[k] + v1[k]));
                let old = v[r];
                let (new, heat) = match s.scheme {
                    Scheme::Series { .. } => {
                        let new = dot(values, v1);
                        let heat = if let Some(remainder) = remainder.filter(|_| s.filter_heat) {
                            let lost: &[f64; K] = window(remainder, first);
                            let both = std::array::from_fn(|k| lost[k] * mean[k]);
                            let rest = old - dot(values, v0);
                            0.5 * rest * rest
                                + (dot(values, &both) - dot(values, lost) * dot(values, &mean))
                        } else {
                            0.0
                        };
                        (new, heat)
                    }
                    Scheme::Blend(a) => {
                        let vl: &[f64; K] = window(lumped, first);
                        let on_grid = dot(values, vl);
                        let change = dot(values, v1) - on_grid;
                        let heat = if s.filter_heat {
                            let square = std::array::from_fn(|k| vl[k] * vl[k]);
                            let rest = old - on_grid;
                            0.5 * (1.0 - a * a) * rest * rest
                                + (1.0 - a) * (dot(values, &square) - on_grid * on_grid)
                        } else {
                            0.0
                        };
                        (a * old + (1.0 - a) * on_grid + change, heat)
                    }
                    Scheme::Affine => (dot(values, v1), 0.0),
                };
                let divergence = dot(g, &mean);
                let working = if s.compatible { dot(g, window(work, first)) } else { divergence };
                v[r] = new;
                x[r] += 0.5 * dt * (old + new);
                j[r] += dt * j_mid[r] * divergence;
                e[r] += heat - stress[r] * dt * working / mass[r];
                d[r] = dot(g, v1);
            }
            if let Some(affine) = c.affine {
                s.gather_affine::<K>(patch, affine);
            }
            s.gather_limiter::<K>(patch, f.velocity_star);
        }
        with_width!(patch.stencils.width, go(patch, self, dt));
    }
}
