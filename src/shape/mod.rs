//! Shape functions: one file per function, one line per function in the list below.
//!
//! A shape function gives the weights of a particle on the nodes near it. Lengths are in cells: a
//! particle lies at `fraction` in [0, 1) of its cell and is `length` long, or in a plane covers its
//! [`ParticleDomain`]. Knows no materials, no time, no messages.

mod corners;
mod domain;
mod function;
mod knots;
mod lanes;
mod line_products;
mod plane;
mod widths;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use corners::CornerLanes;
pub use domain::{DomainExtent, ParticleDomain};
pub(crate) use function::extents;
pub use function::{Basis, CourantLimits, Shape, Weights};
pub(crate) use knots::{floor, from_low_bits, integer, to_low_bits};
pub use lanes::{LANES, Lanes, PlaneLanes};
pub use line_products::{add_product, fours, vector};
pub use plane::Plane;
pub use widths::{MOST_NODES, most_nodes, padded_width};
pub(crate) use widths::{with_shape_width, with_width};

/// Defines the shape functions from a list of `module::Type [width],`: their names in scenes, their
/// properties, and the dispatch to their kernels. The width is the number of nodes along one
/// direction, or `by_length`.
macro_rules! shape_functions {
    ($d:tt $($(#[doc = $doc:literal])+ $module:ident::$name:ident $width:tt,)+) => {
        $(mod $module;)+
        $(pub use $module::$name;)+

        /// Shape functions.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
        #[serde(rename_all = "snake_case")]
        pub enum ShapeKind {
            $($(#[doc = $doc])+ $name,)+
        }

        impl ShapeKind {
            /// All shape functions, in the order of the list.
            pub const ALL: &[ShapeKind] = &[$(ShapeKind::$name),+];

            /// The length or domain of the particle that the shape function depends on.
            pub fn extent(self) -> DomainExtent {
                match self { $(ShapeKind::$name => $name::EXTENT,)+ }
            }

            /// Nodal basis functions from which the shape function is built.
            pub fn basis(self) -> Basis {
                match self { $(ShapeKind::$name => $name::BASIS,)+ }
            }

            /// Greatest number of nodes in the support of a particle of `length` [cells].
            pub fn nodes(self, length: f64) -> usize {
                match self { $(ShapeKind::$name => $name::nodes(length),)+ }
            }

            /// Measured limits of the Courant number.
            pub fn courant_limits(self) -> &'static CourantLimits {
                match self { $(ShapeKind::$name => &$name::COURANT,)+ }
            }
        }

        /// Calls `$call` with the type of a shape function, a width known at compile time of at
        /// least `$nodes`, and the dimension.
        macro_rules! with_shape {
            ($d kind:expr, $d nodes:expr, $d call:ident ( $d($d arg:expr),* )) => {
                match $d kind {
                    $($crate::shape::ShapeKind::$name => $crate::shape::with_shape_width!(
                        $width, $crate::shape::$name, $d nodes, $d call ( $d($d arg),* )
                    ),)+
                }
            };
        }
        pub(crate) use with_shape;
    };
}

shape_functions! { $
    /// Hat functions at the particle's centre (Sulsky, Chen & Schreyer 1994).
    linear::Linear [2],
    /// Hat functions averaged over the particle's undeformed size (Bardenhagen & Kober 2004).
    gimp::Gimp [by_length],
    /// Hat functions interpolated from the corners of the deforming particle (Sadeghirad,
    /// Brannon & Burghardt 2011).
    cpdi::Cpdi [by_length],
    /// Quadratic B-splines at the particle's centre (Steffen, Kirby & Berzins 2008).
    bspline_quadratic::BsplineQuadratic [3],
    /// Cubic B-splines at the particle's centre (Steffen, Kirby & Berzins 2008).
    bspline_cubic::BsplineCubic [4],
    /// Quadratic B-splines averaged over the deforming particle.
    cpdi_bspline_quadratic::CpdiBsplineQuadratic [by_length],
}

impl ShapeKind {
    /// Whether the weights are those of hat functions at the corners of the particles: see
    /// [`CornerLanes`].
    pub fn has_corners(self) -> bool {
        self.basis() == Basis::Hat && self.extent() == DomainExtent::Current
    }

    /// Whether forces jump when a particle crosses into another cell.
    pub fn has_jumps(self) -> bool {
        self.basis() == Basis::Hat && self.extent() == DomainExtent::Point
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks the sums that hold for every shape function, at any position and length of the
    /// particle.
    fn check<S: Shape>(linear: bool) {
        for i in 0..50 {
            for length in [0.01, 0.24, 0.5, 0.77, 1.0, 1.3, 2.4] {
                if S::EXTENT == DomainExtent::Undeformed && length > 1.0 {
                    continue;
                }
                let fraction = i as f64 / 50.0;
                assert!(S::nodes(length) <= 8);
                let w = S::weights::<8>(fraction, length);
                let sum: f64 = w.values.iter().sum();
                let slope: f64 = w.gradients.iter().sum();
                // a mean over a length divides the rounding error by the length
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
        fn call<S: Shape, const K: usize, const D: usize>() {
            check::<S>(true);
        }
        const D: usize = 1;
        for &kind in ShapeKind::ALL {
            with_shape!(kind, 4usize, call());
        }
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
