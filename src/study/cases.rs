//! The cases of a study: all combinations of the swept values.

use std::collections::BTreeMap;

use serde_json::Value;
use sha2::{Digest, Sha256};

use super::spec::{Study, StudyAxis};
use crate::input;
use crate::scene::CheckedScene;

/// A case: a scene with overrides, and its numbers of ranks and threads.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Labels that identify the case: one text per axis of the sweep.
    pub labels: BTreeMap<String, String>,
    /// Overrides `PATH=VALUE` of the scene.
    pub sets: Vec<String>,
    /// Ranks.
    pub ranks: usize,
    /// Threads of each rank.
    pub threads: usize,
}

/// A value as a label: text without quotes, numbers in short form.
pub fn text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// Whether the labels match the selection `only`.
pub fn fits(labels: &BTreeMap<String, String>, only: &BTreeMap<String, Value>) -> bool {
    only.iter().all(|(label, value)| labels.get(label) == Some(&text(value)))
}

/// All cases of a study, except those that it leaves out.
pub fn cases(study: &Study) -> Vec<Case> {
    let sets = study.set.iter().map(|(path, value)| format!("{path}={value}")).collect();
    let mut all = vec![Case { labels: BTreeMap::new(), sets, ranks: 1, threads: 1 }];
    for axis in &study.sweep {
        let variations: Vec<(String, Vec<(&String, &Value)>)> = match axis {
            StudyAxis::Key { key, values } => {
                values.iter().map(|value| (text(value), vec![(key, value)])).collect()
            }
            StudyAxis::Variations { cases, .. } => {
                cases.iter().map(|case| (case.name.clone(), case.set.iter().collect())).collect()
            }
        };
        all = all
            .iter()
            .flat_map(|case| variations.iter().map(move |v| case.with(axis.name(), v)))
            .collect();
    }
    all.retain(|case| !study.leave_out.iter().any(|left| fits(&case.labels, left)));
    all
}

impl Case {
    fn with(&self, label: &str, (text, sets): &(String, Vec<(&String, &Value)>)) -> Case {
        let mut case = self.clone();
        case.labels.insert(label.into(), text.clone());
        for (path, value) in sets {
            let count = value.as_u64().map(|n| n as usize);
            match (path.as_str(), count) {
                ("run.ranks", Some(n)) => case.ranks = n,
                ("run.threads", Some(n)) => case.threads = n,
                _ => case.sets.push(format!("{path}={value}")),
            }
        }
        case
    }

    /// The checked scene of the case. The error is the message of the scene check.
    ///
    /// # Errors
    ///
    /// The message of the scene check.
    pub fn scene(&self, bytes: &[u8], file: &str) -> Result<CheckedScene, String> {
        input::parse(bytes, file, &self.sets).map_err(|error| error.to_string())
    }

    /// Key of the record: a hash of the resolved scene, the program, ranks and threads.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn key(&self, scene: &CheckedScene, program: &str) -> String {
        let mut digest = Sha256::new();
        let text = serde_json::to_string(&scene.scene).expect("a scene is plain data");
        for part in [program, &text, &format!("{} x {}", self.ranks, self.threads)] {
            digest.update((part.len() as u64).to_le_bytes());
            digest.update(part.as_bytes());
        }
        digest.finalize().iter().take(16).map(|b| format!("{b:02x}")).collect()
    }
}
