//! Weights of four particles at a time, one in each lane of a vector, bit by bit those of one
//! particle.

use decomp::array::{from_fn, map};
use wide::f64x4;

use super::knots::ON_KNOT;
use super::plane::{RulePoint, sum_opposite};

/// Particles computed together.
pub const LANES: usize = 4;

/// Weights of four particles on lines of `K` nodes.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<const K: usize> {
    /// First nodes, relative to the lower nodes of the particles' cells.
    pub first: f64x4,
    /// All bits where the first node has no weight, and the next one has.
    pub skipped: f64x4,
    /// Values of the nodes' functions; they sum to 1.
    pub values: [f64x4; K],
    /// Gradients of the nodes' functions [1/cell]; they sum to 0.
    pub gradients: [f64x4; K],
}

/// Weights of four particles on `K` lines of `K` nodes.
#[derive(Clone, Copy, Debug)]
pub struct PlaneLanes<const K: usize> {
    /// First nodes along x and y, relative to the lower nodes of the particles' cells.
    pub first: [f64x4; 2],
    /// All bits where the first nodes have no weight, and the next ones have.
    pub skipped: [f64x4; 2],
    /// Values; they sum to 1.
    pub values: [[f64x4; K]; K],
    /// Gradients along x and y [1/cell]; they sum to 0.
    pub gradients: [[[f64x4; K]; K]; 2],
}

impl<const K: usize> PlaneLanes<K> {
    /// No weights.
    pub fn none() -> Self {
        let none = [[f64x4::ZERO; K]; K];
        PlaneLanes {
            first: [f64x4::ZERO; 2],
            skipped: [f64x4::ZERO; 2],
            values: none,
            gradients: [none; 2],
        }
    }

    /// Takes the weights of particles that are not `kept` from `others`.
    #[cold]
    fn choose(&mut self, kept: f64x4, others: &Self) {
        for a in 0..2 {
            self.first[a] = kept.select(self.first[a], others.first[a]);
            self.skipped[a] = kept.select(self.skipped[a], others.skipped[a]);
        }
        for l in 0..K {
            for k in 0..K {
                self.values[l][k] = kept.select(self.values[l][k], others.values[l][k]);
                for (mine, others) in self.gradients.iter_mut().zip(&others.gradients) {
                    mine[l][k] = kept.select(mine[l][k], others[l][k]);
                }
            }
        }
    }
}

/// The functions of nodes from `by` nodes after the first of a line of `K` nodes on, zero
/// elsewhere.
#[inline(always)]
pub(super) fn moved<const N: usize, const K: usize>(f: &[f64x4; N], by: f64x4) -> [f64x4; K] {
    let at = |k: usize, by: usize| match k.checked_sub(by) {
        Some(k) if k < N => f[k],
        _ => f64x4::ZERO,
    };
    from_fn(|k| {
        // a particle that is torn apart passes the end of its line
        let mut value = at(k, K - N);
        for shift in (0..K - N).rev() {
            let chosen = by.simd_eq(f64x4::splat(shift as f64));
            value = chosen.select(at(k, shift), value);
        }
        value
    })
}

/// First node of windows of `K` nodes for functions of `N` nodes from `least` to `most` on, and whether
/// it has no weight: the node below that of the cell if the window holds all, so that the particles
/// of a cell have one window, else `least`. Hat functions of a cell mostly have one anyway.
#[inline(always)]
pub(super) fn common_first<const N: usize, const K: usize>(
    least: f64x4,
    most: f64x4,
) -> (f64x4, f64x4) {
    if K != N + 1 || N < 3 {
        return (least, f64x4::ZERO);
    }
    let (first, end) = (f64x4::splat(-1.0), f64x4::splat(K as f64 - 1.0));
    let is_held = least.simd_ge(first) & (most + f64x4::splat(N as f64)).simd_le(end);
    let first = is_held.select(first, least);
    (first, least.simd_ne(first))
}

/// Weights of `boxes` where domains are boxes, and by a quadrature rule elsewhere.
#[inline(always)]
pub(super) fn boxes_or_rule<const P: usize, const N: usize, const K: usize>(
    fraction: [f64x4; 2],
    half_edges: [[f64x4; 2]; 2],
    rule: &[RulePoint; P],
    basis: impl Fn(f64x4) -> (f64x4, [f64x4; N]),
    boxes: impl Fn(&mut PlaneLanes<K>),
    out: &mut PlaneLanes<K>,
) {
    let [r1, r2] = half_edges;
    let on_knot = f64x4::splat(ON_KNOT);
    let is_box = r1[1].abs().simd_lt(on_knot) & r2[0].abs().simd_lt(on_knot);
    if is_box.all() {
        return boxes(out);
    }
    by_rule(fraction, half_edges, rule, basis, out);
    if is_box.any() {
        let ruled = *out;
        boxes(out);
        out.choose(is_box, &ruled);
    }
}

/// Weights by a quadrature rule, see `plane::by_rule`.
#[inline(never)]
fn by_rule<const P: usize, const N: usize, const K: usize>(
    fraction: [f64x4; 2],
    [r1, r2]: [[f64x4; 2]; 2],
    rule: &[RulePoint; P],
    basis: impl Fn(f64x4) -> (f64x4, [f64x4; N]),
    out: &mut PlaneLanes<K>,
) {
    let scale = f64x4::HALF / (r1[0] * r2[1] - r1[1] * r2[0]);
    let (g1, g2) = ([r2[1] * scale, -r2[0] * scale], [-r1[1] * scale, r1[0] * scale]);
    // no array is cleared before it is filled: that takes as long as the sums
    let axis = |a: usize| -> ((f64x4, f64x4), [[f64x4; K]; P]) {
        let bases: [(f64x4, [f64x4; N]); P] = from_fn(|p| {
            let [s1, s2] = map(&rule[p].place, f64x4::splat);
            basis(fraction[a] + s1 * r1[a] + s2 * r2[a])
        });
        let (mut least, mut most) = (bases[0].0, bases[0].0);
        for (node, _) in &bases[1..] {
            least = least.fast_min(*node);
            most = most.fast_max(*node);
        }
        let (first, skipped) = common_first::<N, K>(least, most);
        ((first, skipped), from_fn(|p| moved(&bases[p].1, bases[p].0 - first)))
    };
    // functions along x and y on the nodes of the window at each point
    let ((x, across), (y, along)) = (axis(0), axis(1));
    // shares of the points in values and gradients
    let shares: [[f64x4; 3]; P] = from_fn(|p| {
        let ([s1, s2], edge) = (map(&rule[p].place, f64x4::splat), f64x4::splat(rule[p].edge));
        let gradient = |a: usize| edge * (s1 * g1[a] + s2 * g2[a]);
        [f64x4::splat(rule[p].value), gradient(0), gradient(1)]
    });
    for l in 0..K {
        for k in 0..K {
            let at = |p: usize| across[p][k] * along[p][l];
            let [value, gx, gy] = sum_opposite(&shares, at);
            out.values[l][k] = value;
            out.gradients[0][l][k] = gx;
            out.gradients[1][l][k] = gy;
        }
    }
    (out.first, out.skipped) = ([x.0, y.0], [x.1, y.1]);
}

#[cfg(test)]
mod tests {
    use super::super::*;
    use super::*;

    /// Weights of each of four particles by lane equal those of one particle on the same nodes, bit
    /// by bit.
    fn check<S: Shape, const K: usize>(places: [[f64; 2]; 4], domains: [ParticleDomain; 4]) {
        let lanes = |of: &dyn Fn(usize) -> f64| f64x4::from([0, 1, 2, 3].map(of));
        let fraction = [0, 1].map(|a| lanes(&|lane| places[lane][a]));
        let half_edges =
            [0, 1].map(|e| [0, 1].map(|a| lanes(&|lane| domains[lane].half_edges[e][a])));
        let mut four = PlaneLanes::<K>::none();
        S::four_in_plane::<K>(fraction, half_edges, &mut four);
        for lane in 0..4 {
            let [mut n, mut gx, mut gy] = [[[0.0; K]; K]; 3];
            let mut out = Plane { values: &mut n, gradients: [&mut gx, &mut gy] };
            let first = S::plane::<K>(places[lane], &domains[lane], &mut out);
            let of = |v: f64x4| v.to_array()[lane];
            let skipped = four.skipped.map(|s| (s.to_bitmask() >> lane & 1) as usize);
            let start = four.first.map(|first| of(first) as i32);
            assert_eq!([0, 1].map(|a| start[a] + skipped[a] as i32), first, "{places:?}");
            for (one, by_lane) in
                [(&n, &four.values), (&gx, &four.gradients[0]), (&gy, &four.gradients[1])]
            {
                for (l, k) in (0..K).flat_map(|l| (0..K).map(move |k| (l, k))) {
                    let before = [l.checked_sub(skipped[1]), k.checked_sub(skipped[0])];
                    let expected = match before {
                        [Some(l), Some(k)] => one[l][k],
                        _ => 0.0,
                    };
                    // zeros of either sign are one weight
                    assert_eq!(of(by_lane[l][k]) + 0.0, expected + 0.0, "lane {lane}: {l}, {k}");
                }
            }
        }
    }

    fn check_all<S: Shape, const K: usize>() {
        let domain = |ax: f64, ay: f64, bx: f64, by: f64| ParticleDomain {
            half_edges: [[ax, ay], [bx, by]],
        };
        let boxes = [0.25, 0.2, 0.3, 0.25].map(|h| domain(h, 0.0, 0.0, 0.25));
        let sheared = [0.05, -0.1, 0.02, 0.2].map(|s| domain(0.25, s, -s, 0.25));
        let mixed = [boxes[0], sheared[1], sheared[2], boxes[3]];
        for k in 0..40 {
            let at = k as f64 / 40.0;
            let places = [[at, 0.25], [0.75, at], [1.0 - at - 0.01, at], [at, 0.6]];
            for domains in [boxes, sheared, mixed] {
                check::<S, K>(places, domains);
            }
        }
    }

    #[test]
    fn four_particles_have_the_weights_of_one() {
        check_all::<Linear, 2>();
        check_all::<Cpdi, 3>();
        check_all::<Cpdi, 4>();
        check_all::<CpdiBsplineQuadratic, 4>();
    }

    /// Weights of four particles on a line equal those of one, bit by bit, counted from the first node
    /// with a weight.
    #[test]
    fn four_particles_on_a_line_have_the_weights_of_one() {
        for k in 0..40 {
            let at = k as f64 / 40.0;
            let (places, lengths) = ([at, 0.25, 1.0 - at, 0.75], [0.5, 0.47, 0.9, 1.0]);
            let four = CpdiBsplineQuadratic::four::<4>(f64x4::from(places), f64x4::from(lengths));
            for lane in 0..4 {
                let one = CpdiBsplineQuadratic::weights::<4>(places[lane], lengths[lane]);
                let skipped = (four.skipped.to_bitmask() >> lane & 1) as usize;
                let first = four.first.to_array()[lane] as i32;
                assert_eq!(first + skipped as i32, one.first, "{places:?}, {lane}");
                for (lines, expected) in
                    [(&four.values, &one.values), (&four.gradients, &one.gradients)]
                {
                    for node in 0..4_usize {
                        let value = node.checked_sub(skipped).map_or(0.0, |at| expected[at]);
                        assert_eq!(lines[node].to_array()[lane], value, "{places:?}, {lane}");
                    }
                }
            }
        }
    }

    /// Both particles of a cell along a direction take the window from the node below the cell on.
    #[test]
    fn particles_of_a_cell_have_one_window() {
        let of = |at: f64| CpdiBsplineQuadratic::four::<4>(f64x4::splat(at), f64x4::splat(0.5));
        for (at, skipped) in [(0.25, false), (0.8, true), (0.75, true)] {
            let lanes = of(at);
            assert_eq!(lanes.first.to_array(), [-1.0; 4], "{at}");
            assert_eq!(lanes.skipped.any(), skipped, "{at}");
            assert_eq!(lanes.values[0].to_array()[0] == 0.0, skipped, "{at}");
        }
        // nodes 0 to 3: too far to the right
        let lanes = CpdiBsplineQuadratic::four::<4>(f64x4::splat(0.99), f64x4::splat(1.0));
        assert_eq!((lanes.first.to_array(), lanes.skipped.any()), ([-1.0; 4], false));
        let lanes = CpdiBsplineQuadratic::four::<4>(f64x4::splat(1.01), f64x4::splat(1.0));
        assert_eq!((lanes.first.to_array(), lanes.skipped.any()), ([0.0; 4], false));
    }
}
