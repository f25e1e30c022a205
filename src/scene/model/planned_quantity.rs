//! Quantities whose error can be planned.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Passes the list of quantities, `module::Name`, to the macro `callback`: the name in a scene here,
/// the model of its error in `crate::accuracy::plan::quantities`.
macro_rules! planned_quantities {
    ($callback:ident) => {
        $callback! {
            /// Pressure on the plateau behind the shock.
            plateau_pressure::PlateauPressure,
            /// Relative L1 error of the pressure in each profile.
            l1::L1,
            /// Arrival time at a position.
            arrival_time::ArrivalTime,
        }
    };
}
pub(crate) use planned_quantities;

macro_rules! define {
    ($($(#[doc = $doc:literal])+ $module:ident::$name:ident,)+) => {
        /// Quantity whose error is planned.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
        #[serde(rename_all = "snake_case")]
        pub enum PlannedQuantity {
            $($(#[doc = $doc])+ $name,)+
        }
    };
}
planned_quantities!(define);
