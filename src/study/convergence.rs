//! Differences of the histories of cases from those of a reference case: an error for scenes
//! without an exact solution.

use super::StudyRow;
use super::cases::fits;
use super::spec::Convergence;

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
