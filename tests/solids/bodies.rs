//! First motions and the exact solutions that follow from them.

use serde_json::{Value, json};

use crate::tools::{at_most, midpoint, run, shipped};

fn number(score: &Value, name: &str) -> f64 {
    score[name].as_f64().unwrap_or_else(|| panic!("no {name} in {score}"))
}

#[test]
fn a_shear_layer_stays_to_a_strain_of_eight() {
    let mut value = shipped("shear_layer.json");
    value["domain"]["cell_size"] = json!(0.0625);
    let outcome = run::<2>(&value);
    at_most("velocity", number(&outcome.score, "velocity_rms"), 0.01);
    at_most("energy", outcome.energy_drift(), 1e-12);
}

#[test]
fn greshos_vortex_stands_for_a_quarter_turn() {
    let mut value = shipped("gresho.json");
    value["domain"]["cell_size"] = json!(0.05);
    value["time"]["end"] = json!(0.314);
    value["output"]["profiles"]["times"] = json!([0.314]);
    let outcome = run::<2>(&value);
    at_most("velocity", number(&outcome.score, "velocity_rms"), 0.06);
    at_most("pressure", number(&outcome.score, "pressure_form_rms"), 0.3);
    // without its pressure the vortex would have flown apart
    assert!(outcome.column("pressure").iter().all(|&p| p > 4.5));
}

#[test]
fn apic_keeps_the_rotation_of_a_disk() {
    let mut value = shipped("spinning_disk.json");
    value["time"]["end"] = json!(13.5);
    value["output"]["profiles"]["times"] = json!([13.5]);
    let outcome = run::<2>(&value);
    at_most("angular momentum", number(&outcome.score, "angular_momentum_loss"), 1e-3);
    at_most("energy", number(&outcome.score, "energy_loss"), 0.02);
    value["method"] = midpoint("cpdi_bspline_quadratic", json!({"fmpm": 4}));
    let outcome = run::<2>(&value);
    assert!(number(&outcome.score, "angular_momentum_loss") > 0.01, "the filter takes rotation");
    at_most("energy", number(&outcome.score, "energy_loss"), 1e-12);
}
