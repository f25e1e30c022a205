//! Grid to particles at the end of a mid-point step, for own particles only.

use decomp::array::from_fn;

use super::gather::{own, own_tensor, take_tensor, take_vector};
use super::midpoint_update::MidpointColumns;
use super::nodal_sums::{BLOCK, NodalSums, NodalVelocities, PackedVelocities};
use super::scheme::Scheme;
use super::solid::put_back;
use crate::shape::with_width;
use crate::solver::clock::timed;
use crate::solver::packed::with_packed;
use crate::solver::particle_weights::NARROW;
use crate::solver::parts::StepPart;
use crate::solver::patch::Patch;
use crate::transfer::VelocityUpdate;

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
            let (mut window, mut at) = (PackedVelocities::<V, D>::none(), u32::MAX);
            patch.with_stencils(|patch, stencils| {
                s.gather_particles(patch, dt, |r, nodal| {
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
            patch.with_stencils(|patch, stencils| {
                let mut all = stencils.particles::<K, D>(0..patch.block.own());
                s.gather_particles(patch, dt, |_, nodal| {
                    let weights = all.next().expect("those of each own particle");
                    if const { D == 1 && (K == 3 || K == NARROW) } {
                        NodalSums::on_line(nodal, &weights)
                    } else if const { D == 1 } {
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
    /// the index.
    #[inline(always)]
    fn gather_particles(
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
        let mut mean_work_energy = c.mean_work_energy.map(|k| std::mem::take(&mut columns[k]));
        let [mut deformation, mut gradient] =
            [c.deformation, c.velocity_gradient].map(|k| take_tensor(columns, k, D * D));
        let column = |k: usize| &patch.block.columns[k][..n];
        let mut moved = MidpointColumns {
            position: own::<D>(&mut x, n),
            velocity: own::<D>(&mut v, n),
            jacobian: &mut j[..n],
            energy: &mut e[..n],
            divergence: &mut d[..n],
            mean_work_energy: mean_work_energy.as_mut().map(|column| &mut column[..n]),
            deformation: own_tensor(&mut deformation, n),
            velocity_gradient: own_tensor(&mut gradient, n),
            mass: column(c.mass),
            jacobian_mid: column(c.jacobian_mid.expect("mid-point stepping has the column")),
            // as many as a tensor has; a scalar stress has one
            stress: from_fn(|k| column(c.stress_volume + k.min(c.stress_volumes - 1))),
        };
        let mut block = NodalSums::<D, [f64; BLOCK]>::none();
        let mut radii = (D > 1 && self.axisymmetric).then_some([0.0; BLOCK]);
        for first in (0..n).step_by(BLOCK) {
            let count = BLOCK.min(n - first);
            for k in 0..count {
                block.put(k, &sums(first + k, &nodal));
            }
            if let Some(radii) = &mut radii {
                (0..count).for_each(|k| radii[k] = self.radius(patch, first + k));
            }
            self.update_block(&mut moved, [first, count], &block, radii.as_ref(), dt);
        }
        let columns = &mut patch.block.columns;
        put_back(columns, c.position, x);
        put_back(columns, c.velocity, v);
        columns[c.jacobian] = j;
        columns[c.energy] = e;
        columns[c.divergence] = d;
        if let Some((k, column)) = c.mean_work_energy.zip(mean_work_energy) {
            columns[k] = column;
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
}
