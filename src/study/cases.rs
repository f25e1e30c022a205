//! The cases of a study: all combinations of the swept values.

use std::collections::BTreeMap;

use serde_json::Value;
use sha2::{Digest, Sha256};

use super::spec::{Study, StudyAxis, Variation};
use crate::input;
use crate::scene::CheckedScene;

/// A case: a scene with overrides, and its numbers of ranks and threads.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Labels that identify the case: one text per axis of the sweep.
    pub labels: BTreeMap<String, String>,
    /// Overrides `PATH=VALUE` of the scene; `PATH=` removes the key.
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
        let variations: Vec<Variation> = match axis {
            StudyAxis::Key { key, values } => values.iter().map(|v| one_key(key, v)).collect(),
            StudyAxis::Variations { cases, .. } => cases.clone(),
        };
        all = all
            .iter()
            .flat_map(|case| variations.iter().map(move |v| case.with(axis.name(), v)))
            .collect();
    }
    all.retain(|case| !study.leave_out.iter().any(|left| fits(&case.labels, left)));
    all
}

/// A value of one key as a variation.
fn one_key(key: &str, value: &Value) -> Variation {
    let set = BTreeMap::from([(key.to_string(), value.clone())]);
    Variation { name: text(value), remove: Vec::new(), set }
}

impl Case {
    fn with(&self, label: &str, variation: &Variation) -> Case {
        let mut case = self.clone();
        case.labels.insert(label.into(), variation.name.clone());
        case.sets.extend(variation.remove.iter().map(|path| format!("{path}=")));
        for (path, value) in &variation.set {
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

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn keys_are_removed_before_values_are_set() {
        let study = json!({
            "title": "", "scene": "", "set": {"a": 1},
            "sweep": [{"name": "s", "cases": [{"name": "b", "remove": ["m"], "set": {"m.x": 2}}]}],
        });
        let study: Study = serde_json::from_value(study).unwrap();
        assert_eq!(cases(&study)[0].sets, ["a=1", "m=", "m.x=2"]);
    }
}
