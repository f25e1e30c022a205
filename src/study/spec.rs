//! The file of a study: plain structs, read strictly.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::Value;

use super::StudyError;
use crate::scene::input_file;

/// A study: what is run, how often, and what is drawn of it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Study {
    /// One line that names it.
    pub title: String,
    /// What it asks.
    #[serde(default)]
    pub description: String,
    /// The scene's file, relative to that of the study.
    pub scene: PathBuf,
    /// Overrides of all cases: path of a key and its value.
    #[serde(default)]
    pub set: BTreeMap<String, Value>,
    /// What is swept; the cases are all combinations, the last changing fastest.
    pub sweep: Vec<Axis>,
    /// Combinations that are left out: the labels of each.
    #[serde(default)]
    pub leave_out: Vec<BTreeMap<String, Value>>,
    /// How often each case is run, all cases in turn: seconds are medians.
    #[serde(default = "one")]
    pub repeats: usize,
    /// Wall time after which a run is ended and counts as failed \[s\].
    #[serde(default = "ten_minutes")]
    pub limit_seconds: f64,
    /// Pictures.
    #[serde(default)]
    pub pictures: Vec<Picture>,
    /// What others reach, measured elsewhere.
    #[serde(default)]
    pub peers: Vec<Peer>,
    /// The list of cheapest choices.
    #[serde(default)]
    pub choices: Option<Choices>,
}

fn one() -> usize {
    1
}

fn ten_minutes() -> f64 {
    600.0
}

/// What is swept: one key over `values`, or named variations of several keys at once.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged, deny_unknown_fields)]
pub enum Axis {
    /// One key, or `run.ranks` and `run.threads`.
    Key {
        /// Its path, which is the name of its label too.
        key: String,
        /// Its values.
        values: Vec<Value>,
    },
    /// Variations of several keys.
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
    /// Its label.
    pub name: String,
    /// Paths of keys and their values, put in after those of all cases.
    pub set: BTreeMap<String, Value>,
}

/// A picture.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Picture {
    /// Curves over a cost or a key.
    Curves(CurvesPicture),
    /// A map over two keys.
    Map(MapPicture),
}

/// Curves, a panel an error.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CurvesPicture {
    /// Name of its files.
    pub name: String,
    /// The line at the top.
    pub title: String,
    /// A label or a number of [`super::Row::number`].
    pub x: String,
    /// Errors, a panel each.
    pub y: Vec<String>,
    /// Time of the profile whose errors are shown \[s\].
    pub time: f64,
    /// The labels that tell one curve from the next.
    #[serde(default)]
    pub series: Vec<String>,
    /// Rows that are shown: their labels; all where empty.
    #[serde(default)]
    pub only: BTreeMap<String, Value>,
    /// Mark the rows that none beats in both x and y.
    #[serde(default)]
    pub front: bool,
    /// Write the observed order, the slope over x, beside the curves.
    #[serde(default)]
    pub order: bool,
    /// Show the peers.
    #[serde(default)]
    pub peers: bool,
}

/// A number over two keys as colour.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapPicture {
    /// Name of its files.
    pub name: String,
    /// The line at the top.
    pub title: String,
    /// Label along x.
    pub x: String,
    /// Label upwards.
    pub y: String,
    /// The error that is shown, by size.
    pub value: String,
    /// Time of the profile \[s\].
    pub time: f64,
    /// Places that are named: text, x, y.
    #[serde(default)]
    pub marks: Vec<(String, f64, f64)>,
    /// Values beyond this are drawn like it \[in the error's unit\].
    #[serde(default)]
    pub most: Option<f64>,
    /// Rows that are shown.
    #[serde(default)]
    pub only: BTreeMap<String, Value>,
}

/// What another code reaches, measured elsewhere.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Peer {
    /// Its name and settings.
    pub name: String,
    /// User CPU seconds of the run.
    pub seconds: f64,
    /// Errors: by name, pairs of time \[s\] and error.
    pub errors: BTreeMap<String, Vec<[f64; 2]>>,
}

/// Errors wanted, for each of which the cheapest row is listed.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Choices {
    /// The error.
    pub error: String,
    /// Time of the profile \[s\].
    pub time: f64,
    /// Sizes wanted.
    pub wanted: Vec<f64>,
}

impl Study {
    /// Reads a study's file; paths in it become relative to here.
    pub fn read(path: &Path) -> Result<Study, StudyError> {
        let fail = |reason: String| StudyError::Study { file: path.display().to_string(), reason };
        let text = input_file::read_text(path, input_file::LARGEST_JSON)
            .map_err(|fault| fail(fault.to_string()))?;
        let mut reader = serde_json::Deserializer::from_str(&text);
        let mut study: Study = serde_path_to_error::deserialize(&mut reader)
            .map_err(|error| fail(format!("{}: {}", error.path(), error.inner())))?;
        study.scene = path.parent().unwrap_or(Path::new("")).join(&study.scene);
        study.check().map_err(fail)?;
        Ok(study)
    }

    /// Names of the labels of its rows, in the order of the sweep.
    pub fn labels(&self) -> Vec<&str> {
        self.sweep.iter().map(Axis::name).collect()
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
        let known = |what: &str, label: &str| match labels.contains(&label) {
            true => Ok(()),
            false => Err(format!("{what}: no label `{label}`; allowed: {}", labels.join(", "))),
        };
        for left in self.leave_out.iter().flat_map(|l| l.keys()) {
            known("leave_out", left)?;
        }
        for picture in &self.pictures {
            let (name, used, only) = match picture {
                Picture::Curves(p) => (&p.name, p.series.iter().collect::<Vec<_>>(), &p.only),
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

impl Axis {
    /// Name of its label.
    pub fn name(&self) -> &str {
        match self {
            Axis::Key { key, .. } => key,
            Axis::Variations { name, .. } => name,
        }
    }
}
