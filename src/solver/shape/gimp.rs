//! Hat functions averaged over the particle's undeformed length (Bardenhagen & Kober 2004, the
//! generalized interpolation material point method with particles of constant size).

use super::{Extent, Shape, Weights, integer, split};

/// Hat functions averaged over the undeformed particle.
#[derive(Clone, Copy, Debug)]
pub struct Gimp;

/// Integral of the hat function about 0 from minus infinity to `x`.
#[inline(always)]
fn integral(x: f64) -> f64 {
    let t = 1.0 - x.abs().min(1.0);
    let tail = 0.5 * t * t;
    if x < 0.0 { tail } else { 1.0 - tail }
}

/// The hat function about 0.
#[inline(always)]
fn hat(x: f64) -> f64 {
    (1.0 - x.abs()).max(0.0)
}

impl Shape for Gimp {
    const EXTENT: Extent = Extent::Undeformed;

    fn nodes(length: f64) -> usize {
        length.ceil() as usize + 2
    }

    #[inline(always)]
    fn weights<const K: usize>(fraction: f64, length: f64) -> Weights<K> {
        let (first, a) = split(fraction - 0.5 * length);
        let (last, b) = split(fraction + 0.5 * length);
        let (lower, upper) = (first + a, last + b);
        let mut w = Weights::none(integer(first));
        // of the length between them, so that the values sum to 1
        let inverse = 1.0 / (upper - lower);
        for k in 0..K {
            let node = (w.first + k as i32) as f64;
            w.values[k] = (integral(upper - node) - integral(lower - node)) * inverse;
            w.gradients[k] = (hat(upper - node) - hat(lower - node)) * inverse;
        }
        w
    }
}
