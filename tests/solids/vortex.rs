//! The generalized vortex: order and error of the schemes, at low resolution.

use serde_json::{Value, json};

use crate::tools::{at_most, midpoint, run, shipped};

/// Relative L2 error of the displacement at 0.15 s with `cells` a metre.
fn error(method: &Value, cells: f64) -> f64 {
    let mut value = shipped("vortex.json");
    value["method"] = method.clone();
    value["domain"]["cell_size"] = json!(1.0 / cells);
    let outcome = run::<2>(&value);
    if method["transfer"] != "apic" && method["stepping"] == "midpoint" {
        at_most("energy", outcome.energy_drift(), 1e-13);
    }
    outcome.score["displacement_l2"].as_f64().unwrap()
}

fn check(method: Value, order: f64, bound: f64) {
    let (coarse, fine) = (error(&method, 16.0), error(&method, 32.0));
    let found = (coarse / fine).log2();
    assert!(found >= order && fine <= bound, "{method}: order {found}, {fine} at 1/32");
}

#[test]
fn flip_is_of_second_order() {
    for (shape, bound) in [("cpdi", 0.016), ("cpdi_bspline_quadratic", 0.0175)] {
        check(midpoint(shape, json!("flip")), 1.8, bound);
    }
}

#[test]
fn apic_is_of_second_order() {
    for (shape, bound) in [("cpdi", 0.0105), ("cpdi_bspline_quadratic", 0.015)] {
        check(midpoint(shape, json!("apic")), 1.8, bound);
    }
}

#[test]
fn the_full_mass_matrix_is_sharper() {
    for (shape, bound) in [("cpdi", 0.005), ("cpdi_bspline_quadratic", 0.0036)] {
        check(midpoint(shape, json!({"fmpm": 4})), 1.8, bound);
    }
}

#[test]
fn leapfrog_steps_follow_it_too() {
    let method = json!({"shape": "cpdi", "transfer": "flip"});
    at_most("error", error(&method, 16.0), 0.08);
}
