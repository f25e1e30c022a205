//! Paths of keys in messages, and types that a schema allows.

use serde_json::Value;

/// `key` as written in a path: in double quotes if it would be ambiguous.
pub(super) fn quote(key: &str) -> String {
    let plain = !key.is_empty() && !key.contains(['.', '[', ']', '=', '"']);
    if plain { key.to_string() } else { Value::from(key).to_string() }
}

/// Path of `key` below `path`, in the syntax of `--set`.
pub(super) fn join(path: &str, key: &str) -> String {
    if path.is_empty() { quote(key) } else { format!("{path}.{}", quote(key)) }
}

/// Key of an array entry in a path: its name if that is unique, else its number.
pub(super) fn entry_key(entries: &[Value], i: usize) -> String {
    let name = |entry: &Value| entry.get("name").and_then(Value::as_str).map(str::to_string);
    let unlike_others = |own: &String| {
        !own.is_empty() && entries.iter().filter(|e| name(e).as_ref() == Some(own)).count() == 1
    };
    name(&entries[i]).filter(unlike_others).map_or(format!("[{i}]"), |own| quote(&own))
}

/// Names of the types that a schema allows.
pub(super) fn types(schema: &Value) -> Vec<&str> {
    match schema.get("type") {
        Some(Value::String(name)) => vec![name],
        Some(Value::Array(names)) => names.iter().filter_map(Value::as_str).collect(),
        _ => Vec::new(),
    }
}
