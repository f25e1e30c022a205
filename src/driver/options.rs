//! Options and start of a run.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicU8;
use std::time::Instant;

use crate::driver::checkpoint::Checkpoint;
use crate::driver::progress::ProgressChoice;

/// Start of a run.
pub enum Beginning {
    /// The initial state of its scene.
    Scene,
    /// A checkpoint that fits the scene.
    Checkpoint(Box<Checkpoint>),
}

/// Options of a run.
#[derive(Clone, Debug)]
pub struct Options {
    /// Folder of the results.
    pub output: PathBuf,
    /// Whether an earlier result must not be replaced.
    pub keep: bool,
    /// Whether only errors are printed.
    pub quiet: bool,
    /// When rank 0 shows the progress; never if `quiet`.
    pub progress: ProgressChoice,
    /// Whether the report at the end has the errors of all profiles, the effects and the ranks.
    pub verbose: bool,
    /// Threads per rank.
    pub threads: usize,
    /// File of the timeline, and the range of its steps.
    pub trace: Option<(PathBuf, Range<u64>)>,
    /// Start time of the process.
    pub started: Instant,
    /// Number of a signal that requests an end; 0: none.
    pub signal: Arc<AtomicU8>,
    /// Commit of the sources of the program, for the summary.
    pub commit: Option<&'static str>,
}

impl Options {
    /// Options of a run on one thread that prints only errors and writes its results to `output`.
    pub fn quiet(output: PathBuf) -> Options {
        Options {
            output,
            keep: false,
            quiet: true,
            progress: ProgressChoice::Never,
            verbose: false,
            threads: 1,
            trace: None,
            started: Instant::now(),
            signal: Arc::default(),
            commit: None,
        }
    }
}
