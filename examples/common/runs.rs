//! Starts the program as a user does, and reads what it writes.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, Read, Seek};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use flyer_mpm::driver::output::csv::{CsvTable, read_csv};
use flyer_mpm::driver::output::summary::Summary;
use wait4::Wait4;

use super::resident::Watcher;

/// A run of the program.
#[derive(Clone, Debug)]
pub struct Job {
    scene: &'static str,
    sets: Vec<String>,
    ranks: usize,
    threads: usize,
    whole: bool,
    own_cores: bool,
    watched: bool,
}

impl Job {
    /// The shipped scene `inputs/SCENE.json` on one rank and thread, without pictures and HDF5.
    pub fn new(scene: &'static str) -> Job {
        let (whole, own_cores, watched) = (false, false, false);
        Job { scene, sets: Vec::new(), ranks: 1, threads: 1, whole, own_cores, watched }
    }

    /// With `--set PATH=VALUE`.
    pub fn set(mut self, set: impl Into<String>) -> Job {
        self.sets.push(set.into());
        self
    }

    /// On this many ranks; more than one are started by mpirun.
    #[allow(dead_code)] // not every check looks at ranks
    pub fn ranks(self, ranks: usize) -> Job {
        Job { ranks, ..self }
    }

    /// With this many threads a rank.
    #[allow(dead_code)] // not every check looks at threads
    pub fn threads(self, threads: usize) -> Job {
        Job { threads, ..self }
    }

    /// With every output that the scene has, pictures and HDF5 among them.
    #[allow(dead_code)] // not every check looks at pictures
    pub fn whole(self) -> Job {
        Job { whole: true, ..self }
    }

    /// Started by mpirun even on one rank, each rank bound to a core of its own.
    #[allow(dead_code)] // not every check times ranks
    pub fn on_own_cores(self) -> Job {
        Job { own_cores: true, ..self }
    }

    /// With its memory looked at while it runs.
    #[allow(dead_code)] // not every check looks at memory
    pub fn watched(self) -> Job {
        Job { watched: true, ..self }
    }

    fn command(&self, root: &Path, target: &Path) -> Command {
        let program = target.join("release/flyer-mpm");
        let mut command = if self.ranks > 1 || self.own_cores {
            let mut mpirun = Command::new("mpirun");
            if self.own_cores {
                mpirun.args(["--bind-to", "core"]);
            } else {
                mpirun.args(["--oversubscribe", "--bind-to", "none"]);
                let cores = std::thread::available_parallelism().map_or(1, usize::from);
                if self.ranks * self.threads >= cores {
                    mpirun.args(["--mca", "mpi_yield_when_idle", "1"]);
                }
            }
            mpirun.args(["-n", &self.ranks.to_string()]).arg(program);
            mpirun
        } else {
            Command::new(program)
        };
        command.arg(root.join(format!("inputs/{}.json", self.scene)));
        command.args(["--threads", &self.threads.to_string()]);
        // a run that hangs is to say so
        command.args(["--stall-timeout", "60"]);
        if !self.whole {
            command.args(["--set", "output.pictures=false", "--set", "output.hdf5=false"]);
        }
        for set in &self.sets {
            command.args(["--set", set]);
        }
        command
    }

    /// Runs it; the error is what the program said last.
    pub fn run(&self) -> Result<Outcome, String> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let target =
            std::env::var_os("CARGO_TARGET_DIR").map_or(root.join("target"), PathBuf::from);
        let check = std::env::current_exe().ok();
        let check = check.as_deref().and_then(Path::file_stem).unwrap_or(OsStr::new("check"));
        let folder = target.join(check).join(self.scene);
        let _ = fs::remove_dir_all(&folder);
        let mut command = self.command(root, &target);
        command.arg("--output").arg(&folder).stdin(Stdio::null());
        let ended = self.ended(&mut command);
        let ended = ended.map_err(|error| format!("cannot run {command:?}: {error}"))?;
        if !ended.usage.status.success() {
            let line = ended.stderr.lines().find(|l| l.starts_with("error: "));
            let line = line.or_else(|| ended.stderr.lines().find(|l| !l.trim().is_empty()));
            return Err(format!("{}: {}", ended.usage.status, line.unwrap_or("no message")));
        }
        let summary = Summary::read(&folder).map_err(|e| e.to_string())?;
        Ok(Outcome {
            summary,
            folder,
            said: ended.stdout,
            user_seconds: ended.usage.rusage.utime.as_secs_f64(),
            peak_bytes: ended.usage.rusage.maxrss,
            resident: ended.resident,
        })
    }

    fn ended(&self, command: &mut Command) -> io::Result<Ended> {
        // files, so that what is said never waits for a reader
        let (mut stdout, mut stderr) = (tempfile::tempfile()?, tempfile::tempfile()?);
        command.stdout(stdout.try_clone()?).stderr(stderr.try_clone()?);
        let mut child = command.spawn()?;
        let watcher = self.watched.then(|| Watcher::of(child.id()));
        let usage = child.wait4()?;
        let resident = watcher.map_or(Vec::new(), Watcher::end);
        Ok(Ended { usage, resident, stdout: text(&mut stdout)?, stderr: text(&mut stderr)? })
    }
}

/// How a process ended.
struct Ended {
    usage: wait4::ResUse,
    resident: Vec<u64>,
    stdout: String,
    stderr: String,
}

fn text(file: &mut File) -> io::Result<String> {
    let mut bytes = Vec::new();
    file.rewind()?;
    file.read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// What a run has left.
#[allow(dead_code)] // each check has its own figures
pub struct Outcome {
    /// Its `summary.json`.
    pub summary: Summary,
    /// Its folder; the next run of the same scene replaces it.
    pub folder: PathBuf,
    /// What it printed.
    pub said: String,
    /// User CPU time of all its processes [s], as the system counts it.
    pub user_seconds: f64,
    /// Most memory that one of its processes has taken [bytes].
    pub peak_bytes: u64,
    /// Memory of all its processes, looked at in even intervals if it was watched [bytes].
    pub resident: Vec<u64>,
}

impl Outcome {
    /// The profiles as they stand in the files.
    #[allow(dead_code)] // some checks compare bytes
    pub fn tables(&self) -> Result<Vec<CsvTable>, String> {
        let files = self.summary.profiles.iter().map(|p| self.folder.join(&p.file));
        files.map(|file| read_csv(&file).map_err(|e| e.to_string())).collect()
    }
}
