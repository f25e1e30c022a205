//! Error estimates of gauges: of their histories, and of the values that are read from these.

use serde::{Deserialize, Serialize};

use super::bounded::Bounded;
use super::companions::Companions;
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
const EXTREME: f64 = 0.3;
/// The same for levels \[-\].
const LEVEL: f64 = 0.05;
/// The same for arrival times, with the time by which that error shifts the history \[-\].
const ARRIVAL: f64 = 0.2;

/// Error estimates of the histories of a run; histories that are zero, and pressures up to
/// `least_pressure` \[Pa\], are left out.
pub(super) fn of_histories(
    own: &GaugeRecords,
    companions: &Companions,
    least_pressure: f64,
) -> Vec<HistoryEstimate> {
    let estimate = |history: &GaugeHistory| {
        let is_wave = history.quantity != "pressure" || history.greatest() > least_pressure;
        let differences = differences_of(history, companions).filter(|_| is_wave)?;
        Some(HistoryEstimate {
            gauge: history.gauge.clone(),
            quantity: history.quantity.clone(),
            basis: EstimateBasis::Guess,
            l1: differences.l1(1.0),
        })
    };
    own.histories.iter().filter_map(estimate).collect()
}

/// Differences of a history to those of the coarse runs.
fn differences_of(history: &GaugeHistory, companions: &Companions) -> Option<Differences> {
    let is_same = |other: &&GaugeHistory| {
        (&other.gauge, &other.quantity) == (&history.gauge, &history.quantity)
    };
    Differences::new(companions.done.iter().filter_map(|companion| {
        let other = companion.gauges.histories.iter().find(is_same)?;
        Some((companion.factor, history.difference(other)?))
    }))
}

/// Error estimates of the values that are read from the histories of a run; those that no coarse run
/// has are left out.
pub(super) fn of_readings(own: &GaugeRecords, companions: &Companions) -> Vec<ReadingEstimate> {
    let estimate = |reading: &Reading| {
        let is_same = |other: &&Reading| {
            (&other.gauge, &other.quantity) == (&reading.gauge, &reading.quantity)
        };
        let differences = Differences::new(companions.done.iter().filter_map(|companion| {
            let other = companion.gauges.readings.iter().find(is_same)?;
            Some((companion.factor, ((other.value - reading.value) / reading.value).abs()))
        }))?;
        let is_history = |history: &&GaugeHistory| {
            (&history.gauge, &history.quantity) == (&reading.gauge, &reading.history)
        };
        let history = own.histories.iter().find(is_history);
        let least = history.map_or(0.0, |history| {
            let error = differences_of(history, companions).map_or(0.0, |all| all.error());
            match reading.kind {
                ReadingKind::Extreme => EXTREME * error * history.greatest(),
                ReadingKind::Level => LEVEL * error * history.greatest(),
                ReadingKind::Arrival => ARRIVAL * error * history.duration(),
            }
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
    use crate::accuracy::estimate::Companion;

    fn records(velocity: [f64; 3], peak: f64, arrival: f64) -> GaugeRecords {
        let gauge = || "rear".to_string();
        let reading = |quantity: &str, kind, value| Reading {
            gauge: gauge(),
            quantity: quantity.into(),
            history: "velocity".into(),
            kind,
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
            ],
        }
    }

    #[test]
    fn values_have_at_least_a_share_of_the_error_of_their_history() {
        let own = records([0.0, 2.0, 2.0], 2.0, 1.0);
        let coarse = Companion {
            factor: 2.0,
            cell_size: 1.0,
            profiles: Vec::new(),
            arrivals: Vec::new(),
            tables: Vec::new(),
            gauges: records([0.0, 1.6, 2.0], 2.0, 1.0),
        };
        let companions = Companions { done: vec![coarse], ..Companions::default() };
        // the histories differ by 0.4 of 4
        let histories = of_histories(&own, &companions, 2.0);
        assert_eq!(histories.len(), 1, "a pressure of rounding is left out: {histories:?}");
        assert!((histories[0].l1.half_width.unwrap() - 0.2).abs() < 1e-12, "{histories:?}");
        let half_widths: Vec<f64> =
            of_readings(&own, &companions).iter().map(|r| r.value.half_width.unwrap()).collect();
        let expected = [EXTREME * 0.1 * 2.0, LEVEL * 0.1 * 2.0, ARRIVAL * 0.1 * 2.0];
        for (half_width, expected) in half_widths.iter().zip(expected) {
            assert!((half_width - expected).abs() < 1e-8, "{half_widths:?} {expected}");
        }
    }
}
