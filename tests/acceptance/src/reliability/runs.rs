//! Starts the program, waits for its end or kills it, and reads what no break may change.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use flyer_mpm::driver::output::vtkhdf::RESULTS_FILE;
use serde_json::Value;

use crate::program;

/// Longest that any run here takes; one that takes longer hangs.
const LONGEST: Duration = Duration::from_secs(300);

/// An empty folder for a section.
pub fn folder(section: &str) -> PathBuf {
    let folder = program::folder().join("reliability").join(section);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("the target folder can be written");
    folder
}

/// A shipped scene with the keys that make it short, without pictures; with HDF5 if they say so.
pub fn scene(name: &str, sets: &[&str]) -> Vec<String> {
    let file = program::root().join(format!("inputs/{name}.json"));
    let mut args = vec![file.display().to_string()];
    for set in ["output.pictures=false", "output.hdf5=false"].iter().chain(sets) {
        args.extend(["--set".to_string(), set.to_string()]);
    }
    args
}

/// The program with arguments, on some ranks; more than one by mpirun.
pub fn command(ranks: usize, args: &[String]) -> Command {
    let program = program::path();
    let mut command = match ranks {
        1 => Command::new(program),
        _ => {
            let mut mpirun = program::mpirun();
            // more ranks than cores: those that wait give way to those that work
            mpirun.args(["--oversubscribe", "--bind-to", "none"]);
            mpirun.args(["--mca", "mpi_yield_when_idle", "1"]);
            mpirun.args(["-n", &ranks.to_string()]).arg(program);
            mpirun
        }
    };
    command.args(args).args(["--quiet", "--stall-timeout", "60"]);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

/// Runs it to its end: its exit code, and what it said.
pub fn end(ranks: usize, args: &[String]) -> (Option<i32>, String) {
    let mut child = command(ranks, args).spawn().expect("the program and mpirun are there");
    let said = child.stderr.take().expect("it is piped");
    let reader = std::thread::spawn(move || std::io::read_to_string(said).unwrap_or_default());
    let ended = wait(&mut child, LONGEST);
    (ended.then(|| child.wait().ok()?.code()).flatten(), reader.join().unwrap_or_default())
}

/// Runs it to a good end.
pub fn good(ranks: usize, args: &[String]) -> Result<(), String> {
    match end(ranks, args) {
        (Some(0), _) => Ok(()),
        (code, said) => {
            let line = said.lines().find(|l| !l.trim().is_empty()).unwrap_or("no message");
            Err(format!("exit code {code:?}: {line}"))
        }
    }
}

/// Waits for the end, not longer than `most`; one that takes longer is killed.
pub fn wait(child: &mut Child, most: Duration) -> bool {
    let since = Instant::now();
    while child.try_wait().is_ok_and(|status| status.is_none()) {
        if since.elapsed() > most {
            let _ = child.kill();
            return false;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    true
}

/// What no break and no layout may change: files by name, and the summary's lasting parts.
#[derive(PartialEq)]
pub struct Left {
    files: BTreeMap<String, Vec<u8>>,
    summary: Vec<Value>,
}

/// Reads what a run has left in its folder.
pub fn left(folder: &Path) -> Result<Left, String> {
    let entries = fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut files = BTreeMap::new();
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        files.insert(name, fs::read(entry.path()).map_err(|e| e.to_string())?);
    }
    // the scene in it has the layout
    if let Some(of_fields) = files.get_mut(RESULTS_FILE) {
        let file = hdf5::File::open(folder.join(RESULTS_FILE)).map_err(|e| e.to_string())?;
        of_fields.clear();
        contents(&file, of_fields).map_err(|e| format!("{RESULTS_FILE}: {e}"))?;
    }
    let text = files.remove("summary.json").ok_or("no summary.json")?;
    let summary: Value = serde_json::from_slice(&text).map_err(|e| e.to_string())?;
    let keys =
        ["title", "particles", "cells", "steps", "energy", "momentum", "outflow", "profiles"];
    Ok(Left { files, summary: keys.iter().map(|key| summary[*key].clone()).collect() })
}

/// The names and values of all data sets of a group and of those in it.
fn contents(group: &hdf5::Group, into: &mut Vec<u8>) -> hdf5::Result<()> {
    for name in group.member_names()? {
        into.extend(name.bytes());
        match group.dataset(&name) {
            Ok(data) if data.dtype()?.is::<f64>() => {
                into.extend(data.read_raw::<f64>()?.iter().flat_map(|v| v.to_bits().to_le_bytes()));
            }
            Ok(data) => into.extend(data.read_raw::<i64>()?.iter().flat_map(|v| v.to_le_bytes())),
            Err(_) => contents(&group.group(&name)?, into)?,
        }
    }
    Ok(())
}

impl Left {
    /// What first differs from `other`.
    pub fn differs(&self, other: &Left) -> Option<String> {
        if self.files.keys().ne(other.files.keys()) {
            return Some("names of files".into());
        }
        let differs = |name: &&String| self.files[*name] != other.files[*name];
        let file = self.files.keys().find(differs).cloned();
        file.or_else(|| (self.summary != other.summary).then(|| "summary".into()))
    }
}

/// `args` with further ones.
pub fn with(args: &[String], more: &[&str]) -> Vec<String> {
    args.iter().cloned().chain(more.iter().map(|a| a.to_string())).collect()
}

/// Steps of the run that has left `folder`.
pub fn steps(folder: &Path) -> u64 {
    let text = fs::read_to_string(folder.join("summary.json")).unwrap_or_default();
    let summary: Value = serde_json::from_str(&text).unwrap_or_default();
    summary["steps"].as_u64().unwrap_or(0)
}
