//! Differences of the histories of cases from those of a reference case: an error for scenes
//! without an exact solution.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::StudyRow;
use super::cases::fits;

/// Name of the error of the histories in a study.
pub const HISTORIES: &str = "histories";

/// Comparison of histories with those of a reference case.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Convergence {
    /// Labels of the reference case, the one with the smallest cells.
    pub against: BTreeMap<String, Value>,
    /// Columns of `histories.csv` that are compared.
    pub columns: Vec<String>,
}

/// Columns of `histories.csv`; an empty entry is `None`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Histories(BTreeMap<String, Vec<Option<f64>>>);

impl Histories {
    /// The `columns` and the time of the histories in the folder of a run. The error is the reason
    /// why they cannot be read.
    ///
    /// # Errors
    ///
    /// If there is no such file or column.
    pub fn read(folder: &Path, columns: &[String]) -> Result<Histories, String> {
        let mut reader = csv::Reader::from_path(folder.join("histories.csv"))
            .map_err(|error| format!("histories.csv: {error}"))?;
        let heads = reader.headers().map_err(|error| error.to_string())?.clone();
        let rows: Vec<csv::StringRecord> =
            reader.records().collect::<Result<_, _>>().map_err(|error| error.to_string())?;
        let column = |name: &str| {
            let at = heads.iter().position(|head| head == name).ok_or_else(|| {
                let known: Vec<&str> = heads.iter().collect();
                format!("no column `{name}` in histories.csv; there are: {}", known.join(", "))
            })?;
            Ok((name.to_string(), rows.iter().map(|row| row.get(at)?.parse().ok()).collect()))
        };
        let names = columns.iter().map(String::as_str).chain(["time"]);
        Ok(Histories(names.map(column).collect::<Result<_, String>>()?))
    }

    /// Whether the histories have these columns.
    pub fn have(&self, columns: &[String]) -> bool {
        columns.iter().all(|column| self.0.contains_key(column))
    }

    /// Times \[s\] and values of a column, without empty entries.
    fn curve(&self, column: &str) -> Option<Vec<(f64, f64)>> {
        let (times, values) = (self.0.get("time")?, self.0.get(column)?);
        Some(times.iter().zip(values).filter_map(|(t, v)| Some(((*t)?, (*v)?))).collect())
    }

    /// Mean over the `columns` of the integral of |v - v_ref| over time, divided by the integral of
    /// |v_ref|; `None` if a column is missing or zero.
    pub fn difference(&self, reference: &Histories, columns: &[String]) -> Option<f64> {
        let mut sum = 0.0;
        for column in columns {
            let (curve, exact) = (self.curve(column)?, reference.curve(column)?);
            let (mut apart, mut whole) = (0.0, 0.0);
            for pair in exact.windows(2) {
                let [(from, _), (to, value)] = [pair[0], pair[1]];
                let Some(found) = at(&curve, to) else { continue };
                apart += (found - value).abs() * (to - from);
                whole += value.abs() * (to - from);
            }
            sum += Some(apart / whole).filter(|_| whole > 0.0)?;
        }
        Some(sum / columns.len() as f64)
    }
}

/// Value of a curve at a time, between its points; `None` outside of them.
fn at(curve: &[(f64, f64)], time: f64) -> Option<f64> {
    let next = curve.partition_point(|(t, _)| *t < time);
    let (t1, v1) = *curve.get(next)?;
    if t1 == time {
        return Some(v1);
    }
    let (t0, v0) = *curve.get(next.checked_sub(1)?)?;
    Some(v0 + (v1 - v0) * (time - t0) / (t1 - t0))
}

/// Gives all rows but the reference the difference of their histories from those of the reference.
pub fn compare(convergence: &Convergence, rows: &mut [StudyRow]) {
    let is_reference = |row: &StudyRow| fits(&row.labels, &convergence.against);
    let histories = |row: &StudyRow| row.record.measured.as_ref()?.histories.clone();
    let Some(reference) = rows.iter().find(|row| is_reference(row)).and_then(histories) else {
        return;
    };
    for row in rows.iter_mut().filter(|row| !is_reference(row)) {
        row.histories =
            histories(row).and_then(|own| own.difference(&reference, &convergence.columns));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn histories(points: &[(f64, Option<f64>)]) -> Histories {
        let (times, values) = points.iter().map(|(t, v)| (Some(*t), *v)).unzip();
        Histories(BTreeMap::from([("time".into(), times), ("p".into(), values)]))
    }

    #[test]
    fn differences_are_integrals_over_time() {
        let columns = ["p".to_string()];
        let exact = histories(&[(0.0, None), (1.0, Some(2.0)), (2.0, Some(4.0)), (4.0, Some(4.0))]);
        assert_eq!(exact.difference(&exact, &columns), Some(0.0));
        // 1 too high from 1 to 2, between the points of the curve, and 2 from 2 to 4
        let curve = histories(&[(1.0, Some(2.0)), (3.0, Some(8.0)), (4.0, Some(6.0))]);
        let expected = (1.0 * 1.0 + 2.0 * 2.0) / (1.0 * 4.0 + 2.0 * 4.0);
        assert!((curve.difference(&exact, &columns).unwrap() - expected).abs() < 1e-15);
        assert_eq!(curve.difference(&exact, &["q".into()]), None);
        assert!(curve.have(&columns) && !curve.have(&["q".into()]));
    }

    #[test]
    fn a_missing_column_is_named() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("histories.csv"), "time,p\n0,\n1,2.5\n").unwrap();
        let read = |column: &str| Histories::read(folder.path(), &[column.to_string()]);
        assert_eq!(read("p"), Ok(histories(&[(0.0, None), (1.0, Some(2.5))])));
        assert!(
            read("q").unwrap_err().contains("no column `q` in histories.csv; there are: time, p")
        );
    }
}
