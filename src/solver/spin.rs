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

use decomp::array::{from_fn, map};
use wide::f64x4;

use super::columns::SpinColumns;
use super::scheme::Scheme;
use crate::shape::with_width;
use crate::solver::clock::timed;
use crate::solver::packed::{dot, totals, with_packed};
use crate::solver::particle_weights::{Distances, ParticleWeights};
use crate::solver::parts::StepPart;
use crate::solver::patch::Patch;

/// Moment of inertia per unit mass of the weights of a particle about it, I [m2].
#[inline(always)]
pub(super) fn spin_inertia<const K: usize, const D: usize>(
    weights: &ParticleWeights<'_, K, D>,
    place: Distances,
) -> f64 {
    weights.sum(weights.values, |line| {
        let across = place.across(line);
        let mut squares = [0.0; K];
        for k in 0..K {
            let along = place.along(k);
            squares[k] = along * along + across * across;
        }
        squares
    })
}

/// [`spin_inertia`] of a window in vectors, before the sum over the nodes of a line.
#[inline(always)]
pub(super) fn packed_inertia<const V: usize>(values: &[f64x4; V], place: Distances) -> f64x4 {
    let along = place.four_along();
    dot(
        values,
        &from_fn(|line| {
            let across = f64x4::splat(place.across(line));
            along * along + across * across
        }),
    )
}

/// Angular momentum per unit mass of the nodal velocity with the components x and y about a
/// particle, sqrt(I) phi.u [m2/s].
#[inline(always)]
fn moment_of<const K: usize, const D: usize>(
    weights: &ParticleWeights<'_, K, D>,
    place: Distances,
    [x, y]: [&[f64]; 2],
) -> f64 {
    let mut along = [0.0; K];
    (0..K).for_each(|k| along[k] = place.along(k));
    weights.sum(weights.values, |line| {
        let across = place.across(line);
        let (x, y) = (weights.line(x, line), weights.line(y, line));
        let mut moments = [0.0; K];
        (0..K).for_each(|k| moments[k] = along[k] * y[k] - across * x[k]);
        moments
    })
}

/// Inertia of a particle [m2], and [`moment_of`] three nodal velocities.
#[inline(always)]
fn moments_of<const K: usize, const D: usize>(
    weights: &ParticleWeights<'_, K, D>,
    place: Distances,
    nodal: &[[&[f64]; 2]; 3],
) -> [f64; 4] {
    let [start, star, residual] = map(nodal, |v| moment_of(weights, place, v));
    [spin_inertia(weights, place), start, star, residual]
}

/// [`moment_of`] of a window in vectors, before the sum over the nodes of a line.
#[inline(always)]
fn packed_moment<const V: usize>(
    values: &[f64x4; V],
    place: Distances,
    [x, y]: &[[f64x4; V]; 2],
) -> f64x4 {
    let along = place.four_along();
    dot(values, &from_fn(|line| along * y[line] - f64x4::splat(place.across(line)) * x[line]))
}

/// Velocity gradient of a rotation, at the rates `x` and `y` [1/s] of its two components.
#[inline(always)]
pub(super) fn spin_gradient<const D: usize>([x, y]: [f64; 2]) -> [[f64; D]; D] {
    from_fn(|a| {
        from_fn(|b| match (a, b) {
            (0, 1) => -x,
            (1, 0) => y,
            _ => 0.0,
        })
    })
}

impl<const D: usize> Scheme<D> {
    /// Place of the window of a particle in a plane.
    #[inline(always)]
    pub(super) fn place_of(&self, patch: &Patch<D>, particle: usize) -> Distances {
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
            s.gather_spin_of(patch, spin, primes, |patch, r, place, nodal| {
                let stencils = &patch.stencils;
                if !stencils.is_narrow::<K>(r) {
                    return moments_of(&stencils.particle::<K, D>(r), place, nodal);
                }
                if stencils.first[r] != at {
                    at = stencils.first[r];
                    let place = stencils.place(r);
                    window = map(nodal, |v| map(&v, |field| place.nodes::<K, V>(field)));
                }
                let values = stencils.packed_values::<K, V, D>(r);
                let moments = map(&window, |v: [[f64x4; V]; 2]| packed_moment(&values, place, &v));
                let [start, star, residual] = moments;
                totals::<K>([packed_inertia(&values, place), start, star, residual])
            });
        }
        fn single<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            spin: SpinColumns,
            primes: bool,
        ) {
            s.gather_spin_of(patch, spin, primes, |patch, r, place, nodal| {
                moments_of(&patch.stencils.particle::<K, D>(r), place, nodal)
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

    /// The same with the `sums` over the nodes of each particle, by its index and the place of its
    /// window: inertia, and the angular momenta of three nodal velocities per unit mass.
    #[inline(always)]
    fn gather_spin_of(
        &self,
        patch: &mut Patch<D>,
        spin: SpinColumns,
        primes: bool,
        mut sums: impl FnMut(&Patch<D>, usize, Distances, &[[&[f64]; 2]; 3]) -> [f64; 4],
    ) {
        let (c, f) = (&self.columns, &self.fields);
        let n = patch.block.own();
        let columns = &mut patch.block.columns;
        let [mut moment, mut inertia, mut energy] = [spin.angular_momentum, spin.inertia, c.energy]
            .map(|k| std::mem::take(&mut columns[k]));
        let fields = &patch.nodes.fields;
        let vector = |k: usize| [&fields[k][..], &fields[k + D - 1][..]];
        let residual = f.filter_residual.filter(|_| self.filter_heat && !primes);
        let (start, star) = (vector(f.velocity), vector(f.velocity_star));
        let nodal = [start, star, residual.map_or(start, vector)];
        for r in 0..n {
            let place = self.place_of(patch, r);
            let [new_inertia, filtered, new, lost] = sums(patch, r, place, &nodal);
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
