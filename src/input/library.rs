//! Materials by name or from a separate file, with keys beside them that override.
//!
//! `{"library": "copper"}` is replaced by a material built into the program, with its sources;
//! `{"file": "mine.json"}` by the material in a file next to the scene. Objects are merged key by
//! key; an object with a different `type` is replaced as a whole. One rank reads the files
//! ([`inline_files`]). All ranks resolve the names, after the overrides of the command line
//! ([`resolve`]). Nothing is ever written.

use std::path::Path;

use serde::Deserialize;
use serde_json::Value;

use super::comments::without_comments;
use super::errors::{SceneError, SceneFault, one_line, suggest};
use super::failure_laws::resolve_failure;
use super::paths::join;
use super::table::{is_hdf5, read_hdf5};
use super::units::is_quantity;
use crate::input::input_file::{self, InputFault, LARGEST_JSON, LARGEST_NUMBERS};
use crate::material::Table;
use crate::scene::{Course, Side};

/// The materials of the library; each file contains one material in the format of a scene.
pub const LIBRARY: [(&str, &str); 29] = [
    ("aluminium_1100", include_str!("../../inputs/materials/aluminium_1100.json")),
    ("aluminium_2024", include_str!("../../inputs/materials/aluminium_2024.json")),
    (
        "aluminium_2024_johnson_cook",
        include_str!("../../inputs/materials/aluminium_2024_johnson_cook.json"),
    ),
    ("aluminium_6061", include_str!("../../inputs/materials/aluminium_6061.json")),
    (
        "aluminium_6061_steinberg_guinan",
        include_str!("../../inputs/materials/aluminium_6061_steinberg_guinan.json"),
    ),
    ("aluminium_tillotson", include_str!("../../inputs/materials/aluminium_tillotson.json")),
    ("composition_b", include_str!("../../inputs/materials/composition_b.json")),
    ("copper", include_str!("../../inputs/materials/copper.json")),
    ("copper_johnson_cook", include_str!("../../inputs/materials/copper_johnson_cook.json")),
    (
        "copper_steinberg_guinan",
        include_str!("../../inputs/materials/copper_steinberg_guinan.json"),
    ),
    ("gold", include_str!("../../inputs/materials/gold.json")),
    ("iron", include_str!("../../inputs/materials/iron.json")),
    ("iron_tillotson", include_str!("../../inputs/materials/iron_tillotson.json")),
    ("lead", include_str!("../../inputs/materials/lead.json")),
    ("lithium_fluoride", include_str!("../../inputs/materials/lithium_fluoride.json")),
    ("lx_14", include_str!("../../inputs/materials/lx_14.json")),
    ("nickel", include_str!("../../inputs/materials/nickel.json")),
    ("pbx_9404", include_str!("../../inputs/materials/pbx_9404.json")),
    ("pmma", include_str!("../../inputs/materials/pmma.json")),
    ("sapphire", include_str!("../../inputs/materials/sapphire.json")),
    ("steel_304", include_str!("../../inputs/materials/steel_304.json")),
    ("steel_4340", include_str!("../../inputs/materials/steel_4340.json")),
    (
        "steel_4340_johnson_cook",
        include_str!("../../inputs/materials/steel_4340_johnson_cook.json"),
    ),
    ("tantalum", include_str!("../../inputs/materials/tantalum.json")),
    (
        "tantalum_steinberg_guinan",
        include_str!("../../inputs/materials/tantalum_steinberg_guinan.json"),
    ),
    ("titanium", include_str!("../../inputs/materials/titanium.json")),
    ("tnt", include_str!("../../inputs/materials/tnt.json")),
    ("tungsten", include_str!("../../inputs/materials/tungsten.json")),
    ("water", include_str!("../../inputs/materials/water.json")),
];

/// Merges `edit` into `base`: objects key by key, unless their `type` differs; other values as a
/// whole.
fn merge(base: &mut Value, edit: Value) {
    match (base, edit) {
        (Value::Object(base), Value::Object(edit))
            if edit.get("type").is_none_or(|t| base.get("type") == Some(t)) =>
        {
            for (key, value) in edit {
                merge(base.entry(key).or_insert(Value::Null), value);
            }
        }
        (base, edit) => *base = edit,
    }
}

/// Replaces names of the library by their materials; returns the faults.
pub(super) fn resolve(scene: &mut Value) -> Vec<SceneFault> {
    let mut faults = Vec::new();
    let materials = scene.get_mut("materials").and_then(Value::as_object_mut);
    for (key, material) in materials.into_iter().flatten() {
        let path = join("materials", key);
        // without its base, the material has no other keys to judge
        faults.extend(resolve_one(material, &path).err().map(|fault| fault.invalidates(path)));
    }
    faults
}

fn resolve_one(material: &mut Value, path: &str) -> Result<(), SceneFault> {
    if let Some(object) = material.as_object_mut() {
        if let Some(file) = object.get("file") {
            let reason = "is read with the scene's own file alone; allowed: to name it there, or \
                          \"library\"";
            return Err(SceneFault::new(format!("{path}.file"), file, reason));
        }
        let Some(name) = object.remove("library") else { return Ok(()) };
        let known = LIBRARY.iter().map(|(name, _)| *name);
        let found = LIBRARY.iter().find(|(known, _)| name == *known);
        let Some((known, text)) = found else {
            let reason = format!("no such material{}", suggest(name.as_str().unwrap_or(""), known));
            return Err(SceneFault::new(format!("{path}.library"), name, reason));
        };
        let mut made: Value = serde_json::from_str(text).expect("the library is JSON");
        merge(&mut made, material.take());
        *material = made;
        if let Some(object) = material.as_object_mut() {
            resolve_failure(object, known, path)?;
        }
    }
    Ok(())
}

/// Replaces files of materials and tables by their contents; `folder` is that of the scene. Returns
/// whether there were any.
pub(super) fn inline_files(scene: &mut Value, folder: &Path) -> Result<bool, SceneError> {
    let mut found = false;
    let materials = scene.get_mut("materials").and_then(Value::as_object_mut);
    for material in materials.into_iter().flat_map(|m| m.values_mut()) {
        // the path of a table next to the key `file` is relative to the scene
        found |= inline_tables(material, folder)?;
        let Some(object) = material.as_object_mut() else { continue };
        let Some(Value::String(name)) = object.get("file") else { continue };
        let file = folder.join(name);
        let fail = |reason: String| fault(&file, reason);
        let text = read_text(&file, LARGEST_JSON)?;
        let mut made: Value = serde_json::from_str(&without_comments(&text))
            .map_err(|error| fail(format!("is no JSON: {error}; allowed: one material")))?;
        if !made.is_object() {
            return Err(fail("allowed: a material, one JSON object".into()));
        }
        if made.get("file").is_some() {
            return Err(fail("names a file; allowed: a material, or \"library\"".into()));
        }
        inline_tables(&mut made, file.parent().unwrap_or(Path::new("")))?;
        object.remove("file");
        merge(&mut made, material.take());
        *material = made;
        found = true;
    }
    Ok(found)
}

/// Replaces the file name of a material's table by the table.
fn inline_tables(material: &mut Value, folder: &Path) -> Result<bool, SceneError> {
    let mut found = false;
    for place in ["/eos/table", "/eos/solid/table"] {
        let Some(Value::String(name)) = material.pointer(place) else { continue };
        let file = folder.join(name);
        let table = match is_hdf5(&file) {
            // so that a missing or irregular file gives the same message as for text files
            true => input_file::check(&file, LARGEST_NUMBERS)
                .map_err(|reason| cannot(&file, &reason))
                .and_then(|()| read_hdf5(&file).map_err(|reason| fault(&file, reason))),
            false => Table::read(&read_text(&file, LARGEST_NUMBERS)?)
                .map_err(|reason| fault(&file, reason)),
        }?;
        *material.pointer_mut(place).expect("it is there") = serde_json::json!({
            "density": table.density,
            "specific_internal_energy": table.energy,
            "pressure": table.pressure,
        });
        found = true;
    }
    Ok(found)
}

/// Replaces files of time functions of sides by their contents; `folder` is that of the scene.
/// Returns whether there were any.
pub(super) fn inline_courses(scene: &mut Value, folder: &Path) -> Result<bool, SceneError> {
    let mut found = false;
    let sides = scene.get_mut("boundary").and_then(Value::as_object_mut);
    for side in sides.into_iter().flat_map(|sides| sides.values_mut()) {
        // the check of the scene rejects an invalid side
        let Ok(kind) = Side::deserialize(&*side) else { continue };
        let (Some(Course::File(name)), quantity) = (kind.course(), kind.name()) else { continue };
        // such as "1 km/s"
        if is_quantity(&name) {
            continue;
        }
        let file = folder.join(name);
        let points = Course::read(&read_text(&file, LARGEST_NUMBERS)?, quantity);
        side[quantity] = serde_json::json!(points.map_err(|reason| fault(&file, reason))?);
        found = true;
    }
    Ok(found)
}

fn cannot(file: &Path, reason: &InputFault) -> SceneError {
    fault(file, reason.to_string())
}

fn read_text(file: &Path, most: u64) -> Result<String, SceneError> {
    input_file::read_text(file, most).map_err(|reason| cannot(file, &reason))
}

fn fault(file: &Path, reason: String) -> SceneError {
    SceneError::File { file: one_line(&file.display().to_string()), reason: one_line(&reason) }
}

#[cfg(test)]
mod tests {
    use super::super::failure_laws::failure_laws;
    use super::*;
    use crate::exact::hugoniot::{HugoniotState, piston};
    use crate::material::constitutive::{equation, strength_model};
    use crate::material::strength::MaterialState;
    use crate::scene::Material;
    use serde_json::json;

    fn resolved(material: Value) -> Result<Value, SceneFault> {
        let mut scene = json!({"materials": {"m": material}});
        match resolve(&mut scene).pop() {
            Some(fault) => Err(fault),
            None => Ok(scene["materials"]["m"].take()),
        }
    }

    #[test]
    fn keys_beside_a_name_override() {
        let made = resolved(json!({"library": "copper", "eos": {"s": 1.5}})).unwrap();
        assert_eq!((&made["eos"]["s"], &made["eos"]["c0"]), (&json!(1.5), &json!(3940.0)));
        assert!(made.get("library").is_none());
        let gas = json!({"type": "ideal_gas", "gamma": 1.4});
        let made = resolved(json!({"library": "copper", "eos": gas})).unwrap();
        assert_eq!(made["eos"], gas);
    }

    #[test]
    fn failure_laws_are_those_named() {
        let law = |failure: Value| {
            let name = "copper_johnson_cook";
            resolved(json!({"library": name, "failure": failure})).map(|made| {
                assert!(
                    made["source"].as_str().unwrap().contains("Failure: Johnson & Cook (1985)")
                );
                made["failure"].clone()
            })
        };
        let constants = json!({"type": "johnson_cook", "d1": 0.54, "d2": 4.89, "d3": -3.03,
            "d4": 0.014, "d5": 1.12, "reference_rate": 1.0});
        assert_eq!(law(json!("johnson_cook")).unwrap(), constants);
        let over = law(json!({"library": "johnson_cook", "d1": 0.6})).unwrap();
        assert_eq!((&over["d1"], &over["d2"]), (&json!(0.6), &json!(4.89)));
        let message = law(json!("jonson_cook")).unwrap_err().within("s").to_string();
        assert!(
            message.contains("materials.m.failure = \"jonson_cook\"")
                && message.contains("did you mean johnson_cook?"),
            "{message}"
        );
        // none by itself, and none of another material
        assert!(resolved(json!({"library": "tantalum"})).unwrap()["failure"].is_null());
        let spall = resolved(json!({"library": "tantalum", "failure": "spall"})).unwrap();
        assert_eq!(spall["failure"], json!({"type": "tension_limit", "stress": 5.1e9}));
        let message = resolved(json!({"library": "gold", "failure": "spall"})).unwrap_err();
        assert!(message.within("s").to_string().contains("allowed: none, or a law"));
        let own = json!({"type": "tension_limit", "stress": 1e9});
        assert_eq!(resolved(json!({"library": "gold", "failure": own})).unwrap()["failure"], own);
    }

    /// Each law is one of the program and names its source.
    #[test]
    fn failure_laws_of_the_library_have_sources() {
        let mut count = 0;
        for (_, mut law) in LIBRARY.iter().flat_map(|(name, _)| failure_laws(name)) {
            let source = law.as_object_mut().unwrap().remove("source").unwrap();
            assert!(source.as_str().unwrap().len() > 60, "{source}");
            serde_json::from_value::<crate::scene::Failure>(law).unwrap();
            count += 1;
        }
        assert_eq!(count, 5);
    }

    #[test]
    fn unknown_names_are_reported_with_the_known() {
        let message = resolved(json!({"library": "coper"})).unwrap_err().within("s").to_string();
        assert!(
            message.contains("did you mean copper?") && message.contains("aluminium_1100, "),
            "{message}"
        );
        let message = resolved(json!({"file": "x"})).unwrap_err().within("s").to_string();
        assert!(message.contains("materials.m.file"), "{message}");
    }

    #[test]
    fn strength_of_the_library_is_that_of_its_source() {
        let yields = |name: &str, strain: f64, pressure: f64| {
            let text = LIBRARY.iter().find(|(known, _)| *known == name).unwrap().1;
            let material: Material = serde_json::from_str(text).unwrap();
            let at = MaterialState { compression: 1.0, pressure, temperature: 298.0 };
            strength_model(&material).unwrap().yield_stress(strain, &at)
        };
        // a + b ep^n at the reference rate; Y0 (1 + beta ep)^n up to Ymax, times 1 + A p
        for (name, strain, pressure, want) in [
            ("copper_johnson_cook", 1.0, 0.0, 382e6),
            ("steel_4340_johnson_cook", 0.0, 0.0, 792e6),
            ("aluminium_2024_johnson_cook", 1.0, 0.0, 691e6),
            ("copper_steinberg_guinan", 0.0, 0.0, 0.12e9),
            ("copper_steinberg_guinan", 10.0, 10e9, 0.64e9 * 1.283),
            ("aluminium_6061_steinberg_guinan", 0.0, 10e9, 0.29e9 * 1.652),
            ("tantalum_steinberg_guinan", 0.0, 100e9, 0.77e9 * 2.45),
        ] {
            let got = yields(name, strain, pressure);
            assert!((got / want - 1.0).abs() < 1e-9, "{name}: {got:e}, {want:e}");
        }
    }

    #[test]
    fn each_material_has_a_source_and_a_hugoniot() {
        for (name, text) in LIBRARY {
            let mut value: Value = serde_json::from_str(text).unwrap();
            let explosive = value["eos"]["type"] == "jwl";
            if explosive {
                value["eos"]["burn"] = json!("complete");
            }
            let material: Material = serde_json::from_value(value).unwrap();
            assert!(material.source.len() > 30, "{name}");
            if let Some(products) = material.eos.products(material.density) {
                // the detonation velocity that the handbook gives with the constants
                let (_, said) = material.source.split_once("detonation velocity of ").unwrap();
                let said: f64 = said.split(' ').next().unwrap().parse().unwrap();
                let speed = products.detonation().speed;
                assert!((speed / said - 1.0).abs() < 0.01, "{name}: {speed}");
            } else {
                let eos = equation(&material).unwrap().unwrap();
                let rest = HugoniotState::at_rest(&*eos, 0.0, 0.0);
                let front = piston(&*eos, &rest, 100.0).unwrap()[0];
                let (c, us) = (rest.sound_speed, front.speed);
                assert!(us > c && us < c + 500.0, "{name}: {c} {us}");
            }
        }
    }
}
