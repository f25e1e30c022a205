//! Tuler & Butcher's cumulative damage: failure needs a tension above a threshold for some time
//!
//! ```text
//! D = 1/K sum max(0, s - s0)^lambda dt
//! ```
//!
//! s is the greatest principal stress or the tension, as `measure` says. Source: Tuler & Butcher (1968), A criterion for the time
//! dependence of dynamic fracture, Int. J. Fract. Mech. 4, 431, eq. 1.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{FailureLaw, PressureLimit, StrengthBeside, StressState, TensionMeasure};

/// Tuler & Butcher (1968): failure when the time integral of (tension - threshold)^exponent reaches
/// `impulse`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TulerButcher {
    /// Tension s0 below which no damage accumulates, however long it acts [Pa].
    #[schemars(range(min = 0.0))]
    pub threshold: f64,
    /// Exponent lambda of the tension above the threshold [-]. With a larger value the time to
    /// failure falls faster with the tension.
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 10.0))]
    pub exponent: f64,
    /// Value K of the integral at which the material fails [Pa^exponent s]. With a larger value
    /// failure takes longer.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub impulse: f64,
    /// Stress measure that must exceed the threshold.
    #[serde(default)]
    pub measure: TensionMeasure,
}

impl FailureLaw for TulerButcher {
    fn pressure_limit(&self, strength: &StrengthBeside) -> Option<PressureLimit> {
        let limit = PressureLimit { key: "threshold", tension: self.threshold };
        self.measure.is_of_pressure(strength).then_some(limit)
    }

    #[inline(always)]
    fn damage(&self, before: f64, state: &StressState, _: &StrengthBeside) -> f64 {
        let above = self.measure.tension(state) - self.threshold;
        if above <= 0.0 {
            return before;
        }
        (before + above.powf(self.exponent) * state.dt / self.impulse).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::stressed;
    use super::*;

    /// Under constant tension the material fails after the time K/(s - s0)^lambda.
    #[test]
    fn a_constant_tension_fails_in_the_time_of_the_integral() {
        let law = TulerButcher {
            threshold: 1e9,
            exponent: 2.0,
            impulse: (0.5e9f64).powi(2) * 1e-6,
            measure: TensionMeasure::MeanStress,
        };
        let strength = StrengthBeside::default();
        let (mut damage, mut steps) = (0.0, 0);
        while damage < 1.0 {
            damage = law.damage(damage, &stressed(-1.5e9, 0.0, 0.0), &strength);
            steps += 1;
        }
        // 1 us in steps of 10 ns
        assert!((99..=101).contains(&steps), "{steps}");
        assert_eq!(law.damage(0.3, &stressed(-1e9, 0.0, 0.0), &strength), 0.3);
        let principal = TulerButcher { measure: TensionMeasure::PrincipalStress, ..law };
        let half = principal.damage(0.0, &stressed(-1.0e9, 0.25e9, 0.0), &strength);
        assert!((half - 0.25 * 0.01).abs() < 1e-15, "{half}");
    }
}
