//! Grid to particles: own rows alone.

use smallvec::SmallVec;

use super::solid::Taken;
use super::{MOST_NODES, Stepper, with_width};
use crate::clock::spend;
use crate::effects::Effect;
use crate::patch::Patch;
use crate::scene::Limiter;
use crate::transfer::{Row, Scheme};
use crate::viscosity::{self, Nodes};

/// The product of two lines of nodes.
#[inline(always)]
fn times<const K: usize>(a: &[f64; K], b: &[f64; K]) -> [f64; K] {
    std::array::from_fn(|k| a[k] * b[k])
}

impl<const D: usize> Stepper<D> {
    /// New velocity of the own rows by the scheme, and the affine part with it.
    pub(super) fn gather_velocity(&self, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Stepper<D>) {
            let (c, f) = (&s.columns, &s.fields);
            let n = patch.block.own();
            for a in 0..D {
                let lumped = &patch.nodes.fields[f.lumped + a][..];
                let star = &patch.nodes.fields[f.velocity_star + a][..];
                let velocity = &mut patch.block.columns[c.velocity + a][..n];
                match s.scheme {
                    Scheme::Blend(share) => {
                        for (r, v) in velocity.iter_mut().enumerate() {
                            let row = patch.stencils.row::<K, D>(r);
                            let old = row.dot(row.values, lumped);
                            let new = row.dot(row.values, star);
                            *v = share * *v + (1.0 - share) * old + (new - old);
                        }
                    }
                    Scheme::Series { .. } | Scheme::Affine => {
                        for (r, v) in velocity.iter_mut().enumerate() {
                            let row = patch.stencils.row::<K, D>(r);
                            *v = row.dot(row.values, star);
                        }
                    }
                }
            }
            if let Some(affine) = c.affine {
                spend(Effect::Affine, patch, |patch| s.gather_affine::<K>(patch, affine));
            }
        }
        with_width!(patch.stencils.width, go(patch, self));
    }

    /// C = B D^-1 with B = sum N v' (x_i - x_p) and D = sum N (x_i - x_p) (x_i - x_p) (Jiang et
    /// al. 2015): exact for a linear velocity, also where a sheared domain gives D a component xy.
    fn gather_affine<const K: usize>(&self, patch: &mut Patch<D>, affine: usize) {
        for r in 0..patch.block.own() {
            let offset = self.offset(patch, r, patch.stencils.first[r] as usize);
            let row = patch.stencils.row::<K, D>(r);
            let apart = |b: usize, line: usize, k: usize| {
                offset[b] + if b == 0 { k as f64 } else { line as f64 }
            };
            let second = |a: usize, b: usize| {
                let product =
                    |line: usize| std::array::from_fn(|k| apart(a, line, k) * apart(b, line, k));
                row.sum(row.values, product)
            };
            let square: [f64; D] = std::array::from_fn(|b| second(b, b));
            let (first, last) = (0, D - 1);
            let mixed = if D == 1 { 0.0 } else { second(first, last) };
            let determinant = square[first] * square[last] - mixed * mixed;
            for a in 0..D {
                let star = &patch.nodes.fields[self.fields.velocity_star + a][..];
                let moment = |b: usize| {
                    let product = |line: usize| {
                        let v = row.line(star, line);
                        std::array::from_fn(|k| v[k] * apart(b, line, k))
                    };
                    row.sum(row.values, product)
                };
                // on a node of hat functions both vanish, and their ratio tends to the gradient
                let flat = square.iter().any(|d| *d <= 1e-9);
                for b in 0..D {
                    patch.block.columns[affine + D * a + b][r] = if flat {
                        let slopes = match self.total {
                            true => patch.stencils.first_gradient::<K, D>(r, b),
                            false => row.gradient(b),
                        };
                        row.dot(slopes, star)
                    } else if D == 1 {
                        moment(b) / square[b] * self.inverse_cell[b]
                    } else {
                        let other = 1 - b;
                        let slope = moment(b) * square[other] - moment(other) * mixed;
                        slope / determinant * self.inverse_cell[b]
                    };
                }
            }
        }
    }

    /// The divergence `plane` of a velocity in the plane, and about an axis the rate of strain
    /// N v_x/x of a row that a radius adds to it; `radial` gives v_x for each line of nodes.
    #[inline(always)]
    pub(super) fn with_hoop<const K: usize>(
        &self,
        patch: &Patch<D>,
        row: &Row<'_, K, D>,
        r: usize,
        plane: f64,
        radial: impl Fn(usize) -> [f64; K],
    ) -> f64 {
        match D > 1 && self.axisymmetric {
            true => plane + row.sum(row.values, radial) / self.radius(patch, r),
            false => plane,
        }
    }

    /// Gradient of the velocity in the fields from `field` on at a row, as far as a scene needs it.
    #[inline(always)]
    fn tensor<const K: usize>(
        &self,
        patch: &Patch<D>,
        row: &Row<'_, K, D>,
        field: usize,
    ) -> [[f64; D]; D] {
        tensor_of(row, |a, line| *row.line(&patch.nodes.fields[field + a], line))
    }

    /// Divergence of the nodal velocity in the fields from `field` on at the own rows, its whole
    /// gradient where domains deform, and the limiter from it.
    pub(super) fn gather_gradient(&self, patch: &mut Patch<D>, field: usize) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Stepper<D>, field: usize) {
            let column = s.columns.gradient;
            let mut gradient = std::mem::take(&mut patch.block.columns[column]);
            for (r, d) in gradient.iter_mut().enumerate() {
                let row = patch.stencils.row::<K, D>(r);
                let radial = |line| *row.line(&patch.nodes.fields[field], line);
                if let Some(whole) = s.columns.velocity_gradient {
                    let l = s.tensor(patch, &row, field);
                    *d = s.with_hoop(patch, &row, r, trace(&l), radial);
                    put(&mut patch.block.columns, whole, r, &l);
                } else {
                    let along = |a: usize| row.dot(row.gradient(a), &patch.nodes.fields[field + a]);
                    let sum = (1..D).fold(along(0), |sum, a| sum + along(a));
                    *d = s.with_hoop(patch, &row, r, sum, radial);
                }
            }
            patch.block.columns[column] = gradient;
            s.gather_limiter::<K>(patch, field);
        }
        with_width!(patch.stencils.width, go(patch, self, field));
    }

    fn gather_limiter<const K: usize>(&self, patch: &mut Patch<D>, field: usize) {
        let (Some(limiter), Some(column)) =
            (self.viscosity.and_then(|v| v.limiter), self.columns.limiter)
        else {
            return;
        };
        let fields = &patch.nodes.fields;
        let stride = patch.stencils.stride;
        let nodes = Nodes {
            velocity: std::array::from_fn::<&[f64], D, _>(|a| &fields[field + a]),
            inverse_mass: &fields[self.fields.inverse],
            steps: std::array::from_fn(|a| if a == 0 { 1 } else { stride }),
            inverse_cell: self.inverse_cell,
            layer: patch.nodes.nodes.count(),
        };
        let lower = patch.nodes.nodes.lower;
        let n = patch.block.own();
        let (count, layers) = (patch.nodes.nodes.count(), patch.nodes.layers);
        let first = &patch.stencils.first;
        let layer = |r: usize| if layers > 1 { first[r] as usize / count * count } else { 0 };
        let mut limiters = std::mem::take(&mut patch.block.columns[column]);
        let (phi, gradient) = (&mut limiters, &patch.block.columns[self.columns.gradient]);
        for r in 0..n {
            // without compression there is no viscosity to limit
            phi[r] = if gradient[r] >= 0.0 {
                0.0
            } else {
                match limiter {
                    Limiter::Christensen => {
                        let at =
                            |a: usize| (i64::from(patch.block.cells[r][a]) - lower[a]) as usize;
                        let node = (1..D).fold(at(0), |sum, a| sum + stride * at(a));
                        let node = node + layer(r);
                        viscosity::christensen(&nodes, node)
                    }
                    Limiter::Nodal => {
                        let row = patch.stencils.row::<K, D>(r);
                        viscosity::nodal(&nodes, &row, gradient[r], self.push_of(patch, r))
                    }
                }
            };
        }
        patch.block.columns[column] = limiters;
    }

    /// All that the end of a mid-point step brings the own rows: volume and energy from the
    /// gradients of the mean velocity and of w, the filter's heat, velocity, position, and domain.
    pub(super) fn gather_midpoint(&self, patch: &mut Patch<D>, dt: f64) {
        self.gather_contact(patch, dt);
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Stepper<D>, dt: f64) {
            match s.tensor_stress() {
                false => s.gather_rows::<K, false>(patch, dt),
                true => s.gather_rows::<K, true>(patch, dt),
            }
            if let Some(affine) = s.columns.affine {
                spend(Effect::Affine, patch, |patch| s.gather_affine::<K>(patch, affine));
            }
            s.gather_limiter::<K>(patch, s.fields.velocity_star);
        }
        with_width!(patch.stencils.width, go(patch, self, dt));
    }

    fn gather_rows<const K: usize, const TENSOR: bool>(&self, patch: &mut Patch<D>, dt: f64) {
        let (c, f) = (&self.columns, &self.fields);
        let n = patch.block.own();
        let fields = &patch.nodes.fields;
        let vector = |k: usize| std::array::from_fn::<&[f64], D, _>(|a| &fields[k + a]);
        let (lumped, start, star) = (vector(f.lumped), vector(f.velocity), vector(f.velocity_star));
        let work = vector(f.work);
        let remainder = f.remainder.filter(|_| self.filter_heat).map(vector);
        // columns that are written leave the block while the others are read
        let columns = &mut patch.block.columns;
        let mut take = |k: usize| std::mem::take(&mut columns[k]);
        let mut x: [Vec<f64>; D] = std::array::from_fn(|a| take(c.position + a));
        let mut v: [Vec<f64>; D] = std::array::from_fn(|a| take(c.velocity + a));
        let [mut j, mut e, mut d] = [c.jacobian, c.energy, c.gradient].map(&mut take);
        let tensors = [c.deformation, c.velocity_gradient].into_iter().flatten();
        let mut strain: SmallVec<[(usize, Taken); 2]> =
            tensors.map(|first| (first, (first..first + D * D).map(&mut take).collect())).collect();
        let column = |k: usize| &patch.block.columns[k][..n];
        let mid = c.jacobian_mid.expect("mid-point stepping has the column");
        let (mass, j_mid, stress) = (column(c.mass), column(mid), column(c.stress_volume));
        for r in 0..n {
            let row = patch.stencils.row::<K, D>(r);
            let mean = |a: usize, line: usize| -> [f64; K] {
                let (v0, v1) = (row.line(start[a], line), row.line(star[a], line));
                std::array::from_fn(|k| 0.5 * (v0[k] + v1[k]))
            };
            let (mut heat, mut new) = (0.0, [0.0; D]);
            for a in 0..D {
                let old = v[a][r];
                new[a] = row.dot(row.values, star[a]);
                match self.scheme {
                    Scheme::Series { .. } => {
                        if let Some(lost) = remainder {
                            let both = |l: usize| times(row.line(lost[a], l), &mean(a, l));
                            let rest = old - row.dot(row.values, start[a]);
                            heat += 0.5 * rest * rest
                                + (row.sum(row.values, both)
                                    - row.dot(row.values, lost[a])
                                        * row.sum(row.values, |l| mean(a, l)));
                        }
                    }
                    Scheme::Blend(share) => {
                        let on_grid = row.dot(row.values, lumped[a]);
                        let change = new[a] - on_grid;
                        if self.filter_heat {
                            let square =
                                |l: usize| times(row.line(lumped[a], l), row.line(lumped[a], l));
                            let rest = old - on_grid;
                            heat += 0.5 * (1.0 - share * share) * rest * rest
                                + (1.0 - share) * (row.sum(row.values, square) - on_grid * on_grid);
                        }
                        new[a] = share * old + (1.0 - share) * on_grid + change;
                    }
                    Scheme::Affine => {}
                }
            }
            // where domains deform the whole gradients are needed, else their traces
            let (plane, end) = match &mut strain[..] {
                [(_, deformation), (_, gradient)] => {
                    let during = tensor_of(&row, mean);
                    let end = tensor_of(&row, |a, l| *row.line(star[a], l));
                    if self.total {
                        deform_linearly(deformation, gradient, r, &during, dt);
                    } else {
                        deform(deformation, r, &during, dt);
                    }
                    put(gradient, 0, r, &end);
                    (trace(&during), trace(&end))
                }
                _ => (
                    (0..D).map(|a| row.sum(row.gradient(a), |l| mean(a, l))).sum(),
                    (0..D).map(|a| row.dot(row.gradient(a), star[a])).sum(),
                ),
            };
            let divergence = self.with_hoop(patch, &row, r, plane, |l| mean(0, l));
            let work_done = if TENSOR {
                let of = |a: usize, line: usize| match self.compatible {
                    true => *row.line(work[a], line),
                    false => mean(a, line),
                };
                dt * self.stress_power(patch, &row, r, of)
            } else {
                let working = if self.compatible {
                    let plane = (0..D).map(|a| row.dot(row.gradient(a), work[a])).sum();
                    self.with_hoop(patch, &row, r, plane, |l| *row.line(work[0], l))
                } else {
                    divergence
                };
                stress[r] * dt * working
            };
            for a in 0..D {
                x[a][r] += match self.scheme {
                    // with the grid: the particles' own velocities would tear their tiling
                    Scheme::Blend(_) => dt * row.sum(row.values, |l| mean(a, l)),
                    _ => 0.5 * dt * (v[a][r] + new[a]),
                };
                v[a][r] = new[a];
            }
            j[r] += dt * j_mid[r] * divergence;
            e[r] += heat - work_done / mass[r];
            d[r] = self.with_hoop(patch, &row, r, end, |l| *row.line(star[0], l));
        }
        let columns = &mut patch.block.columns;
        for (a, (x, v)) in x.into_iter().zip(v).enumerate() {
            columns[c.position + a] = x;
            columns[c.velocity + a] = v;
        }
        columns[c.jacobian] = j;
        columns[c.energy] = e;
        columns[c.gradient] = d;
        for (first, tensor) in strain {
            for (k, column) in tensor.into_iter().enumerate() {
                columns[first + k] = column;
            }
        }
    }
}

/// The gradient of the velocity at a row, whose components `of` gives for each line of nodes.
#[inline(always)]
pub(super) fn tensor_of<const K: usize, const D: usize>(
    row: &Row<'_, K, D>,
    of: impl Fn(usize, usize) -> [f64; K],
) -> [[f64; D]; D] {
    // no nested closures: they stay calls
    let mut tensor = [[0.0; D]; D];
    for a in 0..D {
        for b in 0..D {
            tensor[a][b] = row.sum(row.gradient(b), |line| of(a, line));
        }
    }
    tensor
}

/// The deformation gradient F in `columns` of a row after `dt` at the gradient `l` of the velocity, by
/// Cayley's form (1 - dt/2 l)^-1 (1 + dt/2 l) F, which turns without stretching.
#[inline(always)]
fn deform<const D: usize>(columns: &mut [Vec<f64>], row: usize, l: &[[f64; D]; D], dt: f64) {
    let half = 0.5 * dt;
    let [xx, xy, yx, yy] = [l[0][0], l[0][D - 1], l[D - 1][0], l[D - 1][D - 1]].map(|l| half * l);
    let inverse = 1.0 / ((1.0 - xx) * (1.0 - yy) - xy * yx);
    for k in [0, 1] {
        let (x, y) = (columns[k][row], columns[k + 2][row]);
        let (x, y) = (x + xx * x + xy * y, y + yx * x + yy * y);
        columns[k][row] = inverse * ((1.0 - yy) * x + xy * y);
        columns[k + 2][row] = inverse * (yx * x + (1.0 - xx) * y);
    }
}

/// F + dt l F_h of a row, with F_h = (1 + dt/2 L) F that of the middle of the step, which the
/// gradient `l` of the velocity has been pushed forward by, and L the gradient in `before`: F is that
/// of the displacements on the grid.
#[inline(always)]
fn deform_linearly<const D: usize>(
    columns: &mut [Vec<f64>],
    before: &[Vec<f64>],
    row: usize,
    l: &[[f64; D]; D],
    dt: f64,
) {
    let half = 0.5 * dt;
    for k in [0, 1] {
        let (x, y) = (columns[k][row], columns[k + 2][row]);
        let at = |a: usize| half * (before[2 * a][row] * x + before[2 * a + 1][row] * y);
        let (mid_x, mid_y) = (x + at(0), y + at(1));
        columns[k][row] = x + dt * (l[0][0] * mid_x + l[0][D - 1] * mid_y);
        columns[k + 2][row] = y + dt * (l[D - 1][0] * mid_x + l[D - 1][D - 1] * mid_y);
    }
}

/// Sum of the diagonal.
#[inline(always)]
pub(super) fn trace<const D: usize>(tensor: &[[f64; D]; D]) -> f64 {
    (1..D).fold(tensor[0][0], |sum, a| sum + tensor[a][a])
}

/// Writes a tensor into its columns from `first` on.
#[inline(always)]
pub(super) fn put<const D: usize>(
    columns: &mut [Vec<f64>],
    first: usize,
    row: usize,
    tensor: &[[f64; D]; D],
) {
    for a in 0..D {
        for b in 0..D {
            columns[first + D * a + b][row] = tensor[a][b];
        }
    }
}
