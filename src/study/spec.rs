//! The file of a study. Unknown keys are refused.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::Value;

use super::StudyError;
use crate::input::input_file;

/// A study: its cases, their repeats, and the pictures.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Study {
    /// Title, one line.
    pub title: String,
    /// Purpose of the study.
    #[serde(default)]
    pub description: String,
    /// Scene file, relative to the file of the study.
    pub scene: PathBuf,
    /// Overrides for all cases: path of a key and its value.
    #[serde(default)]
    pub set: BTreeMap<String, Value>,
    /// Axes of the sweep. `{"file": PATH}` stands for an axis in a file of its own, relative to the
    /// file of the study, and `{"file": PATH, "cases": [NAME, ...]}` for some of its cases. The cases
    /// of the study are all combinations; the last axis changes fastest.
    pub sweep: Vec<StudyAxis>,
    /// Combinations to leave out, given by their labels.
    #[serde(default)]
    pub leave_out: Vec<BTreeMap<String, Value>>,
    /// Number of runs of each case; the whole sweep is repeated. Times are medians.
    #[serde(default = "one")]
    pub repeats: usize,
    /// Wall time after which a run is stopped and counts as failed \[s\].
    #[serde(default = "ten_minutes")]
    pub limit_seconds: f64,
    /// Pictures.
    #[serde(default)]
    pub pictures: Vec<Picture>,
    /// Results of other codes, measured elsewhere.
    #[serde(default)]
    pub peers: Vec<Peer>,
    /// List of cheapest choices.
    #[serde(default)]
    pub choices: Option<Choices>,
    /// Comparison of histories with those of a reference case; adds the error `histories`.
    #[serde(default)]
    pub convergence: Option<Convergence>,
}

fn one() -> usize {
    1
}

fn ten_minutes() -> f64 {
    600.0
}

/// One axis of a sweep: `values` of one key, or named variations of several keys at once.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged, deny_unknown_fields)]
pub enum StudyAxis {
    /// One key; `run.ranks` and `run.threads` are allowed too.
    Key {
        /// Path of the key, also the name of its label.
        key: String,
        /// Its values.
        values: Vec<Value>,
    },
    /// Named variations of several keys.
    Variations {
        /// Name of the label.
        name: String,
        /// The variations.
        cases: Vec<Variation>,
    },
}

/// Keys that change together.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Variation {
    /// Value of the label.
    pub name: String,
    /// Paths of keys to remove from the scene, before `set` is applied.
    #[serde(default)]
    pub remove: Vec<String>,
    /// Paths of keys and their values, applied after those of all cases.
    #[serde(default)]
    pub set: BTreeMap<String, Value>,
}

/// A picture.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Picture {
    /// Curves over a cost or a key.
    Curves(CurvesPicture),
    /// Colour map over two keys.
    Map(MapPicture),
}

/// Curves, one panel per error.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CurvesPicture {
    /// File name, without extension.
    pub name: String,
    /// Title of the picture.
    pub title: String,
    /// A label or a number of [`super::StudyRow::number`].
    pub x: String,
    /// Errors, one panel each.
    pub y: Vec<String>,
    /// Time of the profile whose errors are shown \[s\]; the last profile by default.
    #[serde(default)]
    pub time: Option<f64>,
    /// Labels over which the means of the absolute values are shown.
    #[serde(default)]
    pub over: Vec<String>,
    /// Labels that distinguish the curves.
    #[serde(default)]
    pub series: Vec<String>,
    /// Labels of the rows to show; if empty, all rows.
    #[serde(default)]
    pub only: BTreeMap<String, Value>,
    /// Marks the Pareto front, the rows that no other row beats in both x and y.
    #[serde(default)]
    pub front: bool,
    /// Writes the observed order, the slope over x, beside the curves.
    #[serde(default)]
    pub order: bool,
    /// Shows the results of other codes.
    #[serde(default)]
    pub peers: bool,
}

/// An error over two keys, drawn as colour.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapPicture {
    /// File name, without extension.
    pub name: String,
    /// Title of the picture.
    pub title: String,
    /// Label of the x axis.
    pub x: String,
    /// Label of the y axis.
    pub y: String,
    /// Error to show, as absolute value.
    pub value: String,
    /// Time of the profile \[s\]; the last profile by default.
    #[serde(default)]
    pub time: Option<f64>,
    /// Marked points: text, x, y.
    #[serde(default)]
    pub marks: Vec<(String, f64, f64)>,
    /// Upper limit of the colour scale; larger values get the same colour \[in the error's unit\].
    #[serde(default)]
    pub most: Option<f64>,
    /// Labels of the rows to show; if empty, all rows.
    #[serde(default)]
    pub only: BTreeMap<String, Value>,
}

/// Result of another code, measured elsewhere.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Peer {
    /// Name and settings of the code.
    pub name: String,
    /// User CPU time of the run \[s\].
    pub seconds: f64,
    /// Errors by name: pairs of time \[s\] and error.
    pub errors: BTreeMap<String, Vec<[f64; 2]>>,
}

/// Target errors, for which the cheapest rows are listed.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Choices {
    /// Name of the error.
    pub error: String,
    /// Time of the profile \[s\]; the last profile by default.
    #[serde(default)]
    pub time: Option<f64>,
    /// Labels over which means are taken: the mean of the absolute values must reach a target.
    #[serde(default)]
    pub over: Vec<String>,
    /// Target values of the error \[-\].
    pub wanted: Vec<f64>,
}

/// Comparison of histories with those of a reference case.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Convergence {
    /// Labels of the reference case, the one with the smallest cells.
    pub against: BTreeMap<String, Value>,
    /// Columns of `histories.csv` that are compared.
    pub columns: Vec<String>,
}

impl Study {
    /// Reads the file of a study; makes its paths relative to the current directory.
    ///
    /// # Errors
    ///
    /// If the file cannot be read or is not a valid study.
    pub fn read(path: &Path) -> Result<Study, StudyError> {
        let fail = |reason: String| StudyError::Study { file: path.display().to_string(), reason };
        let text = input_file::read_text(path, input_file::LARGEST_JSON)
            .map_err(|fault| fail(fault.to_string()))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut value: Value = serde_json::from_str(&text).map_err(|e| fail(e.to_string()))?;
        let sweep = value.get_mut("sweep").and_then(Value::as_array_mut);
        for axis in sweep.into_iter().flatten() {
            if axis.get("file").is_some() {
                *axis = read_axis(axis, folder).map_err(fail)?;
            }
        }
        let mut study: Study = serde_path_to_error::deserialize(value)
            .map_err(|error| fail(format!("{}: {}", error.path(), error.inner())))?;
        study.scene = folder.join(&study.scene);
        study.check().map_err(fail)?;
        Ok(study)
    }

    /// Names of the labels, in the order of the sweep.
    pub fn labels(&self) -> Vec<&str> {
        self.sweep.iter().map(StudyAxis::name).collect()
    }

    fn check(&self) -> Result<(), String> {
        if self.repeats == 0 {
            return Err("repeats = 0; allowed: at least 1".into());
        }
        if self.limit_seconds.is_nan() || self.limit_seconds <= 0.0 {
            return Err(format!("limit_seconds = {}; allowed: above 0", self.limit_seconds));
        }
        let labels = self.labels();
        for (k, label) in labels.iter().enumerate() {
            if labels[..k].contains(label) {
                return Err(format!("sweep: `{label}` stands twice; allowed: once"));
            }
        }
        for axis in &self.sweep {
            let values = axis.values();
            if values.is_empty() {
                return Err(format!(
                    "sweep: `{}` has no cases; allowed: at least one",
                    axis.name()
                ));
            }
            for (k, value) in values.iter().enumerate() {
                if values[..k].contains(value) {
                    let name = axis.name();
                    return Err(format!("sweep: `{name}` has {value} twice; allowed: once"));
                }
            }
        }
        let known = |what: &str, label: &str| match labels.contains(&label) {
            true => Ok(()),
            false => Err(format!("{what}: no label `{label}`; allowed: {}", labels.join(", "))),
        };
        for left in self.leave_out.iter().flat_map(|l| l.keys()) {
            known("leave_out", left)?;
        }
        for label in self.convergence.iter().flat_map(|convergence| convergence.against.keys()) {
            known("convergence.against", label)?;
        }
        if self.convergence.as_ref().is_some_and(|convergence| convergence.columns.is_empty()) {
            return Err("convergence.columns: empty; allowed: at least one column".into());
        }
        for over in self.choices.iter().flat_map(|choices| &choices.over) {
            known("choices.over", over)?;
        }
        for picture in &self.pictures {
            let (name, used, only) = match picture {
                Picture::Curves(p) => {
                    (&p.name, p.series.iter().chain(&p.over).collect::<Vec<_>>(), &p.only)
                }
                Picture::Map(p) => (&p.name, vec![&p.x, &p.y], &p.only),
            };
            let plain = |c: char| c.is_ascii_alphanumeric() || "_-".contains(c);
            if name.is_empty() || !name.chars().all(plain) {
                return Err(format!(
                    "pictures: the name `{name}`; allowed: letters, digits, _ and -"
                ));
            }
            for label in used.into_iter().chain(only.keys()) {
                known(&format!("pictures.{name}"), label)?;
            }
        }
        Ok(())
    }
}

/// An axis in a file of its own, which several studies use.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AxisFile {
    /// Path, relative to the folder of the study.
    file: PathBuf,
    /// Names of the cases to use, in this order; without them, all cases of the file.
    cases: Option<Vec<String>>,
}

/// The axis in the file that `reference` names. The error is the reason why it cannot be read.
fn read_axis(reference: &Value, folder: &Path) -> Result<Value, String> {
    let AxisFile { file, cases } =
        AxisFile::deserialize(reference).map_err(|error| format!("sweep.file: {error}"))?;
    let file = folder.join(file);
    let in_file = |reason: String| format!("sweep.file: {}: {reason}", file.display());
    let text = input_file::read_text(&file, input_file::LARGEST_JSON)
        .map_err(|fault| in_file(fault.to_string()))?;
    let mut axis: Value = serde_json::from_str(&text).map_err(|e| in_file(e.to_string()))?;
    if let (Some(names), Some(axis)) = (cases, axis.as_object_mut()) {
        let all = axis.get("cases").and_then(Value::as_array).cloned().unwrap_or_default();
        let known: Vec<&str> = all.iter().filter_map(|case| case["name"].as_str()).collect();
        let find = |name: &String| {
            let found = all.iter().find(|case| case["name"] == name.as_str());
            let known = || in_file(format!("no case `{name}`; allowed: {}", known.join(", ")));
            found.cloned().ok_or_else(known)
        };
        let found = names.iter().map(find).collect::<Result<_, _>>()?;
        axis.insert("cases".into(), Value::Array(found));
    }
    Ok(axis)
}

impl StudyAxis {
    /// Name of the label.
    pub fn name(&self) -> &str {
        match self {
            StudyAxis::Key { key, .. } => key,
            StudyAxis::Variations { name, .. } => name,
        }
    }

    /// Values of the label.
    fn values(&self) -> Vec<Value> {
        match self {
            StudyAxis::Key { values, .. } => values.clone(),
            StudyAxis::Variations { cases, .. } => {
                cases.iter().map(|case| Value::from(&case.name[..])).collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn an_axis_of_a_file_has_the_named_cases_in_their_order() {
        let home = tempfile::tempdir().unwrap();
        let case = |name: &str| json!({"name": name, "set": {}});
        let axis = json!({"name": "scheme", "cases": [case("a"), case("b"), case("c")]});
        std::fs::write(home.path().join("axis.json"), axis.to_string()).unwrap();
        let read = |reference: Value| read_axis(&reference, home.path());
        assert_eq!(read(json!({"file": "axis.json"})), Ok(axis));
        let some = json!({"name": "scheme", "cases": [case("c"), case("a")]});
        assert_eq!(read(json!({"file": "axis.json", "cases": ["c", "a"]})), Ok(some));
        let reason = read(json!({"file": "axis.json", "cases": ["d"]})).unwrap_err();
        assert!(reason.ends_with("axis.json: no case `d`; allowed: a, b, c"), "{reason}");
        let reason = read(json!({"file": "axis.json", "case": ["a"]})).unwrap_err();
        assert!(reason.contains("unknown field `case`"), "{reason}");
    }

    #[test]
    fn a_file_that_is_no_study_is_refused() {
        let home = tempfile::tempdir().unwrap();
        let file = home.path().join("study.json");
        for text in ["[]", "1", "{\"sweep\": [[]]}"] {
            std::fs::write(&file, text).unwrap();
            let reason = Study::read(&file).unwrap_err().to_string();
            assert!(reason.contains("study.json"), "{reason}");
        }
    }

    #[test]
    fn the_shipped_studies_can_be_read() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs/studies");
        let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let files: Vec<PathBuf> = files.filter(|path| path.is_file()).collect();
        assert!(files.len() > 10, "{files:?}");
        for file in files {
            let study = Study::read(&file).unwrap();
            assert!(study.scene.is_file(), "{}", file.display());
        }
    }
}
