//! Definition of a material in a scene: density, equation of state, and optional further responses.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::material::failure::StrengthBeside;

mod response;

pub use response::*;

pub use crate::material::eos::{
    Burn, BurnFront, BurnPlane, BurnWhole, Eos, Gruneisen, TableSource, TableValues,
};
pub use crate::material::failure::Failure;
pub use crate::material::strength::Strength;

/// Density, equation of state, and optional strength, failure, erosion and temperature of one
/// material.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Density at rest, the reference density of the equation of state [kg/m3]; further bounds
    /// follow from the equation of state.
    #[schemars(extend("exclusiveMinimum" = 0.0, "minimum" = 0.0, "maximum" = f64::MAX))]
    pub density: f64,
    /// Equation of state, selected by `type`: the pressure as a function of density and energy, or
    /// the stress of an elastic solid.
    pub eos: Eos,
    /// Strength in shear, in addition to a fluid's equation of state; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strength: Option<Strength>,
    /// Failure, after which the material carries neither tension nor shear; absent: never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failure: Option<Failure>,
    /// Erosion, which removes particles from the run; absent: never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub erosion: Option<Erosion>,
    /// Temperature model, which strength with softening, heat conduction and initial temperatures
    /// need; absent: the material has no temperature.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thermal: Option<Thermal>,
    /// Source of the constants: author, year and table. It has no effect on the run.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub source: String,
}

impl Material {
    /// Greatest tension that the equation of state carries [Pa], of a porous material that of its solid;
    /// `None` without a limit.
    pub fn tension_cutoff(&self) -> Option<f64> {
        let eos = serde_json::json!(self.eos);
        eos["tension_cutoff"].as_f64().or(eos["solid"]["tension_cutoff"].as_f64())
    }

    /// Initial distension v/v_solid [-]: 1 for all but porous solids.
    pub fn distension(&self) -> f64 {
        self.eos.distension(self.density)
    }

    /// Whether the stress is a tensor.
    pub fn bears_shear(&self) -> bool {
        self.eos.is_solid() || self.strength.is_some()
    }

    /// Properties of the strength that the failure law needs.
    pub fn strength_beside(&self) -> StrengthBeside {
        StrengthBeside {
            present: self.strength.is_some(),
            softening_range: self.strength.and_then(|strength| strength.softening_range()),
        }
    }

    /// Whether a part of the plastic work is stored and does not heat the material.
    pub fn stores_work(&self) -> bool {
        let stored = |t: Thermal| t.source == HeatSource::Energy && t.taylor_quinney < 1.0;
        self.strength.is_some() && self.thermal.is_some_and(stored)
    }
}

/// Source of a material, in the JSON schema only: reading a scene replaces it by the full material.
#[derive(JsonSchema)]
#[serde(untagged)]
pub enum MaterialSource {
    /// The full material.
    Whole(Box<Material>),
    /// A material of the library, by its name; keys beside it override.
    Library {
        /// Name in the library.
        library: String,
    },
    /// A material in a file in the folder of the scene file; keys beside it override.
    File {
        /// Path of the file, relative to the scene's folder.
        file: String,
    },
}
