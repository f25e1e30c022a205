//! Starts the program as a user does, and reads what it writes.

use std::fs::{self, File};
use std::io::{self, Read, Seek};
use std::path::PathBuf;
use std::process::{Command, Stdio};

use flyer_mpm::driver::output::csv::{CsvTable, read_csv};
use flyer_mpm::driver::output::summary::Summary;
use wait4::Wait4;

use crate::program;
use crate::resident::{Resident, Watcher};

/// What callgrind counts.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Counted {
    /// Nothing: the program runs by itself.
    Nothing,
    /// Instructions.
    Instructions,
    /// Instructions, and lines of memory that a simulated L2 cache loads and writes back.
    Memory,
}

/// Simulated L2 cache: bytes, ways, bytes of a line.
const L2: &str = "--LL=1048576,8,64";

/// Bytes of a line of a cache.
const LINE: u64 = 64;

/// A run of the program.
#[derive(Clone, Debug)]
pub struct Job {
    /// Folder of the scene, in the repository.
    of: &'static str,
    scene: &'static str,
    sets: Vec<String>,
    ranks: usize,
    threads: usize,
    whole: bool,
    own_cores: bool,
    core: Option<usize>,
    watched: bool,
    counted: Counted,
}

impl Job {
    /// The shipped scene `inputs/SCENE.json` on one rank and thread, without pictures and HDF5.
    pub fn new(scene: &'static str) -> Job {
        Job {
            of: "inputs",
            scene,
            sets: Vec::new(),
            ranks: 1,
            threads: 1,
            whole: false,
            own_cores: false,
            core: None,
            watched: false,
            counted: Counted::Nothing,
        }
    }

    /// The frozen scene `tests/acceptance/bench/SCENE.json`.
    pub fn bench(scene: &'static str) -> Job {
        Job { of: "tests/acceptance/bench", ..Job::new(scene) }
    }

    /// With `--set PATH=VALUE`.
    pub fn set(mut self, set: impl Into<String>) -> Job {
        self.sets.push(set.into());
        self
    }

    /// On this many ranks; more than one are started by mpirun.
    pub fn ranks(self, ranks: usize) -> Job {
        Job { ranks, ..self }
    }

    /// With this many threads a rank.
    pub fn threads(self, threads: usize) -> Job {
        Job { threads, ..self }
    }

    /// With every output that the scene has, pictures and HDF5 among them.
    pub fn whole(self) -> Job {
        Job { whole: true, ..self }
    }

    /// Started by mpirun even on one rank, each rank bound to a core of its own.
    pub fn on_own_cores(self) -> Job {
        Job { own_cores: true, ..self }
    }

    /// On one rank, bound to this core; jobs on different cores can run at the same time.
    pub fn on_core(self, core: usize) -> Job {
        Job { core: Some(core), ..self }
    }

    /// With its memory looked at while it runs.
    pub fn watched(self) -> Job {
        Job { watched: true, ..self }
    }

    /// With its instructions counted by callgrind, on one rank.
    pub fn counted(self) -> Job {
        Job { counted: Counted::Instructions, ..self }
    }

    /// With its traffic between L2 cache and memory simulated by callgrind, on one rank.
    pub fn with_memory_counted(self) -> Job {
        Job { counted: Counted::Memory, ..self }
    }

    fn command(&self, subcommand: Option<&str>) -> Command {
        let program = program::path();
        let mut command = if self.counted != Counted::Nothing {
            let mut valgrind = Command::new("valgrind");
            valgrind.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]);
            if self.counted == Counted::Memory {
                valgrind.args(["--cache-sim=yes", "--simulate-wb=yes", L2]);
            }
            valgrind.arg(program);
            // rep movs counts as one instruction however much it copies
            let above = "1000000000";
            let tunables =
                ["stosb", "movsb"].map(|i| format!("glibc.cpu.x86_rep_{i}_threshold={above}"));
            valgrind.env("GLIBC_TUNABLES", tunables.join(":"));
            valgrind
        } else if self.ranks > 1 || self.own_cores {
            let mut mpirun = program::mpirun();
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
        } else if let Some(core) = self.core {
            let mut taskset = Command::new("taskset");
            taskset.args(["--cpu-list", &core.to_string()]).arg(program);
            taskset
        } else {
            Command::new(program)
        };
        command.args(subcommand);
        command.arg(program::root().join(format!("{}/{}.json", self.of, self.scene)));
        if subcommand.is_none() {
            command.args(["--threads", &self.threads.to_string()]);
            // a run that hangs is to say so
            command.args(["--stall-timeout", "60"]);
        }
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
        let core = self.core.map_or_else(String::new, |core| format!("_core_{core}"));
        let folder = program::folder().join(format!("{}{core}", self.scene));
        let _ = fs::remove_dir_all(&folder);
        let mut command = self.command(None);
        command.arg("--output").arg(&folder);
        let ended = self.succeeded(&mut command)?;
        let summary = Summary::read(&folder).map_err(|e| e.to_string())?;
        Ok(Outcome {
            summary,
            folder,
            said: ended.stdout,
            user_seconds: ended.usage.rusage.utime.as_secs_f64(),
            peak_bytes: ended.resident.fullest,
            resident: ended.resident.together,
            instructions: collected(&ended.stderr, &["Ir"]),
            memory_bytes: collected(&ended.stderr, &TRAFFIC).map(|lines| lines * LINE),
        })
    }

    /// Describes the scene by `flyer-mpm check`; the error is what the program said last.
    pub fn check(&self) -> Result<Described, String> {
        let ended = self.succeeded(&mut self.command(Some("check")))?;
        Ok(Described {
            said: ended.stdout,
            user_seconds: ended.usage.rusage.utime.as_secs_f64(),
            peak_bytes: ended.resident.fullest,
        })
    }

    fn succeeded(&self, command: &mut Command) -> Result<Ended, String> {
        let ended = self.ended(command.stdin(Stdio::null()));
        let ended = ended.map_err(|error| format!("cannot run {command:?}: {error}"))?;
        if !ended.usage.status.success() {
            let line = ended.stderr.lines().find(|l| l.starts_with("error: "));
            let line = line.or_else(|| ended.stderr.lines().find(|l| !l.trim().is_empty()));
            return Err(format!("{}: {}", ended.usage.status, line.unwrap_or("no message")));
        }
        Ok(ended)
    }

    fn ended(&self, command: &mut Command) -> io::Result<Ended> {
        // files, so that what is said never waits for a reader
        let (mut stdout, mut stderr) = (tempfile::tempfile()?, tempfile::tempfile()?);
        command.stdout(stdout.try_clone()?).stderr(stderr.try_clone()?);
        let mut child = command.spawn()?;
        let watcher = self.watched.then(|| Watcher::of(child.id()));
        let usage = child.wait4()?;
        let resident = watcher.map_or_else(Resident::default, Watcher::end);
        Ok(Ended { usage, resident, stdout: text(&mut stdout)?, stderr: text(&mut stderr)? })
    }
}

/// How a process ended.
struct Ended {
    usage: wait4::ResUse,
    resident: Resident,
    stdout: String,
    stderr: String,
}

fn text(file: &mut File) -> io::Result<String> {
    let mut bytes = Vec::new();
    file.rewind()?;
    file.read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// What `flyer-mpm check` has said and taken.
pub struct Described {
    /// What it printed.
    pub said: String,
    /// User CPU time [s].
    pub user_seconds: f64,
    /// Most memory that it has taken if it was watched [bytes].
    pub peak_bytes: u64,
}

/// What a run has left.
pub struct Outcome {
    /// Its `summary.json`.
    pub summary: Summary,
    /// Its folder; the next run of the same scene replaces it.
    pub folder: PathBuf,
    /// What it printed.
    pub said: String,
    /// User CPU time of all its processes [s], as the system counts it.
    pub user_seconds: f64,
    /// Most memory that one of its processes, without mpirun, has taken if it was watched [bytes].
    // the system's own figure for an ended process includes the peak of the process that started it
    pub peak_bytes: u64,
    /// Memory of all its processes, looked at in even intervals if it was watched [bytes].
    pub resident: Vec<u64>,
    /// Instructions of the whole process, where callgrind has counted them.
    pub instructions: Option<u64>,
    /// Bytes that the whole process has moved between L2 cache and memory, where callgrind has
    /// simulated it.
    pub memory_bytes: Option<u64>,
}

/// Events of callgrind in which a line moves between L2 cache and memory: loaded by a read or a
/// write, and written back by either.
const TRAFFIC: [&str; 4] = ["DLmr", "DLmw", "DLdmr", "DLdmw"];

/// Sum of the numbers of `events` that callgrind prints at its end.
fn collected(stderr: &str, events: &[&str]) -> Option<u64> {
    let after = |head: &str| stderr.lines().find_map(|line| Some(line.split_once(head)?.1));
    let names = after("Events    : ")?.split_whitespace();
    let numbers: Vec<(&str, u64)> = names
        .zip(after("Collected : ")?.split_whitespace())
        .filter_map(|(name, number)| Some((name, number.parse().ok()?)))
        .collect();
    let of = |event: &&str| numbers.iter().find(|(name, _)| name == event).map(|(_, n)| *n);
    events.iter().map(of).sum()
}

impl Outcome {
    /// The profiles as they stand in the files.
    pub fn tables(&self) -> Result<Vec<CsvTable>, String> {
        let files = self.summary.profiles.iter().map(|p| self.folder.join(&p.file));
        files.map(|file| read_csv(&file).map_err(|e| e.to_string())).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_counts_of_callgrind_are_found() {
        let said = "==7== Events    : Ir DLmr DLmw\n==7== Collected : 231748 5 7\n==7==\n";
        assert_eq!(collected(said, &["Ir"]), Some(231_748));
        assert_eq!(collected(said, &["DLmr", "DLmw"]), Some(12));
        assert_eq!(collected(said, &TRAFFIC), None);
        assert_eq!(collected("error: no scene\n", &["Ir"]), None);
    }
}
