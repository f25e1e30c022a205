//! Normals of the contact plane: one file per source, one line per source in the list below.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Defines the sources of normals from a list of `module::Name,`. The module name is the name in
/// scenes; the module has the constant `USES_CORNERS` and the function `normal`.
macro_rules! normals {
    ($($(#[$attribute:meta])+ $module:ident::$name:ident,)+) => {
        $(mod $module;)+

        /// Source of the normals of the contact plane.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
        #[serde(rename_all = "snake_case")]
        pub enum Normals {
            $($(#[$attribute])+ $name,)+
        }

        impl Normals {
            /// Whether normals depend on particle corners, which exist only in a plane.
            pub fn uses_corners(self) -> bool {
                match self { $(Normals::$name => $module::USES_CORNERS,)+ }
            }

            /// Unit normal from the first of two bodies to the second; `None` if undefined.
            pub fn normal<const D: usize>(self, pair: &BodyPair<'_, D>) -> Option<[f64; D]> {
                match self { $(Normals::$name => $module::normal(pair),)+ }
            }
        }
    };
}

normals! {
    /// Difference of the two bodies' gradients of filled volume (Lemiale, Hurmane & Nairn 2010).
    #[default]
    volume_gradient::VolumeGradient,
    /// Line that best separates the particle corners of the two bodies (Nairn, Hammerquist & Smith
    /// 2020), in a plane.
    logistic_regression::LogisticRegression,
}

/// Two bodies at a node.
pub struct BodyPair<'a, const D: usize> {
    /// Filled volumes V = sum V_p N [cells].
    pub volume: [f64; 2],
    /// Gradients of the filled volumes g = sum V_p G.
    pub gradient: [&'a [f64; D]; 2],
    /// Corners of the particles that reach the node, for normals that use them.
    pub corners: &'a [BoundaryPoint<D>],
    /// Edges of a cell [m].
    pub cell: &'a [f64; D],
}

/// A particle corner: its position relative to the node [cells], and whether it belongs to the
/// second body. Corners are taken at the fraction [`INSET`] of the half edges, so that two bodies
/// in contact can be separated.
pub type BoundaryPoint<const D: usize> = ([f64; D], bool);

/// Fraction of the half edges at which corners are taken; see [`BoundaryPoint`].
pub const INSET: f64 = 0.9;

/// Relative size below which a component is only rounding.
const AXIS: f64 = 1e-10;

/// Unit vector along `v`; exactly along an axis if it is so to rounding.
fn unit<const D: usize>(v: [f64; D]) -> [f64; D] {
    let length = |v: &[f64; D]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let first = length(&v);
    let v = v.map(|x| if x.abs() < AXIS * first { 0.0 } else { x });
    let length = length(&v);
    v.map(|x| x / length)
}
