//! Cubic B-splines at the particle centre (Steffen, Kirby & Berzins 2008). The splines extend
//! beyond the ends of a body; at a wall they are mirrored, which is their correct boundary form.

use super::domain::DomainExtent;
use super::function::{Basis, CourantLimits, Shape, Weights};
use super::knots::{integer, split};

/// Cubic B-splines.
#[derive(Clone, Copy, Debug)]
pub struct BsplineCubic;

impl Shape for BsplineCubic {
    const EXTENT: DomainExtent = DomainExtent::Point;
    const BASIS: Basis = Basis::Cubic;
    const COURANT: CourantLimits = CourantLimits { leapfrog: [1.0; 9], midpoint: [1.0; 9] };

    fn nodes(_length: f64) -> usize {
        4
    }

    #[inline(always)]
    fn weights<const K: usize>(fraction: f64, _length: f64) -> Weights<K> {
        let (cell, t) = split(fraction);
        let r = 1.0 - t;
        let sixth = 1.0 / 6.0;
        let mut w = Weights::none(integer(cell) - 1);
        w.values[0] = r * r * r * sixth;
        w.values[1] = (3.0 * t * t * t - 6.0 * t * t + 4.0) * sixth;
        w.values[2] = (3.0 * r * r * r - 6.0 * r * r + 4.0) * sixth;
        w.values[3] = t * t * t * sixth;
        w.gradients[0] = -0.5 * r * r;
        w.gradients[1] = 1.5 * t * t - 2.0 * t;
        w.gradients[2] = -1.5 * r * r + 2.0 * r;
        w.gradients[3] = 0.5 * t * t;
        w
    }
}
