//! Quadratic B-splines averaged over the deforming particle: the CPDI method with smoother
//! functions.
//!
//! Values use Simpson's rule over the length of the particle, (phi(lower) + 4 phi(centre) +
//! phi(upper))/6, which keeps linear fields exact. Gradients are the exact mean, (phi(upper) -
//! phi(lower))/length. The same rule is used for parallelograms in two dimensions.

use decomp::array::map;
use wide::f64x4;

use super::domain::{DomainExtent, ParticleDomain};
use super::function::{Basis, CourantLimits, Shape, Weights, four_boxes, product};
use super::knots::{integer, moved, quadratic4};
use super::lanes::{self, Lanes, PlaneLanes};
use super::plane::{Plane, RulePoint, by_rule};

/// Simpson's rule over a parallelogram and along its edges.
const RULE: [RulePoint; 9] = {
    const fn corner(s1: f64, s2: f64) -> RulePoint {
        RulePoint { place: [s1, s2], value: 1.0 / 36.0, edge: 1.0 / 6.0 }
    }
    const fn middle(s1: f64, s2: f64) -> RulePoint {
        RulePoint { place: [s1, s2], value: 4.0 / 36.0, edge: 4.0 / 6.0 }
    }
    RulePoint::rule([
        corner(-1.0, -1.0),
        middle(0.0, -1.0),
        corner(1.0, -1.0),
        middle(-1.0, 0.0),
        RulePoint { place: [0.0, 0.0], value: 16.0 / 36.0, edge: 0.0 },
        middle(1.0, 0.0),
        corner(-1.0, 1.0),
        middle(0.0, 1.0),
        corner(1.0, 1.0),
    ])
};

/// Splines at four places, see [`quadratic4`].
type Splines = (f64x4, [f64x4; 3]);

/// Weights from the splines at the lower end, the centre and the upper end of a particle.
#[inline(always)]
fn averaged<const K: usize>(at: [(&Splines, usize); 3], length: f64) -> Weights<K> {
    let nodes = map(&at, |(splines, lane)| splines.0.as_array()[lane]);
    let lines = map(&[0, 1, 2], |place: usize| {
        let (splines, lane) = at[place];
        let by = integer(nodes[place] - nodes[0]) as usize;
        moved::<3, K>(map(&splines.1, |f| f.as_array()[lane]), by)
    });
    let [lower, centre, upper] = lines;
    let (sixth, inverse) = (1.0 / 6.0, 1.0 / length);
    let mut w = Weights::none(integer(nodes[0]));
    for k in 0..K {
        w.values[k] = (lower[k] + 4.0 * centre[k] + upper[k]) * sixth;
        w.gradients[k] = (upper[k] - lower[k]) * inverse;
    }
    w
}

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
        let at = quadratic4(f64x4::new([fraction - half, fraction, fraction + half, fraction]));
        averaged([(&at, 0), (&at, 1), (&at, 2)], length)
    }

    #[inline(always)]
    fn box_weights<const K: usize>(fraction: [f64; 2], extent: [f64; 2]) -> [Weights<K>; 2] {
        let ([x, y], [half_x, half_y]) = (fraction, extent.map(|length| 0.5 * length));
        let ends = quadratic4(f64x4::new([x - half_x, x + half_x, y - half_y, y + half_y]));
        let middles = quadratic4(f64x4::new([x, y, x, y]));
        [
            averaged([(&ends, 0), (&middles, 0), (&ends, 1)], extent[0]),
            averaged([(&ends, 2), (&middles, 1), (&ends, 3)], extent[1]),
        ]
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
        by_rule(fraction, domain, &RULE, quadratic4, out)
    }

    #[inline(always)]
    fn four<const K: usize>(fraction: f64x4, length: f64x4) -> Lanes<K> {
        let half = f64x4::HALF * length;
        let (least, lower) = quadratic4(fraction - half);
        let (middle, centre) = quadratic4(fraction);
        let (last, upper) = quadratic4(fraction + half);
        let (sixth, inverse) = (f64x4::splat(1.0 / 6.0), f64x4::ONE / length);
        let (first, skipped) = lanes::common_first::<3, K>(least, last);
        let lower: [f64x4; K] = lanes::moved(&lower, least - first);
        let centre: [f64x4; K] = lanes::moved(&centre, middle - first);
        let upper: [f64x4; K] = lanes::moved(&upper, last - first);
        let (mut values, mut gradients) = ([f64x4::ZERO; K], [f64x4::ZERO; K]);
        for k in 0..K {
            values[k] = (lower[k] + f64x4::splat(4.0) * centre[k] + upper[k]) * sixth;
            gradients[k] = (upper[k] - lower[k]) * inverse;
        }
        Lanes { first, skipped, values, gradients }
    }

    #[inline(always)]
    fn four_in_plane<const K: usize>(
        fraction: [f64x4; 2],
        half_edges: [[f64x4; 2]; 2],
        out: &mut PlaneLanes<K>,
    ) {
        let boxes = |out: &mut PlaneLanes<K>| four_boxes::<Self, K>(fraction, half_edges, out);
        lanes::boxes_or_rule(fraction, half_edges, &RULE, quadratic4, boxes, out);
    }
}
