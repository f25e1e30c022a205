//! Rulers: ends, readable unit and round ticks of an axis.

use super::axis::{Axis, AxisScale};

/// Larger values are not drawn, because differences of such numbers overflow.
const HUGE: f64 = 1e200;

/// Fewest numbers on an axis: two do not distinguish a linear axis from a logarithmic one.
const FEWEST: usize = 3;

/// Whether a value can be drawn on an axis of this scale.
#[inline]
pub(super) fn drawable(value: f64, scale: AxisScale) -> bool {
    value.abs() < HUGE && (scale == AxisScale::Linear || value > 1.0 / HUGE)
}

/// A tick of an axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    /// Position, as a fraction of the axis.
    pub at: f64,
    /// Its number; empty for a minor tick.
    pub text: String,
}

/// An axis with ends and ticks.
#[derive(Debug, Clone)]
pub(super) struct Ruler {
    /// Label with its unit.
    pub label: String,
    /// Ticks: first the numbered, then the minor ones, each in ascending order.
    pub ticks: Vec<Tick>,
    low: f64,
    high: f64,
    scale: AxisScale,
}

impl Ruler {
    /// The ruler of `axis` for `values`, with about `wanted` numbered ticks.
    pub fn new(axis: &Axis, values: impl Iterator<Item = f64>, wanted: usize) -> Self {
        Self::with_size(axis, values, wanted, None)
    }

    /// The same, with the unit for values of magnitude `size`; by default that of the axis ends.
    pub fn with_size(
        axis: &Axis,
        values: impl Iterator<Item = f64>,
        wanted: usize,
        size: Option<f64>,
    ) -> Self {
        let scale = axis.scale;
        let data = values.filter(|&v| drawable(v, scale)).fold(None, |range, v| match range {
            None => Some((v, v)),
            Some((low, high)) => Some((v.min(low), v.max(high))),
        });
        let given = axis.range.filter(|&(low, high)| {
            low < high && drawable(low, scale) && drawable(high, scale) && !is_flat(low, high)
        });
        let (low, high) = match (given, scale) {
            (Some(ends), _) => ends,
            (None, AxisScale::Linear) => ends_linear(data, axis.margin),
            (None, AxisScale::Log) => ends_log(data, axis.margin),
        };
        let (unit, factor) = match scale {
            AxisScale::Linear => {
                readable_unit(&axis.unit, size.unwrap_or_else(|| low.abs().max(high.abs())))
            }
            AxisScale::Log => (axis.unit.clone(), 1.0),
        };
        let label =
            if unit.is_empty() { axis.label.clone() } else { format!("{} ({unit})", axis.label) };
        let mut ruler = Self { label, ticks: Vec::new(), low, high, scale };
        ruler.ticks = match scale {
            _ if !axis.ticks.is_empty() => ruler.ticks_given(&axis.ticks, factor),
            AxisScale::Linear => ruler.ticks_linear(factor, wanted),
            AxisScale::Log => ruler.ticks_log(wanted),
        };
        ruler
    }

    /// Position of `value` as a fraction of the axis, below 0 or above 1 if outside; `None` if it
    /// cannot be drawn.
    #[inline]
    pub fn place(&self, value: f64) -> Option<f64> {
        if !drawable(value, self.scale) {
            return None;
        }
        Some(match self.scale {
            AxisScale::Linear => (value - self.low) / (self.high - self.low),
            AxisScale::Log => (value / self.low).ln() / (self.high / self.low).ln(),
        })
    }

    /// Value at a fraction of a linear axis.
    #[inline]
    pub fn value(&self, fraction: f64) -> f64 {
        self.low + fraction * (self.high - self.low)
    }

    fn tick(&self, value: f64, text: String) -> Option<Tick> {
        self.place(value).map(|at| Tick { at: at.clamp(0.0, 1.0), text })
    }

    fn ticks_given(&self, values: &[f64], factor: f64) -> Vec<Tick> {
        let inside = values.iter().filter(|v| (self.low..=self.high).contains(*v));
        inside.filter_map(|&v| self.tick(v, with_minus(&(v / factor).to_string()))).collect()
    }

    fn ticks_linear(&self, factor: f64, wanted: usize) -> Vec<Tick> {
        let (low, high) = (self.low / factor, self.high / factor);
        let (mut step, mut parts) = round_step((high - low) / wanted.max(1) as f64);
        if multiples(low, high, step).count() < FEWEST {
            (step, parts) = widest_step(low, high);
        }
        // Numbers of a logarithmic axis have no unit with a prefix: large ones get a power of ten.
        let power = match self.scale {
            AxisScale::Log => shown_power(high),
            AxisScale::Linear => 0,
        };
        let unit = 10f64.powi(power);
        let decimals = decimals_of(step / unit);
        let times = if power == 0 { String::new() } else { format!("×10{}", superscript(power)) };
        let numbered = multiples(low, high, step).filter_map(|v| {
            let number = format!("{:.decimals$}{times}", v / unit);
            self.tick(v * factor, with_minus(&number))
        });
        let minor =
            multiples(low, high, step / parts).filter_map(|v| self.tick(v * factor, String::new()));
        numbered.chain(minor).collect()
    }

    fn ticks_log(&self, wanted: usize) -> Vec<Tick> {
        let first = (self.low.log10() - 1e-9).ceil() as i32;
        let last = (self.high.log10() + 1e-9).floor() as i32;
        if last - first < 2 {
            return self.ticks_within_decades(wanted);
        }
        let shown = |stride: i32| (first..=last).filter(move |k| k.rem_euclid(stride) == 0);
        let stride = ((last - first + 1) as usize).div_ceil(wanted.max(2)) as i32;
        // three powers or more lie on the axis, so that a stride of 1 has enough
        let stride = (1..=stride).rev().find(|s| shown(*s).count() >= FEWEST).unwrap_or(1);
        let plain = first >= -3 && last <= 4;
        let power = |k: i32| {
            if plain { format!("{}", 10f64.powi(k)) } else { format!("10{}", superscript(k)) }
        };
        let numbered = shown(stride).filter_map(|k| self.tick(10f64.powi(k), power(k)));
        let minor = if stride == 1 { self.minor_log() } else { Vec::new() };
        numbered.chain(minor).collect()
    }

    fn minor_log(&self) -> Vec<Tick> {
        let (first, last) = (self.low.log10().floor() as i32, self.high.log10().ceil() as i32);
        (first..last)
            .flat_map(|k| (2..10).map(move |digit| f64::from(digit) * 10f64.powi(k)))
            .filter(|v| (self.low..=self.high).contains(v))
            .filter_map(|v| self.tick(v, String::new()))
            .collect()
    }

    /// Ticks of a logarithmic axis with few powers of ten: other digits have numbers too.
    fn ticks_within_decades(&self, wanted: usize) -> Vec<Tick> {
        let first = self.low.log10().floor() as i32;
        let round = |digits: &[f64]| -> Vec<Tick> {
            (first..first + 4)
                .flat_map(|k| digits.iter().map(move |&digit| (k, digit)))
                .filter(|&(k, digit)| (self.low..=self.high).contains(&(digit * 10f64.powi(k))))
                .filter_map(|(k, digit)| {
                    let value = digit * 10f64.powi(k);
                    let text = if (-3..4).contains(&k) {
                        format!("{value:.*}", (-k).max(0) as usize)
                    } else {
                        format!("{digit}×10{}", superscript(k))
                    };
                    self.tick(value, text)
                })
                .collect()
        };
        let mut ticks = round(&[1.0, 2.0, 5.0]);
        if ticks.len() < FEWEST {
            ticks = round(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0]);
        }
        if ticks.len() < FEWEST {
            return self.ticks_linear(1.0, wanted);
        }
        ticks.extend(self.minor_log());
        ticks
    }
}

/// Whether two ends are so close that rounding is visible between them.
fn is_flat(low: f64, high: f64) -> bool {
    high - low <= 1e-10 * low.abs().max(high.abs())
}

fn ends_linear(data: Option<(f64, f64)>, margin: f64) -> (f64, f64) {
    let Some((mut low, mut high)) = data else { return (0.0, 1.0) };
    if is_flat(low, high) {
        let room = if low == 0.0 { 1.0 } else { 0.1 * low.abs() };
        return (low - room, high + room);
    }
    if margin > 0.0 {
        // Include zero if it is near.
        if low > 0.0 && low < 0.3 * high {
            low = 0.0;
        }
        if high < 0.0 && high > 0.3 * low {
            high = 0.0;
        }
    }
    let room = margin * (high - low);
    (low - room, high + room)
}

fn ends_log(data: Option<(f64, f64)>, margin: f64) -> (f64, f64) {
    let Some((low, high)) = data else { return (0.1, 10.0) };
    if is_flat(low, high) {
        return (low / 2.0, high * 2.0);
    }
    let room = (high / low).powf(margin);
    (low / room, high * room)
}

/// The unit shown for values up to `greatest`, and its size in `unit`.
fn readable_unit(unit: &str, greatest: f64) -> (String, f64) {
    if greatest == 0.0 || (unit == "m/s" && (0.1..1e4).contains(&greatest)) {
        return (unit.into(), 1.0);
    }
    let power = greatest.log10();
    let base = unit.split(['/', '·', ' ']).next().unwrap_or_default();
    if ["Pa", "m", "s", "J", "N", "W", "Hz"].contains(&base) {
        // The largest shown number is between 0.1 and 100.
        let thousands = ((power + 1.0) / 3.0).floor() as i32;
        if let Some(prefix) = ["f", "p", "n", "µ", "m", "", "k", "M", "G", "T", "P"]
            .get((thousands + 5).max(0) as usize)
            .filter(|_| thousands >= -5)
        {
            return (format!("{prefix}{unit}"), 1000f64.powi(thousands));
        }
    }
    if (1e-2..1e5).contains(&greatest) {
        return (unit.into(), 1.0);
    }
    let power = power.floor() as i32;
    let shown = format!("10{} {unit}", superscript(power));
    (shown.trim_end().into(), 10f64.powi(power))
}

/// The round step next above `raw`, and the number of parts into which minor ticks divide it.
fn round_step(raw: f64) -> (f64, f64) {
    let power = 10f64.powf(raw.log10().floor());
    match raw / power {
        x if x <= 1.0 + 1e-9 => (power, 5.0),
        x if x <= 2.0 + 1e-9 => (2.0 * power, 4.0),
        x if x <= 5.0 + 1e-9 => (5.0 * power, 5.0),
        _ => (10.0 * power, 5.0),
    }
}

/// The widest round step with at least [`FEWEST`] multiples from `low` to `high`, and the number of
/// parts into which minor ticks divide it.
fn widest_step(low: f64, high: f64) -> (f64, f64) {
    let power = 10f64.powf((high - low).log10().floor());
    let steps = [5.0, 4.0, 2.5, 2.0, 1.0, 0.5, 0.4, 0.25];
    let parts = [5.0, 4.0, 5.0, 4.0, 5.0, 5.0, 4.0, 5.0];
    let steps = steps.map(|step| step * power).into_iter().zip(parts);
    let enough = |step: f64| multiples(low, high, step).count() >= FEWEST;
    steps.clone().find(|(step, _)| enough(*step)).unwrap_or((0.2 * power, 4.0))
}

/// Decimals that a multiple of the round number `step` needs, at most 15.
fn decimals_of(step: f64) -> usize {
    let whole = |decimals: &usize| {
        let scaled = step * 10f64.powi(*decimals as i32);
        scaled > 0.5 && (scaled - scaled.round()).abs() < 1e-6 * scaled
    };
    (0..15).find(whole).unwrap_or(15)
}

/// The power of ten by which a number is written on a logarithmic axis; 0: in full.
fn shown_power(greatest: f64) -> i32 {
    let power = greatest.log10().floor() as i32;
    if (-3..5).contains(&power) { 0 } else { power }
}

/// Multiples of `step` from `low` to `high`, at most a hundred.
fn multiples(low: f64, high: f64, step: f64) -> impl Iterator<Item = f64> {
    let first = (low / step - 1e-6).ceil();
    let last = (high / step + 1e-6).floor();
    // Adding zero turns minus zero into zero.
    (0..100)
        .map(move |i| first + f64::from(i))
        .take_while(move |&n| n <= last)
        .map(move |n| n * step + 0.0)
}

/// A number with a minus sign instead of the hyphen.
fn with_minus(number: &str) -> String {
    number.replace('-', "−")
}

fn superscript(number: i32) -> String {
    let raised = |c| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => char::from_u32('⁰' as u32 + (digit as u32 - '0' as u32)).unwrap_or(digit),
    };
    number.to_string().chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(axis: &Axis, values: &[f64]) -> (String, Vec<String>) {
        let ruler = Ruler::new(axis, values.iter().copied(), 5);
        let texts = ruler.ticks.into_iter().map(|tick| tick.text).filter(|text| !text.is_empty());
        (ruler.label, texts.collect())
    }

    #[test]
    fn chooses_readable_units_and_round_numbers() {
        let axis = Axis::linear("Pressure", "Pa").tight();
        let (label, texts) = numbers(&axis, &[0.0, 12.144e9]);
        assert_eq!((label.as_str(), texts.join(" ").as_str()), ("Pressure (GPa)", "0 5 10"));
        let axis = Axis::linear("Time", "s").tight();
        let (label, texts) = numbers(&axis, &[0.0, 1e-6]);
        assert_eq!(label, "Time (µs)");
        assert_eq!(texts.join(" "), "0.0 0.2 0.4 0.6 0.8 1.0");
        let axis = Axis::linear("Velocity", "m/s").tight();
        let (label, texts) = numbers(&axis, &[-500.0, 500.0]);
        assert_eq!(
            (label.as_str(), texts.join(" ").as_str()),
            ("Velocity (m/s)", "−400 −200 0 200 400")
        );
        let axis = Axis::linear("Drift", "").tight();
        assert_eq!(numbers(&axis, &[0.0, 3e-13]).0, "Drift (10⁻¹³)");
    }

    #[test]
    fn numbers_can_be_given() {
        let axis = Axis::log("Workers", "").ticks([0.5, 1.0, 2.0, 4.0, 8.0]);
        assert_eq!(numbers(&axis, &[1.0, 4.0]).1.join(" "), "1 2 4");
    }

    #[test]
    fn logarithmic_axes_have_powers_of_ten() {
        let axis = Axis::log("Error", "");
        assert_eq!(numbers(&axis, &[1e-6, 1.0, 0.0, -3.0]).1.join(" "), "10⁻⁶ 10⁻⁴ 10⁻² 10⁰");
        assert_eq!(numbers(&axis, &[0.02, 0.06]).1.join(" "), "0.02 0.03 0.04 0.05 0.06");
        assert_eq!(numbers(&axis, &[0.5, 200.0]).1.join(" "), "1 10 100");
        assert_eq!(numbers(&axis, &[0.03, 0.9]).1.join(" "), "0.05 0.1 0.2 0.5 1");
    }

    #[test]
    fn every_axis_has_three_numbers_or_more() {
        let widths = [1.0, 1.3, 1.7, 2.1, 2.6, 3.4, 4.4, 5.5, 7.2, 9.3, 9.9];
        let lows = [0.0, 0.04, 0.93, 1.0, 2.3, 7.7, -0.51, -3.0, 123.4];
        for scale in [AxisScale::Linear, AxisScale::Log] {
            for wanted in [1, 2, 3, 5, 10] {
                for power in [-12, -6, -3, 0, 2, 7, 9] {
                    for (width, low) in widths.iter().flat_map(|w| lows.map(|low| (w, low))) {
                        let size = 10f64.powi(power);
                        let (low, high) = match scale {
                            AxisScale::Linear => (low * size, (low + width) * size),
                            // from a small part of a decade to 35 decades
                            AxisScale::Log => (
                                (low.abs() + 0.01) * size,
                                (low.abs() + 0.01) * size * width.powf(low.abs().min(8.0) + 0.3),
                            ),
                        };
                        let axis = Axis { scale, ..Axis::linear("x", "Pa").tight() };
                        let ruler = Ruler::new(&axis, [low, high].into_iter(), wanted);
                        if high - low < 1e-9 * high {
                            continue;
                        }
                        let texts = ruler.ticks.iter().filter(|tick| !tick.text.is_empty());
                        let mut texts: Vec<&str> = texts.map(|tick| tick.text.as_str()).collect();
                        assert!(texts.len() >= 3, "{scale:?} {low} {high} {wanted}: {texts:?}");
                        assert!(texts.len() <= 15, "{scale:?} {low} {high} {wanted}: {texts:?}");
                        texts.dedup();
                        let all = ruler.ticks.iter().filter(|tick| !tick.text.is_empty()).count();
                        assert_eq!(texts.len(), all, "{low} {high}: equal numbers in {texts:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn short_axes_have_round_numbers() {
        let shown = |axis: Axis, low: f64, high: f64| {
            let ruler = Ruler::new(&axis.tight(), [low, high].into_iter(), 1);
            let texts = ruler.ticks.into_iter().map(|tick| tick.text);
            texts.filter(|text| !text.is_empty()).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(shown(Axis::linear("x", ""), 0.0, 8.0), "0 4 8");
        assert_eq!(shown(Axis::linear("x", ""), 0.1, 0.9), "0.25 0.50 0.75");
        assert_eq!(shown(Axis::log("x", ""), 1.0e9, 1.2e9), "1.0×10⁹ 1.1×10⁹ 1.2×10⁹");
        assert_eq!(shown(Axis::log("x", ""), 0.2, 3000.0), "1 10 100 1000");
    }

    #[test]
    fn any_data_give_finite_ticks_in_range() {
        let odd =
            [f64::NAN, f64::INFINITY, 1e300, f64::MIN_POSITIVE, 0.0, -1e-250, 5.0, 5.0 + 1e-15];
        for scale in [AxisScale::Linear, AxisScale::Log] {
            for margin in [0.0, 0.05] {
                for a in odd {
                    for b in odd {
                        let axis = Axis { scale, margin, ..Axis::linear("x", "Pa") };
                        let ruler = Ruler::new(&axis, [a, b].into_iter(), 6);
                        assert!(ruler.low < ruler.high, "{a} {b} {scale:?}");
                        assert!(ruler.ticks.iter().all(|tick| (0.0..=1.0).contains(&tick.at)));
                        assert!(ruler.ticks.iter().any(|tick| !tick.text.is_empty()), "{a} {b}");
                    }
                }
            }
        }
    }
}
