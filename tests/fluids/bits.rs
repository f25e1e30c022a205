//! The same bits for any patches, with columns that a material's history asks for.

use flyer_mpm::input;
use serde_json::{Value, json};

use crate::tools::{run, shipped};

#[test]
fn any_patches_leave_the_same_bits() {
    for (name, cell, end) in [("porous_impact.json", 4e-5, 4e-7), ("detonation.json", 2e-4, 1e-6)] {
        let mut value = shipped(name);
        value["domain"]["cell_size"] = json!(cell);
        value["time"]["end"] = json!(end);
        value["output"] = json!({"profiles": {"times": [end]}});
        let mut digest = |patches: usize| {
            value["domain"]["patches"] = json!([patches]);
            run(&value).digest
        };
        let whole = digest(1);
        assert_eq!([digest(3), digest(8)], [whole.clone(), whole], "{name}");
    }
}

#[test]
fn columns_are_there_for_those_that_ask() {
    let names = |value: &Value| -> Vec<&'static str> {
        let scene = input::parse(value.to_string().as_bytes(), "test.json", &[]).unwrap();
        let columns = flyer_mpm::effects::columns(&scene);
        columns.specs.iter().map(|s| s.name).collect()
    };
    let has = |name: &str, column: &str| names(&shipped(name)).contains(&column);
    assert!(has("porous_impact.json", "distension") && !has("porous_impact.json", "burn_fraction"));
    assert!(has("detonation.json", "burn_fraction") && has("detonation.json", "lighting_time"));
    for name in ["piston.json", "flyer.json", "sod.json", "jwl_expansion.json"] {
        for column in ["distension", "burn_fraction", "lighting_time"] {
            assert!(!has(name, column), "{name} has {column}");
        }
    }
}
