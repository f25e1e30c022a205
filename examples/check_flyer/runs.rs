//! Starts the program as a user does, and reads what it writes.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use flyer_mpm::output::csv::{CsvTable, read_csv};
use flyer_mpm::output::summary::Summary;

/// A run of the program.
#[derive(Clone, Debug)]
pub struct Job {
    scene: &'static str,
    sets: Vec<String>,
    ranks: usize,
    threads: usize,
    whole: bool,
}

impl Job {
    /// The shipped scene `inputs/SCENE.json` on one rank and thread, without pictures and HDF5.
    pub fn new(scene: &'static str) -> Job {
        Job { scene, sets: Vec::new(), ranks: 1, threads: 1, whole: false }
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

    /// Runs it; the error is what the program said last.
    pub fn run(&self) -> Result<Outcome, String> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let target =
            std::env::var_os("CARGO_TARGET_DIR").map_or(root.join("target"), PathBuf::from);
        let program = target.join("release/flyer-mpm");
        let folder = target.join("check_flyer").join(self.scene);
        let _ = fs::remove_dir_all(&folder);
        let mut command = if self.ranks > 1 {
            let mut mpirun = Command::new("mpirun");
            mpirun.args(["--oversubscribe", "-n", &self.ranks.to_string()]).arg(program);
            mpirun
        } else {
            Command::new(program)
        };
        command.arg(root.join(format!("inputs/{}.json", self.scene)));
        command.arg("--output").arg(&folder).arg("--quiet");
        command.args(["--threads", &self.threads.to_string()]);
        if !self.whole {
            command.args(["--set", "output.pictures=false", "--set", "output.hdf5=false"]);
        }
        for set in &self.sets {
            command.args(["--set", set]);
        }
        let before = children_user_seconds();
        let output = command.output().map_err(|e| format!("cannot start {command:?}: {e}"))?;
        let user_seconds = children_user_seconds() - before;
        if !output.status.success() {
            let text = String::from_utf8_lossy(&output.stderr);
            let line = text.lines().find(|l| !l.trim().is_empty()).unwrap_or("no message");
            return Err(format!("{}: {line}", output.status));
        }
        let summary = Summary::read(&folder).map_err(|e| e.to_string())?;
        Ok(Outcome { summary, folder, user_seconds })
    }
}

/// What a run has left.
pub struct Outcome {
    /// Its `summary.json`.
    pub summary: Summary,
    folder: PathBuf,
    /// User CPU time of all its processes [s], as the system counts it.
    pub user_seconds: f64,
}

impl Outcome {
    /// The profiles as they stand in the files.
    pub fn tables(&self) -> Result<Vec<CsvTable>, String> {
        let files = self.summary.profiles.iter().map(|p| self.folder.join(&p.file));
        files.map(|file| read_csv(&file).map_err(|e| e.to_string())).collect()
    }
}

/// User CPU time of all ended children of this process [s]; Linux counts in hundredths.
fn children_user_seconds() -> f64 {
    let stat = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = stat.rsplit_once(')').map_or("", |(_, rest)| rest);
    let ticks = after_name.split_whitespace().nth(13).and_then(|t| t.parse::<f64>().ok());
    ticks.map_or(f64::NAN, |ticks| ticks / 100.0)
}
