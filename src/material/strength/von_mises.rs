//! Yield stress that grows linearly with the plastic strain, or is constant.
//!
//! ```text
//! Y = Y0 + H ep
//! ```
//!
//! Source: von Mises (1913).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{MaterialState, StrengthLaw};

/// Von Mises' yield surface, Y = yield_stress + hardening ep.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VonMises {
    /// Shear modulus G, the elastic shear stress over the shear strain [Pa]. It is constant.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub shear_modulus: f64,
    /// Yield stress at zero plastic strain [Pa].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub yield_stress: f64,
    /// Increase of the yield stress per equivalent plastic strain [Pa]; default 0: perfect
    /// plasticity.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub hardening: f64,
}

impl StrengthLaw for VonMises {
    #[inline(always)]
    fn shear_modulus(&self, _: &MaterialState) -> f64 {
        self.shear_modulus
    }

    #[inline(always)]
    fn yield_stress(&self, strain: f64, _: f64, _: &MaterialState) -> f64 {
        self.yield_stress + self.hardening * strain
    }
}
