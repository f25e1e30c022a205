//! Measures of a patch's load for the balance between ranks: one file per rule, one line per rule in
//! the list below.
//!
//! Independent of particles, fields and messages.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Defines the rules from a list of `module::Name,`: their names in scenes and the function `cost`
/// of their modules.
macro_rules! balance_costs {
    ($($(#[doc = $doc:literal])+ $module:ident::$name:ident,)+) => {
        $(mod $module;)+

        /// Measure of a patch's load.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
        #[serde(rename_all = "snake_case")]
        pub enum BalanceCost {
            $($(#[doc = $doc])+ $name,)+
        }

        impl BalanceCost {
            /// Cost of a step of a patch, in a unit of the rule; 0 without work.
            pub fn of(self, load: &PatchLoad) -> u64 {
                match self { $(BalanceCost::$name => $module::cost(load),)+ }
            }

            /// Whether the rule needs the computing time of patches.
            pub fn measures_time(self) -> bool {
                match self { $(BalanceCost::$name => $module::MEASURES_TIME,)+ }
            }
        }
    };
}

balance_costs! {
    /// Measured and smoothed computing time of the patch.
    time::Time,
    /// Number of particles that the patch computes; the migration is then the same in every run.
    particles::Particles,
}

/// Load of a patch in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchLoad {
    /// Number of particles that it computes; 0 for a quiescent patch.
    pub particles: u64,
    /// Measured and smoothed computing time [s]; `None` before the first measurement.
    pub seconds: Option<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_rule_measures_its_own_load() {
        let load = PatchLoad { particles: 40, seconds: Some(2.5e-6) };
        assert_eq!(BalanceCost::Time.of(&load), 2500);
        assert_eq!(BalanceCost::Time.of(&PatchLoad { seconds: None, ..load }), 40);
        assert_eq!(BalanceCost::Particles.of(&load), 40);
        assert!(BalanceCost::Time.measures_time() && !BalanceCost::Particles.measures_time());
    }
}
