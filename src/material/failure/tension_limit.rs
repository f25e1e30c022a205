//! Instantaneous failure at a tension limit.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{FailureLaw, PressureLimit, StrengthBeside, StressState};

/// Instantaneous failure at a tension limit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TensionLimit {
    /// Tension at which a particle fails at once [Pa]. A larger value makes the material stronger.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub stress: f64,
    /// Stress measure that must reach the limit.
    #[serde(default)]
    pub measure: TensionMeasure,
}

/// Stress measure that is compared with a limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TensionMeasure {
    /// Greatest principal stress.
    #[default]
    PrincipalStress,
    /// Mean of the stresses, which is minus the pressure.
    MeanStress,
}

impl TensionMeasure {
    /// Tension at a material point [Pa].
    #[inline(always)]
    pub fn tension(&self, state: &StressState) -> f64 {
        match self {
            TensionMeasure::PrincipalStress => state.greatest_principal_stress(),
            TensionMeasure::MeanStress => -state.pressure,
        }
    }

    /// Whether the tension is minus the pressure, which without strength every principal stress is.
    pub(super) fn is_of_pressure(self, strength: &StrengthBeside) -> bool {
        self == TensionMeasure::MeanStress || !strength.present
    }
}

impl FailureLaw for TensionLimit {
    fn pressure_limit(&self, strength: &StrengthBeside) -> Option<PressureLimit> {
        let limit = PressureLimit { key: "stress", tension: self.stress };
        self.measure.is_of_pressure(strength).then_some(limit)
    }

    #[inline(always)]
    fn damage(&self, before: f64, state: &StressState, _: &StrengthBeside) -> f64 {
        if self.measure.tension(state) >= self.stress { 1.0 } else { before }
    }
}

#[cfg(test)]
mod tests {
    use super::super::stressed;
    use super::*;

    #[test]
    fn limits_of_tension_fail_at_once() {
        let damage = |measure, state: &StressState| {
            TensionLimit { stress: 1e9, measure }.damage(0.0, state, &StrengthBeside::default())
        };
        let principal = |state: &StressState| damage(TensionMeasure::PrincipalStress, state);
        assert_eq!(principal(&stressed(-0.9e9, 0.09e9, 0.0)), 0.0);
        assert_eq!(principal(&stressed(-0.9e9, 0.11e9, 0.0)), 1.0);
        let mean = |state: &StressState| damage(TensionMeasure::MeanStress, state);
        assert_eq!(mean(&stressed(-0.9e9, 0.2e9, 0.0)), 0.0);
        assert_eq!(mean(&stressed(-1.1e9, -0.2e9, 0.0)), 1.0);
        // the greatest stress is zz = -0.5 xx
        assert_eq!(principal(&stressed(-0.9e9, -0.19e9, 0.0)), 0.0);
        assert_eq!(principal(&stressed(-0.9e9, -0.21e9, 0.0)), 1.0);
        let mut across = stressed(-0.9e9, -0.1e9, 0.0);
        (across.deviator.yy, across.deviator.zz) = (-0.1e9, 0.2e9);
        assert_eq!(principal(&across), 1.0);
    }
}
