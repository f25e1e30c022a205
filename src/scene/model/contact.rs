//! Contact between bodies.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Contact laws by type.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Contact {
    /// Bodies stick together where they meet: one velocity field for all, as without the key.
    Stick {},
    /// Each body has a velocity field of its own; in contact they share the velocity normal to
    /// the plane of contact, part again, and slide freely.
    Frictionless {
        /// Where the normals of the plane of contact come from.
        #[serde(default)]
        normals: Normals,
    },
    /// The same with Coulomb's friction: bodies in contact stick while that takes no more than
    /// the coefficient times the force normal to the plane, else they slide against it.
    Friction {
        /// Coulomb's coefficient [-].
        #[schemars(range(min = 0.0))]
        coefficient: f64,
        /// Where the normals of the plane of contact come from.
        #[serde(default)]
        normals: Normals,
    },
}

/// Normals of the plane of contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Normals {
    /// The difference of the two bodies' gradients of filled volume (Lemiale, Hurmane & Nairn
    /// 2010).
    #[default]
    VolumeGradient,
    /// The line that best tells the corners of the two bodies' particles apart (Nairn,
    /// Hammerquist & Smith 2020), in a plane.
    LogisticRegression,
}
