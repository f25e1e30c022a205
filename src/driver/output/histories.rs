//! Histories: values recorded at many times, written as `histories.csv`.

use std::path::Path;

use super::csv::{field, push_number, write_rows};
use super::error::OutputError;
use crate::simulation::TableColumn;

/// Name of the file in the folder of results.
pub const HISTORIES_FILE: &str = "histories.csv";

/// Named columns that grow row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HistoryTable {
    columns: Vec<TableColumn>,
}

impl HistoryTable {
    /// Empty columns with these names and SI units.
    pub fn new<N: Into<String>, U: Into<String>>(
        columns: impl IntoIterator<Item = (N, U)>,
    ) -> HistoryTable {
        let column = |(name, unit): (N, U)| TableColumn {
            name: name.into(),
            unit: unit.into(),
            values: Vec::new(),
        };
        HistoryTable { columns: columns.into_iter().map(column).collect() }
    }

    /// A table of the given columns.
    pub fn of(columns: Vec<TableColumn>) -> HistoryTable {
        HistoryTable { columns }
    }

    /// Appends one value to each column, in order and in the unit of the column; NaN for a missing
    /// value.
    ///
    /// # Panics
    /// If the number of values differs from the number of columns.
    pub fn push(&mut self, row: &[f64]) {
        assert_eq!(row.len(), self.columns.len(), "one value a column of the histories");
        for (column, &value) in self.columns.iter_mut().zip(row) {
            column.values.push(value);
        }
    }

    /// The first `count` rows.
    pub fn first(&self, count: usize) -> HistoryTable {
        let cut = |c: &TableColumn| TableColumn {
            values: c.values[..count.min(c.values.len())].to_vec(),
            ..c.clone()
        };
        HistoryTable { columns: self.columns.iter().map(cut).collect() }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.columns.first().map_or(0, |c| c.values.len())
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The columns in the order of the file.
    pub fn columns(&self) -> &[TableColumn] {
        &self.columns
    }

    /// Values of the column `name` in its unit, one per row; `None` if there is no such column.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|c| c.name == name).map(|c| c.values.as_slice())
    }

    /// Writes the rows in the CSV format of the profiles.
    ///
    /// # Errors
    ///
    /// If the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        let header: Vec<String> = self.columns.iter().map(|c| field(&c.name)).collect();
        write_rows(path, &header, self.len(), |text, row| {
            for (i, column) in self.columns.iter().enumerate() {
                if i > 0 {
                    text.push(b',');
                }
                push_number(text, column.values[row]);
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::csv::read_csv;
    use super::*;

    #[test]
    fn rows_come_back() {
        let mut histories = HistoryTable::new([("time", "s"), ("interface_x", "m")]);
        assert!(histories.is_empty());
        histories.push(&[0.0, f64::NAN]);
        histories.push(&[1e-9, 0.1]);
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join(HISTORIES_FILE);
        histories.write(&path).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "time,interface_x\n0.0,\n1e-9,0.1\n");
        assert_eq!(read_csv(&path).unwrap().numbers("time"), histories.column("time"));
        assert_eq!((histories.len(), histories.columns()[1].unit.as_str()), (2, "m"));
    }

    #[test]
    #[should_panic(expected = "one value a column")]
    fn a_short_row_is_refused() {
        HistoryTable::new([("time", "s"), ("dt", "s")]).push(&[0.0]);
    }
}
