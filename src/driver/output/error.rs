//! Faults in reading or writing results.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::summary::SUMMARY_FILE;
use crate::scene::input_file::{self, InputFault};

/// A fault in reading or writing results; each is one line that names the path.
#[derive(Debug, Error)]
pub enum OutputError {
    /// The system refused.
    #[error("{}: cannot {doing}: {source}", path.display())]
    Io {
        /// What was tried, such as `create the folder`.
        doing: &'static str,
        /// What it was tried on.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Something other than a folder stands where the folder should be.
    #[error("{}: is not a folder; choose another --output", .0.display())]
    NotAFolder(PathBuf),
    /// An earlier result is there, and the user wants it kept.
    #[error(
        "{}: exists, and --keep forbids replacing it; remove it or choose another --output",
        .0.display()
    )]
    Exists(PathBuf),
    /// The folder holds something that no run of ours has written.
    #[error(
        "{}: holds files but no {SUMMARY_FILE} of an earlier run, so it is not replaced; \
         choose another --output",
        .0.display()
    )]
    NotOurs(PathBuf),
    /// A result of another scene or command is there.
    #[error(
        "{}: holds the result of {theirs}, which is not replaced by {ours}; choose another \
         --output DIR",
        path.display()
    )]
    Foreign {
        /// The folder.
        path: PathBuf,
        /// What made the result.
        theirs: String,
        /// What would replace it.
        ours: String,
    },
    /// The place is inside of a result.
    #[error(
        "{}: is inside of the result {}, which a new run replaces as a whole; choose another --output",
        path.display(), result.display()
    )]
    Inside {
        /// The place.
        path: PathBuf,
        /// The result.
        result: PathBuf,
    },
    /// Another result is inside of the folder.
    #[error(
        "{}: has another result inside, {}, so it is not replaced; choose another --output DIR",
        path.display(), result.display()
    )]
    Around {
        /// The folder.
        path: PathBuf,
        /// The result inside.
        result: PathBuf,
    },
    /// A file that a command writes is there, and another command or the user made it.
    #[error("{}: exists and is not {kind}; choose another file", path.display())]
    OtherFile {
        /// The file.
        path: PathBuf,
        /// What it would have to be.
        kind: String,
    },
    /// The folder cannot be renamed.
    #[error("{}: is {why}, which cannot be replaced; choose a folder inside it", path.display())]
    Fixed {
        /// The folder.
        path: PathBuf,
        /// What it is, such as `a mount point`.
        why: &'static str,
    },
    /// Another run writes there.
    #[error(
        "{}: process {pid} on {host} is writing results there; wait for its end or choose another \
         --output (if it has ended, remove {})",
        path.display(), lock.display()
    )]
    Locked {
        /// The folder.
        path: PathBuf,
        /// The other's process.
        pid: u32,
        /// Its machine.
        host: String,
        /// The file that says so.
        lock: PathBuf,
    },
    /// It is no file that can be read.
    #[error("{}: {fault}", path.display())]
    Input {
        /// The file.
        path: PathBuf,
        /// What it is.
        fault: InputFault,
    },
    /// HDF5 refused.
    #[error("{}: cannot write HDF5: {message}", path.display())]
    Hdf5 {
        /// The file.
        path: PathBuf,
        /// What the library says, on one line.
        message: String,
    },
    /// Not the JSON that was expected.
    #[error("{}: {source}", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        source: serde_json::Error,
    },
    /// Not the CSV that was expected.
    #[error("{}: line {line}: {message}", path.display())]
    Csv {
        /// The file.
        path: PathBuf,
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong.
        message: String,
    },
}

impl OutputError {
    /// Puts what was tried, and on which path, before a fault of the system.
    pub fn io(doing: &'static str, path: &Path) -> impl FnOnce(io::Error) -> OutputError {
        let path = path.to_path_buf();
        move |source| OutputError::Io { doing, path, source }
    }
}

/// The text of a file of at most `most` bytes that a run has left.
pub(super) fn read_text(path: &Path, most: u64) -> Result<String, OutputError> {
    input_file::read_text(path, most).map_err(|fault| match fault {
        InputFault::Io(source) => OutputError::io("read the file", path)(source),
        fault => OutputError::Input { path: path.into(), fault },
    })
}
