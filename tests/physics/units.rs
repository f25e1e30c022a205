//! Units scaled by powers of two: the same bits.

use serde_json::{Value, json};

use crate::tools::{column, run, shipped, short, with};

/// What a unit becomes in units that are 2^length metres, 2^time seconds, 2^mass kilograms.
#[derive(Clone, Copy, Debug)]
struct Units {
    length: i32,
    time: i32,
    mass: i32,
}

impl Units {
    /// The factor of a number in m^l s^t kg^m.
    fn factor(&self, l: i32, t: i32, m: i32) -> f64 {
        2f64.powi(-(self.length * l + self.time * t + self.mass * m))
    }
}

fn scale(value: &mut Value, factor: f64) {
    match value {
        Value::Array(values) => values.iter_mut().for_each(|v| scale(v, factor)),
        _ => *value = json!(value.as_f64().unwrap() * factor),
    }
}

/// The scene in other units.
fn in_units(scene: &Value, units: Units) -> Value {
    let mut value = scene.clone();
    let (length, time) = (units.factor(1, 0, 0), units.factor(0, 1, 0));
    let (speed, density) = (units.factor(1, -1, 0), units.factor(-3, 0, 1));
    for key in ["lower", "upper", "cell_size"] {
        scale(&mut value["domain"][key], length);
    }
    scale(&mut value["time"]["end"], time);
    scale(&mut value["output"]["profiles"]["times"], time);
    for body in value["bodies"].as_array_mut().unwrap() {
        for key in ["lower", "upper"] {
            scale(&mut body["box"][key], length);
        }
        scale(&mut body["velocity"], speed);
        if body.get("pressure").is_some() {
            scale(&mut body["pressure"], units.factor(-1, -2, 1));
        }
    }
    for material in value["materials"].as_object_mut().unwrap().values_mut() {
        scale(&mut material["density"], density);
        if material["eos"].get("c0").is_some() {
            scale(&mut material["eos"]["c0"], speed);
        }
    }
    value
}

#[track_caller]
fn same_bits(scene: &Value) {
    let plain = run(scene);
    for units in [
        Units { length: 7, time: 0, mass: 0 },
        Units { length: 0, time: -9, mass: 0 },
        Units { length: 0, time: 0, mass: 13 },
        Units { length: -5, time: 11, mass: -3 },
    ] {
        let other = run(&in_units(scene, units));
        for (name, factor) in [
            ("x", units.factor(1, 0, 0)),
            ("velocity", units.factor(1, -1, 0)),
            ("pressure", units.factor(-1, -2, 1)),
            ("density", units.factor(-3, 0, 1)),
            ("specific_internal_energy", units.factor(2, -2, 0)),
            ("artificial_viscosity", units.factor(-1, -2, 1)),
        ] {
            let pairs = column(plain.last(), name).iter().zip(column(other.last(), name));
            for (row, (a, b)) in pairs.enumerate() {
                let a = a * factor;
                assert!(
                    a.to_bits() == b.to_bits(),
                    "{} in {units:?}: {name} of row {row} is {b:e}, not {a:e}",
                    scene["method"]
                );
            }
        }
    }
}

#[test]
fn the_default_and_the_documents_settings() {
    for name in ["flyer.json", "flyer_uintah.json", "flyer_defaults.json"] {
        same_bits(&short(name, 0.2e-6));
    }
}

#[test]
fn gases_and_walls() {
    same_bits(&shipped("sod.json"));
    same_bits(&shipped("piston.json"));
}

#[test]
fn what_counts_as_no_pressure() {
    let mut cold = shipped("noh_planar.json");
    cold.as_object_mut().unwrap().remove("reference");
    let body = cold["bodies"][0].as_object_mut().unwrap();
    body.remove("velocity_field");
    body.insert("velocity".into(), json!([-1.0]));
    same_bits(&cold);
}

#[test]
fn other_schemes() {
    for method in [
        json!({"shape": "linear", "transfer": "apic"}),
        json!({"shape": "gimp", "transfer": {"xpic": 3}, "stress_update": "first"}),
        json!({"shape": "bspline_quadratic", "transfer": {"fmpm": 4}}),
        json!({"shape": "bspline_cubic", "transfer": "pic", "stress_update": "modified_last"}),
        json!({"shape": "cpdi", "transfer": {"flip_pic": 0.9}, "stepping": "midpoint"}),
    ] {
        same_bits(&with(&short("flyer_uintah.json", 1e-7), &json!({"method": method})));
    }
    let total = json!({"method": {"frame": "total_lagrangian"}});
    for name in ["flyer.json", "flyer_uintah.json", "soft_flyer.json"] {
        same_bits(&with(&short(name, 1e-7), &total));
    }
    let limiter = json!({"artificial_viscosity": {"limiter": "nodal", "limited": "both"}});
    same_bits(&with(&short("flyer.json", 1e-7), &limiter));
}
