//! Names in a scene: of materials and bodies, which other keys refer to.

use std::collections::HashSet;

use serde_json::Value;

use super::check::check_printable;
use super::errors::{SceneFault, suggest};
use super::paths::{entry_key, join};

/// Faults of names that no material or body of the scene has.
pub(super) fn check(scene: &Value) -> Vec<SceneFault> {
    let mut faults = Vec::new();
    let Some(bodies) = scene["bodies"].as_array() else { return faults };
    if let Some(materials) = scene["materials"].as_object() {
        let known: Vec<&str> = materials.keys().map(String::as_str).collect();
        for (i, body) in bodies.iter().enumerate() {
            // a path costs a look at the names of all bodies
            if body["material"].as_str().is_some_and(|name| !materials.contains_key(name)) {
                let path = format!("{}.material", below("bodies", &entry_key(bodies, i)));
                faults.extend(unknown(&body["material"], &path, "material", &known));
            }
        }
    }
    // a body with a faulty name may be the one that is meant
    let Some(known) = names_of(bodies) else { return faults };
    let mut bodies_at = |value: &Value, path: String| {
        faults.extend(unknown(value, &path, "body", &known));
    };
    for (kind, reference) in scene["reference"].as_object().into_iter().flatten() {
        for key in ["flyer", "target", "left", "right", "body"] {
            bodies_at(&reference[key], join(&join("reference", kind), key));
        }
    }
    bodies_at(&scene["error_estimate"]["body"], "error_estimate.body".into());
    for list in ["tracers", "velocimeters"] {
        let path = join("output.histories", list);
        let points = scene["output"]["histories"][list].as_array().map_or(&[][..], Vec::as_slice);
        for (i, point) in points.iter().enumerate() {
            bodies_at(&point["body"], format!("{}.body", below(&path, &entry_key(points, i))));
        }
    }
    faults
}

/// Names of all bodies; `None` if one has no name of its own.
fn names_of(bodies: &[Value]) -> Option<Vec<&str>> {
    let known: Option<Vec<&str>> = bodies.iter().map(|body| body["name"].as_str()).collect();
    let known = known.filter(|names| !names.is_empty())?;
    let distinct: HashSet<&str> = known.iter().copied().collect();
    let valid = known.iter().all(|name| check_printable("", name).is_ok());
    (valid && distinct.len() == known.len()).then_some(known)
}

/// Path of the entry `key` of the array at `path`.
fn below(path: &str, key: &str) -> String {
    if key.starts_with('[') { format!("{path}{key}") } else { format!("{path}.{key}") }
}

/// Fault of a name that is none of `known`. A value that is no text is reported by the schema.
fn unknown(name: &Value, path: &str, kind: &str, known: &[&str]) -> Option<SceneFault> {
    let name = name.as_str().filter(|name| !known.contains(name))?;
    let reason = format!("no such {kind}{}", suggest(name, known.iter().copied()));
    Some(SceneFault::new(path, name, reason))
}
