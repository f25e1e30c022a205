//! Erosion and temperature of a material.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Removal of a particle from the run, at the first limit that it reaches. The conservation balance
/// counts its content as having left.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Erosion {
    /// Limit of the equivalent plastic strain [-], which needs `strength`; absent: no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub plastic_strain: Option<f64>,
    /// Limit of the volume over the initial volume [-]; absent: no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 1.0))]
    pub volume_ratio: Option<f64>,
}

/// Temperature model of a material.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Thermal {
    /// Specific heat cv at constant volume [J/(kg K)]. With a larger value the same heat raises the
    /// temperature less.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub specific_heat: f64,
    /// Temperature of the material at rest, at its reference density and without heat [K].
    #[schemars(range(min = 0.0))]
    pub reference_temperature: f64,
    /// Quantity that determines the temperature; default `energy`.
    #[serde(default)]
    pub source: HeatSource,
    /// Fraction of the plastic work that becomes heat (Taylor & Quinney 1934) [-]; default 1.
    #[serde(default = "one")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub taylor_quinney: f64,
    /// Thermal conductivity [W/(m K)]; absent: no heat is conducted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub conductivity: Option<f64>,
}

/// Quantity that determines a temperature.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HeatSource {
    /// The temperature follows from the internal energy, relative to the isentrope of the equation
    /// of state.
    #[default]
    Energy,
    /// The temperature rises by the plastic work only.
    PlasticWork,
}

fn one() -> f64 {
    1.0
}
