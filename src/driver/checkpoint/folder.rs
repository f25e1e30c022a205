//! The folder of a run's checkpoints: numbered files, of which the last few are kept.
//!
//! A file is written under a hidden name, flushed and renamed, and then the folder is flushed. A
//! file under its final name is therefore complete, unless it was damaged later.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use decomp::Comm;
use nix::sys::statvfs::statvfs;

use super::{Checkpoint, CheckpointContents, CheckpointError, file, profiles};
use crate::driver::output::OutputError;
use crate::driver::output::folder::{CHECKPOINTS, checkpoint_folder};
use crate::driver::output::origin::{ExistingResult, Maker};
use crate::driver::output::shared_file::{agree, from_first};
use crate::input::input_file;

const BEFORE: &str = "checkpoint-";
const AFTER: &str = ".hdf5";

/// Prefix of the hidden name of a file during writing.
const PARTIAL: &str = ".checkpoint-";

/// Writes a checkpoint into `folder`, which rank 0 names and creates if missing, and keeps the last
/// `keep` files; returns the path of the new one. Collective.
///
/// # Errors
///
/// If the file cannot be written; all ranks return an error, and the message at rank 0 names the last
/// good checkpoint.
pub fn write(
    comm: &dyn Comm,
    folder: &Path,
    keep: u64,
    contents: &CheckpointContents,
) -> Result<PathBuf, CheckpointError> {
    try_write(comm, folder, keep, contents).map_err(|source| {
        if comm.rank() != 0 {
            return source;
        }
        let last = match list(folder).first() {
            Some((_, last)) => format!(
                "the last good checkpoint is {}: continue with --restart {}",
                last.display(),
                folder.display()
            ),
            None => "there is no earlier checkpoint".to_string(),
        };
        CheckpointError::Write { source: Box::new(source), last }
    })
}

/// Name of a checkpoint during writing, its final name, and earlier checkpoints.
type Names = (PathBuf, PathBuf, Vec<PathBuf>);

fn try_write(
    comm: &dyn Comm,
    folder: &Path,
    keep: u64,
    contents: &CheckpointContents,
) -> Result<PathBuf, CheckpointError> {
    let first = comm.rank() == 0;
    let profiles = if first { profiles::missing_bytes(folder, contents.tables) } else { 0 };
    let mut needed = [(contents.bytes() + profiles) as i64];
    comm.sum(&mut needed);
    let names = if first { make_room(folder, needed[0] as u64) } else { Ok(Names::default()) };
    let (partial, path, earlier) = from_first(comm, agree(comm, names)?);
    let written = file::write(comm, &partial, contents).and_then(|()| {
        let place = || {
            fs::rename(&partial, &path)
                .and_then(|()| File::open(folder)?.sync_all())
                .map_err(|e| OutputError::io("put the checkpoint in place", &path)(e).into())
        };
        agree(comm, if first { place() } else { Ok(()) })
    });
    if let Err(error) = written {
        if first {
            let _ = fs::remove_file(&partial);
        }
        return Err(error);
    }
    if first {
        // best effort: one file too many does no harm
        for old in earlier.iter().skip(keep.max(1) as usize - 1) {
            let _ = fs::remove_file(old);
        }
    }
    Ok(path)
}

/// Creates the folder if missing, and chooses the names of the next checkpoint; refuses a disk with
/// less space than is `needed` [bytes].
fn make_room(folder: &Path, needed: u64) -> Result<Names, CheckpointError> {
    fs::create_dir_all(folder).map_err(OutputError::io("make the folder", folder))?;
    let entries = list(folder);
    let number = entries.first().map_or(1, |(number, _)| number + 1);
    let partial = folder.join(format!("{PARTIAL}{number:06}"));
    // remove the file of an earlier process, because HDF5 refuses to overwrite an open file
    let _ = fs::remove_file(&partial);
    if let Ok(disk) = statvfs(folder) {
        #[allow(clippy::unnecessary_cast, reason = "the types differ between systems")]
        let left = disk.blocks_available() as u64 * disk.fragment_size() as u64;
        if left < needed {
            return Err(CheckpointError::Space { path: folder.into(), needed, left });
        }
    }
    let path = folder.join(format!("{BEFORE}{number:06}{AFTER}"));
    Ok((partial, path, entries.into_iter().map(|(_, path)| path).collect()))
}

/// The checkpoints of a folder with their numbers, newest first; empty for an unreadable folder.
pub fn list(folder: &Path) -> Vec<(u64, PathBuf)> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let number = |name: &str| name.strip_prefix(BEFORE)?.strip_suffix(AFTER)?.parse::<u64>().ok();
    // this program never reaches larger numbers, so such files are not its own
    let number = |name: &str| number(name).filter(|&n| n < 1 << 53);
    let mut found: Vec<(u64, PathBuf)> =
        entries.filter_map(|e| Some((number(e.file_name().to_str()?)?, e.path()))).collect();
    found.sort_by(|a, b| b.cmp(a));
    found
}

/// Removes all checkpoints and their profiles from a folder, and the folder if it is then empty. Best effort.
pub fn clear(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let checkpoint = name.starts_with(BEFORE) && name.ends_with(AFTER);
        if checkpoint || name.starts_with(PARTIAL) || profiles::is_profile(&name) {
            let _ = fs::remove_file(entry.path());
        }
    }
    let _ = fs::remove_dir(folder);
}

/// Reads the checkpoint at `path`, or the newest undamaged one if `path` is a folder of checkpoints
/// or of results. Returns it with its path and one line for each damaged file. Collective.
///
/// # Errors
///
/// If the file cannot be read or is damaged, or if the folder has no undamaged checkpoint; all ranks
/// return an error.
pub fn open(
    comm: &dyn Comm,
    path: &Path,
) -> Result<(Checkpoint, PathBuf, Vec<String>), CheckpointError> {
    let first = comm.rank() == 0;
    let found = if first { candidates(path) } else { Ok((Vec::new(), false)) };
    let (found, is_file) = from_first(comm, agree(comm, found)?);
    let mut notes = Vec::new();
    for path in &found {
        match file::read(comm, path) {
            Ok(checkpoint) => return Ok((checkpoint, path.clone(), notes)),
            Err(error) => {
                let damaged = matches!(error, CheckpointError::Damaged { .. });
                // a file that was named alone has its own message
                if !from_first(comm, damaged) || is_file {
                    return Err(error);
                }
                notes.push(error.to_string());
            }
        }
    }
    let why = format!("no checkpoint is whole: {}", notes.join("; "));
    Err(CheckpointError::None { path: path.into(), why })
}

/// The file at `path`, or the checkpoints of the folder at `path`, newest first; and whether it is a
/// file.
fn candidates(path: &Path) -> Result<(Vec<PathBuf>, bool), CheckpointError> {
    let none = |why: String| CheckpointError::None { path: path.into(), why };
    let kind = fs::metadata(path);
    if kind.as_ref().is_ok_and(|m| !m.is_dir()) {
        if is_json(path) {
            return Err(none(format!(
                "is JSON text such as a scene, not a checkpoint; flyer-mpm {} without --restart \
                 runs a scene",
                path.display()
            )));
        }
        return Ok((vec![path.into()], true));
    }
    let beside = checkpoint_folder(path)?;
    let found = [path.to_path_buf(), beside].map(|folder| list(&folder));
    let Some(found) = found.into_iter().find(|list| !list.is_empty()) else {
        return Err(none(match kind {
            Ok(_) => "has no checkpoint".to_string(),
            Err(e) => format!("cannot be read: {e}"),
        }));
    };
    Ok((found.into_iter().map(|(_, path)| path).collect(), false))
}

/// Whether there are checkpoints in the checkpoint folder of `target`.
pub fn has_checkpoints(target: &Path) -> bool {
    checkpoint_folder(target).is_ok_and(|folder| !list(&folder).is_empty())
}

/// Refuses a run whose checkpoints would replace those of another scene in the checkpoint folder of
/// `target`. Damaged checkpoints are ignored.
///
/// # Errors
///
/// If the newest checkpoint is of another scene or cannot be read for another reason than damage, or
/// if the folder is itself a result.
pub fn check_owner(target: &Path, maker: &Maker) -> Result<(), OutputError> {
    let folder = checkpoint_folder(target)?;
    if ExistingResult::read(&folder).is_some() {
        let result = folder.clone();
        return Err(OutputError::Inside { path: folder, result });
    }
    let ours = maker.origin.to_string();
    for (_, path) in list(&folder) {
        let checkpoint = match file::read_head_alone(&path) {
            Ok(checkpoint) => checkpoint,
            Err(CheckpointError::Damaged { .. }) => continue,
            // a checkpoint of another format is a whole one of somebody
            Err(error) => {
                return Err(OutputError::Foreign { path: folder, theirs: error.to_string(), ours });
            }
        };
        let (theirs, scene) = (checkpoint.run_origin(), serde_json::from_str(&checkpoint.scene));
        if maker.may_replace(&theirs, &scene.unwrap_or_default(), &folder) {
            return Ok(());
        }
        return Err(OutputError::Foreign { path: folder, theirs: theirs.to_string(), ours });
    }
    Ok(())
}

/// Whether a file looks like a JSON object or a comment before it, judged by its first characters.
fn is_json(path: &Path) -> bool {
    ["{", " {", "\n{", "\r\n{", "\u{feff}{", "//", "/*"]
        .iter()
        .any(|head| input_file::begins_with(path, head))
}

/// Folder of the results that belong to `checkpoint`, beside the checkpoint folder; `None` if the
/// name of that folder has no suffix of a checkpoint folder.
pub fn results_of(checkpoint: &Path) -> Option<PathBuf> {
    let folder = std::path::absolute(checkpoint).ok()?.parent()?.to_path_buf();
    let name = folder.file_name()?.to_str()?.strip_suffix(CHECKPOINTS)?;
    (!name.is_empty()).then(|| folder.with_file_name(name))
}
