//! Particles to grid: each sum runs over own particles and ghosts in canonical order, so that all
//! patches with a node get bitwise the same sums for it.

use decomp::array;

use super::nodal_matrix::NodalMatrix;
use super::particle_matrix::{ParticleSpin, add_spin, spin_inertia};
use super::scheme::Scheme;
use crate::shape::{Shape, with_shape, with_width};
use crate::solver::clock::timed;
use crate::solver::effect::{Phase, StepContext};
use crate::solver::packed::with_packed;
use crate::solver::particle_weights::{Distances, Offset, ParticleWeights, add, cut, lines};
use crate::solver::parts::StepPart;
use crate::solver::patch::Patch;
use crate::solver::summed_fields::{SummedColumns, SummedSlices};

impl<const D: usize> Scheme<D> {
    /// All sums of a patch at new positions of its particles, with or without the force, and the
    /// lumped velocity and acceleration from them.
    pub(super) fn scatter(&self, patch: &mut Patch<D>, force: bool, step: &StepContext<'_, D>) {
        let recomputed = self.find_weights(patch);
        self.scatter_particles(patch, force, recomputed);
        if force {
            patch.side_forces.clear();
            step.effects.act(Phase::NodalForce, step, patch);
        }
        if let Some(contact) = &self.contact {
            timed(StepPart::Contact as usize, patch, |patch| {
                self.find_contact(patch, contact, step.dt);
            });
        }
        self.divide_by_mass(patch);
        self.start_series(patch);
    }

    /// Finds the weights of all particles of a patch, with windows as wide as its longest particle
    /// needs. Returns whether they have been recomputed, not kept. For sums over corners it finds only
    /// the ranges of particles in canonical order.
    fn find_weights(&self, patch: &mut Patch<D>) -> bool {
        fn find<S: Shape, const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Scheme<D>) {
            let layer = (s.layers > 1).then_some(s.columns.body);
            patch.find_weights::<S, K>(s.columns.fraction, s.columns.domain, s.inverse_cell, layer)
        }
        fn push<const K: usize, const D: usize>(patch: &mut Patch<D>, push: usize) {
            patch.stencils.push_gradients::<K, D>(&patch.block, push);
        }
        if self.sums_corners() {
            let lines = patch.nodes.nodes.extent(0);
            (patch.stencils.width, patch.stencils.stride) = (2, lines);
            patch.block.runs(&mut patch.runs);
            return true;
        }
        let recomputed = !(self.total_lagrangian && patch.stencils.are_kept(&patch.block));
        if recomputed {
            let width = self.shape.nodes(self.longest(&patch.block));
            with_shape!(self.shape, width, find(patch, self));
        }
        if let Some(inverse) = self.columns.inverse_deformation {
            if recomputed {
                patch.stencils.keep(&patch.block);
            }
            with_width!(patch.stencils.width, push(patch, inverse));
        }
        recomputed
    }

    /// Whether the scheme needs the mass matrix.
    pub(super) fn needs_matrix(&self) -> bool {
        self.transfer.needs_matrix(self.compatible)
    }

    /// Mass and momentum of the nodes, the mass matrix and the filled volume if the scheme needs
    /// them, and with `force` the internal force f_i = sum_p (p + q) V G_i (pressure is positive in
    /// compression, so it pushes along the gradient), in one pass over the particles. If the
    /// weights are not `recomputed`, mass, matrix and volume of the last step are kept.
    pub(super) fn scatter_particles(&self, patch: &mut Patch<D>, force: bool, recomputed: bool) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            force: bool,
            recomputed: bool,
        ) {
            if !recomputed && s.columns.affine.is_none() && s.contact.is_none() {
                return s.scatter_moving::<K>(patch, force);
            }
            if const { D > 1 } && s.columns.spin.is_some() {
                return s.scatter_width::<K, true, false, true>(patch, force);
            }
            match (s.needs_matrix(), s.columns.affine) {
                (true, None) => s.scatter_width::<K, true, false, false>(patch, force),
                (false, None) => s.scatter_width::<K, false, false, false>(patch, force),
                (true, Some(_)) => s.scatter_width::<K, true, true, false>(patch, force),
                (false, Some(_)) => s.scatter_width::<K, false, true, false>(patch, force),
            }
        }
        fn groups<const K: usize, const V: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            force: bool,
        ) {
            s.scatter_groups::<K, V>(patch, force);
        }
        self.reflect_ghosts(patch);
        if self.sums_corners() {
            return self.scatter_corners(patch, force);
        }
        let tensor = self.tensor_stress();
        let (width, scalar) = (patch.stencils.width, force && !tensor);
        let is_plain = self.columns.affine.is_none() && !self.axisymmetric;
        let in_vectors = is_plain && (recomputed || self.contact.is_some());
        // matrix, volume and spin need more sums
        let more = self.needs_matrix() || self.edge_mask.is_some() || self.columns.spin.is_some();
        if const { D > 1 } && width == 2 && in_vectors && scalar && !more {
            self.scatter_squares(patch);
        } else if in_vectors {
            with_packed!(
                width,
                groups(patch, self, scalar),
                with_width!(width, go(patch, self, scalar, recomputed))
            );
        } else {
            with_width!(width, go(patch, self, scalar, recomputed));
        }
        if force && tensor {
            timed(StepPart::StressTensor as usize, patch, |patch| self.scatter_stress(patch));
        }
        if force {
            self.turn_forces(patch);
            for (force, part) in &self.forces {
                timed(*part, patch, |patch| self.scatter_force(patch, *force));
            }
        }
    }

    /// Adds the force of all particles, in the columns from `from` on, to the nodes.
    fn scatter_force(&self, patch: &mut Patch<D>, from: usize) {
        fn go<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Scheme<D>, from: usize) {
            for a in 0..D {
                let field = s.fields.acceleration + a;
                let mut nodal = std::mem::take(&mut patch.nodes.fields[field]);
                let force = &patch.block.columns[from + a];
                for r in patch.runs.iter().cloned().flatten() {
                    let weights = patch.stencils.particle::<K, D>(r);
                    weights.add(&mut nodal, weights.values, |n| n * force[r]);
                }
                patch.nodes.fields[field] = nodal;
            }
        }
        with_width!(patch.stencils.width, go(patch, self, from));
    }

    pub(super) fn scatter_width<
        const K: usize,
        const MATRIX: bool,
        const AFFINE: bool,
        const SPIN: bool,
    >(
        &self,
        patch: &mut Patch<D>,
        force: bool,
    ) {
        self.clear_sums::<K, MATRIX>(patch);
        // matrix and fields are taken out while others are read and written
        let mut matrix = std::mem::take(&mut patch.mass_matrix);
        let mut fields = self.take_sums(patch);
        let mut sums = fields.sums();
        let of = self.summed_columns(patch, force);
        for run in &patch.runs {
            for (r, weights) in run.clone().zip(patch.stencils.particles::<K, D>(run.clone())) {
                self.add_particle::<K, MATRIX, AFFINE, SPIN>(
                    patch,
                    (r, &weights),
                    &of,
                    &mut sums,
                    &mut matrix,
                );
            }
        }
        if MATRIX {
            matrix.finish::<D>();
        }
        patch.mass_matrix = matrix;
        self.put_sums(patch, fields);
    }

    /// Columns of the particles of a patch, including ghosts, that are summed.
    #[inline(always)]
    pub(super) fn summed_columns<'a>(
        &self,
        patch: &'a Patch<D>,
        force: bool,
    ) -> SummedColumns<'a, D> {
        let c = &self.columns;
        let particles = patch.block.particles();
        let column = |k: usize| &patch.block.columns[k][..particles];
        SummedColumns {
            mass: column(c.mass),
            velocity: array::from_fn(|a| column(c.velocity + a)),
            filled: c.fill_fraction.map_or(&[][..], column),
            stress: force.then(|| column(c.stress_volume)),
            moment: c.spin.map(|spin| column(spin.angular_momentum)),
        }
    }

    /// Adds a particle with the weights on a window of any width to the sums of its patch, and to
    /// the mass matrix with `MATRIX`.
    #[inline(always)]
    pub(super) fn add_particle<
        const K: usize,
        const MATRIX: bool,
        const AFFINE: bool,
        const SPIN: bool,
    >(
        &self,
        patch: &Patch<D>,
        (r, weights): (usize, &ParticleWeights<'_, K, D>),
        of: &SummedColumns<'_, D>,
        sums: &mut SummedSlices<'_, D>,
        matrix: &mut NodalMatrix,
    ) {
        let m = of.mass[r];
        weights.add(sums.mass, weights.values, |n| n * m);
        if let Some(moment) = of.moment.filter(|_| SPIN) {
            let distances = self.reflect_spin(patch, r, self.node_distances(patch, r));
            let spin = ParticleSpin::new(&distances, spin_inertia(weights, &distances));
            let (x, y) = sums.momentum.split_at_mut(D - 1);
            add_spin(weights, &distances, [x[0], y[0]], of.motion(r, moment[r] / spin.inertia));
            matrix.particles.spinning[r] = spin;
            matrix.particles.distances[r] = distances;
        } else if let Some(affine) = self.columns.affine.filter(|_| AFFINE) {
            let at = |k: usize| patch.block.columns[affine + k][r];
            let slope = array::from_fn(|a| array::from_fn(|b| at(D * a + b)));
            self.add_affine_momentum(patch, weights, r, slope, &mut sums.momentum);
        } else {
            for a in 0..D {
                let mv = m * of.velocity[a][r];
                weights.add(sums.momentum[a], weights.values, |n| n * mv);
            }
        }
        if MATRIX {
            matrix.add(weights, m);
        }
        if let Some(volume) = &mut sums.volume {
            let filled = of.filled[r];
            weights.add(volume, weights.values, |n| n * filled);
        }
        if let Some(stress) = of.stress {
            let s = stress[r];
            for a in 0..D {
                weights.add(sums.force[a], weights.gradient(a), |g| g * s);
            }
            // radial motion of a node strains the material in the hoop direction
            if D > 1 && self.axisymmetric {
                let hoop = s / self.radius(patch, r);
                weights.add(sums.force[0], weights.values, |n| n * hoop);
            }
        }
    }

    /// Adds the momentum m N (v + C (x_i - x_p)) of a particle with the velocity gradient C,
    /// `slope`, to the nodes.
    #[inline(always)]
    fn add_affine_momentum<const K: usize>(
        &self,
        patch: &Patch<D>,
        weights: &ParticleWeights<'_, K, D>,
        r: usize,
        slope: [[f64; D]; D],
        momentum: &mut [&mut [f64]; D],
    ) {
        let column = |k: usize| patch.block.columns[k][r];
        let m = column(self.columns.mass);
        let offset = self.offset(patch, r);
        for a in 0..D {
            let mv = m * column(self.columns.velocity + a);
            let mc: [f64; D] = array::from_fn(|b| m * slope[a][b] * self.cell[b]);
            let mut along = [0.0; K];
            (0..K).for_each(|k| along[k] = mc[0] * offset.at(0, k));
            for line in 0..const { lines(K, D) } {
                let across = match D {
                    1 => mv,
                    _ => mv + mc[D - 1] * offset.at(D - 1, line),
                };
                let n = &weights.values[line];
                let mut terms = [0.0; K];
                (0..K).for_each(|k| terms[k] = n[k] * (across + along[k]));
                add(momentum[a], weights.first + line * weights.stride, terms);
            }
        }
    }

    /// Clears the sums over particles, and the mass matrix with `MATRIX`.
    pub(super) fn clear_sums<const K: usize, const MATRIX: bool>(&self, patch: &mut Patch<D>) {
        let f = &self.fields;
        let scalars = [f.mass].into_iter().chain(f.scratch..f.scratch + f.scratches);
        let vectors = [f.lumped_velocity, f.acceleration].into_iter().chain(f.residuals());
        let components = vectors.flat_map(|v| v..v + D);
        let volume = self.edge_mask.map(|_| f.volume);
        for field in scalars.chain(components).chain(volume) {
            patch.nodes.fields[field].fill(0.0);
        }
        if self.columns.spin.is_some() {
            let (matrix, count) = (&mut patch.mass_matrix.particles, patch.block.particles());
            matrix.spinning.resize(count, ParticleSpin::default());
            matrix.distances.resize(count, Distances::default());
        }
        if MATRIX {
            let nodes = patch.nodes.layers * patch.nodes.nodes.count();
            let mass = &patch.block.columns[self.columns.mass][..patch.block.particles()];
            patch.mass_matrix.start::<K, D>(nodes, mass.iter().copied());
        }
    }

    /// Distance of a particle from the axis at the position of its weights [m]. For an image beyond
    /// the axis or an axial wall it is minus the distance of the particle itself, as a force that
    /// pushes the particle outward pushes its image inward.
    #[inline(always)]
    pub(crate) fn radius(&self, patch: &Patch<D>, particle: usize) -> f64 {
        if let Some(radius) = self.columns.radius {
            return patch.block.columns[radius][particle];
        }
        let fraction = patch.block.columns[self.columns.fraction][particle];
        let cell = patch.block.cells[particle][0];
        let (lower, edge) = (self.lower[0], self.cell[0]);
        let at = lower + (f64::from(cell) + fraction) * edge;
        match i64::from(cell) {
            beyond if beyond < 0 => at - 2.0 * lower,
            beyond if beyond >= self.cells[0] => at - 2.0 * (lower + self.cells[0] as f64 * edge),
            _ => at,
        }
    }

    /// Distances of the nodes of the window of `particle` from it.
    #[inline(always)]
    pub(crate) fn offset(&self, patch: &Patch<D>, particle: usize) -> Offset<D> {
        let (nodes, cell) = (&patch.nodes.nodes, patch.block.cells[particle]);
        let (stride, first) = (patch.stencils.stride, patch.stencils.first[particle] as usize);
        let first = if patch.nodes.layers > 1 { first % nodes.count() } else { first };
        // whole numbers of cells are added first, so that windows that start at another node give
        // the same bits
        let skipped = array::from_fn(|a| i64::from(patch.stencils.skipped[particle] >> a & 1));
        let first = array::from_fn(|a| {
            let at = match (D, a) {
                (1, _) => first,
                (_, 0) => first % stride,
                _ => first / stride,
            };
            let fraction = patch.block.columns[self.columns.fraction + a][particle];
            let weighted = at as i64 + skipped[a];
            (weighted + nodes.lower[a] - i64::from(cell[a])) as f64 - fraction
        });
        Offset { first, skipped: array::map(&skipped, |skipped| skipped as f64) }
    }

    /// Lumped velocity and acceleration of the nodes from their sums; negligible values are set to
    /// zero.
    pub(super) fn divide_by_mass(&self, patch: &mut Patch<D>) {
        let f = &self.fields;
        patch.nodes.fields[f.inverse].fill(0.0);
        let (still, slow) = (self.quiescent_speed, self.still_acceleration);
        for line in &patch.active_lines {
            let [mass, inverse] = patch.nodes.fields_mut([f.mass, f.inverse]);
            for i in line.clone() {
                inverse[i] = if mass[i] > self.empty_mass { 1.0 / mass[i] } else { 0.0 };
            }
            for a in 0..D {
                let [inverse, lumped, acceleration] =
                    patch.nodes.fields_mut([f.inverse, f.lumped_velocity + a, f.acceleration + a]);
                for i in line.clone() {
                    lumped[i] = cut(lumped[i] * inverse[i], still);
                    acceleration[i] = cut(acceleration[i] * inverse[i], slow);
                }
            }
        }
        if self.contact.is_some() {
            self.join_sums(patch);
        }
        self.find_edge(patch);
    }
}
