//! Particles to grid and back: sums in canonical order, dot products in node order.
//!
//! Knows no materials, no time stepping, no messages.

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

/// Sum of weights times nodal values, in node order from +0, so that weights of zero at the end
/// change no bit.
#[inline(always)]
pub fn dot<const K: usize>(weights: &[f64; K], values: &[f64; K]) -> f64 {
    let mut sum = 0.0;
    for k in 0..K {
        sum += weights[k] * values[k];
    }
    sum
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
