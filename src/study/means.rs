//! Means of rows that differ only in some labels, such as the position of the grid or the impact.

use super::StudyRow;
use super::spec::Study;

/// Rows whose other labels are the same.
#[derive(Clone, Debug)]
pub struct MeanRow<'a> {
    rows: Vec<&'a StudyRow>,
}

/// Groups of the rows that differ only in the labels `over`, in the order of their first rows.
pub fn means<'a>(
    study: &Study,
    rows: impl Iterator<Item = &'a StudyRow>,
    over: &[String],
) -> Vec<MeanRow<'a>> {
    let kept: Vec<String> = study
        .labels()
        .into_iter()
        .map(String::from)
        .filter(|label| !over.contains(label))
        .collect();
    let mut groups: Vec<(String, MeanRow<'a>)> = Vec::new();
    for row in rows {
        let name = row.name(&kept);
        match groups.iter_mut().find(|(known, _)| *known == name) {
            Some((_, group)) => group.rows.push(row),
            None => groups.push((name, MeanRow { rows: vec![row] })),
        }
    }
    groups.into_iter().map(|(_, group)| group).collect()
}

impl MeanRow<'_> {
    /// Number of rows.
    pub fn count(&self) -> usize {
        self.rows.len()
    }

    /// First row: its labels are those of all rows, but for those over which the mean is taken.
    pub fn first(&self) -> &StudyRow {
        self.rows[0]
    }

    /// Mean of the absolute values of [`StudyRow::number`]; `None` if a row has no value, so that a
    /// case that fails is not left out of a mean.
    pub fn mean(&self, name: &str, time: Option<f64>) -> Option<f64> {
        let values = self.values(name, time)?;
        Some(values.iter().sum::<f64>() / values.len() as f64)
    }

    /// Greatest of the absolute values of [`StudyRow::number`]; `None` if a row has no value.
    pub fn greatest(&self, name: &str, time: Option<f64>) -> Option<f64> {
        Some(self.values(name, time)?.into_iter().fold(0.0, f64::max))
    }

    fn values(&self, name: &str, time: Option<f64>) -> Option<Vec<f64>> {
        self.rows.iter().map(|row| Some(row.number(name, time)?.abs())).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use serde_json::json;

    use super::super::record::{Measured, ProfileErrors, Seconds, StudyRecord};
    use super::*;

    fn row(scheme: &str, offset: &str, l1: Option<f64>, seconds: f64) -> StudyRow {
        let labels = BTreeMap::from([
            ("scheme".to_string(), scheme.to_string()),
            ("offset".to_string(), offset.to_string()),
        ]);
        let profile = |(time, factor)| ProfileErrors {
            time,
            errors: l1.map(|l1| json!({"l1": factor * l1})),
        };
        let measured = Measured {
            particles: 1,
            cells: 1,
            steps: 1,
            energy_drift: None,
            momentum_drift: None,
            profiles: [(1.0, 10.0), (2.0, 1.0)].map(profile).to_vec(),
            histories: None,
            estimate: None,
        };
        let time = Seconds { loop_cpu: seconds, loop_wall: 0.0, cpu: 0.0, wall: 0.0 };
        let record = StudyRecord { measured: Some(measured), failure: None, seconds: vec![time] };
        StudyRow { labels, ranks: 1, threads: 1, record, histories: None }
    }

    fn study() -> Study {
        serde_json::from_value(json!({
            "title": "", "scene": "", "sweep": [
                {"key": "scheme", "values": []}, {"key": "offset", "values": []},
            ],
        }))
        .unwrap()
    }

    #[test]
    fn rows_are_averaged_over_labels() {
        let rows = [
            row("a", "0", Some(-0.1), 1.0),
            row("b", "0", Some(0.5), 3.0),
            row("a", "1", Some(0.3), 2.0),
            row("b", "1", None, 3.0),
        ];
        let means = means(&study(), rows.iter(), &["offset".into()]);
        assert_eq!(means.len(), 2);
        let [a, b] = &means[..] else { unreachable!() };
        assert_eq!([a.count(), b.count()], [2, 2]);
        assert_eq!(a.first().labels["scheme"], "a");
        // the last profile, or that of a time
        assert!((a.mean("l1", None).unwrap() - 0.2).abs() < 1e-15);
        assert!((a.mean("l1", Some(1.0)).unwrap() - 2.0).abs() < 1e-14);
        assert_eq!(a.greatest("l1", None), Some(0.3));
        assert_eq!(a.mean("loop_cpu_seconds", None), Some(1.5));
        assert_eq!(b.mean("l1", None), None);
        assert_eq!(b.mean("loop_cpu_seconds", None), Some(3.0));
    }

    #[test]
    fn without_labels_each_row_is_its_own_mean() {
        let rows = [row("a", "0", Some(-0.1), 1.0), row("a", "1", Some(0.3), 2.0)];
        let means = means(&study(), rows.iter(), &[]);
        let l1: Vec<_> = means.iter().map(|mean| mean.mean("l1", None).unwrap()).collect();
        assert_eq!(l1, [0.1, 0.3]);
    }
}
