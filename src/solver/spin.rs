//! Spin of particles: their rotation within the stencil, as part of the mass matrix.
//!
//! A filter takes the rotation of a body for noise, because the velocities of particles within a
//! cell differ. Here each particle in a plane carries the angular momentum of its own rotation per
//! unit mass, B, a scalar. With e_i = x_i - x_p and
//!
//! ```text
//! I = sum N_i |e_i|^2,   phi_i = N_i (-e_y, e_x)/sqrt(I)
//! p_i = sum m (N_i v + phi_i B/sqrt(I)),   M_ij = sum m (N_i N_j + phi_i phi_j)
//! B = sqrt(I) sum phi_i.v'_i
//! ```
//!
//! a rigid rotation of the nodes is in the kernel of K = 1 - m^-1 M, so that FMPM of any order keeps
//! the angular momentum sum m (x cross v + B) to rounding. The energy B^2/(2 I) counts as kinetic
//! energy. With u the last term of the series of the filter, the heat
//!
//! ```text
//! (B/sqrt(I) - phi.v)^2/2 - (phi.u)(phi.(v + v')/2) + B^2/2 (1/I_old - 1/I)
//! ```
//!
//! in addition to that of the filter keeps the energy to rounding: the last term is the change of
//! the energy of the spin where a particle moves or deforms while B is constant.
//!
//! Mass-matrix FLIP conserves energy and angular momentum with the full mass matrix (Burgess,
//! Sulsky & Brackbill 1992), implicit time stepping too (Love & Sulsky 2006). The feature phi is the
//! antisymmetric part of the affine velocity of APIC (Jiang, Schroeder & Teran 2017); the symmetric
//! part is left out, since it makes shocks overshoot.

use decomp::array::map;
use wide::f64x4;

use super::columns::SpinColumns;
use super::scheme::Scheme;
use crate::shape::with_width;
use crate::solver::clock::timed;
use crate::solver::packed::{totals, with_packed};
use crate::solver::particle_matrix::{PackedSpin, ParticleSpin, spin_sums};
use crate::solver::particle_weights::Distances;
use crate::solver::parts::StepPart;
use crate::solver::patch::Patch;
use crate::solver::shape_weights::Stencils;

/// A particle with spin, and the distances of its nodes.
type SpinAndDistances<'a> = (&'a ParticleSpin, &'a Distances);

impl<const D: usize> Scheme<D> {
    /// Distances of the nodes of a particle's window from it, in a plane.
    #[inline(always)]
    pub(super) fn node_distances(&self, patch: &Patch<D>, particle: usize) -> Distances {
        let offset = self.offset(patch, particle);
        let cell = [self.cell[0], self.cell[D - 1]];
        let [x, y] = [0, D - 1];
        Distances {
            first: [offset.first[x] * cell[0], offset.first[y] * cell[1]],
            skipped: [offset.skipped[x], offset.skipped[y]],
            cell,
        }
    }

    /// Spin of the own particles at the end of a step from v', and the heat of the filter that
    /// belongs to it; at the start of a run, `primes`, no heat.
    pub(super) fn gather_spin(&self, patch: &mut Patch<D>, primes: bool) {
        fn packed<const K: usize, const V: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            spin: SpinColumns,
            primes: bool,
        ) {
            if const { D == 1 } {
                return;
            }
            let (mut window, mut at) = ([[[f64x4::ZERO; V]; 2]; 3], u32::MAX);
            s.gather_spin_of(patch, spin, primes, |stencils, r, (spin, distances), nodal| {
                if !stencils.is_narrow::<K>(r) {
                    let weights = stencils.particle::<K, D>(r);
                    return map(nodal, |v| spin_sums(&weights, distances, v)[2]);
                }
                if stencils.first[r] != at {
                    at = stencils.first[r];
                    let place = stencils.place(r);
                    window = map(nodal, |v| map(&v, |field| place.nodes::<K, V>(field)));
                }
                let spin = PackedSpin::new(stencils.packed_values::<K, V, D>(r), spin);
                let [start, star, residual] = map(&window, |v: [[f64x4; V]; 2]| spin.sums(&v)[2]);
                let [start, star, residual, _] = totals::<K>([start, star, residual, f64x4::ZERO]);
                [start, star, residual]
            });
        }
        fn single<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            spin: SpinColumns,
            primes: bool,
        ) {
            s.gather_spin_of(patch, spin, primes, |stencils, r, (_, distances), nodal| {
                let weights = stencils.particle::<K, D>(r);
                map(nodal, |v| spin_sums(&weights, distances, v)[2])
            });
        }
        let Some(spin) = self.columns.spin else { return };
        timed(StepPart::Spin as usize, patch, |patch| {
            let width = patch.stencils.width;
            with_packed!(
                width,
                packed(patch, self, spin, primes),
                with_width!(width, single(patch, self, spin, primes))
            );
        });
    }

    /// The same with the function `moments`: from the index of a particle, its spin and the distances
    /// of its nodes, the angular momenta of three nodal velocities per unit mass.
    #[inline(always)]
    fn gather_spin_of(
        &self,
        patch: &mut Patch<D>,
        spin: SpinColumns,
        primes: bool,
        mut moments: impl FnMut(&Stencils, usize, SpinAndDistances<'_>, &[[&[f64]; 2]; 3]) -> [f64; 3],
    ) {
        let (c, f) = (&self.columns, &self.fields);
        let n = patch.block.own();
        let [moment, inertia, energy] =
            patch.block.columns_mut([spin.angular_momentum, spin.inertia, c.energy]);
        let fields = &patch.nodes.fields;
        let vector = |k: usize| [&fields[k][..], &fields[k + D - 1][..]];
        let residual = f.filter_residual.filter(|_| self.filter_heat && !primes);
        let (start, star) = (vector(f.velocity), vector(f.velocity_star));
        let nodal = [start, star, residual.map_or(start, vector)];
        let matrix = &patch.mass_matrix.particles;
        for (r, one) in matrix.spinning[..n].iter().zip(&matrix.distances[..n]).enumerate() {
            let [filtered, new, lost] = moments(&patch.stencils, r, one, &nodal);
            let new_inertia = one.0.inertia;
            let inverse = 1.0 / new_inertia;
            if !primes {
                let old = moment[r];
                let mut heat = 0.5 * old * old * (1.0 / inertia[r] - inverse);
                if residual.is_some() {
                    let rest = old - filtered;
                    let mean = 0.5 * (filtered + new);
                    heat += (0.5 * rest * rest - lost * mean) * inverse;
                }
                energy[r] += heat;
            }
            moment[r] = new;
            inertia[r] = new_inertia;
        }
    }

    /// Energy of the spin of an own particle per unit mass [J/kg].
    #[inline(always)]
    pub(crate) fn spin_energy(&self, columns: &[Vec<f64>], particle: usize) -> f64 {
        let Some(spin) = self.columns.spin else { return 0.0 };
        let moment = columns[spin.angular_momentum][particle];
        0.5 * moment * moment / columns[spin.inertia][particle]
    }
}
