//! Error models of the quantities that a plan can target: one file per quantity, one line per quantity
//! in `scene/model/planned_quantity.rs`.

use super::data::{ErrorLaws, ImpactIndicators, SchemeAccuracy, Size};
use crate::accuracy::estimate::{Bounded, EstimatedErrors};
use crate::scene::{PlannedQuantity, planned_quantities};

/// Number of steps of the search from the largest cell size to the smallest.
const SIZES: usize = 60;

/// Lengths and strength of the impact that scale the errors of a scene.
pub(super) struct ErrorScale {
    /// Shortest pulse of the profiles [m].
    pub pulse: f64,
    /// Shortest plateau [m], or the reason why there is none.
    pub plateau: Result<f64, String>,
    /// Shortest plateau that the plan accepts [cells].
    pub least_plateau: f64,
    /// Distance of the wave to the arrival position [m].
    pub way: Option<f64>,
    /// Pressure behind the shock over the density times the square of the sound speed [-].
    pub strength: f64,
    /// Exact compressions of the struck and of the striking body [-], if the waves are known.
    pub compressions: Option<[f64; 2]>,
    /// Thickness of the striking body [m], if there are two bodies.
    pub other_thickness: Option<f64>,
}

/// Error model of a quantity.
trait ErrorModel {
    /// Whether the quantity belongs to a position of the scene.
    const AT_PLACE: bool = false;

    /// Measured relative errors of a scheme.
    fn laws(m: &SchemeAccuracy) -> &ErrorLaws;

    /// Length that scales the error [m]; the error is the reason why there is none.
    fn length(scale: &ErrorScale) -> Result<f64, String>;

    /// Smallest number of cells in that length.
    fn least_cells(_: &ErrorScale) -> f64 {
        4.0
    }

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

            /// See [`ErrorModel::least_cells`].
            fn least_cells(self, scale: &ErrorScale) -> f64 {
                match self { $(PlannedQuantity::$name => $module::$name::least_cells(scale),)+ }
            }

            fn laws(self, m: &SchemeAccuracy) -> &ErrorLaws {
                match self { $(PlannedQuantity::$name => $module::$name::laws(m),)+ }
            }

            /// See [`ErrorModel::length`].
            pub(super) fn length(self, scale: &ErrorScale) -> Result<f64, String> {
                match self { $(PlannedQuantity::$name => $module::$name::length(scale),)+ }
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

impl PlannedQuantity {
    /// Expected relative error on cells of size `h` [m]; `None` without the length that scales it.
    pub(super) fn error(self, m: &SchemeAccuracy, scale: &ErrorScale, h: f64) -> Option<Size> {
        let length = self.length(scale).ok()?;
        let impact = ImpactIndicators {
            strength: scale.strength,
            compressions: scale.compressions,
            other_thickness: scale.other_thickness.map(|thickness| thickness / length),
        };
        self.laws(m).at(length / h, &impact)
    }

    /// Cell sizes between `least` and `greatest` [m], the largest first; none if the length that scales
    /// the error has too few of the smallest cells.
    pub(super) fn sizes(
        self,
        scale: &ErrorScale,
        [least, greatest]: [f64; 2],
    ) -> impl Iterator<Item = f64> {
        let longest = self.length(scale).map_or(0.0, |length| length / self.least_cells(scale));
        let greatest = greatest.min(longest);
        let size = move |k: usize| greatest * (least / greatest).powf(k as f64 / SIZES as f64);
        (0..=SIZES).map(size).filter(move |_| greatest >= least)
    }

    /// Largest cell size [m] between `least` and `greatest` [m] at which the relative error is at
    /// most `error` in 19 of 20 runs; `None` if there is none.
    pub(super) fn cells_for(
        self,
        m: &SchemeAccuracy,
        scale: &ErrorScale,
        error: f64,
        limits: [f64; 2],
    ) -> Option<f64> {
        let reaches = |h: f64| self.error(m, scale, h).is_some_and(|size| size.most <= error);
        // a law can rise again for small cells: the search starts from the largest size
        let sizes: Vec<f64> = self.sizes(scale, limits).collect();
        let first = sizes.iter().position(|&h| reaches(h))?;
        let (mut fine, mut coarse) = (sizes[first], sizes[first.saturating_sub(1)]);
        for _ in 0..40 {
            let middle = (fine * coarse).sqrt();
            if reaches(middle) { fine = middle } else { coarse = middle }
        }
        Some(fine)
    }
}

/// Relative error of a value with an exact one, or its relative bound.
fn relative(b: &Bounded) -> Option<(f64, bool)> {
    match (b.exact, b.half_width) {
        (Some(exact), _) => Some(((b.value - exact).abs() / exact.abs(), true)),
        (None, Some(width)) => Some((width / b.value.abs(), false)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::estimate::QuantityLaws;
    use crate::accuracy::estimate::error_model::Law;

    /// A scheme whose errors of the L1 are least, 0.01, at 40 cells, and four times as large at 10 and at
    /// 160 cells.
    fn scheme() -> SchemeAccuracy {
        let middle = 40.0_f64.ln();
        let square = 1.0 / 4.0_f64.ln();
        let law = Law {
            evidence: ["cells", "cells*cells"].map(String::from).to_vec(),
            weights: vec![0.01_f64.ln() + square * middle * middle, -2.0 * square * middle, square],
            factor: 1.0,
            cases: 1,
            ranges: [("cells".to_string(), [5.0, 500.0])].into(),
        };
        let laws = || QuantityLaws(vec![law.clone()]);
        let both = || ErrorLaws { median: laws(), most: laws() };
        SchemeAccuracy { l1: both(), plateau: both(), arrival: both(), runs: 1 }
    }

    #[test]
    fn the_largest_size_that_reaches_the_error_is_found() {
        let scale = ErrorScale {
            pulse: 1.0,
            plateau: Err("none".into()),
            least_plateau: 10.0,
            way: None,
            strength: 0.1,
            compressions: None,
            other_thickness: None,
        };
        let sizes = |quantity: PlannedQuantity, error: f64, limits: [f64; 2]| {
            quantity.cells_for(&scheme(), &scale, error, limits)
        };
        let l1 = |error, limits| sizes(PlannedQuantity::L1, error, limits);
        // between 10 and 160 cells the error is at most 0.04; smaller cells do not reach it again
        for limits in [[0.001, 0.2], [1e-9, f64::INFINITY]] {
            assert!((l1(0.04, limits).unwrap() - 0.1).abs() < 1e-9);
        }
        assert_eq!(l1(0.04, [0.001, 0.05]), Some(0.05));
        assert_eq!(l1(0.009, [0.001, 0.2]), None);
        assert_eq!(l1(0.04, [0.3, 1.0]), None, "fewer than four cells in the pulse");
        assert_eq!(sizes(PlannedQuantity::PlateauPressure, 0.04, [0.001, 0.2]), None);
    }
}
