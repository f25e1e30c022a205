//! The domain of a particle: the length, or the parallelogram in a plane, that it covers.

use wide::f64x4;

use super::knots::ON_KNOT;

/// Length of the particle, or its domain in a plane, on which a shape function depends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DomainExtent {
    /// None.
    Point,
    /// Undeformed length or domain.
    Undeformed,
    /// Current length or domain.
    Current,
}

impl DomainExtent {
    /// Number of columns of a particle's domain in a plane: none, the edges of its box, or the two
    /// half edges of its parallelogram.
    pub const fn plane_columns(self) -> usize {
        match self {
            DomainExtent::Point => 0,
            DomainExtent::Undeformed => 2,
            DomainExtent::Current => 4,
        }
    }
}

impl DomainExtent {
    /// Half edges of the domains of four particles from `column`, which gives four values of a
    /// column: see [`DomainExtent::plane_columns`].
    #[inline(always)]
    pub fn half_edges(self, column: impl Fn(usize) -> f64x4) -> [[f64x4; 2]; 2] {
        let (zero, half) = (f64x4::ZERO, f64x4::HALF);
        match self {
            DomainExtent::Point => [[zero; 2]; 2],
            DomainExtent::Undeformed => [[half * column(0), zero], [zero, half * column(1)]],
            DomainExtent::Current => [[column(0), column(1)], [column(2), column(3)]],
        }
    }
}

/// Square of the cosine of 2 degrees, the angle between edges below which a domain is flat.
const FLAT: f64 = 0.998782;

/// Parallelogram of a particle, given by its half edges r1 and r2 [cells]: its corners are at +-r1
/// +-r2 from its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParticleDomain {
    /// Half edges r1 and r2 [cells].
    pub half_edges: [[f64; 2]; 2],
}

impl ParticleDomain {
    /// Domain of `particle` from the columns of `extent`: see [`DomainExtent::plane_columns`].
    #[inline(always)]
    pub fn from_columns(extent: DomainExtent, columns: &[&[f64]; 4], particle: usize) -> Self {
        let half_edges = match extent {
            DomainExtent::Point => [[0.0; 2]; 2],
            DomainExtent::Undeformed => {
                [[0.5 * columns[0][particle], 0.0], [0.0, 0.5 * columns[1][particle]]]
            }
            DomainExtent::Current => [
                [columns[0][particle], columns[1][particle]],
                [columns[2][particle], columns[3][particle]],
            ],
        };
        ParticleDomain { half_edges }
    }

    /// Whether it is a box aligned with the grid, to rounding.
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

    /// Domain whose half diagonals are shortened to `most` [cells] where they are longer: F +
    /// (most/s - 1) n n^T F, with s the length of the longest half diagonal and n its direction,
    /// and again if the other one is still too long. Particles that stretch over several cells
    /// overlap others and no longer tile the body.
    pub fn limited(mut self, most: f64) -> Self {
        // the second time the other diagonal, if that of the first is not longer by rounding alone
        for slack in [0.0, 1e-12] {
            let (longest, s2) = self.longest_diagonal();
            if s2 <= most * most * (1.0 + slack) {
                break;
            }
            let change = (most / s2.sqrt() - 1.0) / s2;
            for r in &mut self.half_edges {
                let along = change * (r[0] * longest[0] + r[1] * longest[1]);
                *r = [r[0] + along * longest[0], r[1] + along * longest[1]];
            }
        }
        self
    }

    /// Longest half diagonal [cells] and its square.
    fn longest_diagonal(&self) -> ([f64; 2], f64) {
        let [r1, r2] = self.half_edges;
        let plus = [r1[0] + r2[0], r1[1] + r2[1]];
        let minus = [r1[0] - r2[0], r1[1] - r2[1]];
        let (long, short) = (dot(plus, plus), dot(minus, minus));
        if long >= short { (plus, long) } else { (minus, short) }
    }

    /// [`Self::limited`] of a domain that first, if it is too long and the angle between its edges
    /// is less than 2 or more than 178 degrees, gets orthogonal edges with the same area and the
    /// same second moments.
    ///
    /// Gradients are differences between opposite edges over their distance. Along a flat
    /// parallelogram opposite edges lie one behind the other: errors of Simpson's rule do not
    /// cancel, and the gradients exceed those of the splines without bound.
    pub fn limited_as_rectangle(self, most: f64) -> Self {
        let [r1, r2] = self.half_edges;
        let is_flat = dot(r1, r2).powi(2) > FLAT * dot(r1, r1) * dot(r2, r2);
        let too_long = self.longest_diagonal().1 > most * most;
        let domain = if is_flat && too_long { self.rectangle() } else { self };
        domain.limited(most)
    }

    /// Domain with the same area and the same second moments and with orthogonal edges: the half
    /// edges, as columns of a matrix, times the least rotation.
    fn rectangle(self) -> Self {
        let [r1, r2] = self.half_edges;
        let (product, squares) = (dot(r1, r2), [dot(r1, r1), dot(r2, r2)]);
        // tan of twice the angle is twice the product over the difference of the squares
        let difference = squares[0] - squares[1];
        let length = (difference * difference + 4.0 * product * product).sqrt();
        let cos = (0.5 + 0.5 * difference.abs() / length).sqrt();
        let sin = product.copysign(product * difference) / (length * cos);
        let along = |a: usize| [r1[a] * cos + r2[a] * sin, r2[a] * cos - r1[a] * sin];
        let [[x1, x2], [y1, y2]] = [along(0), along(1)];
        ParticleDomain { half_edges: [[x1, y1], [x2, y2]] }
    }
}

#[inline(always)]
fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_diagonals_are_shortened_if_both_are_too_long() {
        for half_edges in [[[2.8, 0.0], [0.0, 2.8]], [[3.0, 1.0], [-0.7, 2.4]]] {
            let [r1, r2] = ParticleDomain { half_edges }.limited(1.0).half_edges;
            let plus = f64::hypot(r1[0] + r2[0], r1[1] + r2[1]);
            let minus = f64::hypot(r1[0] - r2[0], r1[1] - r2[1]);
            assert!(plus.max(minus) < 1.0 + 1e-14, "{plus} {minus}");
            assert!(plus.min(minus) > 0.8, "{plus} {minus}");
        }
    }

    /// Also edges of equal length, and those of a mirrored domain.
    #[test]
    fn oblique_domains_get_orthogonal_edges_with_the_same_area_and_second_moments() {
        for half_edges in [
            [[0.59, 37.8], [-0.447, -28.6]],
            [[1.0, 0.1], [1.0, -0.1]],
            [[0.3, 2.0], [0.2, 2.0]],
            [[-2.0, 0.1], [5.0, 0.3]],
        ] {
            let oblique = ParticleDomain { half_edges };
            let turned = oblique.rectangle();
            let of = |domain: &ParticleDomain| {
                let [[ax, ay], [bx, by]] = domain.half_edges;
                [ax * by - ay * bx, ax * ax + bx * bx, ax * ay + bx * by, ay * ay + by * by]
            };
            let size = of(&oblique)[1] + of(&oblique)[3];
            for (a, b) in of(&turned).iter().zip(of(&oblique)) {
                assert!((a - b).abs() < 1e-13 * size, "{half_edges:?}: {a} {b}");
            }
            let squares = half_edges.map(|edge| dot(edge, edge));
            assert!(
                dot(turned.half_edges[0], turned.half_edges[1]).abs() < 1e-13 * size,
                "{half_edges:?}"
            );
            // the longer edge keeps its direction
            let longer = usize::from(squares[1] > squares[0]);
            let (old, new) = (half_edges[longer], turned.half_edges[longer]);
            assert!(dot(old, new) > 0.7 * dot(old, old), "{half_edges:?}");
        }
    }

    #[test]
    fn only_flat_domains_that_are_too_long_become_rectangles() {
        let with_angle = |degrees: f64, length: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            ParticleDomain { half_edges: [[length, 0.0], [1.2 * length * cos, 1.2 * length * sin]] }
        };
        let angle_of_edges = |domain: ParticleDomain| {
            let [r1, r2] = domain.half_edges;
            (dot(r1, r2) / (dot(r1, r1) * dot(r2, r2)).sqrt()).acos().to_degrees()
        };
        for degrees in [1.9, 178.1, 0.1, 179.9] {
            let domain = with_angle(degrees, 2.0);
            let limited = domain.limited_as_rectangle(1.0);
            assert!(limited.longest_diagonal().1 < 1.0 + 1e-12, "{degrees}");
            assert!((angle_of_edges(limited) - 90.0).abs() < 15.0, "{degrees}: {limited:?}");
            assert_eq!(domain.limited_as_rectangle(9.0), domain, "short enough");
        }
        for degrees in [2.1, 177.9, 90.0] {
            let domain = with_angle(degrees, 2.0);
            assert_eq!(domain.limited_as_rectangle(1.0), domain.limited(1.0), "{degrees}");
        }
        let without_edge = ParticleDomain { half_edges: [[2.0, 1.0], [0.0, 0.0]] };
        assert_eq!(without_edge.limited_as_rectangle(1.0), without_edge.limited(1.0));
    }

    #[test]
    fn a_limit_shortens_the_longest_diagonal_alone() {
        let long = ParticleDomain { half_edges: [[3.0, 1.0], [0.2, 0.4]] };
        let limited = long.limited(2.0);
        let [r1, r2] = limited.half_edges;
        assert!((f64::hypot(r1[0] + r2[0], r1[1] + r2[1]) - 2.0).abs() < 1e-14);
        let across = |d: &ParticleDomain| {
            let [r1, r2] = d.half_edges;
            // the extent normal to the diagonal does not change
            [r1, r2].map(|r| (r[0] * 1.4 - r[1] * 3.2).abs())
        };
        for (a, b) in across(&long).iter().zip(across(&limited)) {
            assert!((a - b).abs() < 1e-13);
        }
        let short = ParticleDomain { half_edges: [[0.4, 0.1], [-0.15, 0.3]] };
        assert_eq!(short.limited(1.0), short);
        // with one edge reversed it is the same domain, with its diagonals exchanged
        let turned = ParticleDomain { half_edges: [[3.0, 1.0], [-0.2, -0.4]] };
        assert_eq!(turned.limited(2.0).half_edges, [r1, r2.map(|x| -x)]);
    }
}
