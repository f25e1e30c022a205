//! Studies: sweeps of a scene over any of its keys, to relate accuracy to cost.
//!
//! A study is a JSON file ([`spec`]). Each of its cases ([`cases`]) is a run of the program in a
//! process of its own ([`runner`]); its result is kept and reused ([`record`]). The rows of the
//! table ([`row`], [`table`]) give the pictures ([`curves`], [`map`]) and the list of cheapest
//! choices ([`choices`]). [`scaling`] varies ranks and threads instead. Depends on scenes and
//! summaries, but not on particles or MPI.

pub mod cases;
pub mod choices;
pub mod convergence;
pub mod curves;
pub mod error;
pub mod front;
pub mod map;
pub mod means;
pub mod record;
pub mod row;
pub mod runner;
pub mod scaling;
pub mod spec;
pub mod table;

use std::path::Path;

pub use cases::Case;
pub use error::StudyError;
pub use row::StudyRow;
pub use runner::StudyRunner;
pub use spec::Study;

use crate::plot;

/// File name of the table in the folder of a study.
pub const TABLE_FILE: &str = "study.csv";

/// File name of the list of cheapest choices.
pub const CHOICES_FILE: &str = "choices.md";

/// Runs the missing cases of a study, and writes its table, choices and pictures to the folder of
/// the runner. Returns the rows.
///
/// # Errors
///
/// If the study is not valid, if a program cannot be started, or if a file cannot be written.
pub fn run(study: &Study, runner: &StudyRunner) -> Result<Vec<StudyRow>, StudyError> {
    let rows = runner.run(study)?;
    write(study, &rows, &runner.folder)?;
    Ok(rows)
}

/// Writes the table, choices and pictures of finished rows.
///
/// # Errors
///
/// If a file cannot be written, or if a picture cannot be drawn.
pub fn write(study: &Study, rows: &[StudyRow], folder: &Path) -> Result<(), StudyError> {
    let put = |name: &str, text: String| {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(StudyError::io("cannot be written", &path))
    };
    put(TABLE_FILE, table::csv(study, rows))?;
    if let Some(choices) = &study.choices {
        put(CHOICES_FILE, choices::markdown(study, choices, rows))?;
    }
    for picture in &study.pictures {
        let (name, figure) = match picture {
            spec::Picture::Curves(curves) => (&curves.name, curves::figure(study, curves, rows)),
            spec::Picture::Map(map) => (&map.name, map::figure(map, rows)),
        };
        plot::draw(&figure, &folder.join(name))?;
    }
    Ok(())
}
