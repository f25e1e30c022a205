//! The schemes that a plan can choose.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::{Value, json};

/// A scheme with its particles per cell and Courant number.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedScheme {
    /// Name of the scheme.
    pub name: String,
    /// Particles per cell.
    pub particles_per_cell: usize,
    /// Courant number \[-\].
    pub courant: f64,
    /// Top-level keys of a scene that define the scheme; if empty, those of the standard problem.
    pub set: BTreeMap<String, Value>,
}

/// The scene with the default scheme of this program.
const STANDARD: &str = include_str!("../../../inputs/flyer.json");

/// Keys that define a scheme.
const KEYS: [&str; 2] = ["method", "artificial_viscosity"];

/// The standard problem with the default scheme.
#[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
pub fn standard() -> Value {
    serde_json::from_str(STANDARD).expect("the shipped scene is whole")
}

/// All schemes that a plan can choose; the first is that of the standard problem.
#[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
pub fn schemes() -> Vec<PlannedScheme> {
    let mut all: Vec<PlannedScheme> =
        serde_json::from_str(include_str!("schemes.json")).expect("the shipped schemes are whole");
    let standard = standard();
    for scheme in all.iter_mut().filter(|s| s.set.is_empty()) {
        scheme.set = KEYS.map(|key| (key.to_string(), standard[key].clone())).into();
    }
    all
}

impl PlannedScheme {
    /// Writes the scheme into a scene.
    pub fn apply(&self, scene: &mut Value) {
        for key in KEYS {
            match self.set.get(key) {
                Some(value) => scene[key] = value.clone(),
                None => {
                    scene.as_object_mut().map(|s| s.remove(key));
                }
            }
        }
        scene["time"]["courant"] = json!(self.courant);
        for body in scene["bodies"].as_array_mut().into_iter().flatten() {
            body["particles_per_cell"] = json!([self.particles_per_cell]);
            // given particle positions belong to another cell size
            body.as_object_mut().map(|body| body.remove("positions"));
        }
    }
}
