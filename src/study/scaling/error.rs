//! Reasons why a scaling study has no result.

use std::path::{Path, PathBuf};

use crate::driver::output::OutputError;
use crate::plot::PictureError;

/// Reasons why a scaling study has no result; each message is one line.
#[derive(Debug, thiserror::Error)]
pub enum ScalingError {
    /// The scene cannot be read or is not valid for one of the configurations.
    #[error("{0}")]
    Scene(String),
    /// The folder of the results cannot be used.
    #[error(transparent)]
    Folder(#[from] OutputError),
    /// A process cannot be started.
    #[error("cannot start {command}: {source}")]
    Start {
        /// The command with its arguments.
        command: String,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A run failed; the text names its ranks and threads, and contains its message.
    #[error("{0}")]
    Run(String),
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The summary of a run is not the expected JSON, or a table cannot be written.
    #[error("{}: {reason}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// The reason.
        reason: String,
    },
    /// The picture cannot be drawn.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

impl ScalingError {
    /// Adds the path to an error of the operating system.
    pub(super) fn io(path: &Path) -> impl FnOnce(std::io::Error) -> ScalingError {
        let path = path.to_path_buf();
        move |source| ScalingError::Io { path, source }
    }

    /// Adds the path to an error of the format.
    pub(super) fn format<E: ToString>(path: &Path) -> impl FnOnce(E) -> ScalingError {
        let path = path.to_path_buf();
        move |error| ScalingError::Format { path, reason: error.to_string() }
    }
}
