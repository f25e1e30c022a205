//! The folder of a run's checkpoints: numbered files, of which the last few stay.
//!
//! A file is written under a hidden name, flushed, and renamed, and the folder is flushed: under its
//! own name a checkpoint is whole or was damaged later.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use nix::sys::statvfs::statvfs;

use super::{Checkpoint, CheckpointError, Contents, file};
use crate::driver::output::OutputError;
use crate::driver::output::folder::{CHECKPOINTS, checkpoint_folder};
use crate::driver::output::origin::{Made, Maker};
use crate::scene::input_file;

const BEFORE: &str = "checkpoint-";
const AFTER: &str = ".hdf5";

/// What the hidden name of a file that is being written begins with.
const PARTIAL: &str = ".checkpoint-";

/// Writes a checkpoint into `folder`, which is made where it is missing, and leaves the last `keep`;
/// returns its path. `alive` is called now and then.
pub fn write(
    folder: &Path,
    keep: u64,
    contents: &Contents,
    alive: &dyn Fn(),
) -> Result<PathBuf, CheckpointError> {
    try_write(folder, keep, contents, alive).map_err(|source| {
        let last = match list(folder).first() {
            Some((_, last)) => format!(
                "the last good checkpoint is {}: go on with --restart {}",
                last.display(),
                folder.display()
            ),
            None => "there is no earlier checkpoint".to_string(),
        };
        CheckpointError::Write { source: Box::new(source), last }
    })
}

fn try_write(
    folder: &Path,
    keep: u64,
    contents: &Contents,
    alive: &dyn Fn(),
) -> Result<PathBuf, CheckpointError> {
    fs::create_dir_all(folder).map_err(OutputError::io("make the folder", folder))?;
    let entries = list(folder);
    let number = entries.first().map_or(1, |(number, _)| number + 1);
    let partial = folder.join(format!("{PARTIAL}{number:06}"));
    // one that an earlier process left; HDF5 would refuse to take a file that is open
    let _ = fs::remove_file(&partial);
    if let Ok(disk) = statvfs(folder) {
        // whose types differ from system to system
        #[allow(clippy::unnecessary_cast)]
        let left = disk.blocks_available() as u64 * disk.fragment_size() as u64;
        let needed = contents.bytes();
        if left < needed {
            return Err(CheckpointError::Space { path: folder.into(), needed, left });
        }
    }
    let path = folder.join(format!("{BEFORE}{number:06}{AFTER}"));
    let written = file::write(&partial, contents, alive).and_then(|()| {
        fs::rename(&partial, &path)
            .and_then(|()| File::open(folder)?.sync_all())
            .map_err(|e| OutputError::io("put the checkpoint in place", &path)(e).into())
    });
    if let Err(error) = written {
        let _ = fs::remove_file(&partial);
        return Err(error);
    }
    // best effort: one too many does no harm
    for (_, old) in entries.iter().skip(keep.max(1) as usize - 1) {
        let _ = fs::remove_file(old);
    }
    Ok(path)
}

/// The checkpoints of a folder with their numbers, the newest first; none where it cannot be read.
pub fn list(folder: &Path) -> Vec<(u64, PathBuf)> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let number = |name: &str| name.strip_prefix(BEFORE)?.strip_suffix(AFTER)?.parse::<u64>().ok();
    // numbers that we never come to are not ours
    let number = |name: &str| number(name).filter(|&n| n < 1 << 53);
    let mut found: Vec<(u64, PathBuf)> =
        entries.filter_map(|e| Some((number(e.file_name().to_str()?)?, e.path()))).collect();
    found.sort_by(|a, b| b.cmp(a));
    found
}

/// Takes all checkpoints out of a folder, and the folder if nothing else is in it. Best effort.
pub fn clear(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if name.starts_with(PARTIAL) || (name.starts_with(BEFORE) && name.ends_with(AFTER)) {
            let _ = fs::remove_file(entry.path());
        }
    }
    let _ = fs::remove_dir(folder);
}

/// Reads the checkpoint at `path`, or the newest one of the folder `path` (or of the results
/// `path`) that is whole; returns it with its path and one line for each that is damaged.
pub fn open(path: &Path) -> Result<(Checkpoint, PathBuf, Vec<String>), CheckpointError> {
    let none = |why: String| CheckpointError::None { path: path.into(), why };
    let kind = fs::metadata(path);
    if kind.as_ref().is_ok_and(|m| !m.is_dir()) {
        return match file::read(path) {
            Ok(checkpoint) => Ok((checkpoint, path.into(), Vec::new())),
            Err(CheckpointError::Damaged { .. }) if is_json(path) => Err(none(format!(
                "is JSON text such as a scene, not a checkpoint; flyer-mpm {} without --restart \
                 runs a scene",
                path.display()
            ))),
            Err(error) => Err(error),
        };
    }
    let beside = checkpoint_folder(path)?;
    let found = [path.to_path_buf(), beside].map(|folder| list(&folder));
    let Some(found) = found.into_iter().find(|list| !list.is_empty()) else {
        return Err(none(match kind {
            Ok(_) => "has no checkpoint".to_string(),
            Err(e) => format!("cannot be read: {e}"),
        }));
    };
    let mut notes = Vec::new();
    for (_, path) in &found {
        match file::read(path) {
            Ok(checkpoint) => return Ok((checkpoint, path.clone(), notes)),
            Err(error @ CheckpointError::Damaged { .. }) => notes.push(error.to_string()),
            Err(error) => return Err(error),
        }
    }
    Err(none(format!("no checkpoint is whole: {}", notes.join("; "))))
}

/// Refuses a run whose checkpoints would take the place of those of another scene: those in the
/// folder of `target`'s checkpoints. Damaged ones are nobody's.
pub fn check_owner(target: &Path, maker: &Maker) -> Result<(), OutputError> {
    let folder = checkpoint_folder(target)?;
    if Made::read(&folder).is_some() {
        let result = folder.clone();
        return Err(OutputError::Inside { path: folder, result });
    }
    let newest = list(&folder).into_iter().find_map(|(_, path)| file::read(&path).ok());
    let Some(checkpoint) = newest else { return Ok(()) };
    let (theirs, scene) = (checkpoint.run_origin(), serde_json::from_str(&checkpoint.scene));
    if maker.may_replace(&theirs, &scene.unwrap_or_default(), &folder) {
        return Ok(());
    }
    let (theirs, ours) = (theirs.to_string(), maker.origin.to_string());
    Err(OutputError::Foreign { path: folder, theirs, ours })
}

/// Whether a file is a JSON object, as far as its first character tells.
fn is_json(path: &Path) -> bool {
    ["{", " {", "\n{", "\r\n{", "\u{feff}{"].iter().any(|head| input_file::begins_with(path, head))
}

/// Where the results go of which `checkpoint` is one: what its folder stands beside; `None` where
/// the folder does not say.
pub fn results_of(checkpoint: &Path) -> Option<PathBuf> {
    let folder = std::path::absolute(checkpoint).ok()?.parent()?.to_path_buf();
    let name = folder.file_name()?.to_str()?.strip_suffix(CHECKPOINTS)?;
    (!name.is_empty()).then(|| folder.with_file_name(name))
}
