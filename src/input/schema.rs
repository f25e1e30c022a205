//! The JSON schema of a scene, generated from its structs.

use std::sync::LazyLock;

use schemars::{Schema, generate::SchemaSettings, transform::RecursiveTransform};
use serde_json::{Value, json};

use super::units;
use crate::effects;
use crate::scene::{Preset, Scene};

/// Largest magnitude of any number in a scene. Products of four such numbers, for example an energy
/// of a body, stay finite.
pub(super) const GREATEST: f64 = 1e75;

/// Smallest value of a number in a scene that must be positive. Quotients of four such numbers stay
/// finite.
pub(super) const LEAST: f64 = 1e-150;

/// The JSON schema of a scene (draft 2020-12); units are in the descriptions. A number without
/// bounds of its own has the general bounds.
pub fn schema() -> Value {
    let mut schema = full_schema().clone();
    units::allow_quantities(&mut schema);
    let generator = SchemaSettings::draft2020_12().into_generator();
    let mut names = generator.into_root_schema_for::<Preset>().to_value();
    let names_text = names["description"].take();
    let mut over = schema["$defs"]["Method"].clone();
    over["required"] = json!(["preset"]);
    over["description"] =
        json!("The key `preset`, and keys of `Method` that override those of the preset.");
    over["properties"]["preset"] = json!({"$ref": "#/$defs/Preset"});
    for key in ["$schema", "title"] {
        names.as_object_mut().and_then(|names| names.remove(key));
    }
    names["description"] = names_text;
    schema["$defs"]["Preset"] = names;
    schema["$defs"]["MethodOverPreset"] = over;
    let options =
        ["Preset", "Method", "MethodOverPreset"].map(|of| json!({"$ref": format!("#/$defs/{of}")}));
    schema["properties"]["method"] = json!({
        "description": "Numerical method: the name of a preset, a method in full, or a preset with \
                        keys over it; absent: `default`.",
        "anyOf": options,
    });
    schema["properties"]["$schema"] = json!({
        "description": "Name of a file with this schema, for editors.",
        "type": "string",
    });
    if let Some(required) = schema["required"].as_array_mut() {
        required.retain(|key| key != "method");
    }
    schema
}

/// The JSON schema of a scene whose method is given in full, as every scene is once its preset is
/// expanded.
pub(super) fn full_schema() -> &'static Value {
    // once for all scenes that a process reads
    static SCHEMA: LazyLock<Value> = LazyLock::new(generate);
    &SCHEMA
}

fn generate() -> Value {
    let settings = || SchemaSettings::draft2020_12().with_transform(RecursiveTransform(bound));
    let mut root = settings().into_generator().into_root_schema_for::<Scene>().to_value();
    root["additionalProperties"] = json!(false);
    for key in effects::keys() {
        let mut options = (key.schema)(settings());
        let name = options["title"].take();
        let name = name.as_str().unwrap_or(key.name);
        if let Some(object) = options.as_object_mut() {
            ["$schema", "title"].into_iter().for_each(|key| drop(object.remove(key)));
            if let Some(Value::Object(definitions)) = object.remove("$defs") {
                definitions.into_iter().for_each(|(name, of)| root["$defs"][name] = of);
            }
        }
        let description = options["description"].as_str().unwrap_or("");
        let description = format!("{description} Absent: {}.", key.absent);
        root["properties"][key.name] = json!({
            "description": description,
            "anyOf": [{"$ref": format!("#/$defs/{name}")}, {"type": "null"}],
        });
        root["$defs"][name] = options;
    }
    root
}

/// Adds the general bounds to those of one number.
fn bound(schema: &mut Schema) {
    let of = |key: &str| schema.get(key).and_then(Value::as_f64);
    let is_number = schema.get("type").is_some_and(|kind| match kind {
        Value::Array(kinds) => kinds.iter().any(|kind| kind == "number"),
        kind => kind == "number",
    });
    if !is_number {
        return;
    }
    let upper = of("maximum").or(of("exclusiveMaximum")).is_none().then_some(GREATEST);
    let lower = match (of("minimum"), of("exclusiveMinimum")) {
        (None, None) => Some(-GREATEST),
        (None, Some(0.0)) => Some(LEAST),
        _ => None,
    };
    for (key, bound) in [("maximum", upper), ("minimum", lower)] {
        if let Some(bound) = bound {
            schema.insert(key.into(), json!(bound));
        }
    }
}
