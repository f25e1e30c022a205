//! Contact with Coulomb friction.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ContactCondition, Normals};

/// Parameters of contact with Coulomb friction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Friction {
    /// Coulomb friction coefficient [-].
    #[schemars(range(min = 0.0))]
    pub coefficient: f64,
    /// Source of the normals of the contact plane; default `boundary_faces`.
    #[serde(default)]
    pub normals: Normals,
}

impl Friction {
    pub(super) fn condition(&self) -> Option<ContactCondition> {
        Some(ContactCondition { coefficient: Some(self.coefficient), normals: self.normals })
    }
}
