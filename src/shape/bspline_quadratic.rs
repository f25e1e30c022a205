//! Quadratic B-splines at the particle centre (Steffen, Kirby & Berzins 2008). The splines extend
//! beyond the ends of a body; at a wall they are mirrored, which is their correct boundary form.

use super::domain::DomainExtent;
use super::function::{Basis, CourantLimits, Shape, Weights};
use super::knots::quadratic;

/// Quadratic B-splines.
#[derive(Clone, Copy, Debug)]
pub struct BsplineQuadratic;

impl Shape for BsplineQuadratic {
    const EXTENT: DomainExtent = DomainExtent::Point;
    const BASIS: Basis = Basis::Quadratic;
    const COURANT: CourantLimits = CourantLimits {
        leapfrog: [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.8],
        midpoint: [1.0; 9],
    };

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
