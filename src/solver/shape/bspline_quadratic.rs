//! Quadratic B-splines at the particle's centre (Steffen, Kirby & Berzins 2008). The splines
//! run on beyond a body's ends; at a wall they are mirrored, which is their right boundary form.

use super::{Extent, Shape, Weights, quadratic};

/// Quadratic B-splines.
#[derive(Clone, Copy, Debug)]
pub struct BsplineQuadratic;

impl Shape for BsplineQuadratic {
    const EXTENT: Extent = Extent::Point;

    fn nodes(_length: f64) -> usize {
        3
    }

    #[inline(always)]
    fn weights<const K: usize>(fraction: f64, _length: f64) -> Weights<K> {
        let (first, t, values) = quadratic(fraction);
        let mut w = Weights::none(first);
        w.values[..3].copy_from_slice(&values);
        w.gradients[..3].copy_from_slice(&[t - 1.0, 1.0 - 2.0 * t, t]);
        w
    }
}
