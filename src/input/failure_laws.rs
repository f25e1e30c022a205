//! Failure laws of library materials, by name.
//!
//! A material of the library has no failure until a scene names one of its laws:
//! `{"library": "tantalum", "failure": "spall"}`, or `{"library": "spall", ...}` with keys that
//! override single constants.

use serde_json::{Map, Value};

use super::errors::{SceneFault, suggest};

/// Laws of each library material: an object of laws by name, each with its `source`.
const LAWS: [(&str, &str); 5] = [
    (
        "aluminium_2024_johnson_cook",
        include_str!("../../inputs/failure_laws/aluminium_2024_johnson_cook.json"),
    ),
    ("copper_johnson_cook", include_str!("../../inputs/failure_laws/copper_johnson_cook.json")),
    (
        "steel_4340_johnson_cook",
        include_str!("../../inputs/failure_laws/steel_4340_johnson_cook.json"),
    ),
    ("tantalum", include_str!("../../inputs/failure_laws/tantalum.json")),
    ("tantalum_steinberg_guinan", include_str!("../../inputs/failure_laws/tantalum.json")),
];

/// The laws of the library material `name`, by name, each in the format of a scene with its
/// `source`.
///
/// # Panics
///
/// If a file of the library is no JSON.
pub fn failure_laws(name: &str) -> Map<String, Value> {
    let found = LAWS.iter().find(|(known, _)| *known == name);
    let read = |text| serde_json::from_str(text).expect("the library is JSON");
    found.map_or_else(Map::new, |(_, text)| read(text))
}

/// Replaces the name of a failure law in a material, which is that of the library named `library`, by
/// the law; its source joins that of the material.
pub(super) fn resolve_failure(
    material: &mut Map<String, Value>,
    library: &str,
    path: &str,
) -> Result<(), SceneFault> {
    let (name, path, over) = match material.get("failure") {
        Some(Value::String(name)) => (name.clone(), format!("{path}.failure"), Map::new()),
        Some(Value::Object(keys)) => match keys.get("library") {
            Some(Value::String(name)) => {
                let mut over = keys.clone();
                over.remove("library");
                (name.clone(), format!("{path}.failure.library"), over)
            }
            _ => return Ok(()),
        },
        _ => return Ok(()),
    };
    let mut laws = failure_laws(library);
    let Some(Value::Object(mut law)) = laws.remove(&name) else {
        let known = laws.keys().map(String::as_str);
        let reason = format!(
            "the library has no such failure law of {library}{}, or a law with its type",
            suggest(&name, known)
        );
        return Err(SceneFault::new(path, name, reason));
    };
    if let (Some(Value::String(own)), Some(Value::String(source))) =
        (law.remove("source"), material.get_mut("source"))
    {
        *source = format!("{source} Failure: {own}");
    }
    law.extend(over);
    material.insert("failure".into(), law.into());
    Ok(())
}
