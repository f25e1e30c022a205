//! Overrides `PATH=VALUE` from the command line, applied to the JSON of a scene before it is
//! checked.
//!
//! A path is a list of keys joined by dots. An entry of an array is given by its `name` or its
//! number: `bodies.flyer`, `bodies.0` or `bodies[0]`. A key that contains a dot is in double
//! quotes: `materials."Al 6061.T6".density`. Missing objects along the path are created. Without a
//! value, as in `artificial_viscosity=`, the key or entry is removed.

use serde_json::{Map, Value};

use super::errors::{LONGEST_REASON, LONGEST_VALUE, SceneError, list, nearest, one_line, shorten};

/// Maximum number of keys in a path, more than any path of a scene has.
const LONGEST_PATH: usize = 32;

const FORM: &str = "allowed: PATH=VALUE, such as time.end=1e-6 or bodies.flyer.velocity=[500], or PATH= \
                    to remove a key";

/// Applies one override. A value that is not JSON is taken as a string; an empty one removes the
/// key.
pub(super) fn apply(scene: &mut Value, set: &str) -> Result<(), SceneError> {
    let fail = |reason: String| SceneError::Set {
        set: one_line(&shorten(set, LONGEST_VALUE)),
        reason: one_line(&shorten(&reason, LONGEST_REASON)),
    };
    let (path, value) = split(set).map_err(fail)?;
    if value.is_empty() {
        return remove(scene, &path).map_err(fail);
    }
    let value = serde_json::from_str(value).unwrap_or_else(|_| Value::from(value));
    let mut place = scene;
    let mut walked = String::new();
    for key in &path {
        place = enter(place, &walked, key).map_err(fail)?;
        walked = super::paths::join(&walked, key);
    }
    *place = value;
    Ok(())
}

/// Removes the key at the end of `path`.
fn remove(scene: &mut Value, path: &[String]) -> Result<(), String> {
    let (key, parents) = path.split_last().expect("a path has a key");
    let mut place = scene;
    let mut walked = String::new();
    for parent in parents {
        place = enter(place, &walked, parent)?;
        walked = super::paths::join(&walked, parent);
    }
    let removed = match place {
        Value::Object(object) => object.remove(key).is_some(),
        Value::Array(entries) => {
            let i = find_entry(entries, &walked, key)?;
            entries.remove(i);
            true
        }
        _ => false,
    };
    match removed {
        true => Ok(()),
        false => Err(format!("no key {} to remove", super::paths::join(&walked, key))),
    }
}

/// Rejects an override of a key that is neither in `allowed` nor below such a key.
pub(super) fn check_allowed(set: &str, allowed: &[&str]) -> Result<(), SceneError> {
    let fail = |reason: String| SceneError::Set {
        set: one_line(&shorten(set, LONGEST_VALUE)),
        reason: one_line(&shorten(&reason, LONGEST_REASON)),
    };
    let (keys, _) = split(set).map_err(fail)?;
    let below = |path: &str| {
        path.split('.').zip(&keys).filter(|(a, b)| a == b).count() == path.split('.').count()
    };
    if allowed.iter().any(|path| below(path)) {
        return Ok(());
    }
    Err(fail(format!(
        "cannot change after the start; allowed with --restart: {}",
        list(allowed.iter().copied())
    )))
}

/// Splits an override into the keys of its path and the text of its value.
pub(super) fn split(set: &str) -> Result<(Vec<String>, &str), String> {
    let mut keys = Vec::new();
    let mut rest = set;
    loop {
        let key = if rest.starts_with('"') {
            let end = rest[1..].find('"').ok_or(format!("quote without its end; {FORM}"))? + 1;
            let key = &rest[1..end];
            rest = &rest[end + 1..];
            key
        } else {
            let end = rest.find(['.', '=', '[', ']']).ok_or(format!("has no `=`; {FORM}"))?;
            let key = &rest[..end];
            rest = &rest[end..];
            key
        };
        if key.trim().is_empty() {
            return Err(format!("an empty key in the path; {FORM}"));
        }
        keys.push(key.to_string());
        while let Some(inside) = rest.strip_prefix('[') {
            let end = inside.find(']').ok_or(format!("`[` without `]`; {FORM}"))?;
            keys.push(inside[..end].trim().to_string());
            rest = &inside[end + 1..];
        }
        if keys.len() > LONGEST_PATH {
            return Err(format!("a path of more than {LONGEST_PATH} keys; {FORM}"));
        }
        if let Some(value) = rest.strip_prefix('=') {
            return Ok((keys, value));
        }
        rest = rest.strip_prefix('.').ok_or(format!("`.` or `=` must follow a key; {FORM}"))?;
    }
}

/// The value of `key` in `parent`, which is at `path`; created if an object lacks it.
fn enter<'a>(parent: &'a mut Value, path: &str, key: &str) -> Result<&'a mut Value, String> {
    if parent.is_null() {
        *parent = Value::Object(Map::new());
    }
    match parent {
        Value::Object(object) => Ok(object.entry(key).or_insert(Value::Null)),
        Value::Array(entries) => {
            let i = find_entry(entries, path, key)?;
            Ok(&mut entries[i])
        }
        other => Err(format!(
            "{path} is {}, which has no key {key}; allowed: {path}=VALUE",
            shorten(&other.to_string(), LONGEST_VALUE)
        )),
    }
}

/// Index of the entry whose name is `key`, else of the one whose number it is.
fn find_entry(entries: &[Value], path: &str, key: &str) -> Result<usize, String> {
    let names: Vec<_> =
        entries.iter().filter_map(|entry| entry.get("name").and_then(Value::as_str)).collect();
    let by_name = entries.iter().position(|e| e.get("name").and_then(Value::as_str) == Some(key));
    let by_number = key.parse().ok().filter(|&i: &usize| i < entries.len());
    by_name.or(by_number).ok_or_else(|| {
        let near = nearest(key, names.iter().copied());
        let near = near.map_or(String::new(), |near| format!(" did you mean {near}?"));
        let numbers = match entries.len() {
            0 | 1 => String::new(),
            count => format!(", 0 to {}", count - 1),
        };
        format!("{path} has no entry {key};{near} allowed: {}{numbers}", list(names))
    })
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn applied(mut scene: Value, set: &str) -> Value {
        apply(&mut scene, set).unwrap();
        scene
    }

    fn refused(mut scene: Value, set: &str) -> String {
        apply(&mut scene, set).unwrap_err().to_string()
    }

    #[test]
    fn values_are_json_or_else_strings() {
        assert_eq!(applied(json!({}), "a=[8]"), json!({"a": [8]}));
        assert_eq!(applied(json!({}), "a=0.2"), json!({"a": 0.2}));
        assert_eq!(applied(json!({}), "a=true"), json!({"a": true}));
        assert_eq!(applied(json!({}), "a={\"fmpm\": 4}"), json!({"a": {"fmpm": 4}}));
        assert_eq!(applied(json!({}), "a=flip"), json!({"a": "flip"}));
        assert_eq!(applied(json!({}), "a=\"flip\""), json!({"a": "flip"}));
        assert_eq!(applied(json!({}), "a=NaN"), json!({"a": "NaN"}));
        assert_eq!(applied(json!({}), "a=x=y"), json!({"a": "x=y"}));
    }

    #[test]
    fn an_empty_value_removes_the_key() {
        let scene = json!({"a": {"b": null, "c": 1}, "bodies": [{"name": "flyer"}, {}]});
        assert_eq!(applied(scene.clone(), "a.b=")["a"], json!({"c": 1}));
        assert_eq!(applied(scene.clone(), "bodies.flyer=")["bodies"], json!([{}]));
        assert_eq!(applied(scene.clone(), "a="), json!({"bodies": scene["bodies"]}));
        for (set, key) in [("d=", "d"), ("a.d=", "a.d"), ("a.c.d=", "a.c.d"), ("e.f=", "e.f")] {
            let text = refused(scene.clone(), set);
            assert!(text.contains(&format!("no key {key} to remove")), "{text}");
        }
    }

    #[test]
    fn missing_parents_are_made() {
        assert_eq!(applied(json!({}), "a.b.c=1"), json!({"a": {"b": {"c": 1}}}));
        assert_eq!(applied(json!({"a": null}), "a.b=1"), json!({"a": {"b": 1}}));
        assert_eq!(applied(json!({"a": {"x": 0}}), "a.b=1"), json!({"a": {"x": 0, "b": 1}}));
    }

    #[test]
    fn entries_are_found_by_name_or_number() {
        let scene = json!({"bodies": [{"name": "flyer", "v": [1]}, {"name": "0", "v": [2]}]});
        assert_eq!(applied(scene.clone(), "bodies.flyer.v=[5]")["bodies"][0]["v"], json!([5]));
        assert_eq!(applied(scene.clone(), "bodies.0.v=[5]")["bodies"][1]["v"], json!([5]));
        assert_eq!(applied(scene.clone(), "bodies.1.v=[5]")["bodies"][1]["v"], json!([5]));
        assert_eq!(applied(scene.clone(), "bodies[1].v[0]=5")["bodies"][1]["v"], json!([5]));
        let text = refused(scene.clone(), "bodies.flier.v=5");
        assert!(text.contains("did you mean flyer?") && text.contains("0 to 1"), "{text}");
        assert!(refused(scene, "bodies.7.v=5").contains("allowed: flyer, 0, 0 to 1"));
        assert!(refused(json!({"tracers": []}), "tracers.a.at=1").contains("allowed: none"));
    }

    #[test]
    fn keys_with_dots_stand_in_quotes() {
        let scene = applied(json!({}), "materials.\"Al 6061.T6\".density=1");
        assert_eq!(scene, json!({"materials": {"Al 6061.T6": {"density": 1}}}));
    }

    #[test]
    fn malformed_overrides_are_refused_with_the_form() {
        let long = format!("{}=1", ["a"; 40].join("."));
        for set in
            ["", "=", "=1", "a", "a.=1", ".a=1", "a..b=1", "a[0=1", "a[0]b=1", "\"a=1", &long]
        {
            let text = refused(json!({}), set);
            assert!(text.starts_with("--set ") && text.contains("allowed: PATH=VALUE"), "{text}");
            assert_eq!(text.lines().count(), 1);
        }
        let text = refused(json!({"method": {"transfer": "flip"}}), "method.transfer.fmpm=4");
        assert!(text.contains("method.transfer is \"flip\", which has no key fmpm"), "{text}");
    }
}
