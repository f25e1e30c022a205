//! Steinberg & Guinan's strength at high rates, where the rate no longer has an influence.
//!
//! ```text
//! g = 1 + A p/eta^(1/3) - B (T - 300),  eta = rho/rho0
//! G = G0 g
//! Y = min(Y0 (1 + beta (ep + ei))^n, Ymax) g
//! ```
//!
//! Neither G nor Y falls below 0. Source: Steinberg, Cochran & Guinan (1980), A constitutive model
//! for metals applicable at high strain rate, eqs. 1 to 3; A = G'p/G0, B = -G'T/G0, and the ratio
//! Y'p/Y0 = A as in the source.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{MaterialState, StrengthLaw};
use crate::material::ParameterError;

/// Steinberg, Cochran & Guinan (1980), for high rates: Y = min(yield_stress (1 + beta (ep +
/// initial_strain))^n, max_yield_stress) g and G = shear_modulus g, with g = 1 + A p/eta^(1/3) - B
/// (T - 300) and the compression eta = rho/rho0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SteinbergGuinan {
    /// Shear modulus G0 at zero pressure and 300 K [Pa].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub shear_modulus: f64,
    /// Yield stress Y0 at zero plastic strain, zero pressure and 300 K [Pa].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub yield_stress: f64,
    /// Hardening coefficient beta, a factor of the plastic strain [-]. With a larger value the
    /// material hardens more.
    #[schemars(range(min = 0.0))]
    pub beta: f64,
    /// Exponent n of the hardening (1 + beta (ep + initial_strain))^n [-]; 0: no hardening.
    #[schemars(range(min = 0.0, max = 5.0))]
    pub n: f64,
    /// Equivalent plastic strain that the material has before the start, for its hardening only
    /// [-]; default 0.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub initial_strain: f64,
    /// Greatest yield stress that hardening reaches at zero pressure and 300 K [Pa]; at least
    /// `yield_stress`.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub max_yield_stress: f64,
    /// Growth of shear modulus and yield stress with pressure, A = G'p/G0 [1/Pa].
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub pressure_hardening: f64,
    /// Decrease of shear modulus and yield stress with temperature above 300 K, B = -G'T/G0 [1/K],
    /// which needs `thermal`; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub temperature_softening: Option<f64>,
}

impl SteinbergGuinan {
    #[inline(always)]
    fn growth(&self, at: &MaterialState) -> f64 {
        let pressed = self.pressure_hardening * at.pressure / at.compression.cbrt();
        let warm = self.temperature_softening.map_or(0.0, |b| b * (at.temperature - 300.0));
        (1.0 + pressed - warm).max(0.0)
    }
}

impl StrengthLaw for SteinbergGuinan {
    fn needs_temperature(&self) -> Option<&'static str> {
        self.temperature_softening.map(|_| "temperature_softening")
    }

    fn check(&self) -> Result<(), ParameterError> {
        if self.max_yield_stress < self.yield_stress {
            let reason =
                format!("below yield_stress = {}; allowed: at least as much", self.yield_stress);
            let key = "max_yield_stress";
            return Err(ParameterError::new(key, self.max_yield_stress, reason));
        }
        Ok(())
    }

    #[inline(always)]
    fn shear_modulus(&self, at: &MaterialState) -> f64 {
        self.shear_modulus * self.growth(at)
    }

    #[inline(always)]
    fn yield_stress(&self, strain: f64, _: f64, at: &MaterialState) -> f64 {
        let hardened = (1.0 + self.beta * (strain + self.initial_strain)).powf(self.n);
        (self.yield_stress * hardened).min(self.max_yield_stress) * self.growth(at)
    }
}

/// Copper, Steinberg (1996).
#[cfg(test)]
pub(super) const COPPER: SteinbergGuinan = SteinbergGuinan {
    shear_modulus: 47.7e9,
    yield_stress: 0.12e9,
    beta: 36.0,
    n: 0.45,
    initial_strain: 0.0,
    max_yield_stress: 0.64e9,
    pressure_hardening: 28.3e-12,
    temperature_softening: Some(0.377e-3),
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_moduli_follow_the_paper() {
        let model = COPPER;
        let at = MaterialState { compression: 1.331, pressure: 30e9, temperature: 700.0 };
        let growth = 1.0 + 28.3e-12 * 30e9 / 1.1 - 0.377e-3 * 400.0;
        assert!((model.shear_modulus(&at) / (47.7e9 * growth) - 1.0).abs() < 1e-14);
        let y = |strain| model.yield_stress(strain, 0.0, &at);
        assert!((y(0.1) / (0.12e9 * 4.6f64.powf(0.45) * growth) - 1.0).abs() < 1e-14);
        assert!((y(9.0) / (0.64e9 * growth) - 1.0).abs() < 1e-14, "the most");
        let hot = MaterialState { temperature: 9000.0, ..at };
        assert_eq!((model.shear_modulus(&hot), model.yield_stress(0.1, 0.0, &hot)), (0.0, 0.0));
    }
}
