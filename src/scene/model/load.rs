//! A pressure that a side is loaded by.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A pressure over time [Pa].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Load {
    /// The same at all times [Pa].
    Constant(f64),
    /// Pairs of a time [s] and the pressure then [Pa], ascending in time: linear in between, and
    /// before the first and after the last as there.
    Series(#[schemars(length(min = 1))] Vec<[f64; 2]>),
    /// A CSV file of columns time and pressure, beside the scene's file.
    File(String),
}

impl Load {
    /// The pressure at `time` [Pa].
    pub fn at(&self, time: f64) -> f64 {
        let points = match self {
            Load::Constant(pressure) => return *pressure,
            Load::Series(points) => points,
            Load::File(_) => return f64::NAN,
        };
        let next = points.partition_point(|[t, _]| *t <= time);
        if next == 0 || next == points.len() {
            return points[next.saturating_sub(1)][1];
        }
        let ([t0, p0], [t1, p1]) = (points[next - 1], points[next]);
        p0 + (p1 - p0) * ((time - t0) / (t1 - t0))
    }

    /// Reads the text of a CSV file of columns time and pressure.
    ///
    /// # Errors
    ///
    /// What is wrong with it.
    pub fn read(text: &str) -> Result<Vec<[f64; 2]>, String> {
        const ALLOWED: &str = "allowed: a header time,pressure and rows of two finite numbers";
        let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
        let mut lines = lines.map(|(k, line)| (k + 1, line.split(',').map(str::trim)));
        let header: Vec<&str> = lines.next().map(|(_, words)| words.collect()).unwrap_or_default();
        if header != ["time", "pressure"] {
            return Err(format!("line 1 is no header; {ALLOWED}"));
        }
        let row = |(line, words): (usize, std::iter::Map<std::str::Split<'_, char>, _>)| {
            let numbers: Option<Vec<f64>> =
                words.map(|w: &str| w.parse().ok().filter(|v: &f64| v.is_finite())).collect();
            match numbers.as_deref() {
                Some(&[time, pressure]) => Ok([time, pressure]),
                _ => Err(format!("line {line}; {ALLOWED}")),
            }
        };
        lines.map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_is_linear_between_its_times_and_constant_beyond() {
        let load = Load::Series(vec![[1.0, 2.0], [3.0, 6.0], [4.0, 0.0]]);
        let at = [0.0, 1.0, 2.0, 3.0, 3.5, 4.0, 9.0].map(|t| load.at(t));
        assert_eq!(at, [2.0, 2.0, 4.0, 6.0, 3.0, 0.0, 0.0]);
        assert_eq!(Load::Constant(3.0).at(7.0), 3.0);
    }

    #[test]
    fn files_are_read_or_told_by_line() {
        let read = Load::read("time, pressure\n0,1e9\n\n 1e-6 ,0\n");
        assert_eq!(read, Ok(vec![[0.0, 1e9], [1e-6, 0.0]]));
        for (text, line) in [
            ("", "line 1"),
            ("0,1", "line 1"),
            ("time,pressure\n0,1\n0,x", "line 3"),
            ("time,pressure\n0,inf", "line 2"),
            ("time,pressure\n0", "line 2"),
        ] {
            let told = Load::read(text).unwrap_err();
            assert!(told.contains(line) && told.contains("time,pressure"), "{told}");
        }
    }
}
