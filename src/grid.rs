//! Nodal fields of one patch and the mass matrix on them.
//!
//! Knows no materials and no messages.

/// Where each nodal field stands in a patch's arrays.
///
/// Fields that a scheme has no use for have no array: their number is past the end.
#[derive(Clone, Debug)]
pub struct Fields {
    /// Lumped mass m_i [kg].
    pub mass: usize,
    /// 1/m_i, 0 where there is no mass [1/kg].
    pub inverse: usize,
    /// Lumped velocity vL [m/s]; momentum while it is being summed.
    pub lumped: usize,
    /// Velocity at the start of the step, v [m/s]: without a filter the lumped one itself.
    pub velocity: usize,
    /// Velocity at the end of the step, v' [m/s].
    pub velocity_star: usize,
    /// Acceleration b [m/s2]; internal force while it is being summed.
    pub acceleration: usize,
    /// Velocity whose gradient does the work, w [m/s].
    pub work: usize,
    /// K^(k-1) vL, the last term of the filter's series [m/s]; with a filter.
    pub remainder: Option<usize>,
    /// Scratch for a product.
    pub scratch: usize,
    /// Second scratch for a product.
    pub scratch2: usize,
    /// Fraction of the node's volume that holds material [-], with an edge mask.
    pub volume: usize,
    /// Relaxation: summed compliance and its inverse, the projected pressure, and its first term,
    /// in the end its last.
    pub relaxation: [usize; 4],
    /// Number of fields.
    pub count: usize,
}

impl Fields {
    /// The fields for a scheme with or without a filter, an edge mask and pressure relaxation.
    pub fn new(filtered: bool, masked: bool, relaxed: bool) -> Self {
        let mut count = 8;
        let mut add = |n: usize, wanted: bool| {
            let at = if wanted { count } else { usize::MAX / 2 };
            count += if wanted { n } else { 0 };
            at
        };
        let lumped = 2;
        let velocity = if filtered { add(1, true) } else { lumped };
        let remainder = filtered.then(|| add(1, true));
        let volume = add(1, masked);
        let r = add(4, relaxed);
        Fields {
            mass: 0,
            inverse: 1,
            lumped,
            velocity,
            velocity_star: 3,
            acceleration: 4,
            work: 5,
            remainder,
            scratch: 6,
            scratch2: 7,
            volume,
            relaxation: [r, r + 1, r + 2, r + 3],
            count,
        }
    }
}

/// A symmetric matrix M_ij = sum_p m_p N_ip N_jp over the nodes of a patch, one diagonal after
/// the other: diagonal d holds M_(i,i+d) at i.
#[derive(Clone, Debug, Default)]
pub struct Band {
    rows: Vec<f64>,
    diagonals: Vec<Vec<f64>>,
    width: usize,
}

impl Band {
    /// Sets to zero over `nodes` nodes for particles that touch `width` nodes.
    pub fn clear(&mut self, nodes: usize, width: usize) {
        self.width = width;
        self.rows.clear();
        self.rows.resize(nodes * width, 0.0);
    }

    /// Adds one particle of mass `mass` with weights `values` from node `first` on.
    #[inline(always)]
    pub fn add<const K: usize>(&mut self, first: usize, mass: f64, values: &[f64; K]) {
        let rows = &mut self.rows[first * K..(first + K) * K];
        for i in 0..K {
            let term = mass * values[i];
            for d in 0..K - i {
                rows[i * K + d] += term * values[i + d];
            }
        }
    }

    /// Must be called once all particles are in.
    pub fn finish(&mut self) {
        let (width, nodes) = (self.width, self.rows.len() / self.width);
        self.diagonals.resize_with(width, Vec::new);
        for (d, diagonal) in self.diagonals.iter_mut().enumerate() {
            diagonal.resize(nodes, 0.0);
            for (value, row) in diagonal.iter_mut().zip(self.rows.chunks_exact(width)) {
                *value = row[d];
            }
        }
    }

    /// y = M x on the nodes `range`, which must lie at least the band's width from the ends.
    pub fn product(&self, x: &[f64], range: std::ops::Range<usize>, y: &mut [f64]) {
        self.each_product(x, range, y, |product, _| product);
    }

    /// y = t + x - d M x on the nodes `range`: a sum of a series and its next by Horner's rule.
    pub fn next_sum(
        &self,
        x: &[f64],
        d: &[f64],
        t: &[f64],
        range: std::ops::Range<usize>,
        y: &mut [f64],
    ) {
        let (x_here, d, t) = (&x[range.clone()], &d[range.clone()], &t[range.clone()]);
        self.each_product(x, range, y, |product, i| t[i] + (x_here[i] - d[i] * product));
    }

    /// y = f((M x)_i, i) on the nodes of `range`, i counted from its start.
    #[inline(always)]
    fn each_product(
        &self,
        x: &[f64],
        range: std::ops::Range<usize>,
        y: &mut [f64],
        f: impl Fn(f64, usize) -> f64,
    ) {
        let (from, to) = (range.start, range.end);
        match self.width {
            3 => self.product_of::<3>(x, from, to, y, f),
            4 => self.product_of::<4>(x, from, to, y, f),
            _ => {
                for i in range {
                    let mut sum = self.diagonals[0][i] * x[i];
                    for d in 1..self.width {
                        sum += self.diagonals[d][i] * x[i + d];
                        sum += self.diagonals[d][i - d] * x[i - d];
                    }
                    y[i] = f(sum, i - from);
                }
            }
        }
    }

    /// The same sums in the same order, with the width known so that they run in vectors.
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

    #[test]
    fn the_band_is_the_matrix_of_products() {
        let mut band = Band::default();
        band.clear(12, 3);
        let particles =
            [(3, 2.0, [0.2, 0.5, 0.3]), (4, 1.5, [0.1, 0.6, 0.3]), (3, 0.7, [0.0, 0.4, 0.6])];
        let mut full = [[0.0; 12]; 12];
        for (first, mass, values) in &particles {
            band.add(*first, *mass, values);
            for i in 0..3 {
                for j in 0..3 {
                    full[first + i][first + j] += mass * values[i] * values[j];
                }
            }
        }
        band.finish();
        let x: Vec<f64> = (0..12).map(|i| (i * i) as f64).collect();
        let mut y = vec![0.0; 12];
        band.product(&x, 3..9, &mut y);
        for i in 3..9 {
            let exact: f64 = (0..12).map(|j| full[i][j] * x[j]).sum();
            assert!((y[i] - exact).abs() < 1e-12 * exact.abs().max(1.0));
        }
    }
}
