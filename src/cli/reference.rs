//! Reference of the keys of a scene in Markdown, generated from the JSON schema of scenes.

use std::fmt::Write;

use serde_json::Value;

/// Text before the first table.
const HEAD: &str = include_str!("reference.md");

/// Least and largest magnitude of any number; the head of the page states them.
const GENERAL: [f64; 2] = [1e-150, 1e75];

/// Path of the definitions in the schema.
const DEFINITIONS: &str = "#/$defs/";

/// The reference of `schema`, the JSON schema of a scene.
pub fn markdown(schema: &Value) -> String {
    let mut root = schema.clone();
    let definitions = root["$defs"].take();
    let (mut text, mut written) = (HEAD.to_string(), Vec::new());
    let mut waiting = vec!["Scene".to_string()];
    while let Some(name) = waiting.pop() {
        let definition = definitions.get(&name).unwrap_or(&root);
        section(&mut text, &name, definition);
        written.push(name);
        let compact = definition.to_string();
        let named =
            compact.rmatch_indices(DEFINITIONS).map(|(at, path)| &compact[at + path.len()..]);
        waiting.extend(named.filter_map(|rest| rest.split('"').next()).map(str::to_string));
        waiting.retain(|name| !written.contains(name));
    }
    text
}

/// One object or choice: heading, description, and its keys as a table or its variants as a list.
fn section(text: &mut String, name: &str, definition: &Value) {
    let _ = write!(text, "\n## {name}\n\n{}\n", description(definition));
    // its keys are those of `Method`
    if name != "MethodOverPreset" {
        table(text, definition);
    }
    let variants = variants(definition);
    for (i, variant) in variants.iter().enumerate() {
        let kind = tag(variant).map(|tag| format!("`\"type\": \"{tag}\"`"));
        let kind = kind.unwrap_or_else(|| type_name(variant));
        let line = format!("{}- {kind}: {}", if i == 0 { "\n" } else { "" }, description(variant));
        let _ = writeln!(text, "{}", line.trim_end_matches(": "));
    }
    for (variant, kind) in variants.iter().filter_map(|variant| Some((variant, tag(variant)?))) {
        if keys(variant).count() > 1 {
            let _ = write!(text, "\n### {name} `{kind}`\n");
            table(text, variant);
        }
    }
}

/// Value of the key `type` that selects a variant.
fn tag(variant: &Value) -> Option<&str> {
    variant["properties"]["type"]["const"].as_str()
}

/// Keys of an object.
fn keys(of: &Value) -> impl Iterator<Item = (&String, &Value)> {
    of["properties"].as_object().into_iter().flatten()
}

/// Keys of an object as a table, required ones first.
fn table(text: &mut String, of: &Value) {
    let required = of["required"].as_array().map_or(&[][..], |all| all);
    let mut rows: Vec<_> = keys(of).filter(|(_, of)| of["const"].is_null()).collect();
    rows.sort_by_key(|(key, _)| !required.iter().any(|name| name == *key));
    if !rows.is_empty() {
        text.push_str("\n| key | type | meaning | default |\n|---|---|---|---|\n");
    }
    for (key, of) in rows {
        let default = match &of["default"] {
            _ if required.iter().any(|name| name == key) => "required".into(),
            Value::Null => "-".into(),
            value => format!("`{value}`"),
        };
        let (unit, meaning) = split_unit(&description(of));
        let cells = [format!("`{key}`"), type_name(of) + &unit, meaning, default];
        let _ = writeln!(text, "| {} |", cells.map(|cell| cell.replace('|', "\\|")).join(" | "));
    }
}

/// Description on one line.
fn description(of: &Value) -> String {
    of["description"].as_str().unwrap_or("").split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Takes the unit out of a description that has exactly one.
fn split_unit(text: &str) -> (String, String) {
    match text.split(['[', ']']).collect::<Vec<_>>()[..] {
        [before, unit, after] => (format!(" [{unit}]"), before.trim_end().to_string() + after),
        _ => (String::new(), text.into()),
    }
}

/// Choices of a definition, without that of `null`.
fn variants(of: &Value) -> Vec<&Value> {
    let choices = of["oneOf"].as_array().or(of["anyOf"].as_array());
    choices.into_iter().flatten().filter(|choice| choice["type"] != "null").collect()
}

/// Type of a value with its range; objects are links to their sections.
fn type_name(of: &Value) -> String {
    if let Some(name) = of["$ref"].as_str().and_then(|path| path.strip_prefix(DEFINITIONS)) {
        return format!("[{name}](#{})", name.to_lowercase());
    }
    if let Some(text) = of["const"].as_str() {
        return format!("`\"{text}\"`");
    }
    let choices = variants(of);
    if !choices.is_empty() {
        return choices.into_iter().map(type_name).collect::<Vec<_>>().join(" or ");
    }
    let not_null = of["type"].as_array().and_then(|all| all.iter().find(|kind| *kind != "null"));
    match not_null.unwrap_or(&of["type"]).as_str().unwrap_or("") {
        "object" if of["properties"].is_null() => {
            format!("names, each with {}", type_name(&of["additionalProperties"]))
        }
        "object" => {
            let keys = keys(of).map(|(key, of)| format!("`{key}`: {}", type_name(of)));
            format!("{{{}}}", keys.collect::<Vec<_>>().join(", "))
        }
        "array" => {
            let count = match (of["minItems"].as_u64(), of["maxItems"].as_u64()) {
                (Some(least), most) if Some(least) == most => format!(" ({least})"),
                (Some(least), _) => format!(" (at least {least})"),
                _ => String::new(),
            };
            format!("list of {}{count}", type_name(&of["items"]))
        }
        kind => kind.to_string() + &range(of),
    }
}

/// Bounds of a number that are not the general ones.
fn range(of: &Value) -> String {
    let bound = |key: &str, sign: &str| {
        let bound = of[key].as_f64().filter(|bound| !GENERAL.contains(&bound.abs()))?;
        match bound.abs() {
            // the largest number is no bound
            size if size >= f64::MAX => None,
            size if size >= 1e9 => Some(format!(" {sign} {bound:e}")),
            _ => Some(format!(" {sign} {bound}")),
        }
    };
    let lower = bound("exclusiveMinimum", ">").or(bound("minimum", ">="));
    let upper = bound("exclusiveMaximum", "<").or(bound("maximum", "<="));
    [lower, upper].into_iter().flatten().collect::<Vec<_>>().join(",")
}
