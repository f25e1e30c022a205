//! Normals of the contact plane: one file per source, one line per source in the list below.

mod body_pair;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use body_pair::{BodyPair, BoundaryPoint, ContactParticle, ContactPlane, ContactPlanes, reach};
pub use boundary_faces::BoundaryParticle;

/// Defines the sources of normals from a list of `module::Name,`. The module name is the name in
/// scenes; the module has the constants `PLANE_ONLY` and `USES_FACES` and the function `planes`.
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
            /// Whether the source exists only in a plane.
            pub fn is_plane_only(self) -> bool {
                match self { $(Normals::$name => $module::PLANE_ONLY,)+ }
            }

            /// Whether particles carry the faces of their bodies.
            pub fn uses_faces(self) -> bool {
                match self { $(Normals::$name => $module::USES_FACES,)+ }
            }

            /// Contact planes of two bodies at a node: two in a corner that both fill. `corners`
            /// is scratch.
            pub fn planes<const D: usize>(
                self,
                pair: &BodyPair<'_, D>,
                corners: &mut Vec<BoundaryPoint<D>>,
            ) -> ContactPlanes<D> {
                match self { $(Normals::$name => $module::planes(pair, corners),)+ }
            }
        }
    };
}

normals! {
    /// Faces of the bodies, carried by the particles at their boundaries; `widest_gap` where no
    /// faces meet, as at surfaces of fracture.
    #[default]
    boundary_faces::BoundaryFaces,
    /// The direction with the widest gap between the particles, among those of the two bodies'
    /// gradients of filled volume.
    widest_gap::WidestGap,
    /// Difference of the two bodies' gradients of filled volume (Lemiale, Hurmane & Nairn 2010).
    volume_gradient::VolumeGradient,
    /// Line that best separates the particle corners of the two bodies (Nairn, Hammerquist & Smith
    /// 2020), in a plane.
    logistic_regression::LogisticRegression,
}
