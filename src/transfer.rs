//! Particles to grid and back: sums in canonical order, dot products in node order.
//!
//! A particle touches a window of K nodes along each of D directions, which is K^(D-1) lines of
//! K nodes that follow each other in a field.
//!
//! Knows no materials, no time stepping, no messages.

/// Lines of nodes in a window of `width` nodes along each of `dimension` directions.
pub const fn lines(width: usize, dimension: usize) -> usize {
    width.pow(dimension as u32 - 1)
}

/// The weights of one particle on its window of nodes.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a, const K: usize, const D: usize> {
    /// Its first node, in the patch's arrays.
    pub first: usize,
    /// From a line of the window to the next, in the patch's arrays.
    pub stride: usize,
    /// Values, a line after the other.
    pub values: &'a [[f64; K]],
    /// Gradients [1/m]: those along x, then those along y.
    pub gradients: &'a [[f64; K]],
}

impl<'a, const K: usize, const D: usize> Row<'a, K, D> {
    /// Lines of the window.
    pub const LINES: usize = lines(K, D);

    /// Gradients along `axis`, a line after the other.
    #[inline(always)]
    pub fn gradient(&self, axis: usize) -> &'a [[f64; K]] {
        &self.gradients[axis * Self::LINES..(axis + 1) * Self::LINES]
    }

    /// The nodes of a line of the window.
    #[inline(always)]
    pub fn line<'f>(&self, field: &'f [f64], line: usize) -> &'f [f64; K] {
        window(field, self.first + line * self.stride)
    }

    /// Adds `term` of each line of weights to the nodes of `field`.
    #[inline(always)]
    pub fn add(&self, field: &mut [f64], weights: &[[f64; K]], term: impl Fn(f64) -> f64) {
        for line in 0..Self::LINES {
            add(field, self.first + line * self.stride, weights[line].map(&term));
        }
    }

    /// Sum of weights times nodal values.
    #[inline(always)]
    pub fn dot(&self, weights: &[[f64; K]], field: &[f64]) -> f64 {
        self.sum(weights, |line| *self.line(field, line))
    }

    /// Sum of weights times what `of` gives for each line of nodes: over the lines for each place
    /// in them, then over the places from +0 on, so that weights of zero at the end change no bit.
    #[inline(always)]
    pub fn sum(&self, weights: &[[f64; K]], of: impl Fn(usize) -> [f64; K]) -> f64 {
        let mut sums = [0.0; K];
        for line in 0..Self::LINES {
            let values = of(line);
            for k in 0..K {
                sums[k] += weights[line][k] * values[k];
            }
        }
        sums.iter().fold(0.0, |sum, s| sum + s)
    }
}

/// Adds `terms` to `field` from node `first` on.
#[inline(always)]
pub fn add<const K: usize>(field: &mut [f64], first: usize, terms: [f64; K]) {
    let window: &mut [f64; K] =
        (&mut field[first..first + K]).try_into().expect("a window of K nodes");
    for k in 0..K {
        window[k] += terms[k];
    }
}

/// `value`, or zero if it is smaller than `least`.
#[inline(always)]
pub fn cut(value: f64, least: f64) -> f64 {
    if value.abs() < least { 0.0 } else { value }
}

/// The nodes of `field` from `first` on.
#[inline(always)]
pub fn window<const K: usize>(field: &[f64], first: usize) -> &[f64; K] {
    field[first..first + K].try_into().expect("a window of K nodes")
}

/// How the velocity goes back from the grid to the particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scheme {
    /// v_p' = a v_p + (1 - a) N vL + N (v' - vL): FLIP for a = 1 (Brackbill & Ruppel 1986), PIC
    /// for a = 0 (Harlow 1964).
    Blend(f64),
    /// v_p' = N v', with the affine part carried by the particle (Jiang et al. 2015).
    Affine,
    /// v_p' = N v' with v filtered by the series v = sum_(l<k) K^l vL, K = 1 - m^-1 M.
    Series {
        /// Number of terms k.
        order: u32,
        /// Whether the force goes through the series too: the full mass matrix, FMPM (Nairn &
        /// Hammerquist 2021); else XPIC (Hammerquist & Nairn 2017).
        force: bool,
    },
}

impl From<crate::scene::Transfer> for Scheme {
    fn from(transfer: crate::scene::Transfer) -> Self {
        use crate::scene::Transfer;
        match transfer {
            Transfer::Flip => Scheme::Blend(1.0),
            Transfer::Pic => Scheme::Blend(0.0),
            Transfer::FlipPic(a) => Scheme::Blend(a),
            Transfer::Apic => Scheme::Affine,
            Transfer::Xpic(order) => Scheme::Series { order, force: false },
            Transfer::Fmpm(order) => Scheme::Series { order, force: true },
        }
    }
}
