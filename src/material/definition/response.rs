//! What a material bears of shear, when it fails, and its temperature.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Models of strength by type.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Strength {
    /// Von Mises' yield surface, Y = yield_stress + hardening ep.
    VonMises {
        /// Shear modulus [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        shear_modulus: f64,
        /// Yield stress at no plastic strain [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        yield_stress: f64,
        /// Growth of the yield stress with the plastic strain [Pa].
        #[serde(default)]
        #[schemars(range(min = 0.0))]
        hardening: f64,
    },
    /// Johnson & Cook (1983), Y = (a + b ep^n)(1 + c ln max(1, rate/reference_rate))(1 - T*^m).
    JohnsonCook {
        /// Shear modulus [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        shear_modulus: f64,
        /// Yield stress at no plastic strain [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        a: f64,
        /// Hardening [Pa].
        #[schemars(range(min = 0.0))]
        b: f64,
        /// Exponent of the plastic strain [-].
        #[schemars(range(max = 5.0), extend("exclusiveMinimum" = 0.0))]
        n: f64,
        /// Coefficient of the rate's logarithm [-].
        #[serde(default)]
        #[schemars(range(min = 0.0))]
        c: f64,
        /// Rate from which on it counts [1/s].
        #[serde(default = "one")]
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        reference_rate: f64,
        /// Softening by temperature, which needs `thermal`; absent: none.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        softening: Option<Softening>,
    },
    /// Steinberg, Cochran & Guinan (1980), for high rates.
    SteinbergGuinan {
        /// Shear modulus at rest [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        shear_modulus: f64,
        /// Yield stress at rest [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        yield_stress: f64,
        /// Hardening [-].
        #[schemars(range(min = 0.0))]
        beta: f64,
        /// Its exponent [-].
        #[schemars(range(min = 0.0, max = 5.0))]
        n: f64,
        /// Plastic strain at the start [-].
        #[serde(default)]
        #[schemars(range(min = 0.0))]
        initial_strain: f64,
        /// Most that hardening reaches [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        max_yield_stress: f64,
        /// Growth of both moduli with pressure, A = G'p/G0 [1/Pa].
        #[serde(default)]
        #[schemars(range(min = 0.0))]
        pressure_hardening: f64,
        /// Fall of both moduli with temperature above 300 K, B = -G'T/G0 [1/K], which needs
        /// `thermal`; absent: none.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0.0))]
        temperature_softening: Option<f64>,
    },
}

/// Softening by temperature, 1 - T*^m with T* = (T - reference)/(melt - reference).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Softening {
    /// Exponent [-].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub m: f64,
    /// Temperature below which there is none [K].
    #[schemars(range(min = 0.0))]
    pub reference_temperature: f64,
    /// Melting temperature [K].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub melt_temperature: f64,
}

/// Models of failure by type. What fails bears neither tension nor shear from then on; its elastic
/// energy stays with it as heat.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Failure {
    /// At once at a tension.
    TensionLimit {
        /// The tension [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        stress: f64,
        /// What must reach it.
        #[serde(default)]
        measure: TensionMeasure,
    },
    /// Johnson & Cook (1985): by the sum of plastic strain over the strain at fracture, (d1 + d2
    /// exp(d3 s*))(1 + d4 ln max(1, rate/reference_rate))(1 + d5 T*); needs `strength`.
    JohnsonCook {
        /// Strain at fracture, constant part [-].
        #[serde(default)]
        d1: f64,
        /// Strain at fracture, part that depends on the triaxiality [-].
        #[serde(default)]
        d2: f64,
        /// Its exponent [-].
        #[serde(default)]
        d3: f64,
        /// Coefficient of the rate's logarithm [-].
        #[serde(default)]
        d4: f64,
        /// Coefficient of the temperature, which needs `thermal` and the strength's `softening` [-].
        #[serde(default)]
        d5: f64,
        /// Rate from which on it counts [1/s].
        #[serde(default = "one")]
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        reference_rate: f64,
    },
}

/// What must reach a tension limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TensionMeasure {
    /// The greatest principal stress.
    #[default]
    PrincipalStress,
    /// The mean of the stresses, minus the pressure.
    MeanStress,
}

/// When a particle is taken out of the run: at the first limit that it reaches. What it has is
/// booked as having left.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Erosion {
    /// Equivalent plastic strain [-], which needs `strength`; absent: no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub plastic_strain: Option<f64>,
    /// Volume over that at the start [-]; absent: no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 1.0))]
    pub volume_ratio: Option<f64>,
}

/// The temperature of a material.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Thermal {
    /// Specific heat cv [J/(kg K)].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub specific_heat: f64,
    /// Temperature at rest [K].
    #[schemars(range(min = 0.0))]
    pub reference_temperature: f64,
    /// What the temperature follows from.
    #[serde(default)]
    pub source: HeatSource,
    /// Share of the plastic work that heats (Taylor & Quinney 1934) [-].
    #[serde(default = "one")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub taylor_quinney: f64,
    /// Thermal conductivity [W/(m K)]; absent: no heat is conducted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub conductivity: Option<f64>,
}

/// What a temperature follows from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HeatSource {
    /// The internal energy, about the isentrope of the equation of state.
    #[default]
    Energy,
    /// The plastic work alone.
    PlasticWork,
}

fn one() -> f64 {
    1.0
}
