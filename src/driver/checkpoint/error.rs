//! Errors in writing, finding and reading checkpoints; each message is one line that names the
//! path.

use std::path::PathBuf;

use crate::driver::output::OutputError;

/// An error in writing, finding or reading checkpoints.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// There is no checkpoint.
    #[error("{}: {why}; allowed: a checkpoint, or a folder of them", path.display())]
    None {
        /// Path that was searched.
        path: PathBuf,
        /// What was found instead.
        why: String,
    },
    /// The file has changed since it was written.
    #[error("{}: is damaged: {why}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Evidence of the damage.
        why: String,
    },
    /// The checkpoint has another format.
    #[error(
        "{}: is a checkpoint of format {found}, written by version {version}; this program reads \
         format {known}: continue with the version that wrote it",
        path.display()
    )]
    Format {
        /// The file.
        path: PathBuf,
        /// Format of the file.
        found: String,
        /// Format that this program reads.
        known: u32,
        /// Version of the program that wrote it.
        version: String,
    },
    /// The scene, changed or not, does not fit the checkpoint.
    #[error("{}: {why}", path.display())]
    Unfit {
        /// The file.
        path: PathBuf,
        /// The reason.
        why: String,
    },
    /// The checkpoint could not be written.
    #[error("{source}; {last}")]
    Write {
        /// The cause.
        source: Box<CheckpointError>,
        /// The last good checkpoint, and how to restart from it.
        last: String,
    },
    /// The disk has too little space.
    #[error(
        "{}: a checkpoint needs about {needed} bytes, and {left} are left: make room, or choose \
         another --output",
        path.display()
    )]
    Space {
        /// The folder.
        path: PathBuf,
        /// Space needed [bytes].
        needed: u64,
        /// Space left [bytes].
        left: u64,
    },
    /// Error of the system or of HDF5.
    #[error(transparent)]
    Output(#[from] OutputError),
}
