//! Update of particles at the end of a mid-point step from the sums over their nodes.
//!
//! It is computed for several particles at a time, each operation for all of them before the next, so
//! that compilers assign one vector lane to each particle.

use std::ops::Range;

use decomp::array::{from_fn, map, part, part_mut};

use super::gather::OwnTensor;
use super::nodal_sums::{BLOCK, NodalSums};
use super::scheme::Scheme;
use crate::shape::LANES;
use crate::transfer::VelocityUpdate;

/// Columns of the own particles that the end of a mid-point step reads or writes.
pub(super) struct MidpointColumns<'a, const D: usize> {
    /// Position [m] and velocity [m/s].
    pub position: [&'a mut [f64]; D],
    pub velocity: [&'a mut [f64]; D],
    /// Volume ratio [-].
    pub jacobian: &'a mut [f64],
    /// Specific internal energy [J/kg].
    pub energy: &'a mut [f64],
    /// Divergence of the velocity of the step [1/s].
    pub divergence: &'a mut [f64],
    /// See [`Columns::mean_work_energy`](super::columns::Columns).
    pub mean_work_energy: Option<&'a mut [f64]>,
    /// Deformation gradient [-] and velocity gradient [1/s].
    pub deformation: OwnTensor<'a>,
    pub velocity_gradient: OwnTensor<'a>,
    /// Mass [kg].
    pub mass: &'a [f64],
    /// Volume ratio at the middle of the step [-].
    pub jacobian_mid: &'a [f64],
    /// Stress times volume [J]: xx, yy, xy and zz, or one component four times.
    pub stress: [&'a [f64]; 4],
}

impl<const D: usize> MidpointColumns<'_, D> {
    /// The columns of `count` particles from `first` on.
    #[inline(always)]
    fn part(&mut self, first: usize, count: usize) -> MidpointColumns<'_, D> {
        let these = || first..first + count;
        MidpointColumns {
            position: self.position.each_mut().map(|column| &mut column[these()]),
            velocity: self.velocity.each_mut().map(|column| &mut column[these()]),
            jacobian: &mut self.jacobian[these()],
            energy: &mut self.energy[these()],
            divergence: &mut self.divergence[these()],
            mean_work_energy: self.mean_work_energy.as_mut().map(|column| &mut column[these()]),
            deformation: part_of_tensor(&mut self.deformation, these()),
            velocity_gradient: part_of_tensor(&mut self.velocity_gradient, these()),
            mass: &self.mass[these()],
            jacobian_mid: &self.jacobian_mid[these()],
            stress: map(&self.stress, |column| &column[these()]),
        }
    }
}

/// `particles` of the columns of a tensor, if it exists.
#[inline(always)]
fn part_of_tensor<'a>(tensor: &'a mut OwnTensor<'_>, particles: Range<usize>) -> OwnTensor<'a> {
    let tensor = tensor.as_mut()?;
    Some(tensor.each_mut().map(|column| &mut column[particles.clone()]))
}

/// Trace of the gradients of `L` particles, plus their hoop strain rates at a `distance` from an axis
/// [m], if there is one [1/s].
#[inline(always)]
fn divergence_of<const D: usize, const L: usize>(
    gradient: &[[[f64; L]; D]; D],
    radial: &[f64; L],
    distance: Option<[f64; L]>,
) -> [f64; L] {
    let mut plane = gradient[0][0];
    for a in 1..D {
        plane = from_fn(|i| plane[i] + gradient[a][a][i]);
    }
    distance.map_or(plane, |radius| from_fn(|i| plane[i] + radial[i] / radius[i]))
}

/// Work of the components xx, yy, xy and zz of stress times volume `s` [J] in a step of `dt` [s] at
/// velocities with the gradients `g` [1/s], whose components along x are `radial` [m/s] at the distances
/// `distance` from an axis [m].
#[inline(always)]
fn tensor_work<const D: usize, const L: usize>(
    s: &[[f64; L]; 4],
    g: &[[[f64; L]; D]; D],
    radial: &[f64; L],
    distance: Option<[f64; L]>,
    dt: f64,
) -> [f64; L] {
    let [xx, xy, yx, yy] = [g[0][0], g[0][D - 1], g[D - 1][0], g[D - 1][D - 1]];
    let plane: [f64; L] =
        from_fn(|i| s[0][i] * xx[i] + s[1][i] * yy[i] + s[2][i] * (xy[i] + yx[i]));
    match distance {
        Some(radius) => from_fn(|i| dt * (plane[i] + s[3][i] * radial[i] / radius[i])),
        None => from_fn(|i| dt * plane[i]),
    }
}

impl<const D: usize> Scheme<D> {
    /// Updates `count` particles from `first` on at the end of a step of `dt` [s] from their `sums`;
    /// `radius` are their distances from the axis [m], with axial symmetry.
    #[inline(always)]
    pub(super) fn update_block(
        &self,
        columns: &mut MidpointColumns<'_, D>,
        [first, count]: [usize; 2],
        sums: &NodalSums<D, [f64; BLOCK]>,
        radius: Option<&[f64; BLOCK]>,
        dt: f64,
    ) {
        match count {
            // with a length known at compile time the compiler removes the bounds checks
            BLOCK => self.update(&mut columns.part(first, BLOCK), BLOCK, sums, radius, dt),
            _ => self.update_last(&mut columns.part(first, count), count, sums, radius, dt),
        }
    }

    /// The same for fewer particles than a block.
    #[inline(never)]
    fn update_last(
        &self,
        columns: &mut MidpointColumns<'_, D>,
        count: usize,
        sums: &NodalSums<D, [f64; BLOCK]>,
        radius: Option<&[f64; BLOCK]>,
        dt: f64,
    ) {
        self.update(columns, count, sums, radius, dt);
    }

    /// The same for the first `count` particles of `columns`.
    #[inline(always)]
    fn update(
        &self,
        columns: &mut MidpointColumns<'_, D>,
        count: usize,
        sums: &NodalSums<D, [f64; BLOCK]>,
        radius: Option<&[f64; BLOCK]>,
        dt: f64,
    ) {
        let whole = count / LANES;
        for k in (0..whole).map(|k| LANES * k) {
            let distance = radius.map(|radius| *part(radius, k));
            self.update_some::<LANES>(columns, k, &sums.part(k), distance, dt);
        }
        for k in LANES * whole..count {
            let distance = radius.map(|radius| *part(radius, k));
            self.update_some::<1>(columns, k, &sums.part(k), distance, dt);
        }
    }

    /// The same for `L` particles from `r` on.
    #[inline(always)]
    fn update_some<const L: usize>(
        &self,
        columns: &mut MidpointColumns<'_, D>,
        r: usize,
        at: &NodalSums<D, [f64; L]>,
        distance: Option<[f64; L]>,
        dt: f64,
    ) {
        let old: [[f64; L]; D] = from_fn(|a| *part(columns.velocity[a], r));
        let (new, heat) = self.end_velocity(&old, at);
        self.end_strain(columns, r, at, dt);
        let mean_divergence = divergence_of(&at.mean_gradient, &at.mean[0], distance);
        let s: [[f64; L]; 4] = map(&columns.stress, |stress| *part(stress, r));
        let (mass, j_mid) = (part::<L>(columns.mass, r), part::<L>(columns.jacobian_mid, r));
        let work_done = self.work_done(&s, at, &mean_divergence, distance, dt);
        let energy = part_mut::<L>(columns.energy, r);
        if let Some(mean_work_energy) = &mut columns.mean_work_energy {
            let work = match self.tensor_stress() {
                true => tensor_work(&s, &at.mean_gradient, &at.mean[0], distance, dt),
                false => from_fn(|i| s[0][i] * dt * mean_divergence[i]),
            };
            *part_mut(mean_work_energy, r) = from_fn::<_, L, _>(|i| energy[i] - work[i] / mass[i]);
        }
        *energy = from_fn(|i| energy[i] + (heat[i] - work_done[i] / mass[i]));
        for a in 0..D {
            let x = part_mut::<L>(columns.position[a], r);
            *x = match self.transfer.update {
                // with the grid: the particles' own velocities would break up the tiling
                VelocityUpdate::Blend(_) => from_fn(|i| x[i] + dt * at.mean[a][i]),
                _ => from_fn(|i| x[i] + 0.5 * dt * (old[a][i] + new[a][i])),
            };
            *part_mut(columns.velocity[a], r) = new[a];
        }
        let j = part_mut::<L>(columns.jacobian, r);
        *j = from_fn(|i| j[i] + dt * j_mid[i] * mean_divergence[i]);
        let mut star_divergence = divergence_of(&at.star_gradient, &at.star[0], distance);
        if !self.total_lagrangian {
            // relative to the end of the step, the rates give the volume at the middle of the next one
            // to second order in time
            let share: [f64; L] = from_fn(|i| j_mid[i] / j[i]);
            star_divergence = from_fn(|i| star_divergence[i] * share[i]);
            for component in columns.velocity_gradient.iter_mut().flatten() {
                let component = part_mut::<L>(component, r);
                *component = from_fn(|i| component[i] * share[i]);
            }
        }
        *part_mut(columns.divergence, r) = star_divergence;
    }

    /// Velocities at the end of a step [m/s] from the `old` ones, and the heat of the filter per unit
    /// mass [J/kg].
    #[inline(always)]
    fn end_velocity<const L: usize>(
        &self,
        old: &[[f64; L]; D],
        at: &NodalSums<D, [f64; L]>,
    ) -> ([[f64; L]; D], [f64; L]) {
        let (mut heat, mut new) = ([0.0; L], at.star);
        for a in 0..D {
            let (start, mean) = (&at.start[a], &at.mean[a]);
            let (lost, product) = (&at.lost[a], &at.product[a]);
            let rest: [f64; L] = from_fn(|i| old[a][i] - start[i]);
            match self.transfer.update {
                VelocityUpdate::Filtered => {
                    if self.filter_heat && self.fields.filter_residual.is_some() {
                        heat = from_fn(|i| {
                            let removed = product[i] - lost[i] * mean[i];
                            heat[i] + (0.5 * rest[i] * rest[i] + removed)
                        });
                    }
                }
                VelocityUpdate::Blend(share) => {
                    if self.filter_heat {
                        heat = from_fn(|i| {
                            let kept = 0.5 * (1.0 - share * share) * rest[i] * rest[i];
                            let removed = (1.0 - share) * (product[i] - start[i] * start[i]);
                            heat[i] + (kept + removed)
                        });
                    }
                    new[a] = from_fn(|i| {
                        let change = new[a][i] - start[i];
                        share * old[a][i] + (1.0 - share) * start[i] + change
                    });
                }
                VelocityUpdate::Affine => {}
            }
        }
        (new, heat)
    }

    /// Deformation and velocity gradient at the end of a step, if particles have them.
    #[inline(always)]
    fn end_strain<const L: usize>(
        &self,
        columns: &mut MidpointColumns<'_, D>,
        r: usize,
        at: &NodalSums<D, [f64; L]>,
        dt: f64,
    ) {
        let Some(gradient) = &mut columns.velocity_gradient else { return };
        if let Some(deformation) = &mut columns.deformation {
            let l = &at.mean_gradient;
            let l = [&l[0][0], &l[0][D - 1], &l[D - 1][0], &l[D - 1][D - 1]];
            let f: [[f64; L]; 4] = from_fn(|k| *part(deformation[k], r));
            let f = match self.total_lagrangian {
                true => deformed_linearly(f, l, from_fn(|k| *part(gradient[k], r)), dt),
                false => deformed(f, l, dt),
            };
            (0..4).for_each(|k| *part_mut(deformation[k], r) = f[k]);
        }
        for (a, b) in (0..D).flat_map(|a| (0..D).map(move |b| (a, b))) {
            *part_mut(gradient[D * a + b], r) = at.star_gradient[a][b];
        }
    }

    /// Work that the stress times volume `s` [J] does in a step [J], with the divergence
    /// `mean_divergence` of the mean nodal velocity [1/s], at a `distance` from the axis [m] with axial
    /// symmetry.
    #[inline(always)]
    fn work_done<const L: usize>(
        &self,
        s: &[[f64; L]; 4],
        at: &NodalSums<D, [f64; L]>,
        mean_divergence: &[f64; L],
        distance: Option<[f64; L]>,
        dt: f64,
    ) -> [f64; L] {
        if self.tensor_stress() {
            return tensor_work(s, &at.work_gradient, &at.work, distance, dt);
        }
        let working = match self.compatible {
            true => divergence_of(&at.work_gradient, &at.work, distance),
            false => *mean_divergence,
        };
        from_fn(|i| s[0][i] * dt * working[i])
    }
}

/// Deformation gradients `f` after `dt` with the velocity gradients `l`, by Cayley's form
/// (1 - dt/2 l)^-1 (1 + dt/2 l) F, which keeps a rotation free of stretching.
#[inline(always)]
fn deformed<const L: usize>(f: [[f64; L]; 4], l: [&[f64; L]; 4], dt: f64) -> [[f64; L]; 4] {
    let half = 0.5 * dt;
    let [xx, xy, yx, yy]: [[f64; L]; 4] = map(&l, |l| from_fn(|i| half * l[i]));
    let inverse: [f64; L] = from_fn(|i| 1.0 / ((1.0 - xx[i]) * (1.0 - yy[i]) - xy[i] * yx[i]));
    let column = |x: &[f64; L], y: &[f64; L]| -> [[f64; L]; 2] {
        let mid_x: [f64; L] = from_fn(|i| x[i] + xx[i] * x[i] + xy[i] * y[i]);
        let mid_y: [f64; L] = from_fn(|i| y[i] + yx[i] * x[i] + yy[i] * y[i]);
        [
            from_fn(|i| inverse[i] * ((1.0 - yy[i]) * mid_x[i] + xy[i] * mid_y[i])),
            from_fn(|i| inverse[i] * (yx[i] * mid_x[i] + (1.0 - xx[i]) * mid_y[i])),
        ]
    };
    let ([f_xx, f_yx], [f_xy, f_yy]) = (column(&f[0], &f[2]), column(&f[1], &f[3]));
    [f_xx, f_xy, f_yx, f_yy]
}

/// F + dt l F_h, with the deformation at the middle of the step F_h = (1 + dt/2 L) F, which has pushed
/// the velocity gradients `l` forward, and L the gradients `before`: F then follows from the
/// displacements of the grid.
#[inline(always)]
fn deformed_linearly<const L: usize>(
    f: [[f64; L]; 4],
    [xx, xy, yx, yy]: [&[f64; L]; 4],
    before: [[f64; L]; 4],
    dt: f64,
) -> [[f64; L]; 4] {
    let half = 0.5 * dt;
    let column = |x: &[f64; L], y: &[f64; L]| -> [[f64; L]; 2] {
        let at =
            |a: usize, i: usize| half * (before[2 * a][i] * x[i] + before[2 * a + 1][i] * y[i]);
        let mid_x: [f64; L] = from_fn(|i| x[i] + at(0, i));
        let mid_y: [f64; L] = from_fn(|i| y[i] + at(1, i));
        [
            from_fn(|i| x[i] + dt * (xx[i] * mid_x[i] + xy[i] * mid_y[i])),
            from_fn(|i| y[i] + dt * (yx[i] * mid_x[i] + yy[i] * mid_y[i])),
        ]
    };
    let ([f_xx, f_yx], [f_xy, f_yy]) = (column(&f[0], &f[2]), column(&f[1], &f[3]));
    [f_xx, f_xy, f_yx, f_yy]
}
