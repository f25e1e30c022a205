//! Reasons why a study has no result.

use std::path::{Path, PathBuf};

use crate::plot::PictureError;

/// Reasons why a study has no result. A failed case is not one of them: it is a row of the table.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The file of the study is not valid.
    #[error("{file}: {reason}")]
    Study {
        /// The file.
        file: String,
        /// The error, and the allowed values.
        reason: String,
    },
    /// A file or folder cannot be used.
    #[error("{}: {what}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The operation that failed.
        what: &'static str,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The program could not be started.
    #[error("{program}: cannot be started: {source}")]
    Start {
        /// The program.
        program: String,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// A picture cannot be drawn.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

impl StudyError {
    /// Converts an I/O error of a file or folder.
    pub fn io(what: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> StudyError {
        let path = path.to_path_buf();
        move |source| StudyError::Io { path, what, source }
    }
}
