//! Half-widths from the differences between a run and coarse runs of the same scene.
//!
//! At a shock the error of a run is of first order in the cell size, so that a run with cells f times
//! as large differs from it by f - 1 times its error. The error that the differences suggest is the
//! greatest over the coarse runs; times a factor of safety it is the half-width, as in the grid
//! convergence index (Roache 1994). Smooth solutions converge faster, and their half-widths are too
//! large. The factors were chosen on random scenes (section `accuracy/scenes` of the acceptance
//! program) and are not validated for other scenes: such an estimate is always a guess.

use super::bounded::Bounded;
use super::coarse_results::{CoarseRun, CoarseRuns};
use super::indicators::Evidence;

/// Factor of safety on the L1 error of a field or of a history \[-\].
const L1_SAFETY: f64 = 2.0;

/// Factor of safety on the error of a single value \[-\]. Two runs can agree in a value by chance.
const VALUE_SAFETY: f64 = 2.5;

/// Least half-width relative to the value: differences below it are rounding \[-\].
const ROUNDING: f64 = 1e-9;

/// Relative differences \[-\] from coarse runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Differences(
    /// Nominal and actual cell size of each coarse run over that of the scene, and the difference.
    Vec<([f64; 2], f64)>,
);

impl Differences {
    /// The finite ones of the differences that `of` finds; `None` if there are none.
    pub fn new(
        coarse_runs: &CoarseRuns,
        of: impl Fn(&CoarseRun) -> Option<f64>,
    ) -> Option<Differences> {
        let one = |coarse: &CoarseRun| {
            let difference = of(coarse).filter(|difference| difference.is_finite())?;
            Some(([coarse.factor, coarse.ratio], difference))
        };
        let known: Vec<([f64; 2], f64)> = coarse_runs.done.iter().filter_map(one).collect();
        (!known.is_empty()).then_some(Differences(known))
    }

    /// The relative error that they suggest \[-\].
    pub fn error(&self) -> f64 {
        self.0.iter().map(|([_, ratio], difference)| difference / (ratio - 1.0)).fold(0.0, f64::max)
    }

    /// The differences as indicators.
    fn evidence(&self) -> Evidence {
        self.0.iter().map(|([factor, _], d)| (format!("difference_{factor}"), *d)).collect()
    }

    /// Bound of the L1 error of a field or of a history \[-\], `widened` by a further factor.
    pub fn l1(&self, widened: f64) -> Bounded {
        let half_width = (widened * L1_SAFETY * self.error()).max(ROUNDING);
        Bounded { value: 0.0, half_width: Some(half_width), evidence: self.evidence(), exact: None }
    }

    /// `value` with its half-width, which has `least` added, both in the unit of the value.
    pub fn value(&self, value: f64, least: f64) -> Bounded {
        let half_width = (VALUE_SAFETY * self.error()).max(ROUNDING) * value.abs() + least;
        Bounded { value, half_width: Some(half_width), evidence: self.evidence(), exact: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Differences from coarse runs of these nominal and actual ratios.
    fn differences(all: &[([f64; 2], f64)]) -> Option<Differences> {
        let run = |&([factor, ratio], cell_size): &([f64; 2], f64)| CoarseRun {
            factor,
            ratio,
            // holds the difference in this test
            cell_size,
            ..CoarseRun::default()
        };
        let done = all.iter().map(run).collect();
        Differences::new(&CoarseRuns { done, ..CoarseRuns::default() }, |coarse| {
            Some(coarse.cell_size)
        })
    }

    #[test]
    fn a_first_order_error_gives_the_same_half_width_with_any_coarse_run() {
        // the error of the run is 0.01
        let near = |all: &[([f64; 2], f64)], error: f64| {
            let all = differences(all).unwrap();
            let l1 = all.l1(3.0).half_width.unwrap();
            assert!((l1 - 3.0 * L1_SAFETY * error).abs() < 1e-12, "{l1}");
            let value = all.value(-5.0, 0.1).half_width.unwrap();
            assert!((value - 5.0 * VALUE_SAFETY * error - 0.1).abs() < 1e-12, "{value}");
        };
        near(&[([2.0, 2.0], 0.01)], 0.01);
        near(&[([4.0, 4.0], 0.03)], 0.01);
        near(&[([4.0, 3.5], 0.025)], 0.01);
        near(&[([4.0, 4.0], 0.03), ([2.0, 2.0], 0.002)], 0.01);
        near(&[([4.0, 4.0], 0.03), ([2.0, 2.0], 0.02)], 0.02);
        near(&[([4.0, 4.0], f64::NAN), ([2.0, 2.0], 0.01)], 0.01);
        assert_eq!(differences(&[([2.0, 2.0], f64::NAN)]), None);
    }

    #[test]
    fn runs_that_agree_leave_rounding() {
        let all = differences(&[([2.0, 2.0], 0.0)]).unwrap();
        assert_eq!(all.l1(1.0).half_width, Some(ROUNDING));
        assert_eq!(all.value(3.0, 0.0).half_width, Some(3.0 * ROUNDING));
    }
}
