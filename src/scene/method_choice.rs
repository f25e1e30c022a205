//! Choice of a method by the name of a preset.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A complete method and artificial viscosity by name, adapted to the contents of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Preset {
    /// The most accurate method that was measured to be stable with the contents of the scene.
    Default,
    /// A method with little overshoot and tension ahead of the shock in plane impacts. It passes every
    /// hard case. Its shocks are wider than those of `default`. It equals `default` in two dimensions,
    /// and with contact, failure, strength, gas or pores.
    Robust,
    /// Of the methods in the range of the error estimate, the one with the smallest mean of E1
    /// over ten plane impacts; in the total-Lagrangian frame if the scene has only fluids on a
    /// line that touch and stay in contact. It equals `default` in two dimensions, and with contact,
    /// failure, strength, gas or pores.
    Sharpest,
}

/// The preset of a scene, and why its options were chosen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MethodChoice {
    /// Name of the preset.
    pub preset: Preset,
    /// The transfer and the viscosity in short, then the reasons.
    pub reasons: Vec<String>,
}

impl std::fmt::Display for MethodChoice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.preset.name(), self.reasons.join("; "))
    }
}

impl Preset {
    /// All presets.
    pub const ALL: [Preset; 3] = [Preset::Default, Preset::Robust, Preset::Sharpest];

    /// Name in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Preset::Default => "default",
            Preset::Robust => "robust",
            Preset::Sharpest => "sharpest",
        }
    }
}
