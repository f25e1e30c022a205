//! The library of materials: its list, and a scene with one of them.

use std::path::Path;

use flyer_mpm::input;
use flyer_mpm::input::LIBRARY;
use flyer_mpm::scene::CheckedScene;
use serde_json::{Value, json};

use crate::{Outcome, bad};

/// Name of the scene of a library material.
pub const LIBRARY_SCENE: &str = "library";

/// Largest number of characters of a source in the list.
const SOURCE: usize = 60;

/// All materials: name, models, density and source, one line each.
pub fn list() -> String {
    let lines = LIBRARY.iter().map(|(name, text)| {
        let material: Value = serde_json::from_str(text).expect("the library is JSON");
        let source = material["source"].as_str().unwrap_or("");
        let source: String = match source.char_indices().nth(SOURCE) {
            Some((end, _)) => format!("{}...", source[..end].trim_end()),
            None => source.into(),
        };
        let density = material["density"].as_f64().unwrap_or(0.0);
        let laws = input::failure_laws(name).into_iter().map(|(law, _)| law).collect::<Vec<_>>();
        let laws = match laws.is_empty() {
            true => String::new(),
            false => format!("  failure: {}", laws.join(", ")),
        };
        format!("{name:<32} {:<40} {density:>6} kg/m3  {source}{laws}\n", models(&material))
    });
    let text: String = lines.collect();
    text + "`flyer-mpm material NAME` prints and draws one; in a scene: {\"library\": \"NAME\"},\n\
            with a failure law of the list {\"library\": \"NAME\", \"failure\": \"LAW\"}\n"
}

/// The failure laws that the library has of a material, one line each with the constants and the
/// source.
pub fn failure_laws(name: &str) -> String {
    let line = |(law, mut constants): (String, Value)| {
        let source = constants.as_object_mut().and_then(|keys| keys.remove("source"));
        let source = source.as_ref().and_then(Value::as_str).unwrap_or("");
        format!("failure {law}: {constants}; {source}\n")
    };
    input::failure_laws(name).into_iter().map(line).collect()
}

/// Equation of state, strength, failure and further responses of a material, by their types.
fn models(material: &Value) -> String {
    let typed =
        ["eos", "strength", "failure"].iter().filter_map(|key| material[key]["type"].as_str());
    let plain = ["thermal", "erosion"].into_iter().filter(|key| !material[key].is_null());
    typed.chain(plain).collect::<Vec<_>>().join(", ")
}

/// A scene with one body of a material of the library, an explosive as its products.
///
/// # Errors
///
/// If there is no such material; a file is refused with the missing name of its material.
pub fn scene_of(name: &str) -> Outcome<CheckedScene> {
    let library = LIBRARY.iter().find(|(known, _)| *known == name);
    if library.is_none() && Path::new(name).is_file() {
        return Err(bad(format!("{name}: the name of a material of this scene is missing")));
    }
    if library.is_none() && name.ends_with(".json") {
        return Err(bad(format!("{name}: no such file")));
    }
    let explosive = library.is_some_and(|(_, text)| {
        let material: Value = serde_json::from_str(text).expect("the library is JSON");
        material["eos"]["type"] == "jwl"
    });
    let mut material = json!({"library": name});
    if explosive {
        material["eos"] = json!({"burn": "complete"});
    }
    let scene = json!({
        "title": "Material of the library",
        "domain": {"lower": [0.0], "upper": [0.01], "cell_size": 1e-4},
        "time": {"end": 1e-6},
        "materials": {name: material},
        "bodies": [{"name": "body", "material": name, "velocity": [0.0], "particles_per_cell": [1],
                    "box": {"lower": [0.0], "upper": [0.01]}}],
    });
    input::parse(scene.to_string().as_bytes(), LIBRARY_SCENE, &[]).map_err(|error| {
        // the user has written no scene
        let text = error.to_string();
        let known = text.split_once(": no such material").map(|(_, known)| known);
        bad(known.map_or(text.clone(), |known| format!("{name}: no such material{known}")))
    })
}
