//! Starts the program and waits for its end, at most for a time limit.

use std::ffi::OsString;
use std::fs::File;
use std::io::PipeWriter;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus};
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

use tempfile::TempDir;

#[cfg(feature = "mpi")]
use crate::home::Home;

const PROGRAM: &str = env!("CARGO_BIN_EXE_flyer-mpm");

/// Lets Open MPI run in a container.
const AS_ROOT: [(&str, &str); 2] =
    [("OMPI_ALLOW_RUN_AS_ROOT", "1"), ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")];

/// Processes of the program that run at a time: two runs of three ranks. More would be slow on few
/// cores, for ranks wait for each other.
const MOST_PROCESSES: usize = 6;

/// Number of further processes that may run.
static FREE: Mutex<usize> = Mutex::new(MOST_PROCESSES);
/// Signals an increase of `FREE`.
static FREED: Condvar = Condvar::new();
/// Held by the test that waits for processes, so that no later one overtakes it.
static NEXT: Mutex<()> = Mutex::new(());

/// Time for mpirun to end itself after it has reported the exit code of its ranks. Open MPI 4.1
/// sometimes hangs or crashes there, in `PMIx_server_finalize`.
const LAUNCHER_END: Duration = Duration::from_secs(10);

/// Leave to run a number of processes, until it is dropped; several calls may be made within one.
pub struct Turn {
    processes: usize,
}

impl Turn {
    /// Waits until so many processes may run.
    pub fn of(processes: usize) -> Turn {
        let processes = processes.min(MOST_PROCESSES);
        let _next = NEXT.lock().unwrap_or_else(PoisonError::into_inner);
        let free = FREE.lock().unwrap_or_else(PoisonError::into_inner);
        let mut free = FREED
            .wait_while(free, |free| *free < processes)
            .unwrap_or_else(PoisonError::into_inner);
        *free -= processes;
        Turn { processes }
    }

    /// Waits until no other test runs processes.
    #[cfg(feature = "mpi")]
    pub fn alone() -> Turn {
        Turn::of(MOST_PROCESSES)
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        *FREE.lock().unwrap_or_else(PoisonError::into_inner) += self.processes;
        FREED.notify_one();
    }
}

/// A call of the program.
pub struct Call {
    folder: PathBuf,
    args: Vec<OsString>,
    ranks: Option<usize>,
    limit: Duration,
    /// Receives stderr instead of [`Ended::stderr`].
    pub stderr: Option<PipeWriter>,
    within: bool,
}

/// A call that has ended.
pub struct Ended {
    pub status: ExitStatus,
    pub stdout: String,
    pub stderr: String,
}

/// A call that is still running.
pub struct Started {
    child: Child,
    stdout: File,
    stderr: File,
    since: Instant,
    limit: Duration,
    what: String,
    _turn: Option<Turn>,
    _sessions: TempDir,
}

impl Call {
    /// The program with these arguments, started in `folder`, without mpirun.
    pub fn new<A: AsRef<str>>(folder: &Path, args: impl IntoIterator<Item = A>) -> Call {
        Call {
            folder: folder.to_path_buf(),
            args: args.into_iter().map(|a| a.as_ref().into()).collect(),
            ranks: None,
            limit: Duration::from_secs(60),
            stderr: None,
            within: false,
        }
    }

    /// Runs the call on this many ranks of mpirun.
    pub fn ranks(self, ranks: usize) -> Call {
        Call { ranks: Some(ranks), limit: Duration::from_secs(120), ..self }
    }

    /// Makes the call within a turn that the test has, beside its other calls.
    #[cfg(feature = "mpi")]
    pub fn within(self, _turn: &Turn) -> Call {
        Call { within: true, ..self }
    }

    fn command(&self) -> Command {
        let Some(ranks) = self.ranks else {
            let mut plain = Command::new(PROGRAM);
            // for commands that start mpirun themselves
            plain.args(&self.args).envs(AS_ROOT);
            return plain;
        };
        let mut mpirun = Command::new("mpirun");
        mpirun
            .args(["--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "--bind-to", "none"])
            .args(["-n", &ranks.to_string(), PROGRAM])
            .args(&self.args)
            .envs(AS_ROOT)
            .env("OMPI_MCA_btl_vader_single_copy_mechanism", "none");
        mpirun
    }

    /// Starts the call.
    pub fn start(mut self) -> Started {
        let turn = (!self.within).then(|| Turn::of(self.ranks.unwrap_or(1)));
        // files rather than pipes: a rank that outlives mpirun cannot block the test
        let (stdout, stderr) = (tempfile::tempfile().unwrap(), tempfile::tempfile().unwrap());
        let mut command = self.command();
        // one that ends removes the folder of the user's sessions while another is about to use it
        let sessions = tempfile::tempdir().unwrap();
        command.env("OMPI_MCA_orte_tmpdir_base", sessions.path());
        command.current_dir(&self.folder).stdin(std::process::Stdio::null());
        command.stdout(stdout.try_clone().unwrap());
        match self.stderr.take() {
            Some(pipe) => command.stderr(pipe),
            None => command.stderr(stderr.try_clone().unwrap()),
        };
        let since = Instant::now();
        let what = format!("{command:?}");
        let child = command.spawn().unwrap_or_else(|e| panic!("{what}: {e}"));
        let (limit, _turn, _sessions) = (self.limit, turn, sessions);
        Started { child, stdout, stderr, since, limit, what, _turn, _sessions }
    }

    /// Runs the call to its end.
    #[track_caller]
    pub fn end(self) -> Ended {
        self.start().end()
    }
}

impl Started {
    /// Process id; that of mpirun if it is used.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Whether the process is still running.
    pub fn runs(&mut self) -> bool {
        self.child.try_wait().unwrap().is_none()
    }

    /// Text on stderr so far.
    pub fn said(&self) -> String {
        text(&self.stderr)
    }

    /// Waits for the end; beyond the limit the process is killed and the test fails.
    #[track_caller]
    pub fn end(mut self) -> Ended {
        let mut reported: Option<Instant> = None;
        let status = loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                break status;
            }
            if reported.is_none() && reported_code(&self.said()).is_some() {
                reported = Some(Instant::now());
            }
            if reported.is_some_and(|at| at.elapsed() > LAUNCHER_END) {
                self.kill();
                break self.child.wait().unwrap();
            }
            if self.since.elapsed() > self.limit {
                self.kill();
                let said = text(&self.stderr);
                panic!("{} ran for more than {:?}; it said: {said}", self.what, self.limit);
            }
            std::thread::sleep(Duration::from_millis(5));
        };
        Ended { status, stdout: text(&self.stdout), stderr: text(&self.stderr) }
    }

    /// Kills the process; mpirun is given time to end its ranks.
    fn kill(&mut self) {
        signal("-TERM", self.id());
        let asked = Instant::now();
        while self.runs() && asked.elapsed() < Duration::from_secs(5) {
            std::thread::sleep(Duration::from_millis(20));
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for Started {
    fn drop(&mut self) {
        if self.runs() {
            self.kill();
        }
    }
}

impl Ended {
    /// Exit code of the program. That of its ranks if mpirun itself ended by a signal after it had
    /// reported the code.
    pub fn code(&self) -> Option<i32> {
        self.status.code().or_else(|| reported_code(&self.stderr))
    }

    /// Asserts success and returns stdout.
    #[track_caller]
    pub fn succeeded(self) -> String {
        assert!(self.status.success(), "{}: {}", self.status, self.stderr);
        assert!(!self.stderr.contains("panicked"), "{}", self.stderr);
        assert_eq!(self.errors().len(), 0, "{}", self.stderr);
        self.stdout
    }

    /// Asserts a failure with one line of message that contains all fragments, and an empty stdout.
    #[track_caller]
    pub fn failed(&self, fragments: &[&str]) {
        assert!(self.code().is_some_and(|c| c != 0), "{}: {}", self.status, self.stderr);
        assert!(!self.stderr.contains("panicked"), "{}", self.stderr);
        assert_eq!(self.stdout, "");
        let errors = self.errors();
        assert_eq!(errors.len(), 1, "{}", self.stderr);
        for fragment in fragments {
            assert!(errors[0].contains(fragment), "no `{fragment}` in: {}", self.stderr);
        }
    }

    fn errors(&self) -> Vec<&str> {
        self.stderr.lines().filter(|l| l.starts_with("error:")).collect()
    }
}

/// Exit code of the ranks that mpirun has reported. It does so when all its ranks have ended.
fn reported_code(stderr: &str) -> Option<i32> {
    stderr.lines().find_map(|line| line.trim().strip_prefix("Exit code:"))?.trim().parse().ok()
}

/// Does the same in every folder, at the same time; `act` also gets the index of the folder.
#[cfg(feature = "mpi")]
pub fn at_once(homes: &[Home], act: impl Fn(&Home, usize) + Sync) {
    std::thread::scope(|scope| {
        for (k, home) in homes.iter().enumerate() {
            let act = &act;
            scope.spawn(move || act(home, k));
        }
    });
}

/// Sends a signal, given by name.
pub fn signal(name: &str, process: u32) {
    let sent = Command::new("kill").args([name, &process.to_string()]).status();
    assert!(sent.is_ok(), "cannot call kill");
}

/// Content of a file to which a process may still write. The file position, which that process
/// shares, does not move.
fn text(file: &File) -> String {
    let mut bytes = vec![0; file.metadata().unwrap().len() as usize];
    let read = file.read_at(&mut bytes, 0).unwrap();
    String::from_utf8_lossy(&bytes[..read]).into_owned()
}
