//! Hat functions averaged over the undeformed length of the particle (Bardenhagen & Kober 2004, the
//! generalized interpolation material point method with particles of constant size).

use super::domain::DomainExtent;
use super::function::{Basis, CourantLimits, Shape, Weights};
use super::knots::{integer, split};

/// Hat functions averaged over the undeformed particle.
#[derive(Clone, Copy, Debug)]
pub struct Gimp;

/// Integral of the hat function centred at 0 from minus infinity to `x`.
#[inline(always)]
fn integral(x: f64) -> f64 {
    let t = 1.0 - x.abs().min(1.0);
    let tail = 0.5 * t * t;
    if x < 0.0 { tail } else { 1.0 - tail }
}

/// The hat function centred at 0.
#[inline(always)]
fn hat(x: f64) -> f64 {
    (1.0 - x.abs()).max(0.0)
}

impl Shape for Gimp {
    const EXTENT: DomainExtent = DomainExtent::Undeformed;
    const BASIS: Basis = Basis::Hat;
    const COURANT: CourantLimits = CourantLimits {
        leapfrog: [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.8, 0.6, 0.5],
        midpoint: [1.0, 1.0, 1.0, 1.0, 1.0, 0.9, 0.8, 0.8, 0.8],
    };

    fn nodes(length: f64) -> usize {
        length.ceil() as usize + 2
    }

    #[inline(always)]
    fn weights<const K: usize>(fraction: f64, length: f64) -> Weights<K> {
        let (first, a) = split(fraction - 0.5 * length);
        let (last, b) = split(fraction + 0.5 * length);
        let (lower, upper) = (first + a, last + b);
        let mut w = Weights::none(integer(first));
        // divided by the distance of these ends, so that the values sum to 1
        let inverse = 1.0 / (upper - lower);
        for k in 0..K {
            let node = (w.first + k as i32) as f64;
            w.values[k] = (integral(upper - node) - integral(lower - node)) * inverse;
            w.gradients[k] = (hat(upper - node) - hat(lower - node)) * inverse;
        }
        w
    }
}
