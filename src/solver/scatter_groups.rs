//! Particles to grid by groups of particles that follow each other and have the same window: their
//! sums stay in vectors from one particle to the next.

use std::ops::Range;

use decomp::array;
use wide::f64x4;

use super::band::{Band, Spinning, TOGETHER};
use super::scheme::Scheme;
use super::spin::packed_inertia;
use crate::solver::packed::{WindowPlace, add_to, totals};
use crate::solver::particle_weights::Offset;
use crate::solver::patch::Patch;
use crate::solver::shape_weights::Stencils;
use crate::solver::summed_fields::{SummedColumns, SummedSlices};

/// Sums on a window of two nodes along each direction of a plane.
struct SquareSums<const D: usize> {
    mass: [f64x4; 1],
    momentum: [[f64x4; 1]; D],
    force: [[f64x4; 1]; D],
}

impl<const D: usize> SummedSlices<'_, D> {
    /// Sums of mass, momentum and force on a window of two nodes along each direction.
    #[inline(always)]
    fn square(&self, place: WindowPlace) -> SquareSums<D> {
        let nodes = |field: &[f64]| place.nodes::<2, 1>(field);
        SquareSums {
            mass: nodes(self.mass),
            momentum: array::from_fn(|a| nodes(self.momentum[a])),
            force: array::from_fn(|a| nodes(self.force[a])),
        }
    }

    /// Writes these sums to the nodes.
    #[inline(always)]
    fn put_square(&mut self, place: WindowPlace, sums: &SquareSums<D>) {
        place.put::<2, 1>(self.mass, &sums.mass);
        for a in 0..D {
            place.put::<2, 1>(self.momentum[a], &sums.momentum[a]);
            place.put::<2, 1>(self.force[a], &sums.force[a]);
        }
    }

    /// Adds mass and momentum of a group of particles.
    #[inline(always)]
    fn add_motion<const K: usize, const V: usize>(
        &mut self,
        stencils: &Stencils,
        group: Range<usize>,
        of: &SummedColumns<'_, D>,
    ) {
        let place = stencils.place(group.start);
        let mut mass = place.nodes::<K, V>(self.mass);
        let mut momentum = [mass; D];
        for a in 0..D {
            momentum[a] = place.nodes::<K, V>(self.momentum[a]);
        }
        for r in group {
            let (values, m) = (stencils.packed_values::<K, V, D>(r), of.mass[r]);
            add_to(&mut mass, &values, m);
            for a in 0..D {
                add_to(&mut momentum[a], &values, m * of.velocity[a][r]);
            }
        }
        place.put::<K, V>(self.mass, &mass);
        for a in 0..D {
            place.put::<K, V>(self.momentum[a], &momentum[a]);
        }
    }

    /// The same of particles that turn, in a plane with cells of the edges `cell` \[m\]; `turning`
    /// gives the distances of a particle's nodes and the rates of rotation of its two components \[1/s\].
    #[inline(always)]
    fn add_spinning<const K: usize, const V: usize>(
        &mut self,
        stencils: &Stencils,
        group: Range<usize>,
        of: &SummedColumns<'_, D>,
        cell: [f64; D],
        turning: impl Fn(usize) -> (Offset<D>, [f64; 2]),
    ) {
        let place = stencils.place(group.start);
        let (x, y) = (0, D - 1);
        let mut mass = place.nodes::<K, V>(self.mass);
        let mut along_x = place.nodes::<K, V>(self.momentum[x]);
        let mut along_y = place.nodes::<K, V>(self.momentum[y]);
        for r in group {
            let (values, m) = (stencils.packed_values::<K, V, D>(r), of.mass[r]);
            add_to(&mut mass, &values, m);
            let (offset, rates) = turning(r);
            let [vx, vy] = [x, y].map(|a| m * of.velocity[a][r]);
            let slope = m * -rates[0] * cell[y];
            for line in 0..V {
                let term = vx + slope * offset.at(y, line);
                along_x[line] += values[line] * f64x4::splat(term);
            }
            let nodes = f64x4::from([0, 1, 2, 3].map(|k| offset.at(x, k)));
            let terms = f64x4::splat(vy) + f64x4::splat(m * rates[1] * cell[x]) * nodes;
            for line in 0..V {
                along_y[line] += values[line] * terms;
            }
        }
        place.put::<K, V>(self.mass, &mass);
        place.put::<K, V>(self.momentum[x], &along_x);
        place.put::<K, V>(self.momentum[y], &along_y);
    }

    /// Adds volume and force of a group of particles.
    #[inline(always)]
    fn add_rest<const K: usize, const V: usize>(
        &mut self,
        stencils: &Stencils,
        group: Range<usize>,
        of: &SummedColumns<'_, D>,
    ) {
        let place = stencils.place(group.start);
        if let Some(field) = &mut self.volume {
            let mut volume = place.nodes::<K, V>(field);
            for r in group.clone() {
                add_to(&mut volume, &stencils.packed_values::<K, V, D>(r), of.filled[r]);
            }
            place.put::<K, V>(field, &volume);
        }
        let Some(stress) = of.stress else { return };
        let mut force = [[f64x4::ZERO; V]; D];
        for a in 0..D {
            force[a] = place.nodes::<K, V>(self.force[a]);
        }
        for r in group {
            let gradients = stencils.packed_gradients::<K, V, D>(r);
            for a in 0..D {
                add_to(&mut force[a], &gradients[a], stress[r]);
            }
        }
        for a in 0..D {
            place.put::<K, V>(self.force[a], &force[a]);
        }
    }
}

impl<const D: usize> Scheme<D> {
    /// [`Scheme::scatter_particles`] without affine velocity and axial symmetry.
    pub(super) fn scatter_groups<const K: usize, const V: usize>(
        &self,
        patch: &mut Patch<D>,
        force: bool,
    ) {
        let matrix = self.needs_matrix();
        match (matrix, self.columns.spin) {
            (_, Some(_)) => self.clear_sums::<K, true, true>(patch),
            (true, None) => self.clear_sums::<K, true, false>(patch),
            (false, None) => self.clear_sums::<K, false, false>(patch),
        }
        // matrix and fields are taken out while others are read and written
        let mut band = std::mem::take(&mut patch.band);
        let mut fields = self.take_sums(patch);
        let mut sums = fields.sums();
        let of = self.summed_columns(patch, force);
        for group in patch.runs.iter().flat_map(|run| patch.stencils.groups::<K>(run.clone())) {
            if !patch.stencils.is_narrow::<K>(group.start) {
                self.add_wide::<K>(patch, group, &of, &mut sums, &mut band);
                continue;
            }
            sums.add_rest::<K, V>(&patch.stencils, group.clone(), &of);
            match of.moment {
                Some(moment) => {
                    self.add_spinning::<K, V>(&mut sums, patch, &mut band, group, (&of, moment));
                }
                None => {
                    sums.add_motion::<K, V>(&patch.stencils, group.clone(), &of);
                    if matrix {
                        let mass = |r: usize| of.mass[r];
                        band.add_group::<K, V, D>(&patch.stencils, group, mass);
                    }
                }
            }
        }
        if matrix {
            band.finish();
        }
        patch.band = band;
        self.put_sums(patch, fields);
    }

    /// Mass, momentum and force of the nodes, without matrix and volume, for windows of two nodes along
    /// each direction of a plane. The sums of a window stay in vectors as long as the next particle has
    /// the same window.
    pub(super) fn scatter_squares(&self, patch: &mut Patch<D>) {
        self.clear_sums::<2, false, false>(patch);
        let mut fields = self.take_sums(patch);
        let mut nodal = fields.sums();
        let of = self.summed_columns(patch, true);
        let stress = of.stress.expect("the force is summed");
        let columns = [of.mass, of.velocity[0], of.velocity[D - 1], stress];
        let stencils = &patch.stencils;
        for run in &patch.runs {
            let of_run = |column: usize| &columns[column][run.clone()];
            let velocities = of_run(1).iter().zip(of_run(2));
            let particles = of_run(0).iter().zip(velocities).zip(of_run(3));
            let weights = stencils.squares::<D>(run.clone());
            let mut place = stencils.place(run.start);
            let mut sums = nodal.square(place);
            for ((weights, &first), ((&m, (&vx, &vy)), &stress)) in
                weights.zip(&stencils.first[run.clone()]).zip(particles)
            {
                if first as usize != place.first {
                    nodal.put_square(place, &sums);
                    place.first = first as usize;
                    sums = nodal.square(place);
                }
                add_to(&mut sums.mass, &weights.values, m);
                for (momentum, v) in sums.momentum.iter_mut().zip([vx, vy]) {
                    add_to(momentum, &weights.values, m * v);
                }
                for (force, gradient) in sums.force.iter_mut().zip(&weights.gradients) {
                    add_to(force, gradient, stress);
                }
            }
            nodal.put_square(place, &sums);
        }
        self.put_sums(patch, fields);
    }

    /// Adds a group of particles whose weights do not fit into vectors.
    #[cold]
    fn add_wide<const K: usize>(
        &self,
        patch: &Patch<D>,
        group: Range<usize>,
        of: &SummedColumns<'_, D>,
        sums: &mut SummedSlices<'_, D>,
        band: &mut Band,
    ) {
        for (r, weights) in group.clone().zip(patch.stencils.particles::<K, D>(group)) {
            let one = (r, &weights);
            match (self.needs_matrix(), of.moment) {
                (_, Some(_)) => {
                    self.add_particle::<K, true, false, true>(patch, one, of, sums, band);
                }
                (true, None) => {
                    self.add_particle::<K, true, false, false>(patch, one, of, sums, band);
                }
                (false, None) => {
                    self.add_particle::<K, false, false, false>(patch, one, of, sums, band);
                }
            }
        }
    }

    /// Adds motion and blocks of the mass matrix of a group of particles with spin, a few at a time.
    #[inline(always)]
    fn add_spinning<const K: usize, const V: usize>(
        &self,
        sums: &mut SummedSlices<'_, D>,
        patch: &Patch<D>,
        band: &mut Band,
        group: Range<usize>,
        (of, moment): (&SummedColumns<'_, D>, &[f64]),
    ) {
        let stencils = &patch.stencils;
        let mut from = group.start;
        while from < group.end {
            let count = TOGETHER.min(group.end - from);
            let mut turning = [[0.0; 2]; TOGETHER];
            let mut spinning = [Spinning::default(); TOGETHER];
            for k in 0..count {
                let r = from + k;
                let place = self.place_of(patch, r);
                let inertia = packed_inertia(&stencils.packed_values::<K, V, D>(r), place);
                let [inertia, ..] = totals::<K>([inertia; 4]);
                let inverse = 1.0 / inertia;
                let (rates, place) = self.reflect_spin(patch, r, moment[r] * inverse, place);
                turning[k] = rates;
                spinning[k] = Spinning { mass: of.mass[r], place, inverse };
            }
            let some = from..from + count;
            sums.add_spinning::<K, V>(stencils, some.clone(), of, self.cell, |r| {
                (self.offset(patch, r), turning[r - from])
            });
            band.add_spinning::<K, V, D>(stencils, some, &spinning[..count]);
            from += count;
        }
    }
}
