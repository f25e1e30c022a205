//! Grid to particles, for own particles only.

use std::ops::DerefMut;

use super::nodal_sums::{EndSums, PackedEnds};
use super::scheme::Scheme;
use super::solid::Taken;
use crate::scene::Limiter;
use crate::shape::with_width;
use crate::solver::artificial_viscosity::{self, Nodes};
use crate::solver::clock::timed;
use crate::solver::packed::with_packed;
use crate::solver::particle_weights::ParticleWeights;
use crate::solver::parts::StepPart;
use crate::solver::patch::Patch;

/// Columns of a vector, taken out of their block: they are written while other columns are read.
pub(super) fn take_vector<const D: usize>(columns: &mut [Vec<f64>], first: usize) -> [Vec<f64>; D] {
    decomp::array::from_fn(|a| std::mem::take(&mut columns[first + a]))
}

/// Columns of a tensor with `count` components, if it exists.
pub(super) fn take_tensor(columns: &mut [Vec<f64>], first: Option<usize>, count: usize) -> Taken {
    first.into_iter().flat_map(|k| k..k + count).map(|k| std::mem::take(&mut columns[k])).collect()
}

/// Own particles (the first `particles`) of `N` columns.
#[inline(always)]
pub(super) fn own<const N: usize>(columns: &mut [Vec<f64>], particles: usize) -> [&mut [f64]; N] {
    let mut columns = columns.iter_mut().map(|column| &mut column[..particles]);
    decomp::array::from_fn(|_| columns.next().expect("as many columns"))
}

/// Columns of a tensor in a plane, own particles, if it exists.
pub(super) type OwnTensor<'a> = Option<[&'a mut [f64]; 4]>;

/// Own particles of the columns of a tensor in a plane, if it exists.
#[inline(always)]
pub(super) fn own_tensor(columns: &mut [Vec<f64>], particles: usize) -> OwnTensor<'_> {
    (!columns.is_empty()).then(|| own(columns, particles))
}

/// Sums of most leapfrog steps: velocities and the trace of their gradient, not the full gradient. As a
/// constant it leaves no branch in a loop.
const USUAL: [bool; 3] = [true, true, false];

impl<const D: usize> Scheme<D> {
    /// Updates the own particles at the end of a leapfrog step: velocity by the transfer scheme,
    /// its affine part, and position x += dt N v'; with `strain` also the results of
    /// [`Self::gather_gradient`].
    pub(crate) fn gather_leapfrog(&self, patch: &mut Patch<D>, dt: f64, strain: bool) {
        fn affine<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Scheme<D>) {
            if let Some(affine) = s.columns.affine {
                timed(StepPart::Affine as usize, patch, |patch| {
                    s.gather_affine::<K>(patch, affine)
                });
            }
        }
        self.gather_end(patch, dt, [true, strain]);
        with_width!(patch.stencils.width, affine(patch, self));
    }

    /// Divergence of v' at the own particles, its full gradient if domains deform, and the limiter
    /// computed from it.
    pub(super) fn gather_gradient(&self, patch: &mut Patch<D>) {
        self.gather_end(patch, 0.0, [false, true]);
    }

    /// Moves the own particles by `dt`, computes their velocity gradients, or both, in one pass:
    /// finding the weights and nodes of a particle takes as long as a sum over them.
    fn gather_end(&self, patch: &mut Patch<D>, dt: f64, [moves, strains]: [bool; 2]) {
        fn packed<const K: usize, const V: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            (dt, moves): (f64, bool),
            wanted: [bool; 3],
        ) {
            let (mut window, mut at) = (PackedEnds::<V, D>::none(), u32::MAX);
            patch.with_stencils(|patch, stencils| {
                s.end_particles(patch, dt, [moves, wanted[1]], |r, nodal| {
                    if !stencils.is_narrow::<K>(r) {
                        let weights = stencils.particle::<K, D>(r);
                        return EndSums::one_by_one::<K, K>(nodal, &weights, wanted);
                    }
                    // several particles of a cell have the same window
                    if stencils.first[r] != at {
                        at = stencils.first[r];
                        window.fetch::<K>(nodal, stencils.place(r));
                    }
                    window.sums::<K>(&stencils.packed::<K, V, D>(r), wanted)
                });
            });
        }
        fn single<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            (dt, moves): (f64, bool),
            wanted: [bool; 3],
        ) {
            if moves && wanted == USUAL {
                one_by_one::<K, D>(patch, s, (dt, true), USUAL);
            } else {
                one_by_one::<K, D>(patch, s, (dt, moves), wanted);
            }
        }
        #[inline(always)]
        fn one_by_one<const K: usize, const D: usize>(
            patch: &mut Patch<D>,
            s: &Scheme<D>,
            (dt, moves): (f64, bool),
            wanted: [bool; 3],
        ) {
            patch.with_stencils(|patch, stencils| {
                let mut all = stencils.particles::<K, D>(0..patch.block.own());
                s.end_particles(patch, dt, [moves, wanted[1]], |_, nodal| {
                    let weights = all.next().expect("those of each own particle");
                    if const { D == 1 } {
                        EndSums::one_by_one::<K, 1>(nodal, &weights, wanted)
                    } else {
                        EndSums::one_by_one::<K, K>(nodal, &weights, wanted)
                    }
                });
            });
        }
        fn limiter<const K: usize, const D: usize>(patch: &mut Patch<D>, s: &Scheme<D>) {
            s.gather_limiter::<K>(patch);
        }
        let width = patch.stencils.width;
        // hoop strain needs the velocity at the particle
        let velocities = moves || self.axisymmetric;
        let wanted = [velocities, strains, self.columns.velocity_gradient.is_some()];
        if self.sums_corners() {
            self.gather_corners(patch, dt, [moves, strains]);
        } else if D > 1 && width == 2 && moves && wanted == USUAL {
            self.gather_squares(patch, dt);
        } else {
            with_packed!(
                width,
                packed(patch, self, (dt, moves), wanted),
                with_width!(width, single(patch, self, (dt, moves), wanted))
            );
        }
        if strains {
            with_width!(width, limiter(patch, self));
        }
    }

    /// Moves the own particles and computes the divergence of their velocities in one pass, for windows
    /// of two nodes along each direction of a plane.
    fn gather_squares(&self, patch: &mut Patch<D>, dt: f64) {
        let (mut window, mut at) = (PackedEnds::<1, D>::none(), u32::MAX);
        patch.with_stencils(|patch, stencils| {
            let mut all = stencils.squares(0..patch.block.own());
            self.end_particles(patch, dt, [true, true], |r, nodal| {
                if stencils.first[r] != at {
                    at = stencils.first[r];
                    window.fetch::<2>(nodal, stencils.place(r));
                }
                window.sums::<2>(&all.next().expect("those of each own particle"), USUAL)
            });
        });
    }

    /// [`Self::gather_end`] with `sums`, which gives the sums over the nodes of a particle by its index and
    /// is called once for each own particle, in order.
    #[inline(always)]
    fn end_particles(
        &self,
        patch: &mut Patch<D>,
        dt: f64,
        [moves, strains]: [bool; 2],
        mut sums: impl FnMut(usize, [[&[f64]; D]; 2]) -> EndSums<D>,
    ) {
        let (f, n) = (&self.fields, patch.block.own());
        let mut taken = self.take_ends(patch);
        let mut ends = taken.own(n);
        let fields = &patch.nodes.fields;
        // slices of equal length, so that the bounds of a window are checked only once
        let nodes = fields[f.mass].len();
        let vector = |k: usize| decomp::array::from_fn::<&[f64], D, _>(|a| &fields[k + a][..nodes]);
        let nodal = [vector(f.lumped_velocity), vector(f.velocity_star)];
        for r in 0..n {
            let at = sums(r, nodal);
            ends.put(r, &at, (self.transfer.update, dt), [moves, strains]);
            if strains && D > 1 && self.axisymmetric {
                ends.divergence[r] += at.star[0] / self.radius(patch, r);
            }
        }
        self.put_ends(patch, taken);
    }

    /// C = B D^-1 with B = sum N v' (x_i - x_p) and D = sum N (x_i - x_p) (x_i - x_p) (Jiang et al.
    /// 2015): exact for a linear velocity, also if a sheared domain gives D an xy component.
    pub(super) fn gather_affine<const K: usize>(&self, patch: &mut Patch<D>, affine: usize) {
        for r in 0..patch.block.own() {
            let offset = self.offset(patch, r);
            let weights = patch.stencils.particle::<K, D>(r);
            let apart =
                |b: usize, line: usize, k: usize| offset.at(b, if b == 0 { k } else { line });
            let second = |a: usize, b: usize| {
                let product =
                    |line: usize| decomp::array::from_fn(|k| apart(a, line, k) * apart(b, line, k));
                weights.sum(weights.values, product)
            };
            let square: [f64; D] = decomp::array::from_fn(|b| second(b, b));
            let (first, last) = (0, D - 1);
            let mixed = if D == 1 { 0.0 } else { second(first, last) };
            let determinant = square[first] * square[last] - mixed * mixed;
            for a in 0..D {
                let star = &patch.nodes.fields[self.fields.velocity_star + a][..];
                let moment = |b: usize| {
                    let product = |line: usize| {
                        let v = weights.line(star, line);
                        decomp::array::from_fn(|k| v[k] * apart(b, line, k))
                    };
                    weights.sum(weights.values, product)
                };
                // at a node of hat functions both vanish, and their ratio tends to the gradient
                let flat = square.iter().any(|d| *d <= 1e-9);
                for b in 0..D {
                    patch.block.columns[affine + D * a + b][r] = if flat {
                        let slopes = match self.total_lagrangian {
                            true => patch.stencils.first_gradient::<K, D>(r, b),
                            false => weights.gradient(b),
                        };
                        weights.dot(slopes, star)
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

    /// Divergence of a velocity [1/s]: that in the plane, `plane`, plus with axial symmetry the
    /// hoop strain rate N v_x/x of a particle; `radial` gives v_x [m/s] for each line of nodes.
    #[inline(always)]
    pub(crate) fn with_hoop<const K: usize>(
        &self,
        patch: &Patch<D>,
        weights: &ParticleWeights<'_, K, D>,
        r: usize,
        plane: f64,
        radial: impl Fn(usize) -> [f64; K],
    ) -> f64 {
        match D > 1 && self.axisymmetric {
            true => plane + weights.sum(weights.values, radial) / self.radius(patch, r),
            false => plane,
        }
    }

    pub(super) fn gather_limiter<const K: usize>(&self, patch: &mut Patch<D>) {
        if let (Some(limiter), Some(column)) =
            (self.viscosity.and_then(|v| v.limiter), self.columns.limiter)
        {
            timed(StepPart::Viscosity as usize, patch, |patch| {
                match self.viscosity.is_some_and(|viscosity| viscosity.acts_in_expansion()) {
                    true => self.find_limiter::<K, true>(patch, limiter, column),
                    false => self.find_limiter::<K, false>(patch, limiter, column),
                }
            });
        }
    }

    /// Writes the viscosity limiter of the own particles to its column, in expansion if the viscosity
    /// `EXPANDS`.
    fn find_limiter<const K: usize, const EXPANDS: bool>(
        &self,
        patch: &mut Patch<D>,
        limiter: Limiter,
        column: usize,
    ) {
        let (fields, star) = (&patch.nodes.fields, self.fields.velocity_star);
        let stride = patch.stencils.stride;
        let nodes = Nodes {
            velocity: decomp::array::from_fn::<&[f64], D, _>(|a| &fields[star + a]),
            inverse_mass: &fields[self.fields.inverse],
            steps: decomp::array::from_fn(|a| if a == 0 { 1 } else { stride }),
            inverse_cell: self.inverse_cell,
            layer: patch.nodes.nodes.count(),
        };
        let lower = patch.nodes.nodes.lower;
        let n = patch.block.own();
        let (count, layers) = (patch.nodes.nodes.count(), patch.nodes.layers);
        let first = &patch.stencils.first;
        let layer = |r: usize| if layers > 1 { first[r] as usize / count * count } else { 0 };
        let mut limiters = std::mem::take(&mut patch.block.columns[column]);
        let gradient = &patch.block.columns[self.columns.divergence][..n];
        let particles = limiters[..n].iter_mut().zip(gradient).zip(&patch.block.cells);
        // particles of a cell follow each other; those in compression have one limiter by
        // Christensen, those in expansion another
        let mut of_cell = [(usize::MAX, 0.0); 2];
        for (r, ((phi, &gradient), cell)) in particles.enumerate() {
            let expands = EXPANDS && gradient > 0.0;
            // no viscosity to limit
            if (!EXPANDS && gradient >= 0.0) || gradient == 0.0 {
                *phi = 0.0;
                continue;
            }
            *phi = match limiter {
                Limiter::Christensen => {
                    let at = |a: usize| (i64::from(cell[a]) - lower[a]) as usize;
                    let node = (1..D).fold(at(0), |sum, a| sum + stride * at(a)) + layer(r);
                    let of_cell = &mut of_cell[usize::from(expands)];
                    if of_cell.0 != node {
                        let phi = artificial_viscosity::christensen(&nodes, node, expands);
                        *of_cell = (node, phi);
                    }
                    of_cell.1
                }
                Limiter::Nodal => {
                    let weights = patch.stencils.particle::<K, D>(r);
                    let push = self.push_of(patch, r);
                    artificial_viscosity::nodal(&nodes, &weights, gradient, push)
                }
            };
        }
        patch.block.columns[column] = limiters;
    }
}

/// Velocity gradient at a particle [1/s]; `of` gives the velocity components [m/s] for each line of
/// nodes.
#[inline(always)]
pub(crate) fn tensor_of<const K: usize, const D: usize>(
    weights: &ParticleWeights<'_, K, D>,
    of: impl Fn(usize, usize) -> [f64; K],
) -> [[f64; D]; D] {
    // no nested closures: compilers do not inline them
    let mut tensor = [[0.0; D]; D];
    for a in 0..D {
        for b in 0..D {
            tensor[a][b] = weights.sum(weights.gradient(b), |line| of(a, line));
        }
    }
    tensor
}

/// Trace of a tensor.
#[inline(always)]
pub(crate) fn trace<const D: usize>(tensor: &[[f64; D]; D]) -> f64 {
    (1..D).fold(tensor[0][0], |sum, a| sum + tensor[a][a])
}

/// Writes a tensor to its columns from `first` on.
#[inline(always)]
pub(crate) fn put<const D: usize>(
    columns: &mut [impl DerefMut<Target = [f64]>],
    first: usize,
    particle: usize,
    tensor: &[[f64; D]; D],
) {
    for a in 0..D {
        for b in 0..D {
            columns[first + D * a + b][particle] = tensor[a][b];
        }
    }
}
