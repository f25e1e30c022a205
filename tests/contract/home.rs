//! A temporary folder in which the program is started, and the files that it leaves there.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use tempfile::TempDir;

use crate::program::Call;

/// A temporary folder in which the program is started.
pub struct Home(TempDir);

impl Home {
    /// An empty folder.
    pub fn new() -> Home {
        Home(tempfile::tempdir().unwrap())
    }

    /// A folder with `scene.json`.
    pub fn with(scene: &Value) -> Home {
        let home = Home::new();
        home.write("scene.json", &scene.to_string());
        home
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// Path of a file or folder in it.
    pub fn at(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    /// Writes a file and creates its parent folders.
    pub fn write(&self, name: &str, text: &str) {
        let path = self.at(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    /// A call of the program in this folder.
    pub fn call<'a>(&self, args: impl IntoIterator<Item = &'a str>) -> Call {
        Call::new(self.path(), args)
    }

    /// Runs `scene.json` quietly with further arguments, and returns its results.
    #[track_caller]
    pub fn run(&self, output: &str, args: &[&str]) -> Results {
        let args = ["scene.json", "--quiet", "--output", output].into_iter().chain(args.to_vec());
        assert_eq!(self.call(args).end().succeeded(), "");
        self.results(output)
    }

    /// Results of a run.
    pub fn results(&self, folder: &str) -> Results {
        Results::read(&self.at(folder))
    }

    /// Every file and folder below this one with its bytes, by relative path. Lock files are
    /// omitted: one left by a killed run does not block others.
    pub fn contents(&self) -> Contents {
        let mut found = contents(self.path());
        found.retain(|path, _| path.extension().is_none_or(|end| end != "lock"));
        found
    }
}

/// Files with their bytes, and folders without.
pub type Contents = BTreeMap<PathBuf, Option<Vec<u8>>>;

/// Every file and folder below `root`.
pub fn contents(root: &Path) -> Contents {
    let mut found = Contents::new();
    let mut folders = vec![root.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let bytes = (!path.is_dir()).then(|| fs::read(&path).unwrap());
            if bytes.is_none() {
                folders.push(path.clone());
            }
            found.insert(path.strip_prefix(root).unwrap().to_path_buf(), bytes);
        }
    }
    found
}

/// Names in a folder, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name());
    let mut names: Vec<_> = entries.map(|n| n.into_string().unwrap()).collect();
    names.sort();
    names
}

/// Names of the checkpoints in a folder, the oldest first.
pub fn checkpoints(folder: &Path) -> Vec<String> {
    let mut all = names(folder);
    all.retain(|name| name.starts_with("checkpoint-"));
    all
}

/// Results of a run, kept in memory so that the folder may be deleted.
pub struct Results {
    pub files: Contents,
    pub summary: Value,
}

impl Results {
    fn read(folder: &Path) -> Results {
        let files = contents(folder);
        let summary = files[Path::new("summary.json")].as_ref().unwrap();
        Results { summary: serde_json::from_slice(summary).unwrap(), files }
    }

    /// Names of its files, sorted.
    pub fn names(&self) -> Vec<&str> {
        self.files.keys().map(|name| name.to_str().unwrap()).collect()
    }

    /// The bytes of a file.
    #[track_caller]
    pub fn bytes(&self, name: &str) -> &[u8] {
        let file = self.files.get(Path::new(name)).and_then(Option::as_ref);
        file.unwrap_or_else(|| panic!("no {name} in {:?}", self.names()))
    }

    /// The text of a file.
    #[track_caller]
    pub fn text(&self, name: &str) -> &str {
        std::str::from_utf8(self.bytes(name)).unwrap()
    }

    /// A whole number in the summary.
    #[track_caller]
    pub fn count(&self, key: &str) -> u64 {
        self.summary[key].as_u64().unwrap_or_else(|| panic!("{key}: {}", self.summary[key]))
    }

    /// Text of the profile `k`, found through the summary.
    #[track_caller]
    pub fn profile(&self, k: usize) -> &str {
        self.text(self.summary["profiles"][k]["file"].as_str().unwrap())
    }

    /// Digests and texts of all profiles, for the comparison of runs.
    pub fn states(&self) -> Vec<(&str, &str)> {
        let profiles = self.summary["profiles"].as_array().unwrap();
        let digest = |k: usize| profiles[k]["state_sha256"].as_str().unwrap();
        (0..profiles.len()).map(|k| (digest(k), self.profile(k))).collect()
    }

    /// A column of `histories.csv`.
    #[track_caller]
    pub fn history(&self, name: &str) -> Vec<f64> {
        column(self.text("histories.csv"), name)
    }
}

/// A column of numbers by its name; NaN for empty fields.
pub fn column(csv: &str, name: &str) -> Vec<f64> {
    let (header, rows) = csv.split_once('\n').unwrap();
    let place = header.split(',').position(|n| n == name);
    let place = place.unwrap_or_else(|| panic!("no column {name} in {header}"));
    let field = |row: &str| match row.split(',').nth(place).unwrap() {
        "" => f64::NAN,
        number => number.parse().unwrap(),
    };
    rows.lines().map(field).collect()
}
