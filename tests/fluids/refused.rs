//! Keys of equations of state that are refused, and in what words.

use flyer_mpm::input;
use serde_json::{Value, json};

use crate::tools::shipped;

/// `piston.json` with this material.
#[track_caller]
fn refused(density: f64, eos: Value, fragments: &[&str]) {
    refused_scene(density, eos, json!({}), fragments);
}

#[track_caller]
fn refused_scene(density: f64, eos: Value, body: Value, fragments: &[&str]) {
    let mut value = shipped("piston.json");
    value.as_object_mut().unwrap().remove("reference");
    value["materials"]["aluminium"] = json!({"density": density, "eos": eos});
    for (key, edit) in body.as_object().unwrap() {
        value["bodies"][0][key] = edit.clone();
    }
    let text = value.to_string();
    let error = match input::parse(text.as_bytes(), "bad.json", &[]) {
        Ok(_) => panic!("{eos} passed"),
        Err(error) => error.to_string(),
    };
    for fragment in fragments {
        assert!(error.contains(fragment), "{error}\nhas no {fragment}");
    }
}

fn with(eos: &Value, key: &str, value: Value) -> Value {
    let mut eos = eos.clone();
    match value {
        Value::Null => {
            eos.as_object_mut().unwrap().remove(key);
        }
        value => eos[key] = value,
    }
    eos
}

/// For each key that is missing or out of its range, the message has the path.
#[track_caller]
fn each_key(density: f64, eos: &Value, needed: &[&str], bad: &[(&str, Value, &str)]) {
    for key in needed {
        let path = format!("materials.aluminium.eos.{key}");
        refused(density, with(eos, key, Value::Null), &[&path, "missing key"]);
    }
    for (key, value, word) in bad {
        let path = format!("materials.aluminium.eos.{key} = ");
        refused(density, with(eos, key, value.clone()), &[&path, word]);
    }
}

#[test]
fn mie_gruneisen() {
    let eos = json!({"type": "mie_gruneisen", "c0": 5386.0, "s": 1.339, "gamma0": 2.1});
    let bad = [
        ("s2", json!("a"), "a number"),
        ("tension_cutoff", json!(-1.0), "at least 0"),
        ("gruneisen", json!("constant"), "gamma_constant"),
    ];
    each_key(2785.0, &eos, &["c0", "s", "gamma0"], &bad);
    refused(2785.0, with(&eos, "cutoff", json!(1)), &["eos.cutoff = 1", "unknown key"]);
    refused(2785.0, json!({"type": "mie"}), &["eos.type = \"mie\"", "tillotson", "p_alpha"]);
    let tension = json!({"pressure": -2e9});
    let eos = with(&eos, "tension_cutoff", json!(1e9));
    refused_scene(2785.0, eos, tension, &["pressure = -2000000000.0", "tension_cutoff"]);
}

#[test]
fn the_exact_impact_needs_a_straight_line() {
    let mut value = shipped("flyer.json");
    value["materials"]["copper"]["eos"]["s2"] = json!(1e-5);
    let error = input::parse(value.to_string().as_bytes(), "b", &[]).unwrap_err().to_string();
    assert!(error.contains("reference.flyer_impact.flyer") && error.contains("s2"), "{error}");
}

#[test]
fn fluids() {
    let eos = json!({"type": "stiffened_gas", "gamma": 4.4, "p_inf": 6e8});
    let bad = [
        ("gamma", json!(1.0), "above 1"),
        ("p_inf", json!(0.0), "above 0"),
        ("tension_cutoff", json!(6e8), "below eos.p_inf"),
    ];
    each_key(1000.0, &eos, &["gamma", "p_inf"], &bad);
    let eos = json!({"type": "tait", "bulk_modulus": 2.1e9, "exponent": 7.0});
    let bad = [
        ("bulk_modulus", json!(0.0), "above 0"),
        ("exponent", json!(-1.0), "above 0"),
        ("tension_cutoff", json!(3.1e8), "below bulk_modulus/exponent"),
    ];
    each_key(1000.0, &eos, &["bulk_modulus", "exponent"], &bad);
    refused_scene(1000.0, eos, json!({"pressure": 1e5}), &["pressure = 100000.0", "allowed: 0"]);
}

#[test]
fn tillotson() {
    let eos = json!({
        "type": "tillotson", "a": 0.5, "b": 1.63, "bulk_modulus": 75.2e9, "second_modulus": 65e9,
        "alpha": 5.0, "beta": 5.0, "e0": 5e6, "e_iv": 3e6, "e_cv": 13.9e6
    });
    let needed =
        ["a", "b", "bulk_modulus", "second_modulus", "alpha", "beta", "e0", "e_iv", "e_cv"];
    let bad = [
        ("a", json!(0.0), "above 0"),
        ("b", json!(-1.0), "at least 0"),
        ("bulk_modulus", json!(0.0), "above 0"),
        ("second_modulus", json!(-1.0), "at least 0"),
        ("alpha", json!(-1.0), "at least 0"),
        ("beta", json!(-1.0), "at least 0"),
        ("e0", json!(0.0), "above 0"),
        ("e_iv", json!(0.0), "above 0"),
        ("e_cv", json!(2e6), "above e_iv"),
        ("tension_cutoff", json!(-1.0), "at least 0"),
    ];
    each_key(2700.0, &eos, &needed, &bad);
}

#[test]
fn explosives() {
    let burn = json!({"plane": {"point": [0.0], "normal": [1.0]}, "detonation_velocity": 6930.0,
                      "width": 1e-4});
    let eos = json!({
        "type": "jwl", "a": 371.2e9, "b": 3.231e9, "r1": 4.15, "r2": 0.95, "omega": 0.3,
        "energy": 7e9, "burn": burn,
    });
    let needed = ["a", "b", "r1", "r2", "omega", "energy", "burn"];
    let bad = [
        ("a", json!(0.0), "above 0"),
        ("r1", json!(0.0), "above 0"),
        ("r2", json!(-1.0), "above 0"),
        ("omega", json!(0.0), "above 0"),
        ("energy", json!(0.0), "above 0"),
        ("burn", json!("all"), "complete"),
    ];
    each_key(1630.0, &eos, &needed, &bad);
    let edit = |key: &str, value: Value| with(&eos, "burn", with(&burn, key, value));
    let path = "materials.aluminium.eos.burn";
    let front = |key: &str, value: Value, words: &[&str]| {
        let words: Vec<&str> = words.iter().copied().chain([path]).collect();
        refused(1630.0, edit(key, value), &words);
    };
    front("detonation_velocity", Value::Null, &["detonation_velocity: missing key"]);
    front("detonation_velocity", json!(0.0), &["detonation_velocity = 0", "above 0"]);
    front("width", Value::Null, &["width: missing key"]);
    front("width", json!(0.0), &["width = 0", "above 0"]);
    front("start", json!(-1.0), &["start = -1", "at least 0"]);
    front("plane", Value::Null, &["points: missing key", "\"plane\""]);
    front("points", json!([[0.0]]), &["plane", "one of them"]);
    let points = with(&burn, "plane", Value::Null);
    let points = |value: Value| with(&eos, "burn", with(&points, "points", value));
    refused(1630.0, points(json!([])), &["points", "not empty"]);
    refused(1630.0, points(json!([[0.0, 1.0]])), &["points[0]", "1 number"]);
    front("plane", json!({"point": [0.0], "normal": [0.0]}), &["normal", "no direction"]);
    front("plane", json!({"point": [0.0, 1.0], "normal": [1.0]}), &["plane.point", "1 number"]);
    let pressed = json!({"pressure": 1e5});
    refused_scene(1630.0, eos.clone(), pressed, &["pressure = 100000.0", "its own energy"]);
    let mut value = shipped("piston.json");
    value["materials"]["aluminium"] = json!({"density": 1630.0, "eos": eos});
    let error = input::parse(value.to_string().as_bytes(), "b", &[]).unwrap_err().to_string();
    assert!(error.contains("reference.wall_impact.body") && error.contains("burns"), "{error}");
    // a front that these products do not sustain is warned of
    value.as_object_mut().unwrap().remove("reference");
    value["materials"]["aluminium"]["eos"]["burn"]["detonation_velocity"] = json!(5000.0);
    let scene = input::parse(value.to_string().as_bytes(), "b", &[]).unwrap();
    assert!(scene.warnings.iter().any(|w| w.contains("Chapman-Jouguet")), "{:?}", scene.warnings);
}

#[test]
fn pores() {
    let solid = json!({"type": "mie_gruneisen", "c0": 3940.0, "s": 1.489, "gamma0": 1.96});
    let eos = json!({
        "type": "p_alpha", "solid": solid, "solid_density": 8930.0, "elastic_pressure": 1e8,
        "full_compaction_pressure": 1.6e9,
    });
    let needed = ["solid", "solid_density", "elastic_pressure", "full_compaction_pressure"];
    let bad = [
        ("solid_density", json!(7144.0), "above the material's density"),
        ("elastic_pressure", json!(-1.0), "at least 0"),
        ("full_compaction_pressure", json!(1e8), "above elastic_pressure"),
    ];
    each_key(7144.0, &eos, &needed, &bad);
    let nested = |solid: Value, words: &[&str]| refused(7144.0, with(&eos, "solid", solid), words);
    nested(json!({"type": "ideal_gas", "gamma": 1.4}), &["solid.type = \"ideal_gas\"", "no pores"]);
    nested(eos.clone(), &["solid.type = \"p_alpha\"", "allowed"]);
    nested(with(&solid, "c0", json!(0.0)), &["eos.solid.c0 = 0", "above 0"]);
    let pressed = json!({"pressure": 2e8});
    refused_scene(7144.0, eos.clone(), pressed, &["pressure = 200000000.0", "uncrushed"]);
}

#[test]
fn tables() {
    let table = json!({
        "density": [1000.0, 1500.0, 2000.0],
        "specific_internal_energy": [-1e5, 1e6],
        "pressure": [[-5.2e9, -3e9], [-2e8, 2e9], [4.8e9, 7e9]],
    });
    let eos =
        |key: &str, value: Value| json!({"type": "tabular", "table": with(&table, key, value)});
    let path = "materials.aluminium.eos.table";
    refused(1500.0, json!({"type": "tabular"}), &[path, "missing key"]);
    refused(1500.0, eos("pressure", json!([[-2e8, 2e9]])), &[path, "1 rows of pressure"]);
    refused(1500.0, eos("density", json!([1000.0, 1000.0, 2e3])), &[path, "ascending"]);
    let hole = json!([[-5.2e9, -3e9], [2e9], [4.8e9, 7e9]]);
    refused(1500.0, eos("pressure", hole), &[path, "hole", "density 1500"]);
    let falling = json!([[-5.2e9, -3e9], [-2e8, 2e9], [-4.8e9, -2e9]]);
    refused(1500.0, eos("pressure", falling), &[path, "c^2", "at density"]);
    refused(1500.0, eos("pressure", Value::Null), &[path, "pressure", "missing key"]);
    // the path of a file is read with the scene alone
    let named = json!({"type": "tabular", "table": "t.csv"});
    refused(1500.0, named, &[path, "has not been read"]);
}
