//! Errors of a report.

use std::path::PathBuf;

use thiserror::Error;

/// An error in reading a result; the message is one line that names the path.
#[derive(Debug, Error)]
pub enum ReportError {
    /// The frames cannot be read.
    #[error("{}: cannot read HDF5: {message}", path.display())]
    Hdf5 {
        /// The file.
        path: PathBuf,
        /// Message of the library, on one line.
        message: String,
    },
    /// Error of the operating system.
    #[error("{}: cannot {doing}: {source}", path.display())]
    Io {
        /// The action that failed.
        doing: &'static str,
        /// The file.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
}
