//! Hat functions at the particle centre (Sulsky, Chen & Schreyer 1994). The gradient jumps when a
//! particle crosses a cell boundary: unsuitable for shocks, kept as a reference.

use super::domain::DomainExtent;
use super::function::{Basis, CourantLimits, Shape, Weights};

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
}
