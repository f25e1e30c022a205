//! Functions of time: the pressure on a side, the velocity of a piston.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A function of time, in the SI unit of its quantity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Course {
    /// Constant value.
    Constant(f64),
    /// Pairs of time [s] and value, increasing in time. Linear between the pairs; constant before
    /// the first and after the last.
    Series(#[schemars(length(min = 1))] Vec<[f64; 2]>),
    /// A smooth transition from one value to another.
    Ramp(Ramp),
    /// Name of a CSV file with the columns time and value, in the folder of the scene file.
    File(String),
}

/// A transition with continuous first and second derivatives: from + (to - from) s^3 (10 - 15 s + 6
/// s^2), where s increases from 0 to 1 over the duration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ramp {
    /// Value before the transition, in the unit of the quantity; default 0.
    #[serde(default)]
    pub from: f64,
    /// Value after the transition, in the unit of the quantity.
    pub to: f64,
    /// Start time of the transition [s]; default 0.
    #[serde(default)]
    pub start: f64,
    /// Duration of the transition [s]. With a larger value the transition is smoother.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub duration: f64,
}

impl Ramp {
    fn share(&self, time: f64) -> f64 {
        ((time - self.start) / self.duration).clamp(0.0, 1.0)
    }

    fn at(&self, time: f64) -> f64 {
        let s = self.share(time);
        self.from + (self.to - self.from) * (s * s * s * (10.0 - 15.0 * s + 6.0 * s * s))
    }

    /// Time derivative.
    fn slope(&self, time: f64) -> f64 {
        let s = self.share(time);
        (self.to - self.from) * 30.0 * (s * (1.0 - s)).powi(2) / self.duration
    }

    /// Integral of (value - `from`) over time up to `time`; 0 before the start.
    fn rise(&self, time: f64) -> f64 {
        let s = self.share(time);
        let during = self.duration * s.powi(4) * (2.5 - 3.0 * s + s * s);
        (self.to - self.from) * (during + (time - self.start - self.duration).max(0.0))
    }
}

impl Course {
    /// The value at `time` [s], in the SI unit of its quantity; NaN for a file that has not been
    /// read.
    pub fn at(&self, time: f64) -> f64 {
        match self {
            Course::Constant(value) => *value,
            Course::Series(points) => {
                let next = points.partition_point(|[t, _]| *t <= time);
                if next == 0 || next == points.len() {
                    return points[next.saturating_sub(1)][1];
                }
                let ([t0, p0], [t1, p1]) = (points[next - 1], points[next]);
                p0 + (p1 - p0) * ((time - t0) / (t1 - t0))
            }
            Course::Ramp(ramp) => ramp.at(time),
            Course::File(_) => f64::NAN,
        }
    }

    /// Time derivative just after `time` [s], in the SI unit of the quantity per second; NaN for a
    /// file that has not been read.
    pub fn slope(&self, time: f64) -> f64 {
        match self {
            Course::Constant(_) => 0.0,
            Course::Series(points) => {
                let next = points.partition_point(|[t, _]| *t <= time);
                if next == 0 || next == points.len() {
                    return 0.0;
                }
                let ([t0, p0], [t1, p1]) = (points[next - 1], points[next]);
                (p1 - p0) / (t1 - t0)
            }
            Course::Ramp(ramp) => ramp.slope(time),
            Course::File(_) => f64::NAN,
        }
    }

    /// Integral from 0 to `time` >= 0 [s], in the SI unit of the quantity times seconds; NaN for a
    /// file that has not been read.
    pub fn integral(&self, time: f64) -> f64 {
        match self {
            Course::Constant(value) => value * time,
            Course::Series(points) => {
                let inside = points.iter().map(|p| p[0]).filter(|t| (0.0..time).contains(t));
                let ends = inside.chain([time]);
                let (mut sum, mut from) = (0.0, 0.0);
                for to in ends {
                    sum += 0.5 * (self.at(from) + self.at(to)) * (to - from);
                    from = to;
                }
                sum
            }
            Course::Ramp(ramp) => ramp.from * time + ramp.rise(time) - ramp.rise(0.0),
            Course::File(_) => f64::NAN,
        }
    }

    /// Whether the value depends on time.
    pub fn changes(&self) -> bool {
        !matches!(self, Course::Constant(_))
    }

    /// Smallest and largest value over all times, in the SI unit of the quantity.
    pub fn range(&self) -> [f64; 2] {
        let of = |values: &mut dyn Iterator<Item = f64>| {
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, u], v| [l.min(v), u.max(v)])
        };
        match self {
            Course::Constant(value) => [*value; 2],
            Course::Series(points) => of(&mut points.iter().map(|p| p[1])),
            Course::Ramp(ramp) => of(&mut [ramp.from, ramp.to].into_iter()),
            Course::File(_) => [f64::NAN; 2],
        }
    }

    /// Times at which a derivative is discontinuous [s].
    pub fn kinks(&self) -> Vec<f64> {
        match self {
            Course::Constant(_) | Course::File(_) => Vec::new(),
            Course::Series(points) => points.iter().map(|p| p[0]).collect(),
            Course::Ramp(ramp) => vec![ramp.start, ramp.start + ramp.duration],
        }
    }

    /// Reads the text of a CSV file with the columns time [s] and `quantity` (in its SI unit):
    /// pairs of time and value, one per line.
    ///
    /// # Errors
    ///
    /// A description of the fault and of the allowed format.
    pub fn read(text: &str, quantity: &str) -> Result<Vec<[f64; 2]>, String> {
        let allowed = format!("allowed: a header time,{quantity} and rows of two finite numbers");
        let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
        let mut lines = lines.map(|(k, line)| (k + 1, line.split(',').map(str::trim)));
        let header: Vec<&str> = lines.next().map(|(_, words)| words.collect()).unwrap_or_default();
        if header != ["time", quantity] {
            return Err(format!("line 1 is no header; {allowed}"));
        }
        let row = |(line, words): (usize, std::iter::Map<std::str::Split<'_, char>, _>)| {
            let numbers: Option<Vec<f64>> =
                words.map(|w: &str| w.parse().ok().filter(|v: &f64| v.is_finite())).collect();
            match numbers.as_deref() {
                Some(&[time, value]) => Ok([time, value]),
                _ => Err(format!("line {line}; {allowed}")),
            }
        };
        lines.map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn courses() -> [Course; 3] {
        [
            Course::Constant(3.0),
            Course::Series(vec![[1.0, 2.0], [3.0, 6.0], [4.0, 0.0]]),
            Course::Ramp(Ramp { from: -1.0, to: 4.0, start: 0.5, duration: 2.0 }),
        ]
    }

    #[test]
    fn a_series_is_linear_between_its_times_and_constant_beyond() {
        let [constant, series, ramp] = courses();
        let at = [0.0, 1.0, 2.0, 3.0, 3.5, 4.0, 9.0].map(|t| series.at(t));
        assert_eq!(at, [2.0, 2.0, 4.0, 6.0, 3.0, 0.0, 0.0]);
        assert_eq!(constant.at(7.0), 3.0);
        assert_eq!([0.0, 0.5, 1.5, 2.5, 9.0].map(|t| ramp.at(t)), [-1.0, -1.0, 1.5, 4.0, 4.0]);
        assert_eq!([ramp.range(), series.range()], [[-1.0, 4.0], [0.0, 6.0]]);
    }

    #[test]
    fn slopes_and_integrals_are_those_of_the_values() {
        for course in courses() {
            let (mut sum, n) = (0.0, 50_000);
            let h = 5.0 / f64::from(n);
            for k in 0..n {
                let t = h * f64::from(k);
                sum += 0.5 * h * (course.at(t) + course.at(t + h));
                if k % 997 == 1 {
                    let slope = (course.at(t + h) - course.at(t)) / h;
                    assert!((slope - course.slope(t)).abs() < 2e-3, "{course:?} {t}");
                    assert!((sum - course.integral(t + h)).abs() < 1e-7, "{course:?} {t}");
                }
            }
        }
    }

    #[test]
    fn files_are_read_or_reported_by_line() {
        let read = Course::read("time, pressure\n0,1e9\n\n 1e-6 ,0\n", "pressure");
        assert_eq!(read, Ok(vec![[0.0, 1e9], [1e-6, 0.0]]));
        for (text, line) in [
            ("", "line 1"),
            ("0,1", "line 1"),
            ("time,velocity\n0,1", "line 1"),
            ("time,pressure\n0,1\n0,x", "line 3"),
            ("time,pressure\n0,inf", "line 2"),
            ("time,pressure\n0", "line 2"),
        ] {
            let message = Course::read(text, "pressure").unwrap_err();
            assert!(message.contains(line) && message.contains("time,pressure"), "{message}");
        }
    }
}
