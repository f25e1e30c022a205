//! Sums of nodal velocities at one particle, from which a mid-point step updates it.

use decomp::array::{from_fn, part};
use wide::f64x4;

use crate::shape::fours;
use crate::solver::packed::{PackedWeights, WindowPlace, dot, is_one_vector, total, totals};
use crate::solver::particle_weights::ParticleWeights;

/// Nodal velocities of a step [m/s].
#[derive(Clone, Copy)]
pub(super) struct NodalVelocities<'a, const D: usize> {
    /// At the start of the step.
    pub start: [&'a [f64]; D],
    /// At the end of the step.
    pub star: [&'a [f64]; D],
    /// Velocity that does the work, if it is not the mean of start and end.
    pub work: Option<[&'a [f64]; D]>,
    /// Velocities whose product with the mean the heat of the filter needs.
    pub lost: Option<[&'a [f64]; D]>,
    /// Whether the heat of the filter needs the squares of the velocity at the start.
    pub squares: bool,
    /// Whether all components of the gradients are needed, not their traces alone.
    pub tensors: bool,
    /// Whether all components of the gradient of the work velocity and its value are needed.
    pub work_tensor: bool,
}

/// Sums over the nodes of one particle at the end of a leapfrog step, or of several if `T` is a
/// vector.
#[derive(Clone, Copy)]
pub(super) struct EndSums<const D: usize, T = f64> {
    /// Velocity at the start and at the end [m/s]; 0 if they are not needed.
    pub start: [T; D],
    pub star: [T; D],
    /// Gradient of the velocity at the end [1/s]: row a belongs to component a.
    pub gradient: [[T; D]; D],
}

/// Number of particles whose sums are found before the particles are updated.
pub(super) const BLOCK: usize = 32;

/// Sums over the nodes of one particle, or of several if `T` is an array.
#[derive(Clone, Copy)]
pub(super) struct NodalSums<const D: usize, T = f64> {
    /// Velocity at the start, at the end, and their mean [m/s].
    pub start: [T; D],
    pub star: [T; D],
    pub mean: [T; D],
    /// Lost velocity [m/s], and its product with the mean or the square of the velocity at the start
    /// [m2/s2].
    pub lost: [T; D],
    pub product: [T; D],
    /// Gradients of the mean, of the velocity at the end and of the work velocity [1/s]: row a
    /// belongs to component a.
    pub mean_gradient: [[T; D]; D],
    pub star_gradient: [[T; D]; D],
    pub work_gradient: [[T; D]; D],
    /// Work velocity along x [m/s].
    pub work: T,
}

impl<const D: usize> NodalSums<D, [f64; BLOCK]> {
    /// Zeros.
    pub fn none() -> Self {
        let (vector, tensor) = ([[0.0; BLOCK]; D], [[[0.0; BLOCK]; D]; D]);
        NodalSums {
            start: vector,
            star: vector,
            mean: vector,
            lost: vector,
            product: vector,
            mean_gradient: tensor,
            star_gradient: tensor,
            work_gradient: tensor,
            work: [0.0; BLOCK],
        }
    }

    /// Writes the sums of particle `k` of the block.
    #[inline(always)]
    pub fn put(&mut self, k: usize, one: &NodalSums<D>) {
        for a in 0..D {
            self.start[a][k] = one.start[a];
            self.star[a][k] = one.star[a];
            self.mean[a][k] = one.mean[a];
            self.lost[a][k] = one.lost[a];
            self.product[a][k] = one.product[a];
            for b in 0..D {
                self.mean_gradient[a][b][k] = one.mean_gradient[a][b];
                self.star_gradient[a][b][k] = one.star_gradient[a][b];
                self.work_gradient[a][b][k] = one.work_gradient[a][b];
            }
        }
        self.work[k] = one.work;
    }

    /// Sums of `L` particles from `k` on.
    #[inline(always)]
    pub fn part<const L: usize>(&self, k: usize) -> NodalSums<D, [f64; L]> {
        let part = |all: &[f64; BLOCK]| *part(all, k);
        let vector = |all: &[[f64; BLOCK]; D]| from_fn(|a| part(&all[a]));
        let tensor = |all: &[[[f64; BLOCK]; D]; D]| from_fn(|a| vector(&all[a]));
        NodalSums {
            start: vector(&self.start),
            star: vector(&self.star),
            mean: vector(&self.mean),
            lost: vector(&self.lost),
            product: vector(&self.product),
            mean_gradient: tensor(&self.mean_gradient),
            star_gradient: tensor(&self.star_gradient),
            work_gradient: tensor(&self.work_gradient),
            work: part(&self.work),
        }
    }
}

/// Nodal values on one window in vectors.
pub(super) struct PackedVelocities<const V: usize, const D: usize> {
    start: [[f64x4; V]; D],
    star: [[f64x4; V]; D],
    mean: [[f64x4; V]; D],
    work: [[f64x4; V]; D],
    lost: [[f64x4; V]; D],
    product: [[f64x4; V]; D],
}

impl<const V: usize, const D: usize> PackedVelocities<V, D> {
    /// Nothing.
    pub fn none() -> Self {
        let none = [[f64x4::ZERO; V]; D];
        PackedVelocities {
            start: none,
            star: none,
            mean: none,
            work: none,
            lost: none,
            product: none,
        }
    }

    /// Fetches the nodes of the window at `place`.
    // not inlined: the gather of a mid-point step then takes fewer instructions
    #[inline(never)]
    pub fn fetch<const K: usize>(&mut self, nodal: &NodalVelocities<'_, D>, place: WindowPlace) {
        let nodes = |field: &[f64]| place.nodes::<K, V>(field);
        for a in 0..D {
            self.start[a] = nodes(nodal.start[a]);
            self.star[a] = nodes(nodal.star[a]);
            for l in 0..V {
                self.mean[a][l] = f64x4::HALF * (self.start[a][l] + self.star[a][l]);
            }
            self.work[a] = match nodal.work {
                Some(work) => nodes(work[a]),
                None => self.mean[a],
            };
            if let Some(lost) = nodal.lost {
                self.lost[a] = nodes(lost[a]);
                for l in 0..V {
                    self.product[a][l] = self.lost[a][l] * self.mean[a][l];
                }
            } else if nodal.squares {
                for l in 0..V {
                    self.product[a][l] = self.start[a][l] * self.start[a][l];
                }
            }
        }
    }

    /// Sums at a particle with the `weights` on this window, in a plane.
    #[inline(always)]
    pub fn sums<const K: usize>(
        &self,
        nodal: &NodalVelocities<'_, D>,
        weights: &PackedWeights<V, D>,
    ) -> NodalSums<D> {
        let (n, g) = (&weights.values, &weights.gradients);
        let (x, y) = (0, D - 1);
        let along = |v: &[[f64x4; V]; D], a: usize, b: usize| dot(&g[b], &v[a]);
        let pair = |v: [f64; 2]| from_fn(|a| v[a]);
        let tensor =
            |[xx, xy, yx, yy]: [f64; 4]| from_fn(|a| from_fn(|b| [xx, xy, yx, yy][2 * a + b]));
        let [start_x, start_y, star_x, star_y] = totals::<K>([
            dot(n, &self.start[x]),
            dot(n, &self.start[y]),
            dot(n, &self.star[x]),
            dot(n, &self.star[y]),
        ]);
        let [mean_x, mean_y, work_xx, work_yy] = totals::<K>([
            dot(n, &self.mean[x]),
            dot(n, &self.mean[y]),
            along(&self.work, x, x),
            along(&self.work, y, y),
        ]);
        let mut products = [0.0; 4];
        if nodal.lost.is_some() || nodal.squares {
            products = totals::<K>([
                dot(n, &self.lost[x]),
                dot(n, &self.lost[y]),
                dot(n, &self.product[x]),
                dot(n, &self.product[y]),
            ]);
        }
        let full = |v: &[[f64x4; V]; D]| {
            totals::<K>([along(v, x, x), along(v, x, y), along(v, y, x), along(v, y, y)])
        };
        let [of_mean, of_star] = match nodal.tensors {
            true => [full(&self.mean), full(&self.star)],
            false => {
                let [a, b, c, d] = totals::<K>([
                    along(&self.mean, x, x),
                    along(&self.mean, y, y),
                    along(&self.star, x, x),
                    along(&self.star, y, y),
                ]);
                [[a, 0.0, 0.0, b], [c, 0.0, 0.0, d]]
            }
        };
        let mut others = [0.0; 4];
        if nodal.work_tensor {
            others = totals::<K>([
                along(&self.work, x, y),
                along(&self.work, y, x),
                dot(n, &self.work[x]),
                f64x4::ZERO,
            ]);
        }
        NodalSums {
            start: pair([start_x, start_y]),
            star: pair([star_x, star_y]),
            mean: pair([mean_x, mean_y]),
            lost: pair([products[0], products[1]]),
            product: pair([products[2], products[3]]),
            mean_gradient: tensor(of_mean),
            star_gradient: tensor(of_star),
            work_gradient: tensor([work_xx, others[0], others[1], work_yy]),
            work: others[2],
        }
    }
}

/// Nodal values at the start and the end of a step on one window in vectors.
pub(super) struct PackedEnds<const V: usize, const D: usize> {
    start: [[f64x4; V]; D],
    star: [[f64x4; V]; D],
}

impl<const V: usize, const D: usize> PackedEnds<V, D> {
    /// Nothing.
    pub fn none() -> Self {
        PackedEnds { start: [[f64x4::ZERO; V]; D], star: [[f64x4::ZERO; V]; D] }
    }

    /// Fetches the nodes of the window at `place`.
    #[inline(always)]
    pub fn fetch<const K: usize>(&mut self, [start, star]: [[&[f64]; D]; 2], place: WindowPlace) {
        for a in 0..D {
            self.start[a] = place.nodes::<K, V>(start[a]);
            self.star[a] = place.nodes::<K, V>(star[a]);
        }
    }

    /// Sums at a particle with the `weights` on this window in a plane: of the velocities if it `moves`, of the
    /// gradient if it is `strained`, of all its components for `tensors`.
    #[inline(always)]
    pub fn sums<const K: usize>(
        &self,
        weights: &PackedWeights<V, D>,
        [moves, strained, tensors]: [bool; 3],
    ) -> EndSums<D> {
        let (n, g) = (&weights.values, &weights.gradients);
        let (x, y) = (0, D - 1);
        let along = |a: usize, b: usize| dot(&g[b], &self.star[a]);
        let mut gradient = [0.0; 4];
        let mut ends = [0.0; 4];
        if moves {
            let [start, star] = [&self.start, &self.star];
            ends = totals::<K>([
                dot(n, &start[x]),
                dot(n, &start[y]),
                dot(n, &star[x]),
                dot(n, &star[y]),
            ]);
        }
        if strained {
            let zero = f64x4::ZERO;
            if const { is_one_vector(K) } && !tensors {
                [gradient[0], gradient[3]] = [total(along(x, x)), total(along(y, y))];
            } else {
                let mixed = if tensors { [along(x, y), along(y, x)] } else { [zero; 2] };
                gradient = totals::<K>([along(x, x), mixed[0], mixed[1], along(y, y)]);
            }
        }
        EndSums {
            start: from_fn(|a| ends[a]),
            star: from_fn(|a| ends[2 + a]),
            gradient: from_fn(|a| from_fn(|b| gradient[2 * a + b])),
        }
    }
}

impl<const D: usize> EndSums<D> {
    /// The same sums one after the other, for windows of any width.
    #[inline(always)]
    pub fn one_by_one<const K: usize, const L: usize>(
        [start, star]: [[&[f64]; D]; 2],
        weights: &ParticleWeights<'_, K, D>,
        [moves, strained, tensors]: [bool; 3],
    ) -> Self {
        let (start, star) = (weights.windows::<L, D>(start), weights.windows::<L, D>(star));
        let mut sums = EndSums { start: [0.0; D], star: [0.0; D], gradient: [[0.0; D]; D] };
        for a in 0..D {
            if moves {
                sums.start[a] = weights.sum(weights.values, |l| start[a][l]);
                sums.star[a] = weights.sum(weights.values, |l| star[a][l]);
            }
            for b in 0..D {
                if strained && (a == b || tensors) {
                    sums.gradient[a][b] = weights.sum(weights.gradient(b), |l| star[a][l]);
                }
            }
        }
        sums
    }
}

impl<const D: usize> NodalSums<D> {
    /// Sums at a particle on a line, four in each vector operation, for windows of three or four nodes.
    #[inline(always)]
    pub fn on_line<const K: usize>(
        nodal: &NodalVelocities<'_, D>,
        weights: &ParticleWeights<'_, K, D>,
    ) -> Self {
        let nodes = |field: [&[f64]; D]| fours(weights.line(field[0], 0), 0);
        let (n, g) = (fours(&weights.values[0], 0), fours(&weights.gradients[0], 0));
        let (start, star) = (nodes(nodal.start), nodes(nodal.star));
        let mean = f64x4::HALF * (start + star);
        let work = nodal.work.map_or(mean, nodes);
        let [lost, product] = match nodal.lost {
            Some(lost) => [nodes(lost), nodes(lost) * mean],
            None => [f64x4::ZERO, if nodal.squares { start * start } else { f64x4::ZERO }],
        };
        let values = totals::<K>([n * start, n * star, n * mean, n * product]);
        let others = totals::<K>([g * mean, g * star, g * work, n * lost]);
        NodalSums {
            start: [values[0]; D],
            star: [values[1]; D],
            mean: [values[2]; D],
            lost: [others[3]; D],
            product: [values[3]; D],
            mean_gradient: [[others[0]; D]; D],
            star_gradient: [[others[1]; D]; D],
            work_gradient: [[others[2]; D]; D],
            work: if nodal.work_tensor { totals::<K>([n * work; 4])[0] } else { 0.0 },
        }
    }

    /// The same sums one after the other, for windows of any width.
    #[inline(always)]
    pub fn one_by_one<const K: usize, const L: usize>(
        nodal: &NodalVelocities<'_, D>,
        weights: &ParticleWeights<'_, K, D>,
    ) -> Self {
        // fetched once, as several sums use them
        let start = weights.windows::<L, D>(nodal.start);
        let star = weights.windows::<L, D>(nodal.star);
        let mut mean = start;
        for a in 0..D {
            for l in 0..L {
                for k in 0..K {
                    mean[a][l][k] = 0.5 * (start[a][l][k] + star[a][l][k]);
                }
            }
        }
        let work = nodal.work.map_or(mean, |work| weights.windows::<L, D>(work));
        let mut sums = NodalSums {
            start: [0.0; D],
            star: [0.0; D],
            mean: [0.0; D],
            lost: [0.0; D],
            product: [0.0; D],
            mean_gradient: [[0.0; D]; D],
            star_gradient: [[0.0; D]; D],
            work_gradient: [[0.0; D]; D],
            work: 0.0,
        };
        let n = weights.values;
        let times = |a: &[f64; K], b: &[f64; K]| -> [f64; K] { from_fn(|k| a[k] * b[k]) };
        for a in 0..D {
            sums.start[a] = weights.sum(n, |l| start[a][l]);
            sums.star[a] = weights.sum(n, |l| star[a][l]);
            sums.mean[a] = weights.sum(n, |l| mean[a][l]);
            if let Some(lost) = nodal.lost {
                let [lost] = weights.windows::<L, 1>([lost[a]]);
                sums.lost[a] = weights.sum(n, |l| lost[l]);
                sums.product[a] = weights.sum(n, |l| times(&lost[l], &mean[a][l]));
            } else if nodal.squares {
                sums.product[a] = weights.sum(n, |l| times(&start[a][l], &start[a][l]));
            }
            for b in 0..D {
                let g = weights.gradient(b);
                if a == b || nodal.tensors {
                    sums.mean_gradient[a][b] = weights.sum(g, |l| mean[a][l]);
                    sums.star_gradient[a][b] = weights.sum(g, |l| star[a][l]);
                }
                if a == b || nodal.work_tensor {
                    sums.work_gradient[a][b] = weights.sum(g, |l| work[a][l]);
                }
            }
        }
        if nodal.work_tensor {
            sums.work = weights.sum(n, |l| work[0][l]);
        }
        sums
    }
}
