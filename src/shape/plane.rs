//! Weights in a plane, by a rule over the points of a parallelogram.

use super::domain::ParticleDomain;
use super::line_products::add_product;

/// Output arrays for the weights of one particle: `K` lines of `K` nodes.
#[derive(Debug)]
pub struct Plane<'a, const K: usize> {
    /// Values; they sum to 1.
    pub values: &'a mut [[f64; K]],
    /// Gradients along x and y [1/cell]; they sum to 0.
    pub gradients: [&'a mut [[f64; K]]; 2],
}

/// One point of a quadrature rule over a parallelogram, at s1 r1 + s2 r2.
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

/// Weights by a quadrature rule, for a domain that is not a box: values are the means of the nodes'
/// functions over the domain, gradients the means of their gradients. `basis` gives the `N`
/// functions of one direction at a coordinate, with the first of their nodes.
#[inline(always)]
pub(super) fn by_rule<const P: usize, const N: usize, const K: usize>(
    fraction: [f64; 2],
    domain: &ParticleDomain,
    rule: &[RulePoint; P],
    basis: impl Fn(f64) -> (i32, [f64; N]),
    out: &mut Plane<'_, K>,
) -> [i32; 2] {
    let [r1, r2] = domain.half_edges;
    // outward normals of the edges at +r1 and +r2, times edge length over area
    let scale = 0.5 / (r1[0] * r2[1] - r1[1] * r2[0]);
    let (g1, g2) = ([r2[1] * scale, -r2[0] * scale], [-r1[1] * scale, r1[0] * scale]);
    let bases: [[(i32, [f64; N]); 2]; P] = decomp::array::from_fn(|p| {
        let [s1, s2] = rule[p].place;
        decomp::array::from_fn(|a| basis(fraction[a] + s1 * r1[a] + s2 * r2[a]))
    });
    let mut first = [i32::MAX; 2];
    for point in &bases {
        first = [first[0].min(point[0].0), first[1].min(point[1].0)];
    }
    // whole lines of the window at once, with zeros around the N functions: the vector registers
    // are as long as a line
    let [mut values, mut gx, mut gy] = [[[0.0; K]; K]; 3];
    for (point, [x, y]) in rule.iter().zip(&bases) {
        let [s1, s2] = point.place;
        let gradient: [f64; 2] = decomp::array::from_fn(|a| point.edge * (s1 * g1[a] + s2 * g2[a]));
        let (from_x, from_y) = ((x.0 - first[0]) as usize, (y.0 - first[1]) as usize);
        let mut across = [0.0; K];
        across[from_x..from_x + N].copy_from_slice(&x.1);
        for l in 0..N {
            let y = y.1[l];
            let lines = [&mut values, &mut gx, &mut gy];
            for (lines, share) in lines.into_iter().zip([point.value, gradient[0], gradient[1]]) {
                let (line, share) = (&mut lines[from_y + l], share * y);
                add_product(line, 0, share, &across);
            }
        }
    }
    out.values[..K].copy_from_slice(&values);
    for (out, lines) in out.gradients.iter_mut().zip([gx, gy]) {
        out[..K].copy_from_slice(&lines);
    }
    first
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
