//! Error estimates of gauges: of their histories, and of the values that are read from these.

use serde::{Deserialize, Serialize};

use super::bounded::Bounded;
use super::coarse_results::CoarseRuns;
use super::differences::Differences;
use super::gauge_records::{GaugeHistory, GaugeRecords, Reading, ReadingKind};
use super::range::EstimateBasis;

/// Error estimate of a history.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HistoryEstimate {
    /// Name of the gauge.
    pub gauge: String,
    /// Name of the quantity.
    pub quantity: String,
    /// Always a guess, from the differences to the coarse runs.
    pub basis: EstimateBasis,
    /// Integral of the magnitude of the error over time, over that of the quantity \[-\]: the value
    /// is 0 (no error), the half-width is the bound.
    pub l1: Bounded,
}

/// Error estimate of a value that is read from a history.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReadingEstimate {
    /// Name of the gauge.
    pub gauge: String,
    /// Quantity in words.
    pub quantity: String,
    /// SI unit of the value.
    pub unit: String,
    /// Always a guess, from the differences to the coarse runs.
    pub basis: EstimateBasis,
    /// The value.
    pub value: Bounded,
}

/// Share of the error of a history that is added to the half-width of its greatest and least values
/// \[-\].
const EXTREME_SHARE: f64 = 0.3;
/// The same for levels \[-\].
const LEVEL_SHARE: f64 = 0.05;
/// The same for arrival times, with the time by which that error shifts the history \[-\].
const ARRIVAL_SHARE: f64 = 0.2;

/// Greatest pressure \[Pa\] and velocity \[m/s\] that are rounding, not a wave.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rounding {
    pub pressure: f64,
    pub velocity: f64,
}

/// Error estimates of the histories of a run, with half-widths multiplied by `factor`; those that are
/// zero or rounding are left out.
pub(super) fn of_histories(
    own: &GaugeRecords,
    coarse_runs: &CoarseRuns,
    rounding: Rounding,
    factor: f64,
) -> Vec<HistoryEstimate> {
    let estimate = |history: &GaugeHistory| {
        let least = match &history.quantity[..] {
            "pressure" => rounding.pressure,
            "velocity" => rounding.velocity,
            _ => 0.0,
        };
        let is_wave = history.greatest() > least;
        let differences = differences_of(history, coarse_runs).filter(|_| is_wave)?;
        Some(HistoryEstimate {
            gauge: history.gauge.clone(),
            quantity: history.quantity.clone(),
            basis: EstimateBasis::Guess,
            l1: differences.l1(factor),
        })
    };
    own.histories.iter().filter_map(estimate).collect()
}

/// Differences of a history to those of the coarse runs.
fn differences_of(history: &GaugeHistory, coarse_runs: &CoarseRuns) -> Option<Differences> {
    let is_same = |other: &&GaugeHistory| {
        (&other.gauge, &other.quantity) == (&history.gauge, &history.quantity)
    };
    Differences::new(coarse_runs, |coarse| {
        history.difference(coarse.gauges.histories.iter().find(is_same)?)
    })
}

/// Error estimates of the values that are read from the histories of a run; those that no coarse run
/// has are left out.
pub(super) fn of_readings(own: &GaugeRecords, coarse_runs: &CoarseRuns) -> Vec<ReadingEstimate> {
    let estimate = |reading: &Reading| {
        let is_same = |other: &&Reading| {
            (&other.gauge, &other.quantity) == (&reading.gauge, &reading.quantity)
        };
        let differences = Differences::new(coarse_runs, |coarse| {
            let other = coarse.gauges.readings.iter().find(is_same)?;
            Some(((other.value - reading.value) / reading.value).abs())
        })?;
        let is_history = |history: &&GaugeHistory| {
            (&history.gauge, &history.quantity) == (&reading.gauge, &reading.history)
        };
        let history = own.histories.iter().find(is_history);
        let least = history.map_or(0.0, |history| {
            let error = differences_of(history, coarse_runs).map_or(0.0, |all| all.error());
            let share = match reading.kind {
                ReadingKind::Extreme => EXTREME_SHARE * history.greatest(),
                ReadingKind::Level => LEVEL_SHARE * history.greatest(),
                ReadingKind::Arrival => ARRIVAL_SHARE * history.duration(),
            };
            reading.scale * share * error
        });
        Some(ReadingEstimate {
            gauge: reading.gauge.clone(),
            quantity: reading.quantity.clone(),
            unit: reading.unit.clone(),
            basis: EstimateBasis::Guess,
            value: differences.value(reading.value, least),
        })
    };
    own.readings.iter().filter_map(estimate).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::estimate::CoarseRun;

    fn records(velocity: [f64; 3], peak: f64, arrival: f64) -> GaugeRecords {
        let gauge = || "rear".to_string();
        let reading = |quantity: &str, kind, value| Reading {
            gauge: gauge(),
            quantity: quantity.into(),
            history: "velocity".into(),
            kind,
            scale: if quantity == "spall strength" { 5.0 } else { 1.0 },
            unit: "-".into(),
            value,
        };
        let history = |quantity: &str, values: Vec<f64>| GaugeHistory {
            gauge: gauge(),
            quantity: quantity.into(),
            times: vec![0.0, 1.0, 2.0],
            components: vec![values],
        };
        GaugeRecords {
            histories: vec![
                history("velocity", velocity.to_vec()),
                history("pressure", vec![0.0, 1.0, 1.0]),
            ],
            readings: vec![
                reading("peak velocity", ReadingKind::Extreme, peak),
                reading("plateau velocity", ReadingKind::Level, peak),
                reading("arrival", ReadingKind::Arrival, arrival),
                reading("spall strength", ReadingKind::Extreme, 5.0 * peak),
            ],
        }
    }

    #[test]
    fn values_have_at_least_a_share_of_the_error_of_their_history() {
        let own = records([0.0, 2.0, 2.0], 2.0, 1.0);
        let gauges = records([0.0, 1.6, 2.0], 2.0, 1.0);
        let coarse = CoarseRun { factor: 2.0, ratio: 2.0, gauges, ..CoarseRun::default() };
        let coarse_runs = CoarseRuns { done: vec![coarse], ..CoarseRuns::default() };
        // the histories differ by 0.4 of 4
        let rounding = Rounding { pressure: 2.0, velocity: 0.0 };
        let histories = of_histories(&own, &coarse_runs, rounding, 3.0);
        assert_eq!(histories.len(), 1, "a pressure of rounding is left out: {histories:?}");
        assert!((histories[0].l1.half_width.unwrap() - 3.0 * 0.2).abs() < 1e-12, "{histories:?}");
        let rounding = Rounding { pressure: 0.0, velocity: 2.0 };
        assert_eq!(of_histories(&own, &coarse_runs, rounding, 1.0)[0].quantity, "pressure");
        let half_widths: Vec<f64> =
            of_readings(&own, &coarse_runs).iter().map(|r| r.value.half_width.unwrap()).collect();
        let expected = [0.3 * 0.1 * 2.0, 0.05 * 0.1 * 2.0, 0.2 * 0.1 * 2.0, 5.0 * 0.3 * 0.1 * 2.0];
        assert_eq!(half_widths.len(), expected.len());
        for (half_width, expected) in half_widths.iter().zip(expected) {
            assert!((half_width - expected).abs() < 1e-8, "{half_widths:?} {expected}");
        }
    }
}
