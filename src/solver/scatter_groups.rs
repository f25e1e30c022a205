//! Particles to grid by groups of particles that follow each other and have the same window: their
//! sums stay in vectors from one particle to the next.

use std::ops::Range;

use decomp::array;
use wide::f64x4;

use super::nodal_matrix::NodalMatrix;
use super::particle_matrix::{PackedSpin, ParticleMatrix, ParticleSpin, packed_inertia};
use super::scheme::Scheme;
use crate::solver::packed::{WindowPlace, add_to, totals};
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

    /// The same of particles with spin; `spinning` gives a particle and its rate of rotation [1/s].
    #[inline(always)]
    fn add_spinning<const K: usize, const V: usize>(
        &mut self,
        stencils: &Stencils,
        group: Range<usize>,
        of: &SummedColumns<'_, D>,
        mut spinning: impl FnMut(usize, &[f64x4; V]) -> (ParticleSpin, f64),
    ) {
        let place = stencils.place(group.start);
        let axes = [0, D - 1];
        let mut mass = place.nodes::<K, V>(self.mass);
        let mut momentum = array::map(&axes, |a| place.nodes::<K, V>(self.momentum[a]));
        for r in group {
            let values = stencils.packed_values::<K, V, D>(r);
            add_to(&mut mass, &values, of.mass[r]);
            let (particle, omega) = spinning(r, &values);
            PackedSpin::new(values, &particle).add(&mut momentum, of.motion(r, omega));
        }
        place.put::<K, V>(self.mass, &mass);
        for (a, momentum) in axes.into_iter().zip(&momentum) {
            place.put::<K, V>(self.momentum[a], momentum);
        }
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
        match self.needs_matrix() {
            true => self.clear_sums::<K, true>(patch),
            false => self.clear_sums::<K, false>(patch),
        }
        // matrix and fields are taken out while others are read and written
        let mut matrix = std::mem::take(&mut patch.mass_matrix);
        let mut fields = self.take_sums(patch);
        let mut sums = fields.sums();
        let of = self.summed_columns(patch, force);
        for group in &patch.stencils.groups {
            let (is_wide, group) = (group.packed_count() == 0, group.particles());
            if is_wide {
                self.add_wide::<K>(patch, group, &of, &mut sums, &mut matrix);
                continue;
            }
            sums.add_rest::<K, V>(&patch.stencils, group.clone(), &of);
            match of.moment {
                Some(moment) => {
                    let of = (&of, moment);
                    let matrix = &mut matrix.particles;
                    self.add_spinning::<K, V>(&mut sums, patch, matrix, group, of);
                }
                None => sums.add_motion::<K, V>(&patch.stencils, group.clone(), &of),
            }
        }
        patch.mass_matrix = matrix;
        self.put_sums(patch, fields);
    }

    /// Mass, momentum and force of the nodes, without matrix and volume, for windows of two nodes along
    /// each direction of a plane. The sums of a window stay in vectors as long as the next particle has
    /// the same window.
    pub(super) fn scatter_squares(&self, patch: &mut Patch<D>) {
        self.clear_sums::<2, false>(patch);
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
                if first != place.first {
                    nodal.put_square(place, &sums);
                    place.first = first;
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
        matrix: &mut NodalMatrix,
    ) {
        for (r, weights) in group.clone().zip(patch.stencils.particles::<K, D>(group)) {
            let one = (r, &weights);
            match of.moment {
                Some(_) => self.add_particle::<K, false, false, true>(patch, one, of, sums, matrix),
                None => self.add_particle::<K, false, false, false>(patch, one, of, sums, matrix),
            }
        }
    }

    /// Adds the motion of a group of particles with spin, and stores their inertia and the distances
    /// of their nodes for products with the mass matrix.
    #[inline(always)]
    fn add_spinning<const K: usize, const V: usize>(
        &self,
        sums: &mut SummedSlices<'_, D>,
        patch: &Patch<D>,
        matrix: &mut ParticleMatrix,
        group: Range<usize>,
        (of, moment): (&SummedColumns<'_, D>, &[f64]),
    ) {
        let stencils = &patch.stencils;
        sums.add_spinning::<K, V>(stencils, group, of, |r, values| {
            let distances = self.reflect_spin(patch, r, self.node_distances(patch, r));
            let [inertia, ..] = totals::<K>([packed_inertia(values, &distances); 4]);
            matrix.distances[r] = distances;
            matrix.spinning[r] = ParticleSpin::new(&distances, inertia);
            (matrix.spinning[r], moment[r] / inertia)
        });
    }
}
