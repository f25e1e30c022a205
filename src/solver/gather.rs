//! Grid to particles: own rows alone.

use std::ops::DerefMut;

use super::solid::{Taken, put_back};
use super::{MOST_NODES, Stepper, with_width};
use crate::effects::Effect;
use crate::effects::artificial_viscosity::{self, Nodes};
use crate::scene::Limiter;
use crate::solver::clock::spend;
use crate::solver::patch::Patch;
use crate::solver::transfer::{Row, Scheme};

/// The product of two lines of nodes.
#[inline(always)]
fn times<const K: usize>(a: &[f64; K], b: &[f64; K]) -> [f64; K] {
    std::array::from_fn(|k| a[k] * b[k])
}

/// The columns of a vector, out of their block: what is written leaves it while the others are read.
fn take_vector<const D: usize>(columns: &mut [Vec<f64>], first: usize) -> [Vec<f64>; D] {
    std::array::from_fn(|a| std::mem::take(&mut columns[first + a]))
}

/// Those of a tensor with `count` components, if there is one.
fn take_tensor(columns: &mut [Vec<f64>], first: Option<usize>, count: usize) -> Taken {
    first.into_iter().flat_map(|k| k..k + count).map(|k| std::mem::take(&mut columns[k])).collect()
}

/// The own rows, the first `rows`, of `N` columns.
#[inline(always)]
fn own<const N: usize>(columns: &mut [Vec<f64>], rows: usize) -> [&mut [f64]; N] {
    let mut columns = columns.iter_mut().map(|column| &mut column[..rows]);
    std::array::from_fn(|_| columns.next().expect("as many columns"))
}

/// Those of a tensor in a plane, if there is one.
#[inline(always)]
fn own_tensor(columns: &mut [Vec<f64>], rows: usize) -> Option<[&mut [f64]; 4]> {
    (!columns.is_empty()).then(|| own(columns, rows))
}

/// Half the sum of two lines of nodes.
#[inline(always)]
fn half_sum<const K: usize>(a: &[f64; K], b: &[f64; K]) -> [f64; K] {
    std::array::from_fn(|k| 0.5 * (a[k] + b[k]))
}

impl<const D: usize> Stepper<D> {
    /// What the end of a leapfrog step brings the own rows: velocity by the scheme, the affine part
    /// with it, and position x += dt N v'; with `strain` what [`Self::gather_gradient`] brings.
    pub(super) fn gather_leapfrog(&self, patch: &mut Patch<D>, dt: f64, strain: bool) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Stepper<D>,
            dt: f64,
            strain: bool,
        ) {
            if const { D == 1 } {
                match strain {
                    false => s.gather_end::<K, 1, true, false>(patch, dt),
                    true => s.gather_end::<K, 1, true, true>(patch, dt),
                }
            } else {
                match strain {
                    false => s.gather_end::<K, K, true, false>(patch, dt),
                    true => s.gather_end::<K, K, true, true>(patch, dt),
                }
            }
            if let Some(affine) = s.columns.affine {
                spend(Effect::Affine, patch, |patch| s.gather_affine::<K>(patch, affine));
            }
        }
        with_width!(patch.stencils.width, go(patch, self, dt, strain));
    }

    /// Divergence of v' at the own rows, its whole gradient where domains deform, and the limiter
    /// from it.
    pub(super) fn gather_gradient(&self, patch: &mut Patch<D>) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Stepper<D>) {
            if const { D == 1 } {
                s.gather_end::<K, 1, false, true>(patch, 0.0);
            } else {
                s.gather_end::<K, K, false, true>(patch, 0.0);
            }
        }
        with_width!(patch.stencils.width, go(patch, self));
    }

    /// Moves the own rows by `dt`, strains them, or both: in one pass, since finding a row's weights
    /// and nodes takes as long as a sum over them.
    fn gather_end<const K: usize, const L: usize, const MOVE: bool, const STRAIN: bool>(
        &self,
        patch: &mut Patch<D>,
        dt: f64,
    ) {
        let (c, f) = (&self.columns, &self.fields);
        let n = patch.block.own();
        let fields = &patch.nodes.fields;
        // of one length, so that a window is looked up once for all of them
        let nodes = fields[f.mass].len();
        let vector = |k: usize| std::array::from_fn::<&[f64], D, _>(|a| &fields[k + a][..nodes]);
        let (lumped, star) = (vector(f.lumped), vector(f.velocity_star));
        let columns = &mut patch.block.columns;
        let [mut x, mut v] = [c.position, c.velocity].map(|k| take_vector::<D>(columns, k));
        let mut divergence = std::mem::take(&mut columns[c.gradient]);
        let mut tensor = take_tensor(columns, c.velocity_gradient, D * D);
        let (own_x, own_v) = (&mut own::<D>(&mut x, n), &mut own::<D>(&mut v, n));
        let own_divergence = &mut divergence[..n];
        let mut own_gradient = own_tensor(&mut tensor, n);
        for (r, row) in patch.stencils.rows::<K, D>(0..n).enumerate() {
            let star = row.windows::<L, D>(star);
            if MOVE {
                for a in 0..D {
                    let new = row.sum(row.values, |line| star[a][line]);
                    let v = &mut own_v[a][r];
                    *v = match self.scheme {
                        Scheme::Blend(share) => {
                            let old = row.dot(row.values, lumped[a]);
                            share * *v + (1.0 - share) * old + (new - old)
                        }
                        Scheme::Series { .. } | Scheme::Affine => new,
                    };
                    own_x[a][r] += dt * new;
                }
            }
            if STRAIN {
                let plane = match &mut own_gradient {
                    Some(gradient) => {
                        let l = tensor_of(&row, |a, line| star[a][line]);
                        put(gradient, 0, r, &l);
                        trace(&l)
                    }
                    None => {
                        let along = |a: usize| row.sum(row.gradient(a), |line| star[a][line]);
                        (1..D).fold(along(0), |sum, a| sum + along(a))
                    }
                };
                let radial = |line: usize| star[0][line];
                own_divergence[r] = self.with_hoop(patch, &row, r, plane, radial);
            }
        }
        let columns = &mut patch.block.columns;
        put_back(columns, c.position, x);
        put_back(columns, c.velocity, v);
        columns[c.gradient] = divergence;
        if let Some(first) = c.velocity_gradient {
            put_back(columns, first, tensor);
        }
        if STRAIN {
            self.gather_limiter::<K>(patch);
        }
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

    fn gather_limiter<const K: usize>(&self, patch: &mut Patch<D>) {
        let (Some(limiter), Some(column)) =
            (self.viscosity.and_then(|v| v.limiter), self.columns.limiter)
        else {
            return;
        };
        let (fields, star) = (&patch.nodes.fields, self.fields.velocity_star);
        let stride = patch.stencils.stride;
        let nodes = Nodes {
            velocity: std::array::from_fn::<&[f64], D, _>(|a| &fields[star + a]),
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
                        artificial_viscosity::christensen(&nodes, node)
                    }
                    Limiter::Nodal => {
                        let row = patch.stencils.row::<K, D>(r);
                        artificial_viscosity::nodal(
                            &nodes,
                            &row,
                            gradient[r],
                            self.push_of(patch, r),
                        )
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
            if const { D == 1 } {
                s.gather_rows::<K, 1, false>(patch, dt);
            } else {
                match s.tensor_stress() {
                    false => s.gather_rows::<K, K, false>(patch, dt),
                    true => s.gather_rows::<K, K, true>(patch, dt),
                }
            }
            if let Some(affine) = s.columns.affine {
                spend(Effect::Affine, patch, |patch| s.gather_affine::<K>(patch, affine));
            }
            s.gather_limiter::<K>(patch);
        }
        with_width!(patch.stencils.width, go(patch, self, dt));
    }

    fn gather_rows<const K: usize, const L: usize, const TENSOR: bool>(
        &self,
        patch: &mut Patch<D>,
        dt: f64,
    ) {
        let (c, f) = (&self.columns, &self.fields);
        let n = patch.block.own();
        let fields = &patch.nodes.fields;
        // of one length, so that a window is looked up once for all of them
        let nodes = fields[f.mass].len();
        let vector = |k: usize| std::array::from_fn::<&[f64], D, _>(|a| &fields[k + a][..nodes]);
        let (lumped, start, star) = (vector(f.lumped), vector(f.velocity), vector(f.velocity_star));
        let work = vector(f.work);
        let remainder = f.remainder.filter(|_| self.filter_heat).map(vector);
        let columns = &mut patch.block.columns;
        let [mut x, mut v] = [c.position, c.velocity].map(|k| take_vector::<D>(columns, k));
        let [mut j, mut e, mut d] =
            [c.jacobian, c.energy, c.gradient].map(|k| std::mem::take(&mut columns[k]));
        let [mut deformation, mut gradient] =
            [c.deformation, c.velocity_gradient].map(|k| take_tensor(columns, k, D * D));
        let (own_x, own_v) = (&mut own::<D>(&mut x, n), &mut own::<D>(&mut v, n));
        let [own_j, own_e, own_d] = [&mut j, &mut e, &mut d].map(|column| &mut column[..n]);
        let mut own_deformation = own_tensor(&mut deformation, n);
        let mut own_gradient = own_tensor(&mut gradient, n);
        let column = |k: usize| &patch.block.columns[k][..n];
        let mid = c.jacobian_mid.expect("mid-point stepping has the column");
        let (mass, j_mid, stress) = (column(c.mass), column(mid), column(c.stress_volume));
        for (r, row) in patch.stencils.rows::<K, D>(0..n).enumerate() {
            // looked up once, for they are summed many times
            let (mut means, star) = (row.windows::<L, D>(start), row.windows::<L, D>(star));
            let mut filtered = [0.0; D];
            if remainder.is_some() {
                for a in 0..D {
                    filtered[a] = row.sum(row.values, |line| means[a][line]);
                }
            }
            for a in 0..D {
                for line in 0..L {
                    means[a][line] = half_sum(&means[a][line], &star[a][line]);
                }
            }
            let mean = |a: usize, line: usize| means[a][line];
            let (mut heat, mut new) = (0.0, [0.0; D]);
            for a in 0..D {
                let old = own_v[a][r];
                new[a] = row.sum(row.values, |line| star[a][line]);
                match self.scheme {
                    Scheme::Series { .. } => {
                        if let Some(lost) = remainder {
                            let [lost] = row.windows::<L, 1>([lost[a]]);
                            let both = |l: usize| times(&lost[l], &mean(a, l));
                            let rest = old - filtered[a];
                            heat += 0.5 * rest * rest
                                + (row.sum(row.values, both)
                                    - row.sum(row.values, |l| lost[l])
                                        * row.sum(row.values, |l| mean(a, l)));
                        }
                    }
                    Scheme::Blend(share) => {
                        let [lumped] = row.windows::<L, 1>([lumped[a]]);
                        let on_grid = row.sum(row.values, |l| lumped[l]);
                        let change = new[a] - on_grid;
                        if self.filter_heat {
                            let square = |l: usize| times(&lumped[l], &lumped[l]);
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
            let plane = match (&mut own_deformation, &own_gradient) {
                (Some(deformation), Some(gradient)) => {
                    let during = tensor_of(&row, mean);
                    if self.total {
                        deform_linearly(deformation, gradient, r, &during, dt);
                    } else {
                        deform(deformation, r, &during, dt);
                    }
                    trace(&during)
                }
                _ => (0..D).map(|a| row.sum(row.gradient(a), |l| mean(a, l))).sum(),
            };
            let end = match &mut own_gradient {
                Some(gradient) => {
                    let end = tensor_of(&row, |a, l| star[a][l]);
                    put(gradient, 0, r, &end);
                    trace(&end)
                }
                None => (0..D).map(|a| row.sum(row.gradient(a), |l| star[a][l])).sum(),
            };
            let divergence = self.with_hoop(patch, &row, r, plane, |l| mean(0, l));
            // the velocity that does the work
            let does = if self.compatible { row.windows::<L, D>(work) } else { means };
            let work_done = if TENSOR {
                dt * self.stress_power(patch, &row, r, |a, line| does[a][line])
            } else {
                let working = if self.compatible {
                    let along = |a: usize| row.sum(row.gradient(a), |line| does[a][line]);
                    self.with_hoop(patch, &row, r, (0..D).map(along).sum(), |line| does[0][line])
                } else {
                    divergence
                };
                stress[r] * dt * working
            };
            for a in 0..D {
                own_x[a][r] += match self.scheme {
                    // with the grid: the particles' own velocities would tear their tiling
                    Scheme::Blend(_) => dt * row.sum(row.values, |l| mean(a, l)),
                    _ => 0.5 * dt * (own_v[a][r] + new[a]),
                };
                own_v[a][r] = new[a];
            }
            own_j[r] += dt * j_mid[r] * divergence;
            own_e[r] += heat - work_done / mass[r];
            own_d[r] = self.with_hoop(patch, &row, r, end, |l| star[0][l]);
        }
        let columns = &mut patch.block.columns;
        put_back(columns, c.position, x);
        put_back(columns, c.velocity, v);
        columns[c.jacobian] = j;
        columns[c.energy] = e;
        columns[c.gradient] = d;
        for (first, taken) in [(c.deformation, deformation), (c.velocity_gradient, gradient)] {
            if let Some(first) = first {
                put_back(columns, first, taken);
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
fn deform<const D: usize>(columns: &mut [&mut [f64]; 4], row: usize, l: &[[f64; D]; D], dt: f64) {
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
    columns: &mut [&mut [f64]; 4],
    before: &[&mut [f64]; 4],
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
    columns: &mut [impl DerefMut<Target = [f64]>],
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
