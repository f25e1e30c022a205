//! Mixing of internal energy in compression: less heating at walls and interfaces, the same energy.

use flyer_mpm::input;
use serde_json::{Value, json};

use crate::tools::{Outcome, at_most, run, shipped};

/// Noh's planar problem (Noh 1987) on 100 cells.
fn noh(coefficient: Option<f64>) -> Value {
    let mut scene = shipped("noh_planar.json");
    scene["domain"]["cell_size"] = json!(0.01);
    scene["output"] = json!({});
    scene["heat_mixing"] = coefficient.map_or(Value::Null, |c| json!({"coefficient": c}));
    scene
}

/// Mean density of the two particles of the cell at the wall.
fn at_wall(outcome: &Outcome<1>) -> f64 {
    let density = outcome.column("density");
    0.5 * (density[0] + density[1])
}

#[test]
fn a_wall_is_heated_less_and_energy_stays() {
    let [none, weak, strong] = [None, Some(10.0), Some(20.0)].map(|c| run::<1>(&noh(c)));
    let deficits = [&none, &weak, &strong].map(|outcome| 4.0 - at_wall(outcome));
    assert!(deficits[0] > 1.5, "{deficits:?}");
    assert!(deficits[1] < 0.4 * deficits[0], "{deficits:?}");
    assert!(deficits[2] < deficits[1], "{deficits:?}");
    for outcome in [&none, &weak, &strong] {
        at_most("energy", outcome.energy_drift(), 1e-13);
    }
    // neither a column nor a bit changes without the key or with null
    let mut off = noh(None);
    off.as_object_mut().unwrap().remove("heat_mixing");
    assert_eq!(run::<1>(&off).digest, none.digest);
    assert_ne!(weak.digest, none.digest);
}

#[test]
fn options_that_do_nothing_or_harm_are_refused() {
    let refusal = |scene: &Value| {
        let bytes = scene.to_string();
        input::parse(bytes.as_bytes(), "test.json", &[]).unwrap_err().to_string()
    };
    let error = refusal(&noh(Some(0.0)));
    assert!(error.contains("heat_mixing.coefficient = 0"), "{error}");
    let mut scene = noh(Some(10.0));
    scene["heat_mixing"]["coeficient"] = json!(1.0);
    let error = refusal(&scene);
    assert!(error.contains("heat_mixing.coeficient"), "{error}");
    let mut scene = shipped("piston.json");
    scene["heat_mixing"] = json!({"coefficient": 10.0});
    for material in scene["materials"].as_object_mut().unwrap().values_mut() {
        material["eos"] =
            json!({"type": "neo_hookean", "youngs_modulus": 1e9, "poissons_ratio": 0.3});
    }
    scene.as_object_mut().unwrap().remove("reference");
    scene["method"].as_object_mut().unwrap().remove("pressure_relaxation");
    let error = refusal(&scene);
    assert!(error.contains("heat_mixing.coefficient") && error.contains("no body"), "{error}");
    let mut scene = noh(None);
    scene["heat_mixin"] = json!({});
    let error = refusal(&scene);
    assert!(error.contains("heat_mixin") && error.contains("heat_mixing"), "{error}");
}
