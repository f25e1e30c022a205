//! Faults in writing, finding and reading checkpoints; each is one line that names the path.

use std::path::PathBuf;

use crate::driver::output::OutputError;

/// A fault in writing, finding or reading checkpoints.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// There is none.
    #[error("{}: {why}; allowed: a checkpoint, or a folder of them", path.display())]
    None {
        /// Where it was looked for.
        path: PathBuf,
        /// What is there instead.
        why: String,
    },
    /// It is not what was written.
    #[error("{}: is damaged: {why}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What shows it.
        why: String,
    },
    /// It is of another form.
    #[error(
        "{}: is a checkpoint of format {found}, written by version {version}; this program reads \
         format {known}: go on with the version that wrote it",
        path.display()
    )]
    Format {
        /// The file.
        path: PathBuf,
        /// Its format.
        found: String,
        /// The one that is known.
        known: u32,
        /// Version of the program that wrote it.
        version: String,
    },
    /// The scene, changed or not, is not one that it can go on with.
    #[error("{}: {why}", path.display())]
    Unfit {
        /// The file.
        path: PathBuf,
        /// Why not.
        why: String,
    },
    /// It could not be written.
    #[error("{source}; {last}")]
    Write {
        /// What went wrong.
        source: Box<CheckpointError>,
        /// What is left to go on from, and how.
        last: String,
    },
    /// The disk would be full.
    #[error(
        "{}: a checkpoint needs about {needed} bytes, and {left} are left: make room, or choose \
         another --output",
        path.display()
    )]
    Space {
        /// The folder.
        path: PathBuf,
        /// What is needed [bytes].
        needed: u64,
        /// What is left [bytes].
        left: u64,
    },
    /// The system or HDF5 refused.
    #[error(transparent)]
    Output(#[from] OutputError),
}
