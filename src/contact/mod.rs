//! Contact laws between bodies: one file per law, one line per law in the list below.
//!
//! A law returns its [`ContactCondition`]; the solver depends on no individual law. This module is
//! independent of particles, fields and messages.

mod normals;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use normals::{
    BodyPair, BoundaryParticle, BoundaryPoint, ContactParticle, ContactPlane, Normals, reach,
};

/// Defines the contact laws from a list of `module::Parameters,`. The module name is the name of
/// the law in scenes; the struct has the method `condition`.
macro_rules! contact_laws {
    ($($(#[doc = $doc:literal])+ $module:ident::$law:ident,)+) => {
        $(mod $module;)+
        $(pub use $module::$law;)+

        /// Contact law, selected by `type`.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(tag = "type", rename_all = "snake_case")]
        pub enum Contact {
            $($(#[doc = $doc])+ $law($law),)+
        }

        impl Contact {
            /// Name of the law in scenes.
            pub fn name(&self) -> &'static str {
                match self { $(Contact::$law(_) => stringify!($module),)+ }
            }

            /// Condition at the contact plane; `None`: one velocity field for all bodies.
            pub fn condition(&self) -> Option<ContactCondition> {
                match self { $(Contact::$law(law) => law.condition(),)+ }
            }
        }
    };
}

contact_laws! {
    /// Bodies in contact stick together: one velocity field for all bodies, as without the key
    /// `contact`.
    stick::Stick,
    /// Each body has its own velocity field. Bodies in contact have the same velocity normal to the
    /// contact plane, slide without friction, and can separate.
    frictionless::Frictionless,
    /// As `frictionless`, with Coulomb friction: bodies in contact stick while the tangential force
    /// is at most the coefficient times the normal force, and slide against friction otherwise.
    friction::Friction,
}

/// Greatest adhesion impulse of bodies that no wave has pressed together yet, as a fraction of rho h
/// u [-], with the impact speed u of the scene and the cell edge h: oscillations run ahead of a
/// shock, and an interface that opened at each of them would reflect a part of the shock. Bodies
/// never return more impulse than their contact impulse, initial value included, so adhesion does
/// not last. Bodies that a wave has pressed together carry no tension.
pub const MAX_ADHESION: f64 = 0.02;

/// Condition at the contact plane between bodies with separate velocity fields.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactCondition {
    /// Coulomb friction coefficient [-]; `None`: no friction.
    pub coefficient: Option<f64>,
    /// Source of the normals.
    pub normals: Normals,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modules_have_the_names_of_the_laws_in_scenes() {
        let normals = Normals::default();
        for law in [
            Contact::Stick(Stick {}),
            Contact::Frictionless(Frictionless { normals }),
            Contact::Friction(Friction { coefficient: 0.3, normals }),
        ] {
            assert_eq!(serde_json::json!(law)["type"], law.name());
        }
    }
}
