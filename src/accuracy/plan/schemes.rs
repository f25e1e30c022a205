//! The schemes that can be chosen.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::{Value, json};

/// A scheme with particles per cell and Courant number.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scheme {
    /// Its name.
    pub name: String,
    /// Particles a cell.
    pub particles_per_cell: usize,
    /// Courant number.
    pub courant: f64,
    /// Keys at the top level of a scene that make it; none: those of the standard problem.
    pub set: BTreeMap<String, Value>,
}

/// The scene whose scheme is this program's default.
const STANDARD: &str = include_str!("../../../inputs/flyer.json");

/// Keys that make a scheme.
const KEYS: [&str; 2] = ["method", "artificial_viscosity"];

/// The standard problem with the default scheme.
pub fn standard() -> Value {
    serde_json::from_str(STANDARD).expect("the shipped scene is whole")
}

/// The schemes that can be chosen; the first is that of the standard problem.
pub fn schemes() -> Vec<Scheme> {
    let mut all: Vec<Scheme> =
        serde_json::from_str(include_str!("schemes.json")).expect("the shipped schemes are whole");
    let standard = standard();
    for scheme in all.iter_mut().filter(|s| s.set.is_empty()) {
        scheme.set = KEYS.map(|key| (key.to_string(), standard[key].clone())).into();
    }
    all
}

impl Scheme {
    /// Puts the scheme into a scene.
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
            // positions of its own are those of other cells
            body.as_object_mut().map(|body| body.remove("positions"));
        }
    }
}
