//! The origin of a result: the command and the scene that made it, and the rule for replacing it.
//!
//! Only the same command on the same scene replaces a result. A scene is the same if it is the same
//! file, edited or not. If the original file is not known or no longer exists, a scene with the same
//! values counts as the same, because the new result has the same bits, and so does a file at the
//! same path relative to the result. Therefore a folder of scenes and results can be moved as a
//! whole. A scene in a copied folder counts as another one as long as the original file exists.

use std::fmt;
use std::fs;
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::error::OutputError;
use super::file_names::SUMMARY_FILE;
use super::paths::resolve;
use crate::input::input_file::{self, InputFault, LARGEST_JSON, LARGEST_NUMBERS, LARGEST_RESULT};
use crate::scene::CheckedScene;

/// Name of the file that records the origin of a folder without a summary.
pub const ORIGIN_FILE: &str = "origin.json";

/// Name of this file while it is written.
const ORIGIN_ASIDE: &str = ".origin.json.partial";

/// The command that runs a scene.
pub const RUN: &str = "run";

/// The command and the file that made a result.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Origin {
    /// The command: `run`, `hugoniot`, `material copper`, `study`.
    pub command: String,
    /// Absolute path of the scene or study; `None` if it is not a file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// The same path, relative to the folder of the result.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative: Option<String>,
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.file {
            Some(file) => write!(f, "the {} of {file}", self.command),
            None => write!(f, "a {} of an unknown file", self.command),
        }
    }
}

impl Origin {
    /// The origin of a result of `command` on `file`.
    pub fn new(command: &str, file: &Path) -> Origin {
        Origin { command: command.into(), file: absolute(file), relative: None }
    }

    /// The same origin, with the path relative to the absolute folder `place` of the result.
    pub fn seen_from(&self, place: &Path) -> Origin {
        let file = self.file.as_deref().map(Path::new);
        let relative = file.and_then(|file| relative(file, place));
        Origin { relative, ..self.clone() }
    }

    /// Whether `theirs`, recorded in a result at `place`, is the same command on the same file.
    pub fn is(&self, theirs: &Origin, place: &Path) -> bool {
        let (Some(mine), Some(file)) = (&self.file, &theirs.file) else { return false };
        let moved = || {
            let relative = theirs.relative.as_ref().filter(|_| !Path::new(file).exists());
            let now = relative.and_then(|relative| resolve(&place.join(relative)).ok());
            now.and_then(|now| absolute(&now)).as_ref() == Some(mine)
        };
        self.command == theirs.command && (mine == file || moved())
    }
}

/// Maker of a result: its origin, and the scene as run.
#[derive(Clone, Debug, PartialEq)]
pub struct Maker {
    /// The command and the file.
    pub origin: Origin,
    /// The scene, with overrides and defaults.
    pub scene: Value,
}

impl Maker {
    /// The maker for `command` on a scene.
    pub fn new(command: &str, scene: &CheckedScene) -> Maker {
        Maker::with(Origin::new(command, Path::new(&scene.file)), scene)
    }

    /// The maker for a run with a known origin, such as that in a checkpoint.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn with(origin: Origin, scene: &CheckedScene) -> Maker {
        let scene = serde_json::to_value(&scene.scene).expect("a scene is plain data");
        Maker { origin, scene }
    }

    /// Whether this maker may replace the result at `place` with origin `theirs` and `scene`.
    pub fn may_replace(&self, theirs: &Origin, scene: &Value, place: &Path) -> bool {
        let same_values = self.origin.command == theirs.command && self.scene == *scene;
        let other_file = self.origin.file != theirs.file
            && theirs.file.as_ref().is_some_and(|file| Path::new(file).exists());
        (same_values && !other_file) || self.origin.is(theirs, place)
    }
}

/// A result: a folder with a summary of this program.
#[derive(Clone, Debug, PartialEq)]
pub struct ExistingResult {
    /// Origin of the result; if not recorded, only the command.
    pub origin: Origin,
    /// Scene of the result.
    pub scene: Value,
}

impl ExistingResult {
    /// The result in a folder; `None` if there is none.
    pub fn read(folder: &Path) -> Option<ExistingResult> {
        let text = input_file::read_text(&folder.join(SUMMARY_FILE), LARGEST_NUMBERS).ok()?;
        let mut summary: Value = serde_json::from_str(&text).ok()?;
        if !["version", "scene", "profiles"].iter().all(|key| summary.get(key).is_some()) {
            return None;
        }
        let command = || match (summary.get("chain"), summary.pointer("/material/name")) {
            (Some(_), _) => "hugoniot".into(),
            (None, Some(name)) => format!("material {}", name.as_str().unwrap_or_default()),
            (None, None) => RUN.into(),
        };
        let recorded = summary.get("origin").cloned();
        let recorded = recorded.and_then(|value| serde_json::from_value(value).ok());
        let origin = recorded.unwrap_or_else(|| Origin { command: command(), ..Origin::default() });
        Some(ExistingResult { origin, scene: summary["scene"].take() })
    }
}

/// Refuses a path inside a result, because a new run of that result would remove it. `named` is the
/// path as named by the user.
///
/// # Errors
///
/// If the path is inside a result or cannot be resolved.
pub fn check_outside_results(named: &Path) -> Result<(), OutputError> {
    let place = resolve(named)?;
    let inside = place.ancestors().skip(1).find(|folder| ExistingResult::read(folder).is_some());
    match inside {
        Some(result) => Err(OutputError::Inside { path: named.into(), result: result.into() }),
        None => Ok(()),
    }
}

/// Checks the path of a file that a command writes. Refuses a path inside a result, and a file that
/// another command has made, by its text. Accepts empty files and anything but regular files.
///
/// # Errors
///
/// If the path is inside a result, or if the file cannot be read or is not of this command.
pub fn check_target(
    file: &Path,
    kind: &str,
    is_ours: impl Fn(&str) -> bool,
) -> Result<(), OutputError> {
    check_outside_results(file)?;
    if !file.is_file() {
        return Ok(());
    }
    match input_file::read_text(file, LARGEST_RESULT) {
        Ok(text) if text.is_empty() || is_ours(&text) => Ok(()),
        Err(InputFault::Io(error)) => Err(OutputError::io("read the file", file)(error)),
        _ => Err(OutputError::OtherFile { path: file.into(), kind: kind.into() }),
    }
}

/// Claims a folder without a summary for `origin` and records it there. The folder must be missing,
/// empty, or claimed before by the same command on the same file.
///
/// # Errors
///
/// If the folder is inside a result, has another maker, or cannot be written.
#[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
pub fn claim(folder: &Path, origin: &Origin) -> Result<(), OutputError> {
    check_outside_results(folder)?;
    let (place, file) = (resolve(folder)?, folder.join(ORIGIN_FILE));
    let is_foreign = |entry: fs::DirEntry| entry.file_name() != ORIGIN_ASIDE;
    let foreign = |theirs: String| OutputError::Foreign {
        path: folder.into(),
        theirs,
        ours: origin.to_string(),
    };
    if let Ok(text) = input_file::read_text(&file, LARGEST_JSON) {
        match serde_json::from_str::<Origin>(&text) {
            Ok(theirs) if origin.is(&theirs, &place) => {}
            Ok(theirs) => return Err(foreign(theirs.to_string())),
            Err(_) => return Err(foreign("another program".into())),
        }
    } else if let Some(made) = ExistingResult::read(folder) {
        return Err(foreign(made.origin.to_string()));
    } else if fs::read_dir(folder).is_ok_and(|entries| entries.flatten().any(is_foreign)) {
        return Err(foreign("another program or of an older version".into()));
    }
    fs::create_dir_all(folder).map_err(OutputError::io("create the folder", folder))?;
    let text = serde_json::to_string_pretty(&origin.seen_from(&place)).expect("plain data") + "\n";
    // whole or not at all, so that a run that is killed here does not lock itself out
    let aside = folder.join(ORIGIN_ASIDE);
    fs::write(&aside, text)
        .and_then(|()| fs::rename(&aside, &file))
        .map_err(OutputError::io("write the file", &file))
}

/// The absolute path of a file, with links in its folder resolved; `None` if there is no file.
pub fn absolute(file: &Path) -> Option<String> {
    let name = file.file_name().filter(|_| file.is_file())?;
    let folder = file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    folder.canonicalize().ok()?.join(name).to_str().map(String::from)
}

/// Path of `file` relative to `folder`; both are absolute.
fn relative(file: &Path, folder: &Path) -> Option<String> {
    let both = file.components().zip(folder.components());
    let shared = both.take_while(|(a, b)| a == b).count();
    let up = folder.components().skip(shared).map(|_| Component::ParentDir);
    let path: PathBuf = up.chain(file.components().skip(shared)).collect();
    path.to_str().map(String::from)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn maker(file: &Path, value: i32) -> Maker {
        Maker { origin: Origin::new(RUN, file), scene: json!({"value": value}) }
    }

    #[test]
    fn the_same_file_is_the_same_scene_and_the_same_values_once_it_is_gone() {
        let home = tempfile::tempdir().unwrap();
        let home = home.path().canonicalize().unwrap();
        let (a, b) = (home.join("a.json"), home.join("b.json"));
        fs::write(&a, "").unwrap();
        fs::write(&b, "").unwrap();
        let place = home.join("output/a");
        let (theirs, scene) = (maker(&a, 1).origin.seen_from(&place), json!({"value": 1}));
        assert_eq!(theirs.relative.as_deref(), Some("../../a.json"));
        // edited; the same values in another file; another scene; another command
        assert!(maker(&a, 2).may_replace(&theirs, &scene, &place));
        assert!(!maker(&b, 1).may_replace(&theirs, &scene, &place));
        assert!(!maker(&b, 2).may_replace(&theirs, &scene, &place));
        let mut other = maker(&a, 1);
        other.origin.command = "hugoniot".into();
        assert!(!other.may_replace(&theirs, &scene, &place));
        // a result that records no file; the file of the result is gone
        let unknown = Origin { file: None, relative: None, ..theirs.clone() };
        assert!(maker(&b, 1).may_replace(&unknown, &scene, &place));
        fs::remove_file(&a).unwrap();
        assert!(maker(&b, 1).may_replace(&theirs, &scene, &place));
        assert!(!maker(&b, 2).may_replace(&theirs, &scene, &place));
    }

    #[test]
    fn a_folder_that_was_moved_as_a_whole_keeps_its_scenes() {
        let home = tempfile::tempdir().unwrap();
        let home = home.path().canonicalize().unwrap();
        let (old, new) = (home.join("old"), home.join("new"));
        fs::create_dir(&old).unwrap();
        fs::write(old.join("a.json"), "").unwrap();
        let theirs = maker(&old.join("a.json"), 1).origin.seen_from(&old.join("output/a"));
        let place = new.join("output/a");
        let other = Value::Null;
        // a copy: the original still exists
        fs::create_dir_all(&place).unwrap();
        fs::write(new.join("a.json"), "").unwrap();
        assert!(!maker(&new.join("a.json"), 2).may_replace(&theirs, &other, &place));
        fs::remove_dir_all(&old).unwrap();
        assert!(maker(&new.join("a.json"), 2).may_replace(&theirs, &other, &place));
    }
}
