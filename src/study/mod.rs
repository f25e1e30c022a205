//! Studies: a scene swept over any of its keys, and what accuracy costs in time.
//!
//! A study is a JSON file ([`spec`]); its cases ([`cases`]) are runs of the program in processes of
//! their own ([`runner`]), each made once and kept ([`record`]); the rows of its table ([`row`],
//! [`table`]) give its pictures ([`curves`], [`map`]) and the list of cheapest choices
//! ([`choices`]). Knows scenes and summaries, but no particles and no MPI.

pub mod cases;
pub mod choices;
pub mod curves;
pub mod front;
pub mod map;
pub mod record;
pub mod row;
pub mod runner;
pub mod spec;
pub mod table;

use std::path::{Path, PathBuf};

pub use cases::Case;
pub use row::Row;
pub use runner::Runner;
pub use spec::Study;

use crate::plot::{self, PictureError};

/// Why a study has no result; a case that fails is no such reason, but a row.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The study's file.
    #[error("{file}: {reason}")]
    Study {
        /// The file.
        file: String,
        /// What is wrong, and what is allowed.
        reason: String,
    },
    /// A file or folder.
    #[error("{}: {what}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was tried.
        what: &'static str,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The program could not be started.
    #[error("{program}: cannot be started: {source}")]
    Start {
        /// The program.
        program: String,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A picture.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

impl StudyError {
    /// An error of a file or folder.
    pub fn io(what: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> StudyError {
        let path = path.to_path_buf();
        move |source| StudyError::Io { path, what, source }
    }
}

/// Name of the table in a study's folder.
pub const TABLE_FILE: &str = "study.csv";

/// Name of the list of cheapest choices.
pub const CHOICES_FILE: &str = "choices.md";

/// Runs what is missing of a study and writes its table, choices and pictures to the runner's
/// folder; returns the rows.
pub fn run(study: &Study, runner: &Runner) -> Result<Vec<Row>, StudyError> {
    let rows = runner.run(study)?;
    write(study, &rows, &runner.folder)?;
    Ok(rows)
}

/// Writes table, choices and pictures of finished rows.
pub fn write(study: &Study, rows: &[Row], folder: &Path) -> Result<(), StudyError> {
    let put = |name: &str, text: String| {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(StudyError::io("cannot be written", &path))
    };
    put(TABLE_FILE, table::csv(study, rows))?;
    if let Some(choices) = &study.choices {
        put(CHOICES_FILE, choices::markdown(choices, rows))?;
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
