//! Johnson & Cook's yield stress.
//!
//! ```text
//! Y = (A + B ep^n) (1 + C ln max(1, rate/rate0)) (1 - T*^m)
//! T* = (T - T0)/(Tm - T0), between 0 and 1
//! ```
//!
//! Source: Johnson & Cook (1983), A constitutive model and data for metals subjected to large
//! strains, high strain rates and high temperatures, eqs. 1 and 2. Below the reference rate, where
//! the logarithm would be negative, the rate has no influence.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{MaterialState, StrengthLaw, one};
use crate::material::ParameterError;

/// Johnson & Cook (1983), Y = (a + b ep^n)(1 + c ln max(1, rate/reference_rate))(1 - T*^m).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JohnsonCook {
    /// Shear modulus G, the elastic shear stress over the shear strain [Pa]. It is constant.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub shear_modulus: f64,
    /// Yield stress at zero plastic strain, at the reference rate and the reference temperature
    /// [Pa].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub a: f64,
    /// Hardening coefficient [Pa]: increase of the yield stress at a plastic strain of 1.
    #[schemars(range(min = 0.0))]
    pub b: f64,
    /// Exponent of the plastic strain ep in the hardening b ep^n [-]. With a smaller value the
    /// material hardens earlier.
    #[schemars(range(max = 5.0), extend("exclusiveMinimum" = 0.0))]
    pub n: f64,
    /// Coefficient of the logarithm of the strain rate [-]; default 0. With a larger value the
    /// yield stress grows more with the rate.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub c: f64,
    /// Strain rate below which the rate has no influence [1/s].
    #[serde(default = "one")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub reference_rate: f64,
    /// Thermal softening, which needs `thermal`; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub softening: Option<Softening>,
}

/// Thermal softening, 1 - T*^m with T* = (T - reference)/(melt - reference).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Softening {
    /// Exponent m of the homologous temperature T* [-]. With a larger value the yield stress falls
    /// later, nearer to melting.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub m: f64,
    /// Temperature below which there is no softening [K].
    #[schemars(range(min = 0.0))]
    pub reference_temperature: f64,
    /// Temperature at which the material melts and its yield stress is 0 [K]; above
    /// `reference_temperature`.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub melt_temperature: f64,
}

impl Softening {
    /// 1 - T*^m at a temperature [K].
    #[inline(always)]
    fn factor(&self, temperature: f64) -> f64 {
        let range = self.melt_temperature - self.reference_temperature;
        let warm = ((temperature - self.reference_temperature) / range).clamp(0.0, 1.0);
        1.0 - if warm > 0.0 { warm.powf(self.m) } else { 0.0 }
    }
}

impl StrengthLaw for JohnsonCook {
    fn check(&self) -> Result<(), ParameterError> {
        let Some(softening) = self.softening else { return Ok(()) };
        if softening.melt_temperature <= softening.reference_temperature {
            let reason = format!(
                "not above reference_temperature = {}; allowed: a higher temperature",
                softening.reference_temperature
            );
            let key = "softening.melt_temperature";
            return Err(ParameterError::new(key, softening.melt_temperature, reason));
        }
        Ok(())
    }

    fn needs_temperature(&self) -> Option<&'static str> {
        self.softening.map(|_| "softening")
    }

    fn softening_range(&self) -> Option<[f64; 2]> {
        self.softening.map(|s| [s.reference_temperature, s.melt_temperature])
    }

    #[inline(always)]
    fn shear_modulus(&self, _: &MaterialState) -> f64 {
        self.shear_modulus
    }

    #[inline(always)]
    fn yield_stress(&self, strain: f64, rate: f64, at: &MaterialState) -> f64 {
        let hardened = if strain > 0.0 { self.b * strain.powf(self.n) } else { 0.0 };
        let fast = (rate / self.reference_rate).max(1.0).ln();
        let softened = self.softening.map_or(1.0, |s| s.factor(at.temperature));
        (self.a + hardened) * (1.0 + self.c * fast) * softened
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_factor_is_that_of_the_paper() {
        let model = JohnsonCook {
            shear_modulus: 46e9,
            a: 90e6,
            b: 292e6,
            n: 0.31,
            c: 0.025,
            reference_rate: 1.0,
            softening: Some(Softening {
                m: 1.09,
                reference_temperature: 294.0,
                melt_temperature: 1356.0,
            }),
        };
        let at = |temperature: f64| MaterialState { compression: 1.0, pressure: 0.0, temperature };
        let y = |strain, rate, t| model.yield_stress(strain, rate, &at(t));
        assert_eq!(y(0.0, 0.0, 294.0), 90e6);
        assert!((y(0.3, 1.0, 294.0) - (90e6 + 292e6 * 0.3f64.powf(0.31))).abs() < 1e-3);
        assert!((y(0.0, 1e4, 294.0) / (90e6 * (1.0 + 0.025 * 1e4f64.ln())) - 1.0).abs() < 1e-14);
        let warm: f64 = (800.0 - 294.0) / (1356.0 - 294.0);
        assert!((y(0.0, 1.0, 800.0) / (90e6 * (1.0 - warm.powf(1.09))) - 1.0).abs() < 1e-14);
        assert_eq!(y(0.5, 1e6, 1400.0), 0.0);
        assert_eq!(y(0.5, 1e-9, 294.0), y(0.5, 1.0, 294.0));
    }
}
