//! Records of the gauges of a run: histories, and the values that are read from them.

use super::polyline::interpolate;

/// History of a quantity at a gauge.
#[derive(Clone, Debug, PartialEq)]
pub struct GaugeHistory {
    /// Name of the gauge.
    pub gauge: String,
    /// Name of the quantity, such as `pressure`.
    pub quantity: String,
    /// Times \[s\], increasing.
    pub times: Vec<f64>,
    /// One list per component of the quantity, with a value per time in its SI unit; NaN: none.
    pub components: Vec<Vec<f64>>,
}

/// Kind of a value that is read from a history.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadingKind {
    /// A greatest or least value, or a difference of such values.
    Extreme,
    /// A level that lasts for some time.
    Level,
    /// A time at which a wave arrives.
    Arrival,
}

/// A value that is read from a history.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Name of the gauge.
    pub gauge: String,
    /// Quantity in words, such as `peak pressure`.
    pub quantity: String,
    /// Quantity of the history from which it is read.
    pub history: String,
    /// Kind of the value.
    pub kind: ReadingKind,
    /// Change of the value per change of the history, in their units.
    pub scale: f64,
    /// SI unit.
    pub unit: String,
    /// Value in this unit.
    pub value: f64,
}

/// Records of all gauges of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GaugeRecords {
    /// Histories.
    pub histories: Vec<GaugeHistory>,
    /// Values that are read from them.
    pub readings: Vec<Reading>,
}

impl GaugeHistory {
    /// Greatest magnitude, in the unit of the quantity; 0 without values.
    pub fn greatest(&self) -> f64 {
        self.sizes().filter(|size| !size.is_nan()).fold(0.0, f64::max)
    }

    /// Time for which the greatest magnitude would have to last for the same integral of the
    /// magnitude over time \[s\]; NaN if the quantity is zero.
    pub fn duration(&self) -> f64 {
        let steps = self.times.windows(2).map(|t| t[1] - t[0]);
        let terms = self.sizes().skip(1).zip(steps).map(|(size, step)| size * step);
        terms.filter(|term| !term.is_nan()).sum::<f64>() / self.greatest()
    }

    /// Magnitude at each time.
    fn sizes(&self) -> impl Iterator<Item = f64> + '_ {
        let squared = |row: usize| self.components.iter().map(|c| c[row].powi(2)).sum::<f64>();
        (0..self.times.len()).map(move |row| squared(row).sqrt())
    }

    /// Relative L1 difference \[-\]: the integral over time of |a - b| over that of |a|, at the times
    /// of `self`, with linear interpolation of `other`. `None` if `self` is zero, or if they share no
    /// times.
    pub fn difference(&self, other: &GaugeHistory) -> Option<f64> {
        let curve = |values: &Vec<f64>| -> Vec<(f64, f64)> {
            other.times.iter().copied().zip(values.iter().copied()).collect()
        };
        let others: Vec<Vec<(f64, f64)>> = other.components.iter().map(curve).collect();
        let (mut difference, mut whole) = (0.0, 0.0);
        for row in 1..self.times.len() {
            let step = self.times[row] - self.times[row - 1];
            let (mut apart, mut size) = (0.0, 0.0);
            for (own, theirs) in self.components.iter().zip(&others) {
                let theirs = interpolate(theirs, self.times[row]).unwrap_or(f64::NAN);
                apart += (own[row] - theirs).powi(2);
                size += own[row].powi(2);
            }
            // a gauge without particles has no value
            if apart.is_finite() {
                difference += step * apart.sqrt();
                whole += step * size.sqrt();
            }
        }
        (whole > 0.0).then_some(difference / whole)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn history(times: &[f64], components: &[&[f64]]) -> GaugeHistory {
        let components = components.iter().map(|values| values.to_vec()).collect();
        let (gauge, quantity) = ("rear".into(), "velocity".into());
        GaugeHistory { gauge, quantity, times: times.to_vec(), components }
    }

    #[test]
    fn differences_of_histories_are_integrals_of_vectors() {
        let own = history(&[0.0, 1.0, 2.0, 4.0], &[&[0.0, 3.0, 3.0, 6.0], &[0.0, 4.0, 4.0, 8.0]]);
        assert_eq!(own.difference(&own), Some(0.0));
        // (3, 4) at 1, between its rows (3, 0) at 2, (6, 8) at 4
        let other =
            history(&[0.0, 1.0, 3.0, 4.0], &[&[0.0, 3.0, 3.0, 6.0], &[0.0, 4.0, -4.0, 8.0]]);
        let whole = 5.0 + 5.0 + 2.0 * 10.0;
        assert!((own.difference(&other).unwrap() - 4.0 / whole).abs() < 1e-15);
        let nothing = history(&[0.0, 4.0], &[&[0.0, 0.0], &[0.0, 0.0]]);
        assert_eq!(nothing.difference(&own), None);
        // a row without a value counts in neither integral
        let gap =
            history(&[0.0, 1.0, 2.0, 4.0], &[&[0.0, 3.0, f64::NAN, 0.0], &[0.0, 4.0, 4.0, 0.0]]);
        assert!((own.difference(&gap).unwrap() - 20.0 / 25.0).abs() < 1e-15);
    }
}
