//! Shape functions: one file a function, one line a function in `with_shape` of
//! [`crate::solver`].
//!
//! A shape function gives a particle weights on the nodes about it. Lengths are in cells: a
//! particle lies at `fraction` in [0, 1) of its cell and is `length` long, or in a plane covers
//! its [`Domain`]. Knows no materials, no time, no messages.

mod bspline_cubic;
mod bspline_quadratic;
mod cpdi;
mod cpdi_bspline_quadratic;
mod gimp;
mod linear;
mod plane;

pub use bspline_cubic::BsplineCubic;
pub use bspline_quadratic::BsplineQuadratic;
pub use cpdi::Cpdi;
pub use cpdi_bspline_quadratic::CpdiBsplineQuadratic;
pub use gimp::Gimp;
pub use linear::Linear;
pub use plane::{Domain, Plane};

/// Weights of one particle on a line of `K` nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights<const K: usize> {
    /// First node, counted from the particle's cell's lower node.
    pub first: i32,
    /// Value of each node's function; they sum to 1.
    pub values: [f64; K],
    /// Gradient of each node's function [1/cell]; they sum to 0.
    pub gradients: [f64; K],
}

impl<const K: usize> Weights<K> {
    fn none(first: i32) -> Self {
        Weights { first, values: [0.0; K], gradients: [0.0; K] }
    }
}

/// A shape function along one direction.
pub trait Shape: Copy + Send + Sync + 'static {
    /// Whether the particle's length matters, and if so whether it is the deformed one.
    const EXTENT: Extent;

    /// Most nodes that a particle of `length` (and all shorter ones) gives weight to.
    fn nodes(length: f64) -> usize;

    /// The weights of a particle at `fraction` of its cell. `K` is at least `nodes(length)`.
    fn weights<const K: usize>(fraction: f64, length: f64) -> Weights<K>;

    /// The weights in a plane of a particle at `fraction` of its cell, into `out`; returns the
    /// first node, counted from the cell's lower one. `K` is at least `nodes` of the domain's
    /// extent along either direction. By default the product of the weights along each direction.
    #[inline(always)]
    fn plane<const K: usize>(
        fraction: [f64; 2],
        domain: &Domain,
        out: &mut Plane<'_, K>,
    ) -> [i32; 2] {
        plane::product::<Self, K>(fraction, domain, out)
    }
}

/// Which length of the particle, or which domain in a plane, a shape function looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// None.
    Point,
    /// The undeformed one.
    Undeformed,
    /// The current one.
    Current,
}

impl Extent {
    /// What the shape function `kind` looks at.
    pub fn of(kind: crate::scene::ShapeKind) -> Self {
        use crate::scene::ShapeKind;
        match kind {
            ShapeKind::Linear => Linear::EXTENT,
            ShapeKind::Gimp => Gimp::EXTENT,
            ShapeKind::Cpdi => Cpdi::EXTENT,
            ShapeKind::BsplineQuadratic => BsplineQuadratic::EXTENT,
            ShapeKind::BsplineCubic => BsplineCubic::EXTENT,
            ShapeKind::CpdiBsplineQuadratic => CpdiBsplineQuadratic::EXTENT,
        }
    }

    /// Columns that a particle's domain in a plane takes: nothing, the edges of its box, or the
    /// two half edges of its parallelogram.
    pub const fn plane_columns(self) -> usize {
        match self {
            Extent::Point => 0,
            Extent::Undeformed => 2,
            Extent::Current => 4,
        }
    }
}

/// 3 * 2^51: doubles of its size are whole numbers, and the low half of their bits holds the number
/// that has been added, rounded to the nearest one.
const ROUNDING: f64 = (3u64 << 51) as f64;

/// The greatest whole number not above `x`, for |x| < 2^51. The library's own is a call where the
/// processor's instruction cannot be taken for granted, and a cast to a whole number and back is not
/// taken for some numbers at a time, since casts saturate.
#[inline(always)]
pub(crate) fn floor(x: f64) -> f64 {
    let nearest = (x + ROUNDING) - ROUNDING;
    nearest - if nearest > x { 1.0 } else { 0.0 }
}

/// A whole number as an integer; beyond 2^30 that limit with its sign.
#[inline(always)]
pub(crate) fn integer(whole: f64) -> i32 {
    const MOST: f64 = (1u32 << 30) as f64;
    let within = whole.clamp(-MOST, MOST);
    (within + ROUNDING).to_bits() as i32
}

/// Distance from a knot within which a place counts as on it [cells]: more than rounding leaves
/// between two that should meet. Weights that are rounding alone would make chains of products
/// fall to the least doubles, where bits are lost.
const ON_KNOT: f64 = 1e-12;

/// The whole number below `x` and the rest in [0, 1), 0 where `x` is on a whole number.
#[inline(always)]
fn split(x: f64) -> (f64, f64) {
    let whole = floor(x);
    let rest = x - whole;
    if rest < ON_KNOT {
        (whole, 0.0)
    } else if rest > 1.0 - ON_KNOT {
        (whole + 1.0, 0.0)
    } else {
        (whole, rest)
    }
}

/// The three quadratic B-splines at `x`, with the first of their nodes and the distance from the
/// knot below. Their knots lie midway between nodes.
#[inline(always)]
fn quadratic(x: f64) -> (i32, f64, [f64; 3]) {
    let (first, t) = split(x - 0.5);
    let r = 1.0 - t;
    (integer(first), t, [0.5 * r * r, 0.5 + t * r, 0.5 * t * t])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums that every shape function keeps, for particles anywhere and of any length.
    fn check<S: Shape>(linear: bool) {
        for i in 0..50 {
            for length in [0.01, 0.24, 0.5, 0.77, 1.0, 1.3, 2.4] {
                if S::EXTENT == Extent::Undeformed && length > 1.0 {
                    continue;
                }
                let fraction = i as f64 / 50.0;
                assert!(S::nodes(length) <= 8);
                let w = S::weights::<8>(fraction, length);
                let sum: f64 = w.values.iter().sum();
                let slope: f64 = w.gradients.iter().sum();
                // means over a length divide rounding by it
                let rounding = 1e-14f64.max(3e-16 / length);
                assert!((sum - 1.0).abs() < rounding, "values sum to {sum}");
                assert!(slope.abs() < 1e-12, "gradients sum to {slope}");
                let place = |k: usize| (w.first + k as i32) as f64;
                let x: f64 = (0..8).map(|k| w.values[k] * place(k)).sum();
                let dx: f64 = (0..8).map(|k| w.gradients[k] * place(k)).sum();
                if linear {
                    assert!((x - fraction).abs() < rounding, "x at {fraction}: {x}");
                    assert!((dx - 1.0).abs() < 1e-12, "gradient of x at {fraction}: {dx}");
                }
                let used = (0..8).filter(|&k| w.values[k] != 0.0).max().unwrap() + 1;
                assert!(used <= S::nodes(length), "{used} nodes at {fraction}, {length}");
            }
        }
    }

    #[test]
    fn values_sum_to_one_and_gradients_to_zero() {
        check::<Linear>(true);
        check::<Gimp>(true);
        check::<Cpdi>(true);
        check::<BsplineQuadratic>(true);
        check::<BsplineCubic>(true);
        check::<CpdiBsplineQuadratic>(true);
    }

    #[test]
    fn a_place_off_a_knot_by_a_rounding_lies_on_it() {
        for (x, at) in [(2.0 - 1e-15, 2.0), (2.0 + 1e-15, 2.0), (-1e-17, 0.0), (1e-17, 0.0)] {
            assert_eq!(split(x), (at, 0.0), "{x}");
        }
        assert_eq!(split(1.75), (1.0, 0.75));
    }

    #[test]
    fn floor_is_the_librarys() {
        for x in [-3.5, -3.0, -0.2, -0.0, 0.0, 0.9, 1.0, 7.3, -1e-300, 2e9, -2e9] {
            assert_eq!(floor(x), x.floor(), "{x}");
        }
    }

    #[test]
    fn integers_are_those_of_a_cast_up_to_their_limit() {
        for x in [-3.0, -1.0, -0.0, 0.0, 7.0, 1e9, -1e9] {
            assert_eq!(integer(x), x as i32, "{x}");
        }
        for beyond in [2e9, 1e18, f64::INFINITY] {
            assert_eq!([integer(beyond), integer(-beyond)], [1 << 30, -(1 << 30)]);
        }
        assert_eq!(integer(f64::NAN), 0);
    }

    #[test]
    fn fewer_nodes_give_the_same_weights() {
        let wide = CpdiBsplineQuadratic::weights::<8>(0.3, 0.5);
        let narrow = CpdiBsplineQuadratic::weights::<4>(0.3, 0.5);
        assert_eq!(wide.values[..4], narrow.values);
        assert_eq!(wide.gradients[..4], narrow.gradients);
    }

    #[test]
    fn gradients_of_point_shapes_are_derivatives_of_their_values() {
        fn compare<S: Shape>() {
            let h = 1e-6;
            let (a, b) = (S::weights::<8>(0.3 - h, 0.4), S::weights::<8>(0.3 + h, 0.4));
            let w = S::weights::<8>(0.3, 0.4);
            for k in 0..8 {
                let slope = (b.values[k] - a.values[k]) / (2.0 * h);
                assert!((w.gradients[k] - slope).abs() < 1e-8, "node {k}");
            }
        }
        compare::<Linear>();
        compare::<Gimp>();
        compare::<BsplineQuadratic>();
        compare::<BsplineCubic>();
    }
}
