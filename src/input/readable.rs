//! The part of a faulty scene that can be read, so that its other keys are checked in the same reply.

use serde_json::{Value, json};

use super::overrides::split;
use super::validate::conform;

/// Maximum number of passes: a missing key takes away its object, which another object may need.
const MOST_PASSES: usize = 16;

/// Number of faults above which nothing else is checked.
const MOST_FAULTS: usize = 100;

/// Takes out of `scene` what does not follow its schema, until the rest does. Arbitrary sections stand
/// in for those that every scene has. Returns the paths of what was taken out, which no check may
/// read; `None` if nothing is left to check.
pub(super) fn keep_readable(scene: &mut Value) -> Option<Vec<String>> {
    let mut unread = Vec::new();
    for _ in 0..MOST_PASSES {
        let faults = conform(scene);
        if faults.is_empty() {
            return Some(unread);
        }
        if faults.len() > MOST_FAULTS {
            return None;
        }
        for fault in &faults {
            let path = take_out(scene, fault.path())?;
            // an unknown key leaves nothing unknown but the one that it stands for
            unread.extend((fault.invalidated() == fault.path()).then_some(path));
        }
        // until here, bodies are counted as in the file
        if let Some(bodies) = scene["bodies"].as_array_mut() {
            bodies.retain(|body| !body.is_null());
        }
    }
    None
}

/// Takes out the value at `path`, or, if a key is missing there, the object around it. Returns the
/// path of what was taken out.
fn take_out(scene: &mut Value, path: &str) -> Option<String> {
    let (keys, _) = split(&format!("{path}=")).ok()?;
    let mut keys = &keys[..];
    let mut path = path;
    if find(scene, keys).is_none() {
        if keys == ["domain", "cell_size"] && stand_in_cell_size(&mut scene["domain"]).is_some() {
            return Some(path.to_string());
        }
        // places of bodies do not depend on it
        if let ["bodies", _, "material"] = &keys.iter().map(String::as_str).collect::<Vec<_>>()[..]
        {
            find(scene, &keys[..2])?["material"] = json!("");
            return Some(path.to_string());
        }
        if keys.len() > 1 {
            (keys, path) = (&keys[..keys.len() - 1], parent(path));
        }
    }
    loop {
        let (last, above) = keys.split_last()?;
        match find(scene, above)? {
            Value::Object(object) => {
                object.remove(last);
                if let Some(section) = stand_in(last).filter(|_| above.is_empty()) {
                    object.insert(last.clone(), section);
                }
                return Some(path.to_string());
            }
            Value::Array(_) if above == ["bodies"] => {
                *find(scene, keys)? = Value::Null;
                return Some(path.to_string());
            }
            _ => (keys, path) = (above, parent(path)),
        }
    }
}

/// The value below `keys`, of which each is a key of an object, or name or number of an entry.
fn find<'a>(value: &'a mut Value, keys: &[String]) -> Option<&'a mut Value> {
    let Some((first, rest)) = keys.split_first() else { return Some(value) };
    let inner = match value {
        Value::Object(object) => object.get_mut(first),
        Value::Array(entries) => {
            let named = entries.iter().position(|entry| entry["name"] == *first);
            entries.get_mut(named.or(first.parse().ok())?)
        }
        _ => None,
    };
    find(inner?, rest)
}

/// The path without its last key.
fn parent(path: &str) -> &str {
    let last = match path.as_bytes().last() {
        Some(b']') => path.rfind('['),
        Some(b'"') => path[..path.len() - 1].rfind('"').map(|quote| quote.saturating_sub(1)),
        _ => path.rfind('.'),
    };
    &path[..last.unwrap_or(0)]
}

/// Arbitrary cells of a domain with corners, so that the places of bodies can be checked.
fn stand_in_cell_size(domain: &mut Value) -> Option<()> {
    let corner = |key: &str| serde_json::from_value::<Vec<f64>>(domain[key].clone()).ok();
    let (lower, upper) = (corner("lower")?, corner("upper")?);
    let sizes: Vec<f64> = lower.iter().zip(&upper).map(|(l, u)| (u - l) / 100.0).collect();
    let valid = lower.len() == upper.len() && sizes.iter().all(|size| *size > 0.0);
    domain["cell_size"] = valid.then_some(sizes)?.into();
    Some(())
}

/// A valid section in place of one that every scene has.
fn stand_in(section: &str) -> Option<Value> {
    Some(match section {
        "title" => json!("title"),
        "domain" => json!({"lower": [0.0], "upper": [1.0], "cell_size": 1.0}),
        "time" => json!({"end": 1.0}),
        "method" => json!({"shape": "cpdi", "transfer": "flip"}),
        "materials" => json!({}),
        "bodies" => json!([{"name": "body", "material": ""}]),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(mut scene: Value) -> (Value, Vec<String>) {
        let unread = keep_readable(&mut scene).unwrap();
        assert!(conform(&scene).is_empty());
        (scene, unread)
    }

    fn valid() -> Value {
        let body = |name: &str| json!({"name": name, "material": "m", "box": {"lower": [0.0], "upper": [0.5]}});
        json!({"title": "t", "domain": {"lower": [0.0], "upper": [1.0], "cell_size": 0.1},
            "time": {"end": 1.0}, "method": {"shape": "cpdi", "transfer": "flip"},
            "materials": {"m": {"density": 1.0, "eos": {"type": "ideal_gas", "gamma": 1.4}}},
            "bodies": [body("a"), body("b")]})
    }

    #[test]
    fn the_smallest_part_around_a_fault_is_left_out() {
        assert_eq!(kept(valid()), (valid(), vec![]));
        let mut scene = valid();
        scene["bodies"][0]["colour"] = json!("red");
        scene["time"]["courant"] = json!("x");
        assert_eq!(kept(scene), (valid(), vec!["time.courant".into()]));
        let mut scene = valid();
        scene["bodies"][0]["box"].as_object_mut().unwrap().remove("upper");
        let (without, unread) = kept(scene);
        assert_eq!(unread, ["bodies.a.box"]);
        assert_eq!(without["bodies"][1], valid()["bodies"][1]);
        let mut scene = valid();
        scene["bodies"][0].as_object_mut().unwrap().remove("name");
        let (without, unread) = kept(scene);
        assert_eq!(unread, ["bodies[0]"]);
        assert_eq!(without["bodies"], json!([valid()["bodies"][1]]));
        // the place of a body is known without its material
        let mut scene = valid();
        scene["bodies"][0].as_object_mut().unwrap().remove("material");
        let (without, unread) = kept(scene);
        assert_eq!(unread, ["bodies.a.material"]);
        assert_eq!(without["bodies"][0]["box"], valid()["bodies"][0]["box"]);
    }

    #[test]
    fn sections_of_every_scene_are_replaced() {
        let (_, unread) = kept(json!({}));
        assert_eq!(unread, ["title", "domain", "time", "method", "materials", "bodies"]);
        let mut scene = valid();
        scene["domain"]["cell_size"] = json!("x");
        let (scene, unread) = kept(scene);
        assert!(unread.iter().all(|path| path == "domain.cell_size"), "{unread:?}");
        assert_eq!(scene["domain"]["cell_size"], json!([0.01]));
        let mut scene = valid();
        scene["materials"]["m"]["eos"].as_object_mut().unwrap().remove("type");
        let (scene, unread) = kept(scene);
        assert_eq!(
            (&scene["materials"], &unread[..]),
            (&json!({}), &["materials.m.eos".to_string(), "materials.m".into()][..])
        );
        assert!(keep_readable(&mut json!([])).is_none());
    }

    #[test]
    fn parents_of_paths() {
        for (path, above) in [
            ("a.b", "a"),
            ("a[3]", "a"),
            ("a.\"b.c\"", "a"),
            ("a", ""),
            ("\"a.b\"", ""),
            ("a[3].b", "a[3]"),
        ] {
            assert_eq!(parent(path), above);
        }
    }
}
