//! Columns of the histories of a case, and their difference from those of another.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::accuracy::estimate::GaugeHistory;

/// Columns of `histories.csv`; an empty entry is `None`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CaseHistories(BTreeMap<String, Vec<Option<f64>>>);

impl CaseHistories {
    /// The `columns` and the time of the histories in the folder of a run. The error is the reason
    /// why they cannot be read.
    ///
    /// # Errors
    ///
    /// If there is no such file or column.
    pub fn read(folder: &Path, columns: &[String]) -> Result<CaseHistories, String> {
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
        Ok(CaseHistories(names.map(column).collect::<Result<_, String>>()?))
    }

    /// Whether the histories have these columns.
    pub fn have(&self, columns: &[String]) -> bool {
        columns.iter().all(|column| self.0.contains_key(column))
    }

    /// History of a column, without empty entries.
    fn history(&self, column: &str) -> Option<GaugeHistory> {
        let (times, values) = (self.0.get("time")?, self.0.get(column)?);
        let rows = times.iter().zip(values).filter_map(|(t, v)| Some(((*t)?, (*v)?)));
        let (times, values) = rows.unzip();
        let (gauge, quantity) = (String::new(), column.to_string());
        Some(GaugeHistory { gauge, quantity, times, components: vec![values] })
    }

    /// Mean over the `columns` of the integral of |v - v_ref| over time, divided by the integral of
    /// |v_ref|; `None` if a column is missing or zero.
    pub fn difference(&self, reference: &CaseHistories, columns: &[String]) -> Option<f64> {
        let mut sum = 0.0;
        for column in columns {
            sum += reference.history(column)?.difference(&self.history(column)?)?;
        }
        Some(sum / columns.len() as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn histories(points: &[(f64, Option<f64>)]) -> CaseHistories {
        let (times, values) = points.iter().map(|(t, v)| (Some(*t), *v)).unzip();
        CaseHistories(BTreeMap::from([("time".into(), times), ("p".into(), values)]))
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
        let read = |column: &str| CaseHistories::read(folder.path(), &[column.to_string()]);
        assert_eq!(read("p"), Ok(histories(&[(0.0, None), (1.0, Some(2.5))])));
        assert!(
            read("q").unwrap_err().contains("no column `q` in histories.csv; there are: time, p")
        );
    }
}
