//! Hat functions at the particle centre (Sulsky, Chen & Schreyer 1994). The gradient jumps when a
//! particle crosses a cell boundary: unsuitable for shocks, kept as a reference.

use wide::f64x4;

use super::domain::DomainExtent;
use super::function::{Basis, CourantLimits, Shape, Weights};
use super::lanes::Lanes;

/// Hat functions.
#[derive(Clone, Copy, Debug)]
pub struct Linear;

impl Shape for Linear {
    const EXTENT: DomainExtent = DomainExtent::Point;
    const BASIS: Basis = Basis::Hat;
    const COURANT: CourantLimits = CourantLimits {
        leapfrog: [1.0, 1.0, 0.3, 1.0, 1.0, 0.8, 0.4, 0.3, 0.2],
        midpoint: [0.8, 1.0, 1.0, 1.0, 0.9, 0.9, 0.7, 0.7, 0.7],
    };

    fn nodes(_length: f64) -> usize {
        2
    }

    #[inline(always)]
    fn weights<const K: usize>(fraction: f64, _length: f64) -> Weights<K> {
        let mut w = Weights::none(0);
        w.values[0] = 1.0 - fraction;
        w.values[1] = fraction;
        w.gradients[0] = -1.0;
        w.gradients[1] = 1.0;
        w
    }

    #[inline(always)]
    fn four<const K: usize>(fraction: f64x4, _length: f64x4) -> Lanes<K> {
        let (mut values, mut gradients) = ([f64x4::ZERO; K], [f64x4::ZERO; K]);
        values[0] = f64x4::ONE - fraction;
        values[1] = fraction;
        gradients[0] = f64x4::splat(-1.0);
        gradients[1] = f64x4::ONE;
        Lanes { first: f64x4::ZERO, skipped: f64x4::ZERO, values, gradients }
    }
}
