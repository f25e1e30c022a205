//! Shipped scenes to be edited by tests.

use std::path::Path;

use serde_json::{Value, json};

/// All shape functions.
pub const SHAPES: [&str; 6] =
    ["linear", "gimp", "cpdi", "bspline_quadratic", "bspline_cubic", "cpdi_bspline_quadratic"];

/// A shipped scene to be edited, without histories.
pub fn shipped(name: &str) -> Value {
    // the acceptance crate, two folders further down, reads the same scenes
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    let file = crates.map(|root| root.join("inputs").join(name)).find(|file| file.exists());
    let file = file.unwrap_or_else(|| panic!("no scene {name}"));
    let mut value: Value = serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap();
    value["output"].as_object_mut().unwrap().remove("histories");
    value
}

/// Merges `edit` into `value`: objects key by key, other values as a whole; null removes a key. A
/// choice given as an object with one key, such as a transfer, is replaced as a whole.
pub fn merge(value: &mut Value, edit: &Value) {
    let Value::Object(edits) = edit else {
        *value = edit.clone();
        return;
    };
    if !value.is_object() {
        *value = json!({});
    }
    let object = value.as_object_mut().unwrap();
    for (key, edit) in edits {
        if edit.is_null() {
            object.remove(key);
        } else if matches!(key.as_str(), "transfer" | "x_lower" | "x_upper" | "reference") {
            object.insert(key.clone(), edit.clone());
        } else {
            merge(object.entry(key).or_insert(Value::Null), edit);
        }
    }
}

/// `value` with an edit.
pub fn with(value: &Value, edit: &Value) -> Value {
    let mut value = value.clone();
    merge(&mut value, edit);
    value
}
