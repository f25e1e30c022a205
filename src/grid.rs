//! Nodal fields of one patch and the mass matrix on them.
//!
//! Knows no materials and no messages.

use std::ops::Range;

use crate::transfer::{NARROW, Row, add_product, lines};

/// Where each nodal field stands in a patch's arrays. A vector takes D fields that follow each
/// other; its number is that of the first.
///
/// Fields that a scheme has no use for have no array: their number is past the end.
#[derive(Clone, Debug)]
pub struct Fields {
    /// Lumped mass m_i [kg].
    pub mass: usize,
    /// 1/m_i, 0 where there is no mass [1/kg].
    pub inverse: usize,
    /// Lumped velocity vL [m/s], a vector; momentum while it is being summed.
    pub lumped: usize,
    /// Velocity at the start of the step, v [m/s], a vector: without a filter the lumped one
    /// itself.
    pub velocity: usize,
    /// Velocity at the end of the step, v' [m/s], a vector.
    pub velocity_star: usize,
    /// Acceleration b [m/s2], a vector; internal force while it is being summed.
    pub acceleration: usize,
    /// Velocity whose gradient does the work, w [m/s], a vector.
    pub work: usize,
    /// K^(k-1) vL, the last term of the filter's series [m/s], a vector; with a filter.
    pub remainder: Option<usize>,
    /// Scratch for a product.
    pub scratch: usize,
    /// First terms of the series of force and work, a vector.
    pub first: usize,
    /// Fraction of the node's volume that holds material [-], with an edge mask.
    pub volume: usize,
    /// Relaxation: summed compliance and its inverse, the projected pressure, and its first term,
    /// in the end its last.
    pub relaxation: [usize; 4],
    /// Heat of friction [J/kg], with contact or a wall that has friction.
    pub heat: Option<usize>,
    /// What heat conduction takes, with it.
    pub conduction: Option<ConductionFields>,
    /// Scratch for the sums of a side.
    pub side: usize,
    /// Number of fields.
    pub count: usize,
}

/// Where the fields of heat conduction stand.
#[derive(Clone, Copy, Debug)]
pub struct ConductionFields {
    /// 1/C_i of the heat capacity, 0 where there is none [K/J].
    pub inverse: usize,
    /// Temperature T_i [K].
    pub temperature: usize,
    /// Temperature projected through the full matrix of capacities [K].
    pub projected: usize,
    /// Its rate [K/s].
    pub rate: usize,
}

/// What of the fields a scheme and its effects ask for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wanted {
    /// A filter.
    pub filtered: bool,
    /// An edge mask.
    pub masked: bool,
    /// Pressure relaxation.
    pub relaxed: bool,
    /// Friction.
    pub rubs: bool,
    /// Heat conduction.
    pub conducts: bool,
    /// Sums of a side.
    pub sides: usize,
}

impl Fields {
    /// The fields in `dimension` directions.
    pub fn new(dimension: usize, wanted: Wanted) -> Self {
        let Wanted { filtered, masked, relaxed, rubs, conducts, sides } = wanted;
        let mut count = 0;
        let mut add = |n: usize, wanted: bool| {
            let at = if wanted { count } else { usize::MAX / 2 };
            count += if wanted { n } else { 0 };
            at
        };
        let [mass, inverse, scratch] = [1; 3].map(|n| add(n, true));
        let [lumped, velocity_star, acceleration, work, first] =
            [dimension; 5].map(|n| add(n, true));
        let velocity = if filtered { add(dimension, true) } else { lumped };
        let remainder = filtered.then(|| add(dimension, true));
        let volume = add(1, masked);
        let r = add(4, relaxed);
        let heat = rubs.then(|| add(1, true));
        let conduction = conducts.then(|| ConductionFields {
            inverse: add(1, true),
            temperature: add(1, true),
            projected: add(1, true),
            rate: add(1, true),
        });
        let side = add(sides, true);
        Fields {
            mass,
            inverse,
            lumped,
            velocity,
            velocity_star,
            acceleration,
            work,
            remainder,
            scratch,
            first,
            volume,
            relaxation: [r, r + 1, r + 2, r + 3],
            heat,
            conduction,
            side,
            count,
        }
    }
}

/// A symmetric matrix M_ij = sum_p m_p N_ip N_jp over the nodes of a patch, one diagonal after
/// the other: a diagonal holds M_(i,i+offset) at i, for the offsets to nodes that come later.
#[derive(Clone, Debug, Default)]
pub struct Band {
    rows: Vec<f64>,
    diagonals: Vec<Vec<f64>>,
    /// From a node to the other of each diagonal, in the patch's arrays.
    offsets: Vec<usize>,
    /// Nodes along one direction that a particle touches.
    width: usize,
}

/// Diagonals for windows of `width` nodes along each of `dimension` directions.
const fn diagonals(width: usize, dimension: usize) -> usize {
    (lines(2 * width - 1, dimension) * (2 * width - 1)).div_ceil(2)
}

impl Band {
    /// Sets to zero over `nodes` nodes for particles that touch `width` nodes along each of
    /// `dimension` directions, in arrays whose lines are `stride` long.
    pub fn clear(&mut self, nodes: usize, width: usize, dimension: usize, stride: usize) {
        self.width = width;
        let count = diagonals(width, dimension);
        self.rows.clear();
        self.rows.resize(nodes * count, 0.0);
        let across = if dimension == 1 { 1 } else { width };
        let place = |line: usize, k: usize| match line {
            0 => k,
            _ => line * stride + k + 1 - width,
        };
        self.offsets.clear();
        for line in 0..across {
            let length = if line == 0 { width } else { 2 * width - 1 };
            self.offsets.extend((0..length).map(|k| place(line, k)));
        }
        debug_assert_eq!(self.offsets.len(), count);
    }

    /// Adds one particle of mass `mass`.
    #[inline(always)]
    pub fn add<const K: usize, const D: usize>(&mut self, row: &Row<'_, K, D>, mass: f64) {
        if row.is_narrow() {
            self.add_part::<K, D, NARROW>(row, mass);
        } else {
            self.add_part::<K, D, K>(row, mass);
        }
    }

    /// Adds the products of the first `M` nodes along each direction.
    #[inline(always)]
    fn add_part<const K: usize, const D: usize, const M: usize>(
        &mut self,
        row: &Row<'_, K, D>,
        mass: f64,
    ) {
        let count = const { diagonals(K, D) };
        let first_nodes =
            |values: &[f64; K]| -> [f64; M] { *values.first_chunk().expect("as many nodes") };
        for line in 0..const { lines(M, D) } {
            let from = row.first + line * row.stride;
            // of a length known at compile time, so that no place in it is checked
            let rows = &mut self.rows[from * count..][..const { K * diagonals(K, D) }];
            let (here, later) = row.values[..const { lines(M, D) }][line..]
                .split_first()
                .expect("the lines from this one on");
            for i in 0..M {
                let term = mass * here[i];
                for k in i..M {
                    rows[i * count + k - i] += term * here[k];
                }
                let across = rows[i * count + K..(i + 1) * count].chunks_exact_mut(2 * K - 1);
                for (sums, values) in across.zip(later) {
                    add_product(sums, K - 1 - i, term, &first_nodes(values));
                }
            }
        }
    }

    /// Must be called once all particles are in.
    pub fn finish(&mut self) {
        let count = self.offsets.len();
        let nodes = self.rows.len() / count;
        self.diagonals.resize_with(count, Vec::new);
        for (d, diagonal) in self.diagonals.iter_mut().enumerate() {
            diagonal.resize(nodes, 0.0);
            for (value, row) in diagonal.iter_mut().zip(self.rows.chunks_exact(count)) {
                *value = row[d];
            }
        }
    }

    /// y = M x on the nodes `range`, which must lie at least the band's width from the ends.
    pub fn product(&self, x: &[f64], range: Range<usize>, y: &mut [f64]) {
        self.each_product(x, range, y, |product, _| product);
    }

    /// y = t + x - d M x on the nodes `range`, d a diagonal matrix: a sum of a series and its
    /// next by Horner's rule.
    pub fn next_sum(&self, x: &[f64], d: &[f64], t: &[f64], range: Range<usize>, y: &mut [f64]) {
        let (x_here, d, t) = (&x[range.clone()], &d[range.clone()], &t[range.clone()]);
        self.each_product(x, range, y, |product, i| t[i] + (x_here[i] - d[i] * product));
    }

    /// y = f((M x)_i, i) on the nodes of `range`, i counted from its start.
    #[inline(always)]
    fn each_product(
        &self,
        x: &[f64],
        range: Range<usize>,
        y: &mut [f64],
        f: impl Fn(f64, usize) -> f64,
    ) {
        let (from, to) = (range.start, range.end);
        match self.offsets.len() {
            3 => self.product_of::<3>(x, from, to, y, f),
            4 => self.product_of::<4>(x, from, to, y, f),
            _ => self.product_by_diagonals(x, range, y, f),
        }
    }

    /// The same sums in the same order, a diagonal after the other: for many of them.
    #[inline(always)]
    fn product_by_diagonals(
        &self,
        x: &[f64],
        range: Range<usize>,
        y: &mut [f64],
        f: impl Fn(f64, usize) -> f64,
    ) {
        let (from, to) = (range.start, range.end);
        if from >= to {
            return;
        }
        let sums = &mut y[range];
        let n = sums.len();
        let (main, centre) = (&self.diagonals[0][from..to], &x[from..to]);
        for i in 0..n {
            sums[i] = main[i] * centre[i];
        }
        for (diagonal, &o) in self.diagonals.iter().zip(&self.offsets).skip(1) {
            let (above, x_above) = (&diagonal[from..to], &x[from + o..to + o]);
            let (below, x_below) = (&diagonal[from - o..to - o], &x[from - o..to - o]);
            for i in 0..n {
                sums[i] += above[i] * x_above[i];
                sums[i] += below[i] * x_below[i];
            }
        }
        for (i, sum) in sums.iter_mut().enumerate() {
            *sum = f(*sum, i);
        }
    }

    /// The same sums in the same order, with few diagonals known so that they run in vectors.
    #[inline(always)]
    fn product_of<const W: usize>(
        &self,
        x: &[f64],
        from: usize,
        to: usize,
        y: &mut [f64],
        f: impl Fn(f64, usize) -> f64,
    ) {
        if from >= to {
            return;
        }
        let n = to - from;
        let y = &mut y[from..to];
        let main = &self.diagonals[0][from..to];
        let above: [(&[f64], &[f64]); W] =
            std::array::from_fn(|d| (&self.diagonals[d][from..to], &x[from + d..to + d]));
        let below: [(&[f64], &[f64]); W] =
            std::array::from_fn(|d| (&self.diagonals[d][from - d..to - d], &x[from - d..to - d]));
        let centre = &x[from..to];
        for i in 0..n {
            let mut sum = main[i] * centre[i];
            for d in 1..W {
                sum += above[d].0[i] * above[d].1[i];
                sum += below[d].0[i] * below[d].1[i];
            }
            y[i] = f(sum, i);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Particles: their first node, mass and values.
    fn check<const K: usize, const D: usize>(
        extent: [usize; 2],
        particles: &[(usize, f64, Vec<[f64; K]>)],
        inner: Range<usize>,
    ) {
        let nodes = extent[0] * extent[1];
        let mut band = Band::default();
        band.clear(nodes, K, D, extent[0]);
        let mut full = vec![vec![0.0; nodes]; nodes];
        for (first, mass, values) in particles {
            let row: Row<'_, K, D> =
                Row { first: *first, stride: extent[0], narrow: false, values, gradients: &[] };
            band.add(&row, *mass);
            let place = |l: usize, k: usize| first + l * extent[0] + k;
            for (l, k) in (0..values.len()).flat_map(|l| (0..K).map(move |k| (l, k))) {
                for (m, j) in (0..values.len()).flat_map(|m| (0..K).map(move |j| (m, j))) {
                    full[place(l, k)][place(m, j)] += mass * values[l][k] * values[m][j];
                }
            }
        }
        band.finish();
        let x: Vec<f64> = (0..nodes).map(|i| (i * i % 17) as f64).collect();
        let mut y = vec![0.0; nodes];
        band.product(&x, inner.clone(), &mut y);
        assert!(inner.clone().any(|i| y[i] != 0.0));
        for i in inner {
            let exact: f64 = (0..nodes).map(|j| full[i][j] * x[j]).sum();
            assert!((y[i] - exact).abs() < 1e-12 * exact.abs().max(1.0), "{i}");
        }
    }

    #[test]
    fn the_band_is_the_matrix_of_products() {
        let particles = [
            (3, 2.0, vec![[0.2, 0.5, 0.3]]),
            (4, 1.5, vec![[0.1, 0.6, 0.3]]),
            (3, 0.7, vec![[0.0, 0.4, 0.6]]),
        ];
        check::<3, 1>([12, 1], &particles, 3..9);
    }

    #[test]
    fn in_a_plane_too() {
        let lines = |a: f64| vec![[0.1, 0.2, 0.05], [a, 0.25, 0.1], [0.0, 0.07, 0.3 - a]];
        let particles = [(40, 2.0, lines(0.1)), (41, 1.5, lines(0.2)), (52, 0.7, lines(0.05))];
        check::<3, 2>([12, 9], &particles, 36..80);
    }
}
