//! Grid to particles at the end of a mid-point step, for own particles only.

use decomp::array::from_fn;

use super::gather::{OwnTensor, own, own_tensor, put, take_tensor, take_vector, trace};
use super::nodal_sums::{NodalSums, NodalVelocities, PackedVelocities};
use super::scheme::Scheme;
use super::solid::put_back;
use crate::shape::with_width;
use crate::solver::clock::timed;
use crate::solver::packed::with_packed;
use crate::solver::parts::StepPart;
use crate::solver::patch::Patch;
use crate::transfer::VelocityUpdate;

/// Scales the velocity gradient of a particle, if it exists, by `share`, the ratio of the volumes at
/// the middle and the end of the step. Relative to the end, it gives the volume at the middle of the
/// next step to second order in time.
#[inline(always)]
fn scale(gradient: &mut OwnTensor<'_>, particle: usize, share: f64) {
    for component in gradient.iter_mut().flatten() {
        component[particle] *= share;
    }
}

/// Divergence `plane` in the plane, plus the hoop strain rate at a radius, if there is one [1/s].
#[inline(always)]
fn with_hoop(plane: f64, radial: f64, radius: Option<f64>) -> f64 {
    match radius {
        Some(radius) => plane + radial / radius,
        None => plane,
    }
}

/// Work of the components xx, yy, xy and zz of stress times volume `s` [J] in a step of `dt` [s] at a
/// velocity with the gradient `g` [1/s], whose component along x is `radial` [m/s] at the distance
/// `hoop` from an axis [m].
#[inline(always)]
fn tensor_work<const D: usize>(
    s: [f64; 4],
    g: &[[f64; D]; D],
    radial: f64,
    hoop: Option<f64>,
    dt: f64,
) -> f64 {
    let [x, y] = [0, D - 1];
    let plane = s[0] * g[x][x] + s[1] * g[y][y] + s[2] * (g[x][y] + g[y][x]);
    match hoop {
        Some(radius) => dt * (plane + s[3] * radial / radius),
        None => dt * plane,
    }
}

impl<const D: usize> Scheme<D> {
    /// Updates the own particles at the end of a mid-point step of `dt` [s]: volume and energy from
    /// the gradients of the mean velocity and of w, heat of the filter, velocity, position and
    /// domain.
    pub(super) fn gather_midpoint(&self, patch: &mut Patch<D>, dt: f64) {
        fn packed<const K: usize, const V: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            dt: f64,
        ) {
            match s.columns.mean_work_energy {
                Some(_) => packed_with::<K, V, D, true>(patch, s, dt),
                None => packed_with::<K, V, D, false>(patch, s, dt),
            }
        }
        fn packed_with<const K: usize, const V: usize, const D: usize, const MEAN: bool>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            dt: f64,
        ) {
            let (mut window, mut at) = (PackedVelocities::<V, D>::none(), u32::MAX);
            patch.with_stencils(|patch, stencils| {
                s.gather_particles::<MEAN>(patch, dt, |r, nodal| {
                    if !stencils.is_narrow::<K>(r) {
                        return NodalSums::one_by_one::<K, K>(nodal, &stencils.particle::<K, D>(r));
                    }
                    // several particles of a cell have the same window
                    if stencils.first[r] != at {
                        at = stencils.first[r];
                        window.fetch::<K>(nodal, stencils.place(r));
                    }
                    window.sums::<K>(nodal, &stencils.packed::<K, V, D>(r))
                });
            });
        }
        fn single<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Scheme<D>, dt: f64) {
            match s.columns.mean_work_energy {
                Some(_) => single_with::<K, D, true>(patch, s, dt),
                None => single_with::<K, D, false>(patch, s, dt),
            }
        }
        fn single_with<const K: usize, const D: usize, const MEAN: bool>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            dt: f64,
        ) {
            patch.with_stencils(|patch, stencils| {
                let mut all = stencils.particles::<K, D>(0..patch.block.own());
                s.gather_particles::<MEAN>(patch, dt, |_, nodal| {
                    let weights = all.next().expect("those of each own particle");
                    if const { D == 1 } {
                        NodalSums::one_by_one::<K, 1>(nodal, &weights)
                    } else {
                        NodalSums::one_by_one::<K, K>(nodal, &weights)
                    }
                });
            });
        }
        fn rest<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Scheme<D>) {
            if let Some(affine) = s.columns.affine {
                timed(StepPart::Affine as usize, patch, |patch| {
                    s.gather_affine::<K>(patch, affine)
                });
            }
            s.gather_limiter::<K>(patch);
        }
        let width = patch.stencils.width;
        with_packed!(width, packed(patch, self, dt), with_width!(width, single(patch, self, dt)));
        with_width!(width, rest(patch, self));
    }

    /// Updates the own particles with the `sums` over the nodes of each, asked for in their order by
    /// the index. With `MEAN`, [`Columns::mean_work_energy`](super::columns::Columns) is written.
    #[inline(always)]
    fn gather_particles<const MEAN: bool>(
        &self,
        patch: &mut Patch<D>,
        dt: f64,
        mut sums: impl FnMut(usize, &NodalVelocities<'_, D>) -> NodalSums<D>,
    ) {
        let c = &self.columns;
        let n = patch.block.own();
        let nodal = self.nodal_velocities(&patch.nodes.fields);
        let columns = &mut patch.block.columns;
        let [mut x, mut v] = [c.position, c.velocity].map(|k| take_vector::<D>(columns, k));
        let [mut j, mut e, mut d] =
            [c.jacobian, c.energy, c.divergence].map(|k| std::mem::take(&mut columns[k]));
        let mut mean_work_energy = match c.mean_work_energy {
            Some(k) if MEAN => std::mem::take(&mut columns[k]),
            _ => Vec::new(),
        };
        let [mut deformation, mut gradient] =
            [c.deformation, c.velocity_gradient].map(|k| take_tensor(columns, k, D * D));
        let (own_x, own_v) = (&mut own::<D>(&mut x, n), &mut own::<D>(&mut v, n));
        let [own_j, own_e, own_d] = [&mut j, &mut e, &mut d].map(|column| &mut column[..n]);
        let mut own_deformation = own_tensor(&mut deformation, n);
        let mut own_gradient = own_tensor(&mut gradient, n);
        let column = |k: usize| &patch.block.columns[k][..n];
        let mid = c.jacobian_mid.expect("mid-point stepping has the column");
        let (mass, j_mid) = (column(c.mass), column(mid));
        // as many as a tensor has; a scalar stress has one
        let stress: [&[f64]; 4] =
            from_fn(|k| column(c.stress_volume + k.min(c.stress_volumes - 1)));
        for r in 0..n {
            let at = sums(r, &nodal);
            let old = from_fn(|a| own_v[a][r]);
            let (new, heat) = self.end_velocity(old, &at);
            self.end_strain(r, &at, (&mut own_deformation, &mut own_gradient), dt);
            let hoop = self.hoop_of(patch, r);
            let plane = trace(&at.mean_gradient);
            let divergence = with_hoop(plane, at.mean[0], hoop);
            let s = from_fn(|k| stress[k][r]);
            let work_done = self.work_done(s, &at, divergence, hoop, dt);
            if MEAN {
                let work = self.mean_work(s, &at, divergence, hoop, dt);
                mean_work_energy[r] = own_e[r] - work / mass[r];
            }
            for a in 0..D {
                own_x[a][r] += match self.transfer.update {
                    // with the grid: the particles' own velocities would break up the tiling
                    VelocityUpdate::Blend(_) => dt * at.mean[a],
                    _ => 0.5 * dt * (own_v[a][r] + new[a]),
                };
                own_v[a][r] = new[a];
            }
            own_j[r] += dt * j_mid[r] * divergence;
            own_e[r] += heat - work_done / mass[r];
            let plane = trace(&at.star_gradient);
            own_d[r] = with_hoop(plane, at.star[0], hoop);
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
        if let Some(k) = c.mean_work_energy {
            columns[k] = mean_work_energy;
        }
        for (first, taken) in [(c.deformation, deformation), (c.velocity_gradient, gradient)] {
            if let Some(first) = first {
                put_back(columns, first, taken);
            }
        }
    }

    /// Nodal velocities that the gather needs.
    #[inline(always)]
    fn nodal_velocities<'a>(&self, fields: &'a [Vec<f64>]) -> NodalVelocities<'a, D> {
        let f = &self.fields;
        // slices of equal length, so that the bounds of a window are checked only once
        let nodes = fields[f.mass].len();
        let vector = |k: usize| from_fn::<&[f64], D, _>(|a| &fields[k + a][..nodes]);
        let is_blend = matches!(self.transfer.update, VelocityUpdate::Blend(_));
        NodalVelocities {
            start: vector(f.velocity),
            star: vector(f.velocity_star),
            work: self.compatible.then(|| vector(f.work)),
            lost: f.filter_residual.filter(|_| self.filter_heat).map(vector),
            squares: is_blend && self.filter_heat,
            tensors: self.columns.velocity_gradient.is_some(),
            work_tensor: self.tensor_stress() || self.axisymmetric,
        }
    }

    /// Velocity of a particle at the end of a step [m/s] from its `old` one, and the heat of the
    /// filter per unit mass [J/kg].
    #[inline(always)]
    fn end_velocity(&self, old: [f64; D], at: &NodalSums<D>) -> ([f64; D], f64) {
        let (mut heat, mut new) = (0.0, at.star);
        for a in 0..D {
            let rest = old[a] - at.start[a];
            match self.transfer.update {
                VelocityUpdate::Filtered => {
                    if self.filter_heat && self.fields.filter_residual.is_some() {
                        heat += 0.5 * rest * rest + (at.product[a] - at.lost[a] * at.mean[a]);
                    }
                }
                VelocityUpdate::Blend(share) => {
                    let on_grid = at.start[a];
                    let change = new[a] - on_grid;
                    if self.filter_heat {
                        heat += 0.5 * (1.0 - share * share) * rest * rest
                            + (1.0 - share) * (at.product[a] - on_grid * on_grid);
                    }
                    new[a] = share * old[a] + (1.0 - share) * on_grid + change;
                }
                VelocityUpdate::Affine => {}
            }
        }
        (new, heat)
    }

    /// Deformation and velocity gradient of a particle at the end of a step, if it has them.
    #[inline(always)]
    fn end_strain(
        &self,
        r: usize,
        at: &NodalSums<D>,
        (deformation, gradient): (&mut OwnTensor<'_>, &mut OwnTensor<'_>),
        dt: f64,
    ) {
        if let (Some(deformation), Some(gradient)) = (deformation, &*gradient) {
            if self.total_lagrangian {
                deform_linearly(deformation, gradient, r, &at.mean_gradient, dt);
            } else {
                deform(deformation, r, &at.mean_gradient, dt);
            }
        }
        if let Some(gradient) = gradient {
            put(gradient, 0, r, &at.star_gradient);
        }
    }

    /// Work that the stress times volume `s` [J] of a particle does in a step [J], with the
    /// `divergence` of the mean nodal velocity [1/s]; `hoop` is its distance from the axis [m], with
    /// axial symmetry.
    #[inline(always)]
    fn work_done(
        &self,
        s: [f64; 4],
        at: &NodalSums<D>,
        divergence: f64,
        hoop: Option<f64>,
        dt: f64,
    ) -> f64 {
        if self.tensor_stress() {
            return tensor_work(s, &at.work_gradient, at.work, hoop, dt);
        }
        let working = match self.compatible {
            true => with_hoop(trace(&at.work_gradient), at.work, hoop),
            false => divergence,
        };
        s[0] * dt * working
    }

    /// The same work at the mean nodal velocity.
    #[inline(always)]
    fn mean_work(
        &self,
        s: [f64; 4],
        at: &NodalSums<D>,
        divergence: f64,
        hoop: Option<f64>,
        dt: f64,
    ) -> f64 {
        match self.tensor_stress() {
            true => tensor_work(s, &at.mean_gradient, at.mean[0], hoop, dt),
            false => s[0] * dt * divergence,
        }
    }

    /// Distance of a particle from the axis [m], with axial symmetry.
    #[inline(always)]
    fn hoop_of(&self, patch: &Patch<D>, r: usize) -> Option<f64> {
        if D > 1 && self.axisymmetric { Some(self.radius(patch, r)) } else { None }
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
