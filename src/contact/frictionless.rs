//! Contact without friction.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ContactCondition, Normals};

/// Parameters of contact without friction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Frictionless {
    /// Source of the normals of the contact plane; default `boundary_faces`.
    #[serde(default)]
    pub normals: Normals,
}

impl Frictionless {
    pub(super) fn condition(&self) -> Option<ContactCondition> {
        Some(ContactCondition { coefficient: None, normals: self.normals })
    }
}
