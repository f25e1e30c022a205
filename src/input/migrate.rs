//! Former formats of a scene: their keys are rejected with the new names, and rewritten on request.

use jsonc_parser::ParseOptions;
use jsonc_parser::cst::{CstInputValue, CstNode, CstRootNode, CstStringLit};
use serde_json::Value;

use super::errors::SceneFault;
use crate::scene::FORMAT;

/// A key or a string value that was renamed in a format.
struct Renamed {
    /// Format that introduced the new name.
    since: u32,
    /// Parent keys; `*` matches any key or index.
    parents: &'static [&'static str],
    kind: RenamedKind,
    former: &'static str,
    now: &'static str,
}

#[derive(Clone, Copy, PartialEq)]
enum RenamedKind {
    Key,
    Text,
}

const fn key(parents: &'static [&'static str], former: &'static str, now: &'static str) -> Renamed {
    Renamed { since: 2, parents, kind: RenamedKind::Key, former, now }
}

const fn text(
    parents: &'static [&'static str],
    former: &'static str,
    now: &'static str,
) -> Renamed {
    Renamed { since: 2, parents, kind: RenamedKind::Text, former, now }
}

/// In an order in which a parent is renamed before its keys are searched.
const RENAMED: &[Renamed] = &[
    key(&[], "watch", "monitor"),
    key(&["monitor"], "crowding", "max_particles_per_cell_ratio"),
    key(&["monitor"], "most_redos", "max_retries"),
    key(&["monitor"], "least_step", "min_time_step_ratio"),
    key(&["monitor"], "above_limit", "on_courant_exceeded"),
    key(&["decomposition"], "skip_quiet", "skip_quiescent"),
    text(&["decomposition", "filter_halo"], "deep", "redundant"),
    key(&["artificial_viscosity", "growth"], "most", "max"),
    key(&["materials", "*", "eos"], "stiffness", "p_inf"),
    key(&["materials", "*", "eos"], "compaction_pressure", "full_compaction_pressure"),
];

/// Rejects a scene of another format, and a scene with a former name.
pub(super) fn check_format(scene: &Value) -> Result<(), SceneFault> {
    if let Some(format) = scene.get("format").and_then(Value::as_u64) {
        if format > u64::from(FORMAT) {
            let reason = format!(
                "the scene is of a newer format than this program reads; allowed: {FORMAT}, or a \
                 newer flyer-mpm"
            );
            return Err(SceneFault::new("format", format, reason));
        }
        if format < u64::from(FORMAT) {
            let reason = format!(
                "the scene is of an older format; allowed: {FORMAT}; flyer-mpm migrate rewrites it"
            );
            return Err(SceneFault::new("format", format, reason));
        }
    }
    for renamed in RENAMED {
        if let Some(path) = renamed.find(scene, renamed.parents, String::new()) {
            let Renamed { since, now, .. } = renamed;
            let what = match renamed.kind {
                RenamedKind::Key => "the key",
                RenamedKind::Text => "the value",
            };
            let reason = format!(
                "{what} is named {now} since format {since}; flyer-mpm migrate rewrites a scene"
            );
            return Err(match renamed.kind {
                RenamedKind::Key => SceneFault::missing(path, reason),
                RenamedKind::Text => SceneFault::new(path, renamed.former, reason),
            });
        }
    }
    Ok(())
}

impl Renamed {
    /// Path of the former name below `value`, which is at `path`.
    fn find(&self, value: &Value, parents: &[&str], path: String) -> Option<String> {
        let below = |key: &str| match path.as_str() {
            "" => key.to_string(),
            path => format!("{path}.{key}"),
        };
        let Some((parent, rest)) = parents.split_first() else {
            return match self.kind {
                RenamedKind::Key => value.get(self.former).map(|_| below(self.former)),
                RenamedKind::Text => (value == self.former).then_some(path),
            };
        };
        match value {
            Value::Object(object) => object
                .iter()
                .filter(|(key, _)| *parent == "*" || key == parent)
                .find_map(|(key, value)| self.find(value, rest, below(key))),
            _ => None,
        }
    }

    /// Rewrites the former name below `node`; returns whether it was found.
    fn rewrite(&self, node: &CstNode, parents: &[&str]) -> bool {
        let rename = |literal: CstStringLit| literal.set_raw_value(format!("\"{}\"", self.now));
        let Some((parent, rest)) = parents.split_first() else {
            return match self.kind {
                RenamedKind::Key => {
                    let property = node.as_object().and_then(|object| object.get(self.former));
                    let name = property.and_then(|p| p.name()?.as_string_lit());
                    name.map(rename).is_some()
                }
                RenamedKind::Text => {
                    let literal = node.as_string_lit();
                    let former =
                        |l: &CstStringLit| l.decoded_value().is_ok_and(|t| t == self.former);
                    literal.filter(former).map(rename).is_some()
                }
            };
        };
        let properties = node.as_object().map_or(Vec::new(), |object| object.properties());
        let mut found = false;
        for property in properties {
            if (*parent == "*" || property.decoded_name().is_some_and(|name| name == *parent))
                && let Some(value) = property.value()
            {
                found |= self.rewrite(&value, rest);
            }
        }
        found
    }
}

/// Text of a scene in the current format, and the former names that it contained. White space and
/// the order of keys are preserved; comments are not allowed in JSON.
///
/// # Errors
///
/// If the text is not a JSON object, or of a format newer than [`FORMAT`].
pub fn migrate(text: &str) -> Result<(String, Vec<&'static str>), String> {
    let strict = ParseOptions {
        allow_comments: false,
        allow_loose_object_property_names: false,
        allow_trailing_commas: false,
        ..ParseOptions::default()
    };
    let root = CstRootNode::parse(text, &strict).map_err(|error| error.to_string())?;
    let object = root.object_value().ok_or("is not a JSON object")?;
    let format = object.get("format");
    let number = format.as_ref().and_then(|f| f.value()?.as_number_lit());
    if number.is_some_and(|n| n.to_string().parse::<u64>().is_ok_and(|n| n > u64::from(FORMAT))) {
        return Err(format!("is of a newer format than {FORMAT}, which this program reads"));
    }
    let node = root.value().ok_or("is not a JSON object")?;
    let former: Vec<_> =
        RENAMED.iter().filter(|r| r.rewrite(&node, r.parents)).map(|r| r.former).collect();
    let now = CstInputValue::Number(FORMAT.to_string());
    match format {
        Some(format) => format.set_value(now),
        None => {
            object.insert(0, "format", now);
        }
    }
    Ok((root.to_string(), former))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    const FORMER: &str = r#"{
  "title": "former",
  "watch": { "crowding": 2.0, "above_limit": "allow" },
  "decomposition": {"filter_halo": "deep",
                    "skip_quiet": false},
  "materials": {"water": {"eos": {"type": "stiffened_gas", "stiffness": 6e8}}}
}
"#;

    #[test]
    fn former_names_are_rewritten_and_nothing_else() {
        let (text, former) = migrate(FORMER).unwrap();
        assert_eq!(former.len(), 6, "{former:?}");
        assert_eq!(
            text,
            r#"{
  "format": 2,
  "title": "former",
  "monitor": { "max_particles_per_cell_ratio": 2.0, "on_courant_exceeded": "allow" },
  "decomposition": {"filter_halo": "redundant",
                    "skip_quiescent": false},
  "materials": {"water": {"eos": {"type": "stiffened_gas", "p_inf": 6e8}}}
}
"#
        );
        let (again, former) = migrate(&text).unwrap();
        assert_eq!((again, former), (text, vec![]));
    }

    #[test]
    fn every_former_name_is_refused_with_the_new_one() {
        for renamed in RENAMED {
            let leaf = match renamed.kind {
                RenamedKind::Key => json!({renamed.former: 1}),
                RenamedKind::Text => json!(renamed.former),
            };
            let parents = renamed.parents.iter().rev();
            let scene = parents.fold(leaf, |value, parent| json!({*parent: value}));
            let fault = format!("{:?}", check_format(&scene).unwrap_err());
            assert!(fault.contains(&format!("is named {}", renamed.now)), "{fault}");
            let (text, _) = migrate(&scene.to_string()).unwrap();
            assert_eq!(check_format(&serde_json::from_str(&text).unwrap()), Ok(()));
        }
    }

    #[test]
    fn other_formats_are_refused() {
        for (format, word) in [(1, "older"), (FORMAT + 1, "newer")] {
            let fault = format!("{:?}", check_format(&json!({"format": format})).unwrap_err());
            assert!(fault.contains(word), "{fault}");
        }
        assert!(migrate(&format!("{{\"format\": {}}}", FORMAT + 1)).is_err());
        assert!(migrate("[]").is_err() && migrate("{").is_err());
    }
}
