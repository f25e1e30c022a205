//! Errors in reading or writing results.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::file_names::SUMMARY_FILE;
use crate::input::input_file::{self, InputFault};

/// An error in reading or writing results; each message is one line that names the path.
#[derive(Debug, Error)]
pub enum OutputError {
    /// Error of the operating system.
    #[error("{}: cannot {doing}: {source}", path.display())]
    Io {
        /// The action that failed, such as `create the folder`.
        doing: &'static str,
        /// Path of the action.
        path: PathBuf,
        /// Error of the system.
        source: io::Error,
    },
    /// The path of the folder exists but is not a folder.
    #[error("{}: is not a folder; choose another --output", .0.display())]
    NotAFolder(PathBuf),
    /// The summary has another format.
    #[error("{}: is of format {format}; allowed: {read}, which this program writes and reads", path.display())]
    Format {
        /// Path of the summary.
        path: PathBuf,
        /// Format of the summary; 1 if it states none.
        format: u64,
        /// The format that this program reads.
        read: u32,
    },
    /// There is an earlier result, and the user asked to keep it.
    #[error(
        "{}: exists, and --keep forbids replacing it; remove it or choose another --output",
        .0.display()
    )]
    Exists(PathBuf),
    /// The folder contains files that are not a result of this program.
    #[error(
        "{}: holds files but no {SUMMARY_FILE} of an earlier run, so it is not replaced; \
         choose another --output",
        .0.display()
    )]
    NotOurs(PathBuf),
    /// The folder contains a result of another scene or command.
    #[error(
        "{}: holds the result of {theirs}, which is not replaced by {ours}; choose another \
         --output DIR",
        path.display()
    )]
    Foreign {
        /// The folder.
        path: PathBuf,
        /// Origin of the existing result.
        theirs: String,
        /// Origin of the new result.
        ours: String,
    },
    /// The path is inside a result.
    #[error(
        "{}: is inside of the result {}, which a new run replaces as a whole; choose another --output",
        path.display(), result.display()
    )]
    Inside {
        /// The path.
        path: PathBuf,
        /// The result.
        result: PathBuf,
    },
    /// The folder contains another result.
    #[error(
        "{}: has another result inside, {}, so it is not replaced; choose another --output DIR",
        path.display(), result.display()
    )]
    Around {
        /// The folder.
        path: PathBuf,
        /// The result inside the folder.
        result: PathBuf,
    },
    /// The file exists and was made by another command or by the user.
    #[error("{}: exists and is not {kind}; choose another file", path.display())]
    OtherFile {
        /// The file.
        path: PathBuf,
        /// The kind of file that this command writes.
        kind: String,
    },
    /// The folder cannot be renamed.
    #[error("{}: is {why}, which cannot be replaced; choose a folder inside it", path.display())]
    Fixed {
        /// The folder.
        path: PathBuf,
        /// The reason, such as `a mount point`.
        why: &'static str,
    },
    /// Another run writes into the folder.
    #[error(
        "{}: process {pid} on {host} is writing results there; wait for its end or choose another \
         --output (if it has ended, remove {})",
        path.display(), lock.display()
    )]
    Locked {
        /// The folder.
        path: PathBuf,
        /// Process of the other run.
        pid: u32,
        /// Machine of the other run.
        host: String,
        /// The lock file.
        lock: PathBuf,
    },
    /// The input file cannot be read.
    #[error("{}: {fault}", path.display())]
    Input {
        /// The file.
        path: PathBuf,
        /// The reason.
        fault: InputFault,
    },
    /// Error of the HDF5 library.
    #[error("{}: cannot write HDF5: {message}", path.display())]
    Hdf5 {
        /// The file.
        path: PathBuf,
        /// Message of the library, on one line.
        message: String,
    },
    /// The file is not the expected JSON.
    #[error("{}: {source}", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// The error and its position.
        source: serde_json::Error,
    },
    /// Error of another rank, at rank 0.
    #[error("rank {rank}: {text}")]
    OnRank {
        /// The other rank.
        rank: usize,
        /// Its message.
        text: String,
    },
    /// Error of another rank; rank 0 has the message.
    #[error("another rank has failed")]
    Elsewhere,
    /// The file is not the expected CSV.
    #[error("{}: line {line}: {message}", path.display())]
    Csv {
        /// The file.
        path: PathBuf,
        /// Number of the line, from 1.
        line: u64,
        /// The error.
        message: String,
    },
}

impl OutputError {
    /// Adds the failed action and its path to an error of the system.
    pub fn io(doing: &'static str, path: &Path) -> impl FnOnce(io::Error) -> OutputError {
        let path = path.to_path_buf();
        move |source| OutputError::Io { doing, path, source }
    }
}

/// Text of a result file of at most `most` bytes.
pub(super) fn read_text(path: &Path, most: u64) -> Result<String, OutputError> {
    input_file::read_text(path, most).map_err(|fault| match fault {
        InputFault::Io(source) => OutputError::io("read the file", path)(source),
        fault => OutputError::Input { path: path.into(), fault },
    })
}
