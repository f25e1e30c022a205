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

use decomp::array::from_fn;

use super::columns::SpinColumns;
use super::scheme::Scheme;
use crate::shape::with_width;
use crate::solver::clock::timed;
use crate::solver::particle_weights::ParticleWeights;
use crate::solver::parts::StepPart;
use crate::solver::patch::Patch;

/// Distance of the first node of a window from the particle, and the distance between nodes [m].
pub(super) type Place = ([f64; 2], [f64; 2]);

/// Moment of inertia per unit mass of the weights of a particle about it, I [m2].
#[inline(always)]
pub(super) fn spin_inertia<const K: usize, const D: usize>(
    weights: &ParticleWeights<'_, K, D>,
    (first, cell): Place,
) -> f64 {
    weights.sum(weights.values, |line| {
        let across = first[1] + line as f64 * cell[1];
        let mut squares = [0.0; K];
        for k in 0..K {
            let along = first[0] + k as f64 * cell[0];
            squares[k] = along * along + across * across;
        }
        squares
    })
}

/// Angular momentum per unit mass of the nodal velocity with the components x and y about a
/// particle, sqrt(I) phi.u [m2/s].
#[inline(always)]
fn moment_of<const K: usize, const D: usize>(
    weights: &ParticleWeights<'_, K, D>,
    (first, cell): Place,
    [x, y]: [&[f64]; 2],
) -> f64 {
    let mut along = [0.0; K];
    (0..K).for_each(|k| along[k] = first[0] + k as f64 * cell[0]);
    weights.sum(weights.values, |line| {
        let across = first[1] + line as f64 * cell[1];
        let (x, y) = (weights.line(x, line), weights.line(y, line));
        let mut moments = [0.0; K];
        (0..K).for_each(|k| moments[k] = along[k] * y[k] - across * x[k]);
        moments
    })
}

/// Velocity gradient of a rotation at the rate `omega` [1/s].
#[inline(always)]
pub(super) fn spin_gradient<const D: usize>(omega: f64) -> [[f64; D]; D] {
    from_fn(|a| {
        from_fn(|b| match (a, b) {
            (0, 1) => -omega,
            (1, 0) => omega,
            _ => 0.0,
        })
    })
}

impl<const D: usize> Scheme<D> {
    /// Place of the window of a particle in a plane.
    #[inline(always)]
    pub(super) fn place_of<const K: usize>(
        &self,
        patch: &Patch<D>,
        weights: &ParticleWeights<'_, K, D>,
        particle: usize,
    ) -> Place {
        let offset = self.offset(patch, particle, weights.first);
        let cell = [self.cell[0], self.cell[D - 1]];
        ([offset[0] * cell[0], offset[D - 1] * cell[1]], cell)
    }

    /// Spin of the own particles at the end of a step from v', and the heat of the filter that
    /// belongs to it; at the start of a run, `primes`, no heat.
    pub(super) fn gather_spin(&self, patch: &mut Patch<D>, primes: bool) {
        fn go<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            spin: SpinColumns,
            primes: bool,
        ) {
            if const { D > 1 } {
                s.gather_spin_of::<K>(patch, spin, primes);
            }
        }
        let Some(spin) = self.columns.spin else { return };
        timed(StepPart::Spin as usize, patch, |patch| {
            with_width!(patch.stencils.width, go(patch, self, spin, primes));
        });
    }

    fn gather_spin_of<const K: usize>(
        &self,
        patch: &mut Patch<D>,
        spin: SpinColumns,
        primes: bool,
    ) {
        let (c, f) = (&self.columns, &self.fields);
        let n = patch.block.own();
        let columns = &mut patch.block.columns;
        let [mut moment, mut inertia, mut energy] = [spin.angular_momentum, spin.inertia, c.energy]
            .map(|k| std::mem::take(&mut columns[k]));
        let fields = &patch.nodes.fields;
        let vector = |k: usize| [&fields[k][..], &fields[k + D - 1][..]];
        let residual = f.filter_residual.filter(|_| self.filter_heat && !primes).map(vector);
        let (start, star) = (vector(f.velocity), vector(f.velocity_star));
        for (r, weights) in patch.stencils.particles::<K, D>(0..n).enumerate() {
            let place = self.place_of(patch, &weights, r);
            let new_inertia = spin_inertia(&weights, place);
            let inverse = 1.0 / new_inertia;
            let new = moment_of(&weights, place, star);
            if !primes {
                let old = moment[r];
                let mut heat = 0.5 * old * old * (1.0 / inertia[r] - inverse);
                if let Some(residual) = residual {
                    let filtered = moment_of(&weights, place, start);
                    let rest = old - filtered;
                    let mean = 0.5 * (filtered + new);
                    heat +=
                        (0.5 * rest * rest - moment_of(&weights, place, residual) * mean) * inverse;
                }
                energy[r] += heat;
            }
            moment[r] = new;
            inertia[r] = new_inertia;
        }
        let columns = &mut patch.block.columns;
        columns[spin.angular_momentum] = moment;
        columns[spin.inertia] = inertia;
        columns[c.energy] = energy;
    }

    /// Energy of the spin of an own particle per unit mass [J/kg].
    #[inline(always)]
    pub(crate) fn spin_energy(&self, columns: &[Vec<f64>], particle: usize) -> f64 {
        let Some(spin) = self.columns.spin else { return 0.0 };
        let moment = columns[spin.angular_momentum][particle];
        0.5 * moment * moment / columns[spin.inertia][particle]
    }
}
