//! Error models of the quantities that a plan can target: one file per quantity, one line per quantity
//! in `scene/model/planned_quantity.rs`.

use super::data::{SchemeAccuracy, Size};
use crate::accuracy::estimate::{Bounded, EstimatedErrors};
use crate::scene::{PlannedQuantity, planned_quantities};

/// Smallest number of cells of a plateau, or of the distance to an arrival position.
const LEAST_PLATEAU: f64 = 26.0;

/// Lengths of a scene that scale its errors.
pub(super) struct ErrorScale {
    /// Shortest pulse of the profiles [m].
    pub pulse: f64,
    /// Shortest plateau [m].
    pub plateau: Option<f64>,
    /// Distance of the wave to the arrival position [m].
    pub way: Option<f64>,
}

/// Error model of a quantity.
trait ErrorModel {
    /// Whether the quantity belongs to a position of the scene.
    const AT_PLACE: bool = false;

    /// Expected relative error on cells of size `h` [m]; `None` without the length that scales it.
    fn error(m: &SchemeAccuracy, scale: &ErrorScale, h: f64) -> Option<Size>;

    /// Largest cell size [m] at which the relative error is at most `error` in 19 of 20 runs.
    fn cells_for(m: &SchemeAccuracy, scale: &ErrorScale, error: f64) -> Option<f64>;

    /// Relative errors of a finished run, each with whether it is true and not estimated; `exact_l1`
    /// is the L1 of each profile against the exact solution.
    fn actual(exact_l1: &[f64], estimate: Option<&EstimatedErrors>) -> Vec<(f64, bool)>;
}

macro_rules! dispatch {
    ($($(#[doc = $doc:literal])+ $module:ident::$name:ident,)+) => {
        $(mod $module;)+

        impl PlannedQuantity {
            /// Whether the quantity belongs to a position of the scene.
            pub(super) fn at_place(self) -> bool {
                match self { $(PlannedQuantity::$name => $module::$name::AT_PLACE,)+ }
            }

            /// See [`ErrorModel::error`].
            pub(super) fn error(
                self,
                m: &SchemeAccuracy,
                scale: &ErrorScale,
                h: f64,
            ) -> Option<Size> {
                match self { $(PlannedQuantity::$name => $module::$name::error(m, scale, h),)+ }
            }

            /// See [`ErrorModel::cells_for`].
            pub(super) fn cells_for(
                self,
                m: &SchemeAccuracy,
                scale: &ErrorScale,
                error: f64,
            ) -> Option<f64> {
                match self { $(PlannedQuantity::$name => $module::$name::cells_for(m, scale, error),)+ }
            }

            /// See [`ErrorModel::actual`].
            pub(super) fn actual(
                self,
                exact_l1: &[f64],
                estimate: Option<&EstimatedErrors>,
            ) -> Vec<(f64, bool)> {
                match self { $(PlannedQuantity::$name => $module::$name::actual(exact_l1, estimate),)+ }
            }
        }
    };
}
planned_quantities!(dispatch);

/// Relative error of a value with an exact one, or its relative bound.
fn relative(b: &Bounded) -> Option<(f64, bool)> {
    match (b.exact, b.half_width) {
        (Some(exact), _) => Some(((b.value - exact).abs() / exact.abs(), true)),
        (None, Some(width)) => Some((width / b.value.abs(), false)),
        _ => None,
    }
}
