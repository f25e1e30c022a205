//! Total-Lagrangian frame: shape functions of the initial positions of the particles.
//!
//! ```text
//! N = N(X),  G = F_h^-T G0(X)                 on a line G0/J_h
//! F += dt l F_h                               l the gradient of the step's velocity with G
//! h = dx/|F^-1 n|                             edge of a cell along the most compressed direction n
//! dt = courant * min dx/(|particle a of F^-1| (c + 2 (a1 c + a2 h |D|)))
//! ```
//!
//! The grid moves with the material (de Vaucorbeil, Nguyen & Hutchinson 2020), so that weights,
//! mass matrix and cells of the particles never change, no particle crosses a cell boundary, and
//! the speed of the material does not limit the time step. The rest of a step is the same as in the
//! updated-Lagrangian frame, at the current volumes. Limits of this frame: separate bodies cannot
//! collide, and a body cannot touch itself.

use decomp::Block;

use super::scheme::Scheme;
use crate::shape::DomainExtent;
use crate::solver::patch::{FaultPhase, Patch};

/// Inverse and determinant of a tensor with the components xx, xy, yx, yy.
#[inline(always)]
fn inverse([xx, xy, yx, yy]: [f64; 4]) -> ([f64; 4], f64) {
    let determinant = xx * yy - xy * yx;
    let scale = 1.0 / determinant;
    ([yy * scale, -xy * scale, -yx * scale, xx * scale], determinant)
}

/// 1/|F^-1 n| along the direction n of strongest compression, or of strongest stretching if the
/// volume grows, with the projector n n = (E - e2)/(e1 - e2) of the strain rate E with eigenvalues
/// e1 and e2.
#[inline(always)]
fn stretch_of([ixx, ixy, iyx, iyy]: [f64; 4], [lxx, lxy, lyx, lyy]: [f64; 4]) -> f64 {
    // C = F^-T F^-1
    let (cx, cy, cs) = (ixx * ixx + iyx * iyx, ixy * ixy + iyy * iyy, ixx * ixy + iyx * iyy);
    let (half, shear) = (0.5 * (lxx - lyy), 0.5 * (lxy + lyx));
    let radius = (half * half + shear * shear).sqrt();
    let mean = 0.5 * (cx + cy);
    let square = match radius > 0.0 {
        true if lxx + lyy > 0.0 => mean + (half * 0.5 * (cx - cy) + shear * cs) / radius,
        true => mean - (half * 0.5 * (cx - cy) + shear * cs) / radius,
        false => mean,
    };
    1.0 / square.sqrt()
}

/// F of a particle extrapolated by the time `ahead` [s], from the columns that start at `f` (F) and
/// `l` (velocity gradient).
#[inline(always)]
fn ahead_of(columns: &[Vec<f64>], particle: usize, [f, l]: [usize; 2], ahead: f64) -> [f64; 4] {
    let tensor =
        |first: usize| -> [f64; 4] { decomp::array::from_fn(|k| columns[first + k][particle]) };
    let (f, l) = (tensor(f), tensor(l));
    decomp::array::from_fn(|k| {
        let (a, b) = (k / 2, k % 2);
        f[k] + ahead * (l[2 * a] * f[b] + l[2 * a + 1] * f[2 + b])
    })
}

impl<const D: usize> Scheme<D> {
    /// F^-1, which pushes the gradients of the own particles forward, at the time `ahead` [s] of
    /// their deformation and the volume ratio in column `jacobian`.
    pub(super) fn invert_deformation(&self, patch: &mut Patch<D>, ahead: f64, jacobian: usize) {
        let Some(push) = self.columns.inverse_deformation else { return };
        let n = patch.block.own();
        for k in 0..D * D {
            patch.block.columns[push + k].resize(n, 0.0);
        }
        let mut turned = None;
        let columns = &mut patch.block.columns;
        for r in 0..n {
            let determinant = if D == 1 {
                let j = columns[jacobian][r];
                columns[push][r] = 1.0 / j;
                j
            } else {
                let (f, determinant) = inverse(self.deformation(columns, r, ahead));
                (0..4).for_each(|k| columns[push + k][r] = f[k]);
                determinant
            };
            if turned.is_none() && (determinant.is_nan() || determinant <= 0.0) {
                turned = Some(r);
            }
        }
        if let Some(particle) = turned {
            self.fault(
                patch,
                FaultPhase::Start,
                particle,
                "it is turned inside out within one step".into(),
            );
        }
    }

    /// F of a particle in a plane, extrapolated by the time `ahead` [s].
    #[inline(always)]
    fn deformation(&self, columns: &[Vec<f64>], particle: usize, ahead: f64) -> [f64; 4] {
        let both = self.columns.deformation.zip(self.columns.velocity_gradient);
        let (f, l) = both.expect("the frame has the columns in a plane");
        ahead_of(columns, particle, [f, l], ahead)
    }

    /// Transforms the velocity gradients of the own particles in the columns from `out` on to
    /// gradients with respect to the initial positions, L F.
    pub(crate) fn pull_gradient(&self, patch: &mut Patch<D>, out: usize, jacobian: usize) {
        for r in 0..patch.block.own() {
            let columns = &mut patch.block.columns;
            if D == 1 {
                columns[out][r] *= columns[jacobian][r];
                continue;
            }
            let f: [f64; 4] = self.deformation(columns, r, 0.0);
            for a in 0..D {
                let [x, y] = [columns[out + D * a][r], columns[out + D * a + D - 1][r]];
                columns[out + D * a][r] = x * f[0] + y * f[2];
                columns[out + D * a + D - 1][r] = x * f[1] + y * f[3];
            }
        }
    }

    /// Initial domains and volumes of the own particles [cells].
    pub(super) fn find_first_domains(&self, patch: &mut Patch<D>) {
        let c = &self.columns;
        let n = patch.block.own();
        let scale: f64 = self.inverse_cell.iter().product();
        for k in c.fill_fraction.into_iter().chain((D == 1).then_some(c.domain)) {
            let [volume0, out] =
                patch.block.columns.get_disjoint_mut([c.volume0, k]).expect("columns differ");
            out.clear();
            out.extend(volume0[..n].iter().map(|v| v * scale));
        }
        if let (true, Some(filled), Some(first)) = (self.axisymmetric, c.fill_fraction, c.reference)
        {
            let [x, out] = patch.block.columns.get_disjoint_mut([first, filled]).expect("differ");
            out.iter_mut().zip(x).for_each(|(out, x)| *out /= *x);
        }
        let Some(half_lengths) = c.half_lengths.filter(|_| D > 1) else { return };
        for a in 0..D {
            let mut set = |k: usize, edge: f64| {
                let [half, out] =
                    patch.block.columns.get_disjoint_mut([half_lengths + a, k]).expect("differ");
                out.clear();
                out.extend(half[..n].iter().map(|h| edge * h * self.inverse_cell[a]));
            };
            match self.extent() {
                DomainExtent::Point => {}
                DomainExtent::Undeformed => set(c.domain + a, 2.0),
                DomainExtent::Current => (0..D).for_each(|edge| {
                    set(c.domain + D * edge + a, if edge == a { 1.0 } else { 0.0 });
                }),
            }
        }
    }

    /// Positions of the own particles at the time `ahead` [s]: distance from the axis, and for
    /// contact displacement and current volume, the latter from the volume ratio in column
    /// `jacobian`.
    pub(super) fn find_shift(&self, patch: &mut Patch<D>, ahead: f64, jacobian: usize) {
        let c = &self.columns;
        if let Some(radius) = c.radius {
            let [x, v, out] = patch
                .block
                .columns
                .get_disjoint_mut([c.position, c.velocity, radius])
                .expect("columns differ");
            out.clear();
            out.extend(x.iter().zip(&*v).map(|(x, v)| x + ahead * v));
        }
        let (Some(shift), Some(room), Some(first)) =
            (c.displacement, c.current_volume, c.reference)
        else {
            return;
        };
        let n = patch.block.own();
        let scale: f64 = self.inverse_cell.iter().product();
        let columns = &mut patch.block.columns;
        for a in 0..D {
            let [x, v, first, out] = columns
                .get_disjoint_mut([c.position + a, c.velocity + a, first + a, shift + a])
                .expect("columns differ");
            out.clear();
            out.extend((0..n).map(|r| x[r] + ahead * v[r] - first[r]));
        }
        let [volume0, j, out] =
            columns.get_disjoint_mut([c.volume0, jacobian, room]).expect("columns differ");
        out.clear();
        out.extend((0..n).map(|r| volume0[r] * j[r] * scale));
    }

    /// Ratio of the current to the initial length of a cell at a particle [-], along the direction
    /// of strongest compression, in a plane.
    #[inline(always)]
    pub(super) fn stretch(&self, patch: &Patch<D>, particle: usize) -> f64 {
        let tensor = |first: Option<usize>| -> [f64; 4] {
            let first = first.expect("the frame has the columns in a plane");
            decomp::array::from_fn(|k| patch.block.columns[first + k][particle])
        };
        stretch_of(tensor(self.columns.inverse_deformation), tensor(self.columns.velocity_gradient))
    }

    /// Greatest number of initial cells that a signal from a particle crosses per second [1/s], on
    /// a line times the edge of a cell [m/s]; and the ratio of the initial to the current length of
    /// a cell there.
    #[inline(always)]
    pub(super) fn signal_rate(&self, block: &Block<D>, particle: usize, sound: f64) -> (f64, f64) {
        let c = &self.columns;
        let d = block.columns[c.divergence][particle];
        let of = |stretch: f64| sound + self.viscosity.map_or(0.0, |q| q.speed(sound, d, stretch));
        if D == 1 {
            let j = block.columns[c.jacobian][particle];
            return (of(j) / j, 1.0 / j);
        }
        let columns = &block.columns;
        let (push, _) = inverse(self.deformation(columns, particle, 0.0));
        let first = c.velocity_gradient.expect("the frame has the column in a plane");
        let stretch = stretch_of(push, decomp::array::from_fn(|k| columns[first + k][particle]));
        let [xx, xy, yx, yy] = push;
        let shorter = [(xx * xx + xy * xy).sqrt(), (yx * yx + yy * yy).sqrt()];
        let rate = |a: usize| shorter[a] * self.inverse_cell[a];
        (of(stretch) * rate(0).max(rate(D - 1)), shorter[0].max(shorter[1]))
    }

    /// Momentum of the nodes, and with `force` the internal force of a fluid, if weights, masses
    /// and matrix are those of the last step; the sums are the same as in a full pass.
    pub(super) fn scatter_moving<const K: usize>(&self, patch: &mut Patch<D>, force: bool) {
        let (c, f) = (&self.columns, &self.fields);
        let vectors = [f.lumped_velocity, f.acceleration].into_iter().chain(f.residuals());
        let scratches = f.scratch..f.scratch + f.scratches;
        for field in vectors.flat_map(|v| v..v + D).chain(scratches) {
            patch.nodes.fields[field].fill(0.0);
        }
        let mut take = |k: usize| std::mem::take(&mut patch.nodes.fields[k]);
        let mut momentum: [Vec<f64>; D] = decomp::array::from_fn(|a| take(f.lumped_velocity + a));
        let mut nodal_force: [Vec<f64>; D] = decomp::array::from_fn(|a| take(f.acceleration + a));
        let column = |k: usize| &patch.block.columns[k][..patch.block.particles()];
        let velocity: [&[f64]; D] = decomp::array::from_fn(|a| column(c.velocity + a));
        let (mass, stress) = (column(c.mass), column(c.stress_volume));
        for r in patch.runs.iter().cloned().flatten() {
            let weights = patch.stencils.particle::<K, D>(r);
            for a in 0..D {
                let mv = mass[r] * velocity[a][r];
                weights.add(&mut momentum[a], weights.values, |n| n * mv);
                if force {
                    weights.add(&mut nodal_force[a], weights.gradient(a), |g| g * stress[r]);
                }
            }
            if force && D > 1 && self.axisymmetric {
                let hoop = stress[r] / self.radius(patch, r);
                weights.add(&mut nodal_force[0], weights.values, |n| n * hoop);
            }
        }
        for (a, (momentum, force)) in momentum.into_iter().zip(nodal_force).enumerate() {
            patch.nodes.fields[f.lumped_velocity + a] = momentum;
            patch.nodes.fields[f.acceleration + a] = force;
        }
    }

    /// F^-1 [-] of a particle at the time of the forces, in the total-Lagrangian frame.
    #[inline(always)]
    pub(super) fn push_of(&self, patch: &Patch<D>, particle: usize) -> Option<[[f64; D]; D]> {
        let push = self.columns.inverse_deformation?;
        let at = |a: usize, b: usize| patch.block.columns[push + D * a + b][particle];
        Some(decomp::array::from_fn(|a| decomp::array::from_fn(|b| at(a, b))))
    }

    /// Reports a fault for particles beyond a rigid side: in this frame a wall acts only on
    /// material that touched it at the start.
    pub(super) fn fault_beyond_walls(&self, patch: &mut Patch<D>) {
        for (a, end) in (0..D).flat_map(|a| [(a, 0), (a, 1)]) {
            if !self.sides[a][end].is_rigid() {
                continue;
            }
            let upper = self.lower[a] + self.cells[a] as f64 * self.cell[a];
            let x = &patch.block.columns[self.columns.position + a][..patch.block.own()];
            let passed = x.iter().position(|&x| match end {
                0 => x < self.lower[a],
                _ => x > upper,
            });
            if let Some(particle) = passed {
                let what = "it passes a wall that its body did not touch at the start; \
                            method.frame \"updated_lagrangian\" knows such a wall";
                self.fault(patch, FaultPhase::Locate, particle, what.into());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Inverse of F.
    fn inverse_of(f: [f64; 4]) -> [f64; 4] {
        inverse(f).0
    }

    #[test]
    fn a_cell_shortens_along_what_is_compressed_most() {
        // half the length along x, which is compressed, or along y, which is not
        let (along, across) = (inverse_of([0.5, 0.0, 0.0, 1.0]), inverse_of([1.0, 0.0, 0.0, 0.5]));
        let compression = [-2.0, 0.0, 0.0, -0.5];
        assert!((stretch_of(along, compression) - 0.5).abs() < 1e-15);
        assert!((stretch_of(across, compression) - 1.0).abs() < 1e-15);
        // the same rotated by 30 degrees: R F, with the rate R E R^T
        let (s, c) = (0.5, 0.75f64.sqrt());
        let turned = inverse_of([0.5 * c, -s, 0.5 * s, c]);
        let rate =
            [-2.0 * c * c - 0.5 * s * s, -1.5 * s * c, -1.5 * s * c, -2.0 * s * s - 0.5 * c * c];
        assert!((stretch_of(turned, rate) - 0.5).abs() < 1e-15);
        // in expansion, the direction of strongest stretching counts
        assert!((stretch_of(along, [2.0, 0.0, 0.0, 0.5]) - 0.5).abs() < 1e-15);
        assert!((stretch_of(along, [0.5, 0.0, 0.0, 2.0]) - 1.0).abs() < 1e-15);
        // no direction of strongest compression
        let even = inverse_of([0.8, 0.0, 0.0, 0.8]);
        assert!((stretch_of(even, [-1.0, 0.0, 0.0, -1.0]) - 0.8).abs() < 1e-15);
    }

    #[test]
    fn inverses_undo() {
        let f = [1.2, 0.3, -0.4, 0.9];
        let (i, determinant) = inverse(f);
        assert!((determinant - 1.2).abs() < 1e-15);
        let product = [
            f[0] * i[0] + f[1] * i[2],
            f[0] * i[1] + f[1] * i[3],
            f[2] * i[0] + f[3] * i[2],
            f[2] * i[1] + f[3] * i[3],
        ];
        for (value, one) in product.into_iter().zip([1.0, 0.0, 0.0, 1.0]) {
            assert!((value - one).abs() < 1e-15);
        }
    }
}
