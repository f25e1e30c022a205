//! Materials and bodies.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::VelocityField;

/// A material.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Density at rest [kg/m3].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub density: f64,
    /// Equation of state.
    pub eos: Eos,
}

/// Equations of state by type.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Eos {
    /// Mie-Grueneisen solid about the Hugoniot Us = c0 + s up, with gamma0 rho0 constant.
    MieGruneisen {
        /// Bulk sound speed at rest [m/s].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        c0: f64,
        /// Slope of the Us-up line [-].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        s: f64,
        /// Grueneisen coefficient at rest [-].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        gamma0: f64,
    },
    /// Ideal gas, p = (gamma - 1) rho e.
    IdealGas {
        /// Ratio of specific heats [-].
        #[schemars(extend("exclusiveMinimum" = 1.0))]
        gamma: f64,
    },
    /// Elastic solid, linear in the logarithmic strain: Hooke's law where strains are small.
    LinearElastic {
        /// Young's modulus [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        youngs_modulus: f64,
        /// Poisson's ratio [-].
        #[schemars(extend("exclusiveMinimum" = -1.0, "exclusiveMaximum" = 0.5))]
        poissons_ratio: f64,
    },
    /// Neo-Hookean solid, sigma = (lambda ln J 1 + mu (F F^T - 1))/J.
    NeoHookean {
        /// Young's modulus where strains are small [Pa].
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        youngs_modulus: f64,
        /// Poisson's ratio where strains are small [-].
        #[schemars(extend("exclusiveMinimum" = -1.0, "exclusiveMaximum" = 0.5))]
        poissons_ratio: f64,
    },
}

impl Eos {
    /// Whether the material bears shear: its stress is a tensor.
    pub fn is_solid(&self) -> bool {
        matches!(self, Eos::LinearElastic { .. } | Eos::NeoHookean { .. })
    }
}

/// A body: a box of one material, filled with particles.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Name, unlike that of any other body.
    pub name: String,
    /// Name of its material.
    pub material: String,
    /// Where it lies at the start.
    #[serde(rename = "box")]
    pub extent: BoxShape,
    /// Velocity at the start [m/s]; absent: at rest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity: Option<Vec<f64>>,
    /// Velocity at the start as a function of place, instead of `velocity`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_field: Option<VelocityField>,
    /// Pressure at the start [Pa], reached at the material's density by its internal energy.
    #[serde(default)]
    pub pressure: f64,
    /// Particles a cell in each direction.
    #[schemars(inner(range(min = 1)))]
    pub particles_per_cell: Vec<usize>,
}

/// A box.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxShape {
    /// Lower corner [m].
    pub lower: Vec<f64>,
    /// Upper corner [m].
    pub upper: Vec<f64>,
}
