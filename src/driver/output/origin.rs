//! The command and the scene that made a result, recorded in it, and who may replace it.
//!
//! A result is replaced by the same command on the same scene alone. A scene is the same if it is the
//! same file, edited or not, or if it holds the same values: then the new result has the same bits.
//! A file that is no longer where it was is the same as one at the same place relative to the result,
//! so that a folder of scenes and results can be moved as a whole.

use std::fmt;
use std::fs;
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::error::OutputError;
use super::folder::resolve;
use super::summary::SUMMARY_FILE;
use crate::scene::CheckedScene;
use crate::scene::input_file::{self, InputFault, LARGEST_JSON, LARGEST_NUMBERS, LARGEST_RESULT};

/// Name of the file that records the origin of a folder without a summary.
pub const ORIGIN_FILE: &str = "origin.json";

/// The command that makes results of scenes.
pub const RUN: &str = "run";

/// The command and the file that made a result.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Origin {
    /// The command: `run`, `hugoniot`, `material copper`, `study`.
    pub command: String,
    /// Absolute path of the scene or study; none where it was no file.
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
    /// The origin of what `command` makes of `file`.
    pub fn new(command: &str, file: &Path) -> Origin {
        Origin { command: command.into(), file: absolute(file), relative: None }
    }

    /// The same with the path relative to the folder of the result, absolute.
    pub fn seen_from(&self, place: &Path) -> Origin {
        let file = self.file.as_deref().map(Path::new);
        let relative = file.and_then(|file| relative(file, place));
        Origin { relative, ..self.clone() }
    }

    /// Whether this is the same command on the same file as `theirs`, recorded in a result at
    /// `place`.
    fn is(&self, theirs: &Origin, place: &Path) -> bool {
        let (Some(mine), Some(file)) = (&self.file, &theirs.file) else { return false };
        let moved = || {
            let relative = theirs.relative.as_ref().filter(|_| !Path::new(file).exists());
            let now = relative.and_then(|relative| resolve(&place.join(relative)).ok());
            now.and_then(|now| absolute(&now)).as_ref() == Some(mine)
        };
        self.command == theirs.command && (mine == file || moved())
    }
}

/// Who makes a result: its origin, and the scene as run.
#[derive(Clone, Debug, PartialEq)]
pub struct Maker {
    /// The command and the file.
    pub origin: Origin,
    /// The scene, with overrides and defaults.
    pub scene: Value,
}

impl Maker {
    /// The maker of what `command` makes of a scene.
    pub fn new(command: &str, scene: &CheckedScene) -> Maker {
        Maker::with(Origin::new(command, Path::new(&scene.file)), scene)
    }

    /// The maker of a run that goes on from a checkpoint, whose origin stands in that.
    pub fn with(origin: Origin, scene: &CheckedScene) -> Maker {
        let scene = serde_json::to_value(&scene.scene).expect("a scene is plain data");
        Maker { origin, scene }
    }

    /// Whether this maker may replace a result of `theirs`, at `place`, made from `scene`.
    pub fn may_replace(&self, theirs: &Origin, scene: &Value, place: &Path) -> bool {
        let same = self.origin.command == theirs.command && self.scene == *scene;
        same || self.origin.is(theirs, place)
    }
}

/// A result: a folder with a summary of this program.
#[derive(Clone, Debug, PartialEq)]
pub struct Made {
    /// Its origin; of a result that does not record it the command alone.
    pub origin: Origin,
    /// The scene it was made from.
    pub scene: Value,
}

impl Made {
    /// The result in a folder; none where there is none.
    pub fn read(folder: &Path) -> Option<Made> {
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
        Some(Made { origin, scene: summary["scene"].take() })
    }
}

/// Refuses a place inside of a result: a new run of that would remove what is put there. `named` is
/// the place as the user named it.
pub fn check_outside_results(named: &Path) -> Result<(), OutputError> {
    let place = resolve(named)?;
    let inside = place.ancestors().skip(1).find(|folder| Made::read(folder).is_some());
    match inside {
        Some(result) => Err(OutputError::Inside { path: named.into(), result: result.into() }),
        None => Ok(()),
    }
}

/// Refuses a file that a command writes where one is that this command has not made, by its text, and
/// a place inside of a result. An empty file is nobody's; what is no plain file is left alone.
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

/// Takes a folder without a summary for `origin`, which is recorded in it: one that is not there, that
/// is empty, or that the same command on the same file has taken before.
pub fn claim(folder: &Path, origin: &Origin) -> Result<(), OutputError> {
    check_outside_results(folder)?;
    let (place, file) = (resolve(folder)?, folder.join(ORIGIN_FILE));
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
    } else if let Some(made) = Made::read(folder) {
        return Err(foreign(made.origin.to_string()));
    } else if fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()) {
        return Err(foreign("another program or of an older version".into()));
    }
    fs::create_dir_all(folder).map_err(OutputError::io("create the folder", folder))?;
    let text = serde_json::to_string_pretty(&origin.seen_from(&place)).expect("plain data") + "\n";
    fs::write(&file, text).map_err(OutputError::io("write the file", &file))
}

/// The absolute path of a file, links in its folder followed; none where there is no such file.
pub fn absolute(file: &Path) -> Option<String> {
    let name = file.file_name().filter(|_| file.is_file())?;
    let folder = file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    folder.canonicalize().ok()?.join(name).to_str().map(String::from)
}

/// `file` as a path from `folder`, both absolute.
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
    fn the_same_file_or_the_same_values_are_the_same_scene() {
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
        assert!(maker(&b, 1).may_replace(&theirs, &scene, &place));
        assert!(!maker(&b, 2).may_replace(&theirs, &scene, &place));
        let mut other = maker(&a, 1);
        other.origin.command = "hugoniot".into();
        assert!(!other.may_replace(&theirs, &scene, &place));
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
        // a copy: the first is still there
        fs::create_dir_all(&place).unwrap();
        fs::write(new.join("a.json"), "").unwrap();
        assert!(!maker(&new.join("a.json"), 2).may_replace(&theirs, &other, &place));
        fs::remove_dir_all(&old).unwrap();
        assert!(maker(&new.join("a.json"), 2).may_replace(&theirs, &other, &place));
    }
}
