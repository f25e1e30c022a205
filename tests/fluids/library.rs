//! Materials of the library and from files.

use std::fs;

use flyer_mpm::input;
use flyer_mpm::input::LIBRARY;
use flyer_mpm::scene::CheckedScene;
use serde_json::{Value, json};

use crate::tools::{checked, run, shipped};

#[test]
fn a_name_stands_for_its_material() {
    let mut value = shipped("piston.json");
    value["materials"]["aluminium"] = json!({"library": "aluminium_1100"});
    let scene = checked(&value);
    let material = scene.material_of(0);
    assert!(material.density == 2707.0 && material.source.contains("UCRL-MA-106439"));
    // the scene that is written out is whole
    let text = serde_json::to_string(&scene.scene).unwrap();
    assert!(!text.contains("library") && text.contains("2707"));
    // overrides from the command line come before
    let sets = ["materials.aluminium.library=copper", "materials.aluminium.eos.s=1.5"];
    let sets: Vec<String> = sets.map(String::from).to_vec();
    let scene = input::parse(value.to_string().as_bytes(), "t", &sets).unwrap();
    let material = scene.material_of(0);
    let straight = material.eos.straight(material.density).unwrap();
    assert_eq!((straight.rho0, straight.c0, straight.s), (8930.0, 3940.0, 1.5));
}

#[test]
fn each_of_the_library_starts_a_run() {
    for (name, text) in LIBRARY {
        let mut value = shipped("piston.json");
        value["domain"]["cell_size"] = json!(2e-4);
        value["time"]["end"] = json!(2e-7);
        value["output"] = json!({});
        value["materials"]["aluminium"] = json!({"library": name});
        let material: Value = serde_json::from_str(text).unwrap();
        if material["eos"]["type"] == "jwl" {
            value["materials"]["aluminium"]["eos"] = json!({"burn": "complete"});
        }
        value["bodies"][0]["velocity"] = json!([-50.0]);
        // the exact solution knows no strength
        value.as_object_mut().unwrap().remove("reference");
        let outcome = run(&value);
        assert!(outcome.column("pressure").iter().any(|&p| p > 1e6), "{name}");
    }
}

#[test]
fn files_stand_beside_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("metals")).unwrap();
    let metal = json!({"library": "copper", "density": 9000.0});
    fs::write(at("metals/mine.json"), metal.to_string()).unwrap();
    let mut value = shipped("piston.json");
    value["materials"]["aluminium"] = json!({"file": "metals/mine.json", "eos": {"c0": 4000.0}});
    let read = |value: &Value| -> Result<CheckedScene, String> {
        fs::write(at("scene.json"), value.to_string()).unwrap();
        let bytes = input::read(&at("scene.json")).map_err(|e| e.to_string())?;
        input::parse(&bytes, "scene.json", &[]).map_err(|e| e.to_string())
    };
    let scene = read(&value).unwrap();
    let material = scene.material_of(0);
    let straight = material.eos.straight(material.density).unwrap();
    assert_eq!((straight.rho0, straight.c0, straight.s), (9000.0, 4000.0, 1.489));
    let refused = |file: &str, text: &str, words: &[&str]| {
        fs::write(at(file), text).unwrap();
        let mut value = value.clone();
        value["materials"]["aluminium"] = json!({"file": file});
        let error = read(&value).unwrap_err();
        words.iter().for_each(|w| assert!(error.contains(w), "{error} has no {w}"));
    };
    refused("a.json", "{", &["a.json", "no JSON"]);
    refused("b.json", "[1]", &["b.json", "one JSON object"]);
    refused("c.json", "{\"file\": \"a.json\"}", &["c.json", "names a file"]);
    value["materials"]["aluminium"] = json!({"file": "metals"});
    assert!(read(&value).unwrap_err().contains("metals: is a directory"));
    value["materials"]["aluminium"] = json!({"file": "none.json"});
    assert!(read(&value).unwrap_err().contains("none.json: cannot be read"));
}

#[test]
fn tables_stand_beside_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let mut text = "density,specific_internal_energy,pressure\n".to_string();
    for rho in [1200.0, 1500.0, 2000.0, 4000.0] {
        for e in [-1e5, 0.0, 1e6, 2e6] {
            text += &format!("{rho},{e},{}\n", 1e7 * (rho - 1500.0) + 2e3 * e);
        }
    }
    let mut value = shipped("piston.json");
    value.as_object_mut().unwrap().remove("reference");
    value["bodies"][0]["velocity"] = json!([-100.0]);
    let eos = json!({"type": "tabular", "table": "table.csv"});
    let read = |material: Value, table: &str| -> Result<CheckedScene, String> {
        let mut value = value.clone();
        value["materials"]["aluminium"] = material;
        fs::write(at("table.csv"), table).unwrap();
        fs::write(at("scene.json"), value.to_string()).unwrap();
        let bytes = input::read(&at("scene.json")).map_err(|e| e.to_string())?;
        input::parse(&bytes, "scene.json", &[]).map_err(|e| e.to_string())
    };
    read(json!({"density": 1500.0, "eos": eos}), &text).unwrap();
    let pores = json!({
        "type": "p_alpha", "solid": eos, "solid_density": 1500.0, "elastic_pressure": 1e7,
        "full_compaction_pressure": 1e8,
    });
    read(json!({"density": 1400.0, "eos": pores}), &text).unwrap();
    // the same from HDF5, to the bit
    let first = read(json!({"density": 1500.0, "eos": eos}), &text).unwrap();
    let densities = [1200.0, 1500.0, 2000.0, 4000.0];
    let energies = [-1e5, 0.0, 1e6, 2e6];
    let write = |last: f64, rows: usize| {
        let file = hdf5::File::create(at("table.h5")).unwrap();
        let put = |name: &str, values: &[f64]| {
            file.new_dataset_builder().with_data(values).create(name).map(drop).unwrap();
        };
        put("density", &densities[..3]);
        put("specific_internal_energy", &energies);
        let pressure: Vec<f64> = [1200.0, 1500.0, last][..rows]
            .iter()
            .flat_map(|rho| energies.map(|e| 1e7 * (rho - 1500.0) + 2e3 * e))
            .collect();
        let set = file.new_dataset::<f64>().shape([rows, 4]).create("pressure").unwrap();
        set.write_raw(&pressure).unwrap();
    };
    let named = json!({"type": "tabular", "table": "table.h5"});
    let taken = |last: f64, rows: usize| {
        write(last, rows);
        read(json!({"density": 1500.0, "eos": named}), "")
    };
    let tables = [first, taken(2000.0, 3).unwrap()].map(|scene| {
        let eos = serde_json::to_value(&scene.material_of(0).eos).unwrap();
        eos["table"]["pressure"].as_array().unwrap()[..3].to_vec()
    });
    assert_eq!(tables[0], tables[1]);
    let short = taken(2000.0, 2).unwrap_err();
    assert!(short.contains("2 rows of pressure; allowed: 3"), "{short}");
    let odd = taken(f64::NAN, 3).unwrap_err();
    assert!(odd.contains("table.h5") && odd.contains("finite"), "{odd}");
    fs::write(at("table.h5"), "no HDF5").unwrap();
    let other = read(json!({"density": 1500.0, "eos": named}), "").unwrap_err();
    assert!(other.contains("table.h5") && other.contains("data sets density"), "{other}");
    let holed = text.replacen("1500,0,0\n", "", 1);
    assert_ne!(holed, text);
    let error = read(json!({"density": 1500.0, "eos": eos}), &holed).unwrap_err();
    let words = ["table.csv", "hole", "density 1500, energy 0"];
    words.iter().for_each(|w| assert!(error.contains(w), "{error}"));
    let outside = read(json!({"density": 900.0, "eos": eos}), &text).unwrap_err();
    let words = ["materials.aluminium.eos.table", "900", "outside"];
    words.iter().for_each(|w| assert!(outside.contains(w), "{outside}"));
}
