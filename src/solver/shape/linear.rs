//! Hat functions at the particle's centre (Sulsky, Chen & Schreyer 1994). The gradient jumps
//! when a particle crosses a cell's side: useless for shocks, kept as the reference.

use super::{Extent, Shape, Weights};

/// Hat functions.
#[derive(Clone, Copy, Debug)]
pub struct Linear;

impl Shape for Linear {
    const EXTENT: Extent = Extent::Point;

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
