//! Ends of a colour scale, robust against a few outliers.

use super::shades::Shades;

/// Type of colour scale.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Shading {
    /// From dark to bright: density, equivalent stress.
    Sequential,
    /// Blue, light gray, red, with zero in the middle: a velocity component.
    Diverging,
    /// Sequential, or diverging if there are significant negative values: pressure.
    #[default]
    BySign,
}

/// A colour scale with its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AxisLimits {
    pub shades: Shades,
    pub low: f64,
    pub high: f64,
    /// Whether some values are clearly below `low`.
    pub under: bool,
    /// Whether some values are clearly above `high`.
    pub over: bool,
}

/// Fractions of the values that may lie beyond each end of the scale. The first fraction that keeps
/// most of the range is used.
const TAILS: [f64; 5] = [1e-3, 1e-4, 1e-5, 1e-6, 0.0];
/// Part of the range below which an end is set to zero, or to the extreme value.
const NEAR: f64 = 0.05;
/// The same for the extremes of fewer values than [`FEW`]: one of these may be a peak.
const NEAR_OF_FEW: f64 = 1.5;
const FEW: usize = 10_000;

impl AxisLimits {
    /// The scale for `values`, which are reordered and may be non-finite. Valid `given` ends take
    /// precedence over those of the values.
    pub fn of(mut values: Vec<f64>, shading: Shading, given: Option<(f64, f64)>) -> Self {
        values.retain(|v| v.is_finite());
        let extremes = values.iter().fold(None, |ends, &v| match ends {
            None => Some((v, v)),
            Some((low, high)) => Some((v.min(low), v.max(high))),
        });
        let given = given.filter(|&(low, high)| is_wide(low, high));
        let (low, high) = given.or_else(|| robust(&mut values)).unwrap_or((0.0, 0.0));
        let negative = low < -NEAR * high.max(0.0);
        let is_diverging = match shading {
            Shading::Sequential => false,
            Shading::Diverging => true,
            Shading::BySign => negative,
        };
        let (shades, (low, high)) = match is_diverging {
            true => (Shades::Diverging, around_zero(low, high)),
            false if given.is_some() => (Shades::Sequential, (low, high)),
            false => (Shades::Sequential, from_zero_if_near(low, high)),
        };
        let (low, high) = if given.is_some() { (low, high) } else { rounded(low, high) };
        let clear = 0.005 * (high - low);
        let beyond = |(least, greatest): (f64, f64)| (least < low - clear, greatest > high + clear);
        let (under, over) = extremes.map_or((false, false), beyond);
        Self { shades, low, high, under, over }
    }
}

/// Whether the difference of two ends is more than rounding.
fn is_wide(low: f64, high: f64) -> bool {
    (high - low).is_finite() && high - low > 1e-9 * low.abs().max(high.abs())
}

/// Ends that cover nearly all values.
fn robust(values: &mut [f64]) -> Option<(f64, f64)> {
    let ends: Vec<(f64, f64)> =
        TAILS.iter().map(|&tail| without_tails(values, tail)).collect::<Option<_>>()?;
    let width = |(low, high): (f64, f64)| high - low;
    // The few omitted values may be the only ones of interest: a small spot in a body at rest.
    let wide = |pair: &&[(f64, f64)]| width(pair[0]) >= 0.02 * width(pair[1]);
    let all = ends[ends.len() - 1];
    let (mut low, mut high) = ends.windows(2).find(wide).map_or(all, |pair| pair[0]);
    let near = if values.len() < FEW { NEAR_OF_FEW } else { NEAR } * (high - low);
    if low - all.0 <= near {
        low = all.0;
    }
    if all.1 - high <= near {
        high = all.1;
    }
    Some((low, high))
}

/// Smallest and largest value without a fraction of the values at each end (at least one of many).
fn without_tails(values: &mut [f64], share: f64) -> Option<(f64, f64)> {
    let last = values.len().checked_sub(1)?;
    let left_out =
        if share > 0.0 && last >= 100 { (share * last as f64).ceil() as usize } else { 0 };
    let low = *values.select_nth_unstable_by(left_out, f64::total_cmp).1;
    let high = *values.select_nth_unstable_by(last - left_out, f64::total_cmp).1;
    Some((low, high))
}

fn around_zero(low: f64, high: f64) -> (f64, f64) {
    match low.abs().max(high.abs()) {
        0.0 => (-1.0, 1.0),
        greatest => (-greatest, greatest),
    }
}

/// Moves an end to zero if it is near zero; equal values are placed in the middle of the scale.
fn from_zero_if_near(low: f64, high: f64) -> (f64, f64) {
    if low == 0.0 && high == 0.0 {
        (0.0, 1.0)
    } else if !is_wide(low, high) {
        (low - 0.1 * low.abs(), high + 0.1 * high.abs())
    } else if high > 0.0 && low < 0.3 * high && low > -NEAR * high {
        (0.0, high)
    } else {
        (low, high)
    }
}

/// Moves ends to round numbers just beyond them, so that the ends have a number.
fn rounded(low: f64, high: f64) -> (f64, f64) {
    let range = high - low;
    let power = 10f64.powf(range.log10().floor());
    let step = if range < 2.0 * power { 0.1 * power } else { 0.5 * power };
    let near = |end: f64, round: f64| if (round - end).abs() <= 0.03 * range { round } else { end };
    (near(low, (low / step).floor() * step), near(high, (high / step).ceil() * step))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends(values: &[f64], shading: Shading) -> (Shades, f64, f64, bool, bool) {
        let found = AxisLimits::of(values.to_vec(), shading, None);
        (found.shades, found.low, found.high, found.under, found.over)
    }

    #[test]
    fn stray_values_are_left_out_and_marked() {
        let mut values: Vec<f64> = (0..10_000).map(|i| f64::from(i) * 1e5).collect();
        values[17] = 1e15;
        let (shades, low, high, under, over) = ends(&values, Shading::BySign);
        assert_eq!((shades, low, under, over), (Shades::Sequential, 0.0, false, true));
        assert!((high / 1e9 - 1.0).abs() < 0.01, "{high}");
        values[17] = -1e15;
        let (_, low, _, under, over) = ends(&values, Shading::Sequential);
        assert_eq!((low, under, over), (0.0, true, false));
    }

    #[test]
    fn a_small_spot_in_a_body_at_rest_is_seen() {
        let mut values = vec![0.0; 100_000];
        values[500..520].fill(3e9);
        assert_eq!(ends(&values, Shading::BySign), (Shades::Sequential, 0.0, 3e9, false, false));
    }

    #[test]
    fn of_few_values_a_peak_is_kept_but_not_a_stray() {
        let mut values: Vec<f64> = (0..600).map(|i| f64::from(i % 100) * 1e7).collect();
        values[300] = 2e9;
        assert_eq!(ends(&values, Shading::BySign).2, 2e9);
        values[300] = 2e12;
        let (_, _, high, _, over) = ends(&values, Shading::BySign);
        assert!(high < 1.1e9 && over, "{high}");
    }

    #[test]
    fn ends_are_round_where_that_is_near() {
        assert_eq!(rounded(-997.0, 997.0), (-1000.0, 1000.0));
        assert_eq!(rounded(0.0, 1.27e9).1, 1.3e9);
        assert_eq!(rounded(2785.0, 3585.0), (2785.0, 3600.0));
        assert_eq!(rounded(0.0, 1.22), (0.0, 1.22));
    }

    #[test]
    fn sign_chooses_the_colours() {
        let pulled = [-2e9, 0.0, 1e9];
        assert_eq!(ends(&pulled, Shading::BySign), (Shades::Diverging, -2e9, 2e9, false, false));
        assert_eq!(ends(&[-1e7, 1e9], Shading::BySign).0, Shades::Sequential);
        assert_eq!(ends(&[0.0, 900.0], Shading::Diverging).1, -900.0);
        assert_eq!(ends(&[2700.0, 3500.0], Shading::Sequential).1, 2700.0);
    }

    #[test]
    fn odd_values_still_give_ascending_ends() {
        let odd: [&[f64]; 6] =
            [&[], &[f64::NAN, f64::INFINITY], &[0.0], &[5.0, 5.0], &[-5.0], &[1e-300, f64::NAN]];
        for values in odd {
            for shading in [Shading::Sequential, Shading::Diverging, Shading::BySign] {
                let (_, low, high, under, over) = ends(values, shading);
                assert!(low < high && !under && !over, "{values:?} {shading:?} {low} {high}");
            }
        }
        let given = AxisLimits::of(vec![0.0, 9.0], Shading::BySign, Some((1.0, 2.0)));
        assert_eq!((given.low, given.high, given.under, given.over), (1.0, 2.0, true, true));
        let given = AxisLimits::of(vec![0.0, 9.0], Shading::Diverging, Some((-1.0, 2.0)));
        assert_eq!((given.low, given.high), (-2.0, 2.0));
        for bad in [(f64::NAN, 2.0), (5.0, 5.0 + 1e-12), (2.0, 1.0)] {
            assert_eq!(AxisLimits::of(vec![0.0, 9.0], Shading::BySign, Some(bad)).high, 9.0);
        }
    }
}
