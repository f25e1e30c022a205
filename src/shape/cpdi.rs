//! Hat functions interpolated from the corners of the deforming particle (convected particle domain
//! interpolation: Sadeghirad, Brannon & Burghardt 2011). In one dimension the corners are the ends
//! of the particle, one deformed length apart.
//!
//! In a plane, values are the mean over the corners of the parallelogram. Gradients use the
//! trapezoidal rule along its edges, which is exact for the interpolated hat functions.

use super::domain::{DomainExtent, ParticleDomain};
use super::function::{Basis, CourantLimits, Shape, Weights, product};
use super::knots::{integer, split};
use super::plane::{Plane, RulePoint, by_rule};

/// Corners of the parallelogram.
const RULE: [RulePoint; 4] = {
    const fn corner(s1: f64, s2: f64) -> RulePoint {
        RulePoint { place: [s1, s2], value: 0.25, edge: 0.5 }
    }
    [corner(-1.0, -1.0), corner(1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0)]
};

/// Hat functions from the ends of the deforming particle.
#[derive(Clone, Copy, Debug)]
pub struct Cpdi;

impl Shape for Cpdi {
    const EXTENT: DomainExtent = DomainExtent::Current;
    const BASIS: Basis = Basis::Hat;
    const COURANT: CourantLimits = CourantLimits {
        leapfrog: [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.8, 0.7, 0.7],
        midpoint: [1.0, 1.0, 1.0, 1.0, 1.0, 0.9, 0.9, 0.7, 0.7],
    };

    fn nodes(length: f64) -> usize {
        length.ceil() as usize + 2
    }

    #[inline(always)]
    fn weights<const K: usize>(fraction: f64, length: f64) -> Weights<K> {
        let (first, a) = split(fraction - 0.5 * length);
        let (last, b) = split(fraction + 0.5 * length);
        let inverse = 1.0 / length;
        let mut w = Weights::none(integer(first));
        // nodes of the upper end, relative to the first node of the lower end
        let apart = last - first;
        for k in 0..K {
            let at = k as f64;
            let from_lower = if k == 0 {
                1.0 - a
            } else if k == 1 {
                a
            } else {
                0.0
            };
            let from_upper = if at == apart {
                1.0 - b
            } else if at == apart + 1.0 {
                b
            } else {
                0.0
            };
            w.values[k] = 0.5 * (from_lower + from_upper);
            w.gradients[k] = (from_upper - from_lower) * inverse;
        }
        w
    }

    #[inline(always)]
    fn plane<const K: usize>(
        fraction: [f64; 2],
        domain: &ParticleDomain,
        out: &mut Plane<'_, K>,
    ) -> [i32; 2] {
        if domain.is_box() {
            return product::<Self, K>(fraction, domain, out);
        }
        let hats = |x: f64| {
            let (first, t) = split(x);
            (integer(first), [1.0 - t, t])
        };
        by_rule(fraction, domain, &RULE, hats, out)
    }
}
