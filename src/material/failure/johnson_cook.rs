//! Johnson & Cook's damage D: the sum of plastic strain over the strain at fracture
//!
//! ```text
//! ef = (D1 + D2 exp(D3 s*)) (1 + D4 ln max(1, rate/rate0)) (1 + D5 T*)
//! ```
//!
//! s* is the mean tension over the equivalent stress, at most 1.5. T* rises from 0 to 1 between the
//! temperatures of the material's strength. Source: Johnson & Cook (1985), Fracture characteristics
//! of three metals, eqs. 3 and 4.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{FailureLaw, StrengthBeside, StressState, one};
use crate::material::ParameterError;
use crate::material::strength::equivalent;

/// Johnson & Cook (1985): damage is the sum of plastic strain over the strain at fracture, (d1 + d2
/// exp(d3 s*))(1 + d4 ln max(1, rate/reference_rate))(1 + d5 T*); needs `strength`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JohnsonCookFracture {
    /// Part d1 of the strain at fracture that does not depend on the stress [-]; default 0. A
    /// larger value makes the material more ductile.
    #[serde(default)]
    pub d1: f64,
    /// Coefficient d2 of the part of the strain at fracture that depends on the triaxiality s*, the
    /// mean tension over the equivalent stress [-]; default 0.
    #[serde(default)]
    pub d2: f64,
    /// Factor d3 of the triaxiality in the exponential [-]; default 0. With a negative d3 and a
    /// positive d2 the strain at fracture falls with tension.
    #[serde(default)]
    pub d3: f64,
    /// Coefficient d4 of the logarithm of the strain rate [-]; default 0. With a larger value the
    /// strain at fracture grows more with the rate.
    #[serde(default)]
    pub d4: f64,
    /// Coefficient of the temperature, which needs `thermal` and the strength's `softening` [-].
    #[serde(default)]
    pub d5: f64,
    /// Strain rate below which the rate has no influence [1/s].
    #[serde(default = "one")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub reference_rate: f64,
}

impl JohnsonCookFracture {
    /// Plastic strain at fracture [-], limited from below to a tiny value.
    fn fracture_strain(
        &self,
        triaxiality: f64,
        rate: f64,
        temperature: f64,
        softening_range: Option<[f64; 2]>,
    ) -> f64 {
        let fast = (rate / self.reference_rate).max(1.0).ln();
        let warm = softening_range
            .map_or(0.0, |[room, melt]| ((temperature - room) / (melt - room)).clamp(0.0, 1.0));
        let strain = (self.d1 + self.d2 * (self.d3 * triaxiality.min(1.5)).exp())
            * (1.0 + self.d4 * fast)
            * (1.0 + self.d5 * warm);
        strain.max(1e-6)
    }
}

impl FailureLaw for JohnsonCookFracture {
    fn check(&self, strength: &StrengthBeside) -> Result<(), ParameterError> {
        if !strength.present {
            let reason = "needs plastic strain; allowed: \"tension_limit\", or strength beside it";
            return Err(ParameterError::new("type", "johnson_cook", reason));
        }
        if self.d1 + self.d2.max(0.0) <= 0.0 {
            let reason = format!(
                "with d2 = {} the material breaks at no strain at all; allowed: d1 + d2 above 0",
                self.d2
            );
            return Err(ParameterError::new("d1", self.d1, reason));
        }
        if self.d5 != 0.0 && strength.softening_range.is_none() {
            let reason = "needs the temperatures of strength.softening of \"johnson_cook\"; \
                          allowed: 0, or those";
            return Err(ParameterError::new("d5", self.d5, reason));
        }
        Ok(())
    }

    #[inline(always)]
    fn damage(&self, before: f64, state: &StressState, strength: &StrengthBeside) -> f64 {
        if state.plastic_strain <= 0.0 {
            return before;
        }
        let size = equivalent(&state.deviator);
        let triaxiality = if size > 0.0 { -state.pressure / size } else { 1.5 };
        let rate = state.plastic_strain / state.dt;
        let range = strength.softening_range;
        let fracture = self.fracture_strain(triaxiality, rate, state.temperature, range);
        (before + state.plastic_strain / fracture).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::stressed;
    use super::*;

    #[test]
    fn damage_is_plastic_strain_over_that_at_fracture() {
        // OFHC copper
        let law = JohnsonCookFracture {
            d1: 0.54,
            d2: 4.89,
            d3: -3.03,
            d4: 0.014,
            d5: 1.12,
            reference_rate: 1.0,
        };
        let range = Some([294.0, 1356.0]);
        let strength = StrengthBeside { present: true, softening_range: range };
        let damage = |before, state| law.damage(before, &state, &strength);
        let warm = (300.0 - 294.0) / (1356.0 - 294.0);
        let rate: f64 = 0.001 / 1e-8;
        let triaxial: f64 = 0.2e9 / 0.3e9;
        let fracture = (0.54 + 4.89 * (-3.03 * triaxial).exp())
            * (1.0 + 0.014 * rate.ln())
            * (1.0 + 1.12 * warm);
        let after = damage(0.25, stressed(-0.2e9, 0.2e9, 0.001));
        assert!((after - (0.25 + 0.001 / fracture)).abs() < 1e-15, "{after}");
        assert_eq!(damage(0.25, stressed(-0.2e9, 0.2e9, 0.0)), 0.25);
        let most = law.fracture_strain(1.5, rate, 300.0, range);
        let bounded = law.fracture_strain(2.5, rate, 300.0, range);
        assert_eq!(bounded, most, "triaxiality is bounded");
        assert_eq!(damage(0.9999999, stressed(-0.2e9, 0.2e9, 0.1)), 1.0);
    }
}
