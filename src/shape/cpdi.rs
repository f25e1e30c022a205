//! Hat functions interpolated from the corners of the deforming particle (convected particle domain
//! interpolation: Sadeghirad, Brannon & Burghardt 2011). In one dimension the corners are the ends
//! of the particle, one deformed length apart.
//!
//! In a plane, values are the mean over the corners of the parallelogram. Gradients use the
//! trapezoidal rule along its edges, which is exact for the interpolated hat functions.

use wide::f64x4;

use super::domain::{DomainExtent, ParticleDomain};
use super::function::{Basis, CourantLimits, Shape, Weights, four_boxes, product};
use super::knots::{integer, moved, split, split4};
use super::lanes::{self, Lanes, PlaneLanes};
use super::plane::{Plane, RulePoint, by_rule};

/// Corners of the parallelogram.
const RULE: [RulePoint; 4] = {
    const fn corner(s1: f64, s2: f64) -> RulePoint {
        RulePoint { place: [s1, s2], value: 0.25, edge: 0.5 }
    }
    RulePoint::rule([corner(-1.0, -1.0), corner(1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0)])
};

/// Weights of a particle from the node below each of its ends and the distance from it.
#[inline(always)]
fn between<const K: usize>(
    (first, a): (f64, f64),
    (last, b): (f64, f64),
    length: f64,
) -> Weights<K> {
    let inverse = 1.0 / length;
    let mut w = Weights::none(integer(first));
    let from_lower: [f64; K] = moved([1.0 - a, a], 0);
    let from_upper: [f64; K] = moved([1.0 - b, b], integer(last - first) as usize);
    for k in 0..K {
        w.values[k] = 0.5 * (from_lower[k] + from_upper[k]);
        w.gradients[k] = (from_upper[k] - from_lower[k]) * inverse;
    }
    w
}

/// Hat functions at four places: the nodes below, and the values there and at the next nodes.
#[inline(always)]
fn hats(x: f64x4) -> (f64x4, [f64x4; 2]) {
    let (first, t) = split4(x);
    (first, [f64x4::ONE - t, t])
}

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
        let lower = split(fraction - 0.5 * length);
        let upper = split(fraction + 0.5 * length);
        between(lower, upper, length)
    }

    #[inline(always)]
    fn box_weights<const K: usize>(fraction: [f64; 2], extent: [f64; 2]) -> [Weights<K>; 2] {
        let ([x, y], [half_x, half_y]) = (fraction, extent.map(|length| 0.5 * length));
        let ends = split4(f64x4::new([x - half_x, x + half_x, y - half_y, y + half_y]));
        let end = |lane: usize| (ends.0.as_array()[lane], ends.1.as_array()[lane]);
        [between(end(0), end(1), extent[0]), between(end(2), end(3), extent[1])]
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
        by_rule(fraction, domain, &RULE, hats, out)
    }

    #[inline(always)]
    fn four<const K: usize>(fraction: f64x4, length: f64x4) -> Lanes<K> {
        let half = f64x4::HALF;
        let (first, lower) = hats(fraction - half * length);
        let (last, upper) = hats(fraction + half * length);
        let inverse = f64x4::ONE / length;
        let lower: [f64x4; K] = lanes::moved(&lower, f64x4::ZERO);
        let upper: [f64x4; K] = lanes::moved(&upper, last - first);
        let (mut values, mut gradients) = ([f64x4::ZERO; K], [f64x4::ZERO; K]);
        for k in 0..K {
            values[k] = half * (lower[k] + upper[k]);
            gradients[k] = (upper[k] - lower[k]) * inverse;
        }
        Lanes { first, skipped: f64x4::ZERO, values, gradients }
    }

    #[inline(always)]
    fn four_in_plane<const K: usize>(
        fraction: [f64x4; 2],
        half_edges: [[f64x4; 2]; 2],
        out: &mut PlaneLanes<K>,
    ) {
        let boxes = |out: &mut PlaneLanes<K>| four_boxes::<Self, K>(fraction, half_edges, out);
        lanes::boxes_or_rule(fraction, half_edges, &RULE, hats, boxes, out);
    }
}
