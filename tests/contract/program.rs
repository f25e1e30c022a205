//! Starts the program and waits for its end, at most for a time limit.

use std::ffi::OsString;
use std::fs::File;
use std::io::{PipeWriter, Read, Seek};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus};
use std::sync::{RwLock, RwLockReadGuard, RwLockWriteGuard};
use std::time::{Duration, Instant};

const PROGRAM: &str = env!("CARGO_BIN_EXE_flyer-mpm");

/// Several ranks that wait for each other are slow on few cores, so such calls run alone.
static CORES: RwLock<()> = RwLock::new(());

// the guards are kept only for their drop
enum Turn {
    Shared(#[expect(dead_code)] RwLockReadGuard<'static, ()>),
    Alone(#[expect(dead_code)] RwLockWriteGuard<'static, ()>),
}

/// A call of the program.
pub struct Call {
    folder: PathBuf,
    args: Vec<OsString>,
    ranks: Option<usize>,
    limit: Duration,
    stderr: Option<PipeWriter>,
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
    _turn: Turn,
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
        }
    }

    /// Runs the call on this many ranks of mpirun.
    pub fn ranks(self, ranks: usize) -> Call {
        Call { ranks: Some(ranks), limit: Duration::from_secs(120), ..self }
    }

    /// Redirects stderr to a pipe instead of [`Ended::stderr`].
    #[allow(dead_code)] // used by other targets
    pub fn stderr(self, pipe: PipeWriter) -> Call {
        Call { stderr: Some(pipe), ..self }
    }

    fn command(&self) -> Command {
        let Some(ranks) = self.ranks else {
            let mut plain = Command::new(PROGRAM);
            plain.args(&self.args);
            return plain;
        };
        let mut mpirun = Command::new("mpirun");
        mpirun
            .args(["--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "--bind-to", "none"])
            .args(["-n", &ranks.to_string(), PROGRAM])
            .args(&self.args)
            .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
            .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
            .env("OMPI_MCA_btl_vader_single_copy_mechanism", "none");
        mpirun
    }

    /// Starts the call.
    pub fn start(mut self) -> Started {
        let turn = match self.ranks {
            Some(_) => Turn::Alone(CORES.write().unwrap_or_else(|e| e.into_inner())),
            None => Turn::Shared(CORES.read().unwrap_or_else(|e| e.into_inner())),
        };
        // files rather than pipes: a rank that outlives mpirun cannot block the test
        let (stdout, stderr) = (tempfile::tempfile().unwrap(), tempfile::tempfile().unwrap());
        let mut command = self.command();
        command.current_dir(&self.folder).stdin(std::process::Stdio::null());
        command.stdout(stdout.try_clone().unwrap());
        match self.stderr.take() {
            Some(pipe) => command.stderr(pipe),
            None => command.stderr(stderr.try_clone().unwrap()),
        };
        let since = Instant::now();
        let what = format!("{command:?}");
        let child = command.spawn().unwrap_or_else(|e| panic!("{what}: {e}"));
        Started { child, stdout, stderr, since, limit: self.limit, what, _turn: turn }
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

    /// Waits for the end; beyond the limit the process is killed and the test fails.
    #[track_caller]
    pub fn end(mut self) -> Ended {
        let status = loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                break status;
            }
            if self.since.elapsed() > self.limit {
                self.kill();
                let said = text(&mut self.stderr);
                panic!("{} ran for more than {:?}; it said: {said}", self.what, self.limit);
            }
            std::thread::sleep(Duration::from_millis(5));
        };
        Ended { status, stdout: text(&mut self.stdout), stderr: text(&mut self.stderr) }
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
        assert!(self.status.code().is_some_and(|c| c != 0), "{}: {}", self.status, self.stderr);
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

/// Sends a signal, given by name.
pub fn signal(name: &str, process: u32) {
    let sent = Command::new("kill").args([name, &process.to_string()]).status();
    assert!(sent.is_ok(), "cannot call kill");
}

fn text(file: &mut File) -> String {
    let mut bytes = Vec::new();
    file.rewind().unwrap();
    file.read_to_end(&mut bytes).unwrap();
    String::from_utf8_lossy(&bytes).into_owned()
}
