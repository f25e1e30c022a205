//! Particles' domains in a plane, and weights by a rule over the points of a parallelogram.

use super::{Extent, ON_KNOT, Shape, Weights};
use crate::solver::transfer::add_product;

/// The parallelogram of a particle: its half edges r1 and r2 [cells], so that its corners lie at
/// +-r1 +-r2 from its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    /// The half edges.
    pub half_edges: [[f64; 2]; 2],
}

impl Domain {
    /// The domain of `row` from the columns of `extent`: see [`Extent::plane_columns`].
    #[inline(always)]
    pub fn from_columns(extent: Extent, columns: &[&[f64]; 4], row: usize) -> Self {
        let half_edges = match extent {
            Extent::Point => [[0.0; 2]; 2],
            Extent::Undeformed => [[0.5 * columns[0][row], 0.0], [0.0, 0.5 * columns[1][row]]],
            Extent::Current => {
                [[columns[0][row], columns[1][row]], [columns[2][row], columns[3][row]]]
            }
        };
        Domain { half_edges }
    }

    /// Whether it is a box along the grid, to rounding.
    #[inline(always)]
    pub fn is_box(&self) -> bool {
        let [r1, r2] = self.half_edges;
        r1[1].abs() < ON_KNOT && r2[0].abs() < ON_KNOT
    }

    /// Its extent along each direction [cells].
    #[inline(always)]
    pub fn extent(&self) -> [f64; 2] {
        let [r1, r2] = self.half_edges;
        [2.0 * (r1[0].abs() + r2[0].abs()), 2.0 * (r1[1].abs() + r2[1].abs())]
    }

    /// Shortened along its longest half diagonal to `most` [cells], as far as it is longer
    /// (F + (most/s - 1) n n^T F with s the length of that half diagonal and n its direction).
    /// Particles that stretch further than some cells reach over others, and no longer tile.
    pub fn limited(mut self, most: f64) -> Self {
        let [r1, r2] = self.half_edges;
        let plus = [r1[0] + r2[0], r1[1] + r2[1]];
        let minus = [r1[0] - r2[0], r1[1] - r2[1]];
        let square = |v: [f64; 2]| v[0] * v[0] + v[1] * v[1];
        let longest = if square(plus) >= square(minus) { plus } else { minus };
        let s2 = square(longest);
        if s2 <= most * most {
            return self;
        }
        let change = (most / s2.sqrt() - 1.0) / s2;
        for r in &mut self.half_edges {
            let along = change * (r[0] * longest[0] + r[1] * longest[1]);
            *r = [r[0] + along * longest[0], r[1] + along * longest[1]];
        }
        self
    }
}

/// Where the weights of one particle go: `K` lines of `K` nodes.
#[derive(Debug)]
pub struct Plane<'a, const K: usize> {
    /// Values; they sum to 1.
    pub values: &'a mut [[f64; K]],
    /// Gradients along x and y [1/cell]; they sum to 0.
    pub gradients: [&'a mut [[f64; K]]; 2],
}

impl<const K: usize> Plane<'_, K> {
    /// As [`Shape::plane`], of a particle that gives weight to the first `M` nodes along each direction
    /// alone: as many are computed.
    #[inline(always)]
    pub fn fill_first<S: Shape, const M: usize>(
        &mut self,
        fraction: [f64; 2],
        domain: &Domain,
    ) -> [i32; 2] {
        let [mut values, mut gx, mut gy] = [[[0.0; M]; M]; 3];
        let mut out = Plane { values: &mut values, gradients: [&mut gx, &mut gy] };
        let first = S::plane(fraction, domain, &mut out);
        let [to_x, to_y] = &mut self.gradients;
        for (to, from) in [(&mut *self.values, &values), (to_x, &gx), (to_y, &gy)] {
            to.fill([0.0; K]);
            for (to, from) in to.iter_mut().zip(from) {
                to[..M].copy_from_slice(from);
            }
        }
        first
    }
}

/// The weights of a box: the products of those along each direction.
#[inline(always)]
pub(super) fn product<S: Shape, const K: usize>(
    fraction: [f64; 2],
    domain: &Domain,
    out: &mut Plane<'_, K>,
) -> [i32; 2] {
    let extent = domain.extent();
    let x: Weights<K> = S::weights(fraction[0], extent[0]);
    let y: Weights<K> = S::weights(fraction[1], extent[1]);
    let [gx, gy] = &mut out.gradients;
    for l in 0..K {
        for k in 0..K {
            out.values[l][k] = x.values[k] * y.values[l];
            gx[l][k] = x.gradients[k] * y.values[l];
            gy[l][k] = x.values[k] * y.gradients[l];
        }
    }
    [x.first, y.first]
}

/// One point of a rule over a parallelogram: it lies at s1 r1 + s2 r2.
#[derive(Clone, Copy, Debug)]
pub(super) struct RulePoint {
    /// s1 and s2.
    pub place: [f64; 2],
    /// Its share of the mean over the domain.
    pub value: f64,
    /// Its share of the mean over an edge, for the mean gradient by Gauss's theorem: the sum over
    /// the outline of value times outward normal over the area.
    pub edge: f64,
}

/// The weights by a rule, of a domain that is no box: values are the means of the nodes' functions over the domain, gradients
/// the means of theirs. `basis` gives the `N` functions of a direction about a place, with the
/// first of their nodes.
#[inline(always)]
pub(super) fn by_rule<const P: usize, const N: usize, const K: usize>(
    fraction: [f64; 2],
    domain: &Domain,
    rule: &[RulePoint; P],
    basis: impl Fn(f64) -> (i32, [f64; N]),
    out: &mut Plane<'_, K>,
) -> [i32; 2] {
    let [r1, r2] = domain.half_edges;
    // outward normals of the edges at +r1 and +r2, times their length over the area
    let scale = 0.5 / (r1[0] * r2[1] - r1[1] * r2[0]);
    let (g1, g2) = ([r2[1] * scale, -r2[0] * scale], [-r1[1] * scale, r1[0] * scale]);
    let bases: [[(i32, [f64; N]); 2]; P] = std::array::from_fn(|p| {
        let [s1, s2] = rule[p].place;
        std::array::from_fn(|a| basis(fraction[a] + s1 * r1[a] + s2 * r2[a]))
    });
    let mut first = [i32::MAX; 2];
    for point in &bases {
        first = [first[0].min(point[0].0), first[1].min(point[1].0)];
    }
    // whole lines of the window at once, with zeros about the N functions: the processor's vectors
    // are as long as a line
    let [mut values, mut gx, mut gy] = [[[0.0; K]; K]; 3];
    for (point, [x, y]) in rule.iter().zip(&bases) {
        let [s1, s2] = point.place;
        let gradient: [f64; 2] = std::array::from_fn(|a| point.edge * (s1 * g1[a] + s2 * g2[a]));
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

    const TILTED: Domain = Domain { half_edges: [[0.4, 0.1], [-0.15, 0.3]] };

    fn weights<S: Shape>(fraction: [f64; 2], domain: &Domain) -> ([i32; 2], [Vec<[f64; 6]>; 3]) {
        let mut all = [0; 3].map(|_| vec![[0.0; 6]; 6]);
        let [values, x, y] = &mut all;
        let first = S::plane::<6>(fraction, domain, &mut Plane { values, gradients: [x, y] });
        (first, all)
    }

    fn sum(lines: &[[f64; 6]], of: impl Fn(usize, usize) -> f64) -> f64 {
        (0..6).flat_map(|l| (0..6).map(move |k| (l, k))).map(|(l, k)| lines[l][k] * of(l, k)).sum()
    }

    fn check<S: Shape>(domain: &Domain) {
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
        let square = Domain { half_edges: [[0.25, 0.0], [0.0, 0.25]] };
        let mirrored = Domain { half_edges: [[-0.25, 0.1], [0.0, 0.25]] };
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
        // next to nothing from a box, and so left to the rule
        let domain = Domain { half_edges: [[0.5 * length, 2e-12], [0.0, 0.5 * height]] };
        assert!(!domain.is_box());
        fn compare<S: Shape>(domain: &Domain, length: f64, height: f64) {
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

    #[test]
    fn a_limit_shortens_the_longest_diagonal_alone() {
        let long = Domain { half_edges: [[3.0, 1.0], [0.2, 0.4]] };
        let limited = long.limited(2.0);
        let [r1, r2] = limited.half_edges;
        assert!((f64::hypot(r1[0] + r2[0], r1[1] + r2[1]) - 2.0).abs() < 1e-14);
        let across = |d: &Domain| {
            let [r1, r2] = d.half_edges;
            // what stands across the diagonal stays
            [r1, r2].map(|r| (r[0] * 1.4 - r[1] * 3.2).abs())
        };
        for (a, b) in across(&long).iter().zip(across(&limited)) {
            assert!((a - b).abs() < 1e-13);
        }
        assert_eq!(TILTED.limited(1.0), TILTED);
        // an edge turned about is the same domain, with its diagonals exchanged
        let turned = Domain { half_edges: [[3.0, 1.0], [-0.2, -0.4]] };
        assert_eq!(turned.limited(2.0).half_edges, [r1, r2.map(|x| -x)]);
    }
}
