//! Quadratic B-splines averaged over the deforming particle: the CPDI method with smoother
//! functions.
//!
//! Values use Simpson's rule over the length of the particle, (phi(lower) + 4 phi(centre) +
//! phi(upper))/6, which keeps linear fields exact. Gradients are the exact mean, (phi(upper) -
//! phi(lower))/length. The same rule is used for parallelograms in two dimensions.

use super::domain::{DomainExtent, ParticleDomain};
use super::function::{Basis, CourantLimits, Shape, Weights, product};
use super::knots::quadratic;
use super::plane::{Plane, RulePoint, by_rule};

/// Simpson's rule over a parallelogram and along its edges.
const RULE: [RulePoint; 9] = {
    const fn corner(s1: f64, s2: f64) -> RulePoint {
        RulePoint { place: [s1, s2], value: 1.0 / 36.0, edge: 1.0 / 6.0 }
    }
    const fn middle(s1: f64, s2: f64) -> RulePoint {
        RulePoint { place: [s1, s2], value: 4.0 / 36.0, edge: 4.0 / 6.0 }
    }
    [
        corner(-1.0, -1.0),
        middle(0.0, -1.0),
        corner(1.0, -1.0),
        middle(-1.0, 0.0),
        RulePoint { place: [0.0, 0.0], value: 16.0 / 36.0, edge: 0.0 },
        middle(1.0, 0.0),
        corner(-1.0, 1.0),
        middle(0.0, 1.0),
        corner(1.0, 1.0),
    ]
};

/// Quadratic B-splines averaged over the deforming particle.
#[derive(Clone, Copy, Debug)]
pub struct CpdiBsplineQuadratic;

impl Shape for CpdiBsplineQuadratic {
    const EXTENT: DomainExtent = DomainExtent::Current;
    const BASIS: Basis = Basis::Quadratic;
    const COURANT: CourantLimits = CourantLimits { leapfrog: [1.0; 9], midpoint: [1.0; 9] };

    fn nodes(length: f64) -> usize {
        length.ceil() as usize + 3
    }

    #[inline(always)]
    fn weights<const K: usize>(fraction: f64, length: f64) -> Weights<K> {
        let half = 0.5 * length;
        let (first, _, lower) = quadratic(fraction - half);
        let (middle, _, centre) = quadratic(fraction);
        let (last, _, upper) = quadratic(fraction + half);
        let (c, u) = ((middle - first) as usize, (last - first) as usize);
        let (sixth, inverse) = (1.0 / 6.0, 1.0 / length);
        let mut w = Weights::none(first);
        // each on the whole window: a choice by position would cost mispredicted branches
        let [mut at_lower, mut at_centre, mut at_upper] = [[0.0; K]; 3];
        at_lower[..3].copy_from_slice(&lower);
        at_centre[c..c + 3].copy_from_slice(&centre);
        at_upper[u..u + 3].copy_from_slice(&upper);
        for k in 0..K {
            w.values[k] = (at_lower[k] + 4.0 * at_centre[k] + at_upper[k]) * sixth;
            w.gradients[k] = (at_upper[k] - at_lower[k]) * inverse;
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
        let splines = |x: f64| {
            let (first, _, values) = quadratic(x);
            (first, values)
        };
        by_rule(fraction, domain, &RULE, splines, out)
    }
}
