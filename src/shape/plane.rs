//! Weights in a plane, by a rule over the points of a parallelogram.

use wide::f64x4;

use super::domain::ParticleDomain;
use super::knots::{integer, moved};
use super::line_products::fours;
use super::widths::MOST_NODES_IN_PLANE;

/// Output arrays for the weights of one particle: `K` lines of `K` nodes.
#[derive(Debug)]
pub struct Plane<'a, const K: usize> {
    /// Values [-]; they sum to 1.
    pub values: &'a mut [[f64; K]],
    /// Gradients along x and y [1/cell]; they sum to 0.
    pub gradients: [&'a mut [[f64; K]]; 2],
}

/// One point of a quadrature rule over a parallelogram, at s1 r1 + s2 r2. In a rule of `P` points,
/// point p and point P - 1 - p are opposite and have the same weights.
#[derive(Clone, Copy, Debug)]
pub(super) struct RulePoint {
    /// Coordinates s1 and s2 [-].
    pub place: [f64; 2],
    /// Weight in the mean over the domain [-].
    pub value: f64,
    /// Weight in the mean over an edge [-], for the mean gradient by Gauss's theorem: the sum over
    /// the outline of value times outward normal, divided by the area.
    pub edge: f64,
}

impl RulePoint {
    /// A rule of these `points`.
    ///
    /// # Panics
    ///
    /// If points p and P - 1 - p are not opposite, or a point at the centre counts as on an edge.
    pub(super) const fn rule<const P: usize>(points: [RulePoint; P]) -> [RulePoint; P] {
        let mut p = 0;
        while p < P {
            let (one, other) = (&points[p], &points[P - 1 - p]);
            assert!(one.place[0] == -other.place[0] && one.place[1] == -other.place[1]);
            assert!(one.value == other.value && one.edge == other.edge);
            assert!(p != P - 1 - p || one.edge == 0.0);
            p += 1;
        }
        points
    }
}

/// Sums over the points of a rule of their `shares` in a value and two gradients, times the functions
/// `at` the points: opposite points have the same share in values, and opposite shares in gradients.
#[inline(always)]
pub(super) fn sum_opposite<const P: usize>(
    shares: &[[f64x4; 3]; P],
    at: impl Fn(usize) -> f64x4,
) -> [f64x4; 3] {
    let [mut value, mut gx, mut gy] = match P % 2 {
        0 => [f64x4::ZERO; 3],
        _ => [shares[P / 2][0] * at(P / 2), f64x4::ZERO, f64x4::ZERO],
    };
    for p in P.div_ceil(2)..P {
        let (one, other) = (at(p), at(P - 1 - p));
        let [share, x, y] = shares[p];
        let difference = one - other;
        value += share * (one + other);
        gx += x * difference;
        gy += y * difference;
    }
    [value, gx, gy]
}

/// Groups of four nodes in the widest line of a plane.
const MOST_FOURS: usize = MOST_NODES_IN_PLANE.div_ceil(4);

/// Weights by a quadrature rule, for a domain that is not a box: values are the means of the nodes'
/// functions over the domain, gradients the means of their gradients. `basis` gives the `N`
/// functions of one direction at four coordinates, with the first of their nodes.
#[inline(always)]
pub(super) fn by_rule<const P: usize, const N: usize, const K: usize>(
    fraction: [f64; 2],
    domain: &ParticleDomain,
    rule: &[RulePoint; P],
    basis: impl Fn(f64x4) -> (f64x4, [f64x4; N]),
    out: &mut Plane<'_, K>,
) -> [i32; 2] {
    let [r1, r2] = domain.half_edges;
    // outward normals of the edges at +r1 and +r2, times edge length over area
    let scale = 0.5 / (r1[0] * r2[1] - r1[1] * r2[0]);
    let (g1, g2) = ([r2[1] * scale, -r2[0] * scale], [-r1[1] * scale, r1[0] * scale]);
    // two points at a time: x, y, x, y
    let twice = |[x, y]: [f64; 2]| f64x4::new([x, y, x, y]);
    let (centre, along_r1, along_r2) = (twice(fraction), twice(r1), twice(r2));
    let mut bases = [(f64x4::ZERO, [f64x4::ZERO; N]); P];
    let mut least = f64x4::splat(f64::INFINITY);
    for pair in 0..const { P.div_ceil(2) } {
        let places = |c: usize| {
            let [a, b] = [2 * pair, (2 * pair + 1).min(P - 1)].map(|p| rule[p].place[c]);
            f64x4::new([a, a, b, b])
        };
        bases[pair] = basis(centre + places(0) * along_r1 + places(1) * along_r2);
        least = least.fast_min(bases[pair].0);
    }
    let [x, y, next_x, next_y] = least.to_array();
    let first = [x.min(next_x), y.min(next_y)];
    // whole lines of the window at once, with zeros around the N functions
    let lines: [[[f64; K]; 2]; P] = decomp::array::from_fn(|p| {
        let (nodes, functions) = &bases[p / 2];
        decomp::array::from_fn(|axis| {
            let lane = 2 * (p % 2) + axis;
            let by = integer(nodes.as_array()[lane] - first[axis]);
            moved(decomp::array::map(functions, |f| f.as_array()[lane]), by as usize)
        })
    });
    let shares: [[f64x4; 3]; P] = decomp::array::from_fn(|p| {
        let RulePoint { place: [s1, s2], value, edge } = rule[p];
        let gradient = |a: usize| edge * (s1 * g1[a] + s2 * g2[a]);
        decomp::array::map(&[value, gradient(0), gradient(1)], f64x4::splat)
    });
    let mut sums = [[[f64x4::ZERO; MOST_FOURS]; K]; 3];
    for l in 0..K {
        for four in 0..const { K.div_ceil(4) } {
            let at = |p: usize| fours(&lines[p][0], four) * f64x4::splat(lines[p][1][l]);
            for (sums, sum) in sums.iter_mut().zip(sum_opposite(&shares, at)) {
                sums[l][four] = sum;
            }
        }
    }
    let [gx, gy] = &mut out.gradients;
    for (out, sums) in [&mut *out.values, gx, gy].into_iter().zip(&sums) {
        for (out, sums) in out.iter_mut().zip(sums) {
            for k in 0..K {
                out[k] = sums[k / 4].as_array()[k % 4];
            }
        }
    }
    first.map(integer)
}

#[cfg(test)]
mod tests {
    use super::super::*;
    use super::*;

    const TILTED: ParticleDomain = ParticleDomain { half_edges: [[0.4, 0.1], [-0.15, 0.3]] };

    fn weights<S: Shape>(
        fraction: [f64; 2],
        domain: &ParticleDomain,
    ) -> ([i32; 2], [Vec<[f64; 6]>; 3]) {
        let mut all = [0; 3].map(|_| vec![[0.0; 6]; 6]);
        let [values, x, y] = &mut all;
        let first = S::plane::<6>(fraction, domain, &mut Plane { values, gradients: [x, y] });
        (first, all)
    }

    fn sum(lines: &[[f64; 6]], of: impl Fn(usize, usize) -> f64) -> f64 {
        (0..6).flat_map(|l| (0..6).map(move |k| (l, k))).map(|(l, k)| lines[l][k] * of(l, k)).sum()
    }

    fn check<S: Shape>(domain: &ParticleDomain) {
        for i in 0..20 {
            for j in 0..20 {
                let at = [i as f64 / 20.0, j as f64 / 20.0];
                let (first, [n, gx, gy]) = weights::<S>(at, domain);
                let x = |_: usize, k: usize| (first[0] + k as i32) as f64;
                let y = |l: usize, _: usize| (first[1] + l as i32) as f64;
                for (lines, of_one, of_x, of_y) in
                    [(&n, 1.0, at[0], at[1]), (&gx, 0.0, 1.0, 0.0), (&gy, 0.0, 0.0, 1.0)]
                {
                    assert!((sum(lines, |_, _| 1.0) - of_one).abs() < 1e-13);
                    assert!((sum(lines, x) - of_x).abs() < 1e-13, "{at:?}");
                    assert!((sum(lines, y) - of_y).abs() < 1e-13, "{at:?}");
                }
            }
        }
    }

    #[test]
    fn linear_fields_are_exact() {
        let square = ParticleDomain { half_edges: [[0.25, 0.0], [0.0, 0.25]] };
        let mirrored = ParticleDomain { half_edges: [[-0.25, 0.1], [0.0, 0.25]] };
        check::<Linear>(&square);
        check::<Gimp>(&square);
        check::<BsplineQuadratic>(&square);
        check::<BsplineCubic>(&square);
        for domain in [square, mirrored, TILTED] {
            check::<Cpdi>(&domain);
            check::<CpdiBsplineQuadratic>(&domain);
        }
    }

    /// The sum of the absolute gradients of quadratic splines is at most 2 along each direction;
    /// almost parallel edges give a sum of up to 13.
    #[test]
    fn gradients_of_flat_oblique_domains_are_bounded() {
        let flat = ParticleDomain { half_edges: [[0.59, 37.8], [-0.447, -28.6]] };
        for k in 0..40 {
            let at = [k as f64 / 40.0, (7 * k % 40) as f64 / 40.0];
            let (_, [_, gx, gy]) =
                weights::<CpdiBsplineQuadratic>(at, &flat.limited_as_rectangle(0.7));
            for lines in [gx, gy] {
                let sum: f64 = lines.as_flattened().iter().map(|g| g.abs()).sum();
                assert!(sum < 2.2, "{at:?}: {sum}");
            }
        }
    }

    #[test]
    fn a_box_has_the_product_of_its_lines() {
        let (length, height) = (0.7, 0.4);
        // almost a box, but handled by the rule
        let domain = ParticleDomain { half_edges: [[0.5 * length, 2e-12], [0.0, 0.5 * height]] };
        assert!(!domain.is_box());
        fn compare<S: Shape>(domain: &ParticleDomain, length: f64, height: f64) {
            let (first, [n, gx, gy]) = weights::<S>([0.3, 0.9], domain);
            let (x, y) = (S::weights::<6>(0.3, length), S::weights::<6>(0.9, height));
            assert_eq!(first, [x.first, y.first]);
            for l in 0..6 {
                for k in 0..6 {
                    assert!((n[l][k] - x.values[k] * y.values[l]).abs() < 1e-11);
                    assert!((gx[l][k] - x.gradients[k] * y.values[l]).abs() < 1e-11);
                    assert!((gy[l][k] - x.values[k] * y.gradients[l]).abs() < 1e-11);
                }
            }
        }
        compare::<Cpdi>(&domain, length, height);
        compare::<CpdiBsplineQuadratic>(&domain, length, height);
    }
}
