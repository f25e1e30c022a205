//! The folder of the results of a scene that is run without `--output`.
//!
//! It has the name of the scene's file. If that folder holds results or checkpoints of another
//! scene, or if a run of another scene is writing there, a number is appended: `output/plate-2`. A
//! scene that is run again finds its own folder again. Independent of MPI: called on one rank only.

use std::path::{Path, PathBuf};

use crate::driver::checkpoint::folder::{check_owner, has_checkpoints};
use crate::driver::output::OutputError;
use crate::driver::output::lock::{Lock, holder};
use crate::driver::output::origin::{ExistingResult, Maker};

/// Largest number that is appended to the name of a folder.
const LARGEST_NUMBER: usize = 999;

/// The folder for the results of a scene, locked for its run.
#[derive(Debug)]
pub struct DefaultFolder {
    /// The folder.
    pub path: PathBuf,
    /// The folder with the name of the scene, and the reason why it is not used, if it is not.
    pub avoided: Option<(PathBuf, String)>,
    /// Lock on the folder.
    pub lock: Lock,
}

/// The first of `output/NAME`, `output/NAME-2`, ... that holds results or checkpoints of `maker`, else
/// the first that holds nothing; `NAME` is the name of the file `scene` without its ending. Folders
/// that runs of other scenes have locked are passed over.
///
/// # Errors
///
/// If a run of the same scene has locked the folder, or if the folder cannot be used.
pub fn default_folder(scene: &Path, maker: &Maker) -> Result<DefaultFolder, OutputError> {
    let name = scene.file_stem().unwrap_or_else(|| "scene".as_ref());
    locked_folder(&Path::new("output").join(name), maker)
}

fn locked_folder(base: &Path, maker: &Maker) -> Result<DefaultFolder, OutputError> {
    let mut in_use: Vec<(PathBuf, String)> = Vec::new();
    loop {
        let found = free_folder(base, maker, &in_use);
        let lock = match Lock::take_for(&found.path, &maker.origin) {
            Ok(lock) => lock,
            Err(locked @ OutputError::Locked { .. }) if in_use.len() < LARGEST_NUMBER => {
                match holder(&found.path) {
                    Some(theirs) if !maker.origin.is(&theirs, &found.path) => {
                        in_use.push((found.path, format!("{theirs} is writing there")));
                        continue;
                    }
                    _ => return Err(locked),
                }
            }
            Err(error) => return Err(error),
        };
        // another run may have ended with results there before the folder was locked
        if free_folder(base, maker, &in_use) == found {
            let FreeFolder { path, avoided } = found;
            return Ok(DefaultFolder { path, avoided, lock });
        }
    }
}

/// A folder for the results of a scene, not yet locked.
#[derive(Debug, PartialEq)]
struct FreeFolder {
    path: PathBuf,
    /// As in [`DefaultFolder`].
    avoided: Option<(PathBuf, String)>,
}

/// Contents of a folder of results and of the checkpoints beside it.
enum Contents {
    Nothing,
    /// Results or checkpoints that the maker may replace.
    Own,
    /// Those of another scene, or a run of it, in words.
    Foreign(String),
}

/// The first of `base`, `base-2`, ... that holds something of `maker`, else the first that holds
/// nothing. `in_use` are folders that other scenes have locked, with the reason in words.
fn free_folder(base: &Path, maker: &Maker, in_use: &[(PathBuf, String)]) -> FreeFolder {
    let contents = |folder: &Path| match in_use.iter().find(|(used, _)| used == folder) {
        Some((_, reason)) => Contents::Foreign(reason.clone()),
        None => contents(folder, maker),
    };
    let numbered = |number: usize| {
        let mut name = base.file_name().unwrap_or_default().to_os_string();
        name.push(format!("-{number}"));
        base.with_file_name(name)
    };
    let avoided = match contents(base) {
        Contents::Foreign(origin) => Some((base.to_path_buf(), origin)),
        Contents::Own => return FreeFolder { path: base.into(), avoided: None },
        Contents::Nothing => None,
    };
    let mut free = avoided.is_none().then(|| base.to_path_buf());
    for path in (2..=LARGEST_NUMBER).map(numbered) {
        match contents(&path) {
            Contents::Own => return FreeFolder { path, avoided },
            Contents::Nothing if free.is_none() => free = Some(path),
            _ => {}
        }
    }
    // without a free number, the run is refused with the name of the other scene
    FreeFolder { path: free.unwrap_or_else(|| base.into()), avoided }
}

fn contents(folder: &Path, maker: &Maker) -> Contents {
    let result = ExistingResult::read(folder);
    if let Some(made) = &result
        && !maker.may_replace(&made.origin, &made.scene, folder)
    {
        return Contents::Foreign(format!("it holds {}", made.origin));
    }
    match check_owner(folder, maker) {
        Err(OutputError::Foreign { theirs, .. }) => Contents::Foreign(format!("it holds {theirs}")),
        _ if result.is_some() || has_checkpoints(folder) => Contents::Own,
        _ => Contents::Nothing,
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use serde_json::{Value, json};

    use super::*;
    use crate::driver::output::origin::{Origin, RUN};

    #[test]
    fn another_scene_gets_a_number_and_finds_it_again() {
        let home = tempfile::tempdir().unwrap();
        let home = home.path().canonicalize().unwrap();
        let base = home.join("output/plate");
        let makers = ["a.json", "b.json", "c.json"].map(|name| {
            fs::write(home.join(name), "").unwrap();
            Maker { origin: Origin::new(RUN, &home.join(name)), scene: json!({"same": "values"}) }
        });
        let write = |folder: &Path, maker: &Maker| {
            fs::create_dir_all(folder).unwrap();
            let origin = serde_json::to_value(&maker.origin).unwrap();
            let summary: Value =
                json!({"version": "0", "scene": maker.scene, "profiles": [], "origin": origin});
            fs::write(folder.join("summary.json"), summary.to_string()).unwrap();
        };
        let expected = ["plate", "plate-2", "plate-3"].map(|name| home.join("output").join(name));
        // the second time, each finds its own folder
        for _ in 0..2 {
            for (maker, path) in makers.iter().zip(&expected) {
                let found = free_folder(&base, maker, &[]);
                assert_eq!(&found.path, path);
                let avoided = found.avoided.map(|(folder, origin)| {
                    assert!(origin.contains("a.json"), "{origin}");
                    folder
                });
                assert_eq!(avoided, (*path != base).then(|| base.clone()));
                write(path, maker);
            }
        }
        // a number that has become free is taken by a new scene alone
        fs::remove_dir_all(&expected[0]).unwrap();
        assert_eq!(free_folder(&base, &makers[1], &[]).path, expected[1]);
        assert_eq!(free_folder(&base, &makers[0], &[]).path, expected[0]);
    }

    #[test]
    fn a_folder_in_which_another_scene_is_running_is_passed_over() {
        let home = tempfile::tempdir().unwrap();
        let home = home.path().canonicalize().unwrap();
        let base = home.join("output/plate");
        let [a, b] = ["a.json", "b.json"].map(|name| {
            fs::write(home.join(name), "").unwrap();
            Maker { origin: Origin::new(RUN, &home.join(name)), scene: json!({}) }
        });
        let first = locked_folder(&base, &a).unwrap();
        assert_eq!((&first.path, &first.avoided), (&base, &None));
        let second = locked_folder(&base, &b).unwrap();
        assert_eq!(second.path, home.join("output/plate-2"));
        let (avoided, reason) = second.avoided.as_ref().unwrap();
        assert_eq!(avoided, &base);
        assert!(reason.contains("a.json is writing there"), "{reason}");
        // the same scene is refused while it runs
        for maker in [&a, &b] {
            assert!(matches!(locked_folder(&base, maker), Err(OutputError::Locked { .. })));
        }
        drop(first);
        assert_eq!(locked_folder(&base, &a).unwrap().path, base);
    }
}
