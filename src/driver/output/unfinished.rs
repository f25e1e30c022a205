//! The folder of a run that is under way, or that has failed or was stopped: `<results>.unfinished`
//! beside the folder of results. It holds what the run has written so far; a run that ends moves it
//! into the results.

use std::fs;
use std::path::{Path, PathBuf};

use super::error::OutputError;
use super::origin::{ORIGIN_FILE, Origin, claim};
use super::paths::resolve;

/// Suffix of the name of the folder.
const UNFINISHED: &str = ".unfinished";

/// The folder for results at `target`.
///
/// # Errors
///
/// If the target cannot be resolved to an absolute path.
pub fn unfinished_folder(target: &Path) -> Result<PathBuf, OutputError> {
    let place = resolve(target)?;
    let mut name = place.file_name().unwrap_or_default().to_os_string();
    name.push(UNFINISHED);
    Ok(place.with_file_name(name))
}

/// Creates the folder for a run of `origin`. What an earlier run of the same scene has left there is
/// removed, unless this run `continues` that one.
///
/// # Errors
///
/// If the folder is that of another scene, or cannot be written.
pub fn begin(target: &Path, origin: &Origin, continues: bool) -> Result<PathBuf, OutputError> {
    let folder = unfinished_folder(target)?;
    claim(&folder, origin)?;
    if !continues {
        for entry in entries(&folder) {
            remove(&entry)?;
        }
    }
    Ok(folder)
}

/// Moves the contents into the folder of results `into`, and removes the folder. Without a folder
/// nothing happens.
///
/// # Errors
///
/// If a file cannot be moved.
pub fn finish(folder: &Path, into: &Path, wanted: &[&str]) -> Result<(), OutputError> {
    for entry in entries(folder) {
        let name = entry.file_name().unwrap_or_default().to_owned();
        if wanted.iter().any(|wanted| name == *wanted) {
            let to = into.join(name);
            fs::rename(&entry, &to).map_err(OutputError::io("move the file", &entry))?;
        }
    }
    clear(folder)
}

/// Removes the folder of a run that has ended.
///
/// # Errors
///
/// If it cannot be removed.
pub fn clear(folder: &Path) -> Result<(), OutputError> {
    if folder.join(ORIGIN_FILE).exists() {
        fs::remove_dir_all(folder).map_err(OutputError::io("remove the folder", folder))?;
    }
    Ok(())
}

/// What the folder holds besides the file of its origin.
fn entries(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.map(|e| e.path()).filter(|path| !path.ends_with(ORIGIN_FILE)).collect()
}

fn remove(path: &Path) -> Result<(), OutputError> {
    let removed = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    removed.map_err(OutputError::io("remove", path))
}
