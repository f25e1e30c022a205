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

/// Cold gas that closes in on the middle of its domain at 1 m/s.
fn noh(symmetry: &str) -> Value {
    let plane = symmetry != "planar";
    let both = |x: f64| if plane { json!([x, x]) } else { json!([x]) };
    let cell = if plane { 0.05 } else { 0.01 };
    json!({
        "title": "Noh",
        "domain": {"lower": both(-1.3), "upper": both(1.3), "cell_size": cell},
        "time": {"end": 0.6},
        "method": midpoint("cpdi_bspline_quadratic", json!({"fmpm": 2})),
        "materials": {"gas": {"density": 1.0, "eos":
            {"type": "ideal_gas", "gamma": 1.6666666666666667}}},
        "bodies": [{
            "name": "gas", "material": "gas", "box": {"lower": both(-1.2), "upper": both(1.2)},
            "velocity_field": {"radial": {"about": both(0.0), "speed": -1.0}},
            // a gas without any pressure falls to less than none by rounding
            "pressure": 1e-6,
            "particles_per_cell": if plane { json!([2, 2]) } else { json!([2]) }
        }],
        "artificial_viscosity": {"linear": 0.2, "quadratic": 2.0},
        "reference": {"noh": {"body": "gas", "symmetry": symmetry, "between": [0.05, 0.15]}}
    })
}

#[test]
fn nohs_gas_has_its_density_behind_the_shock() {
    let line = run::<1>(&noh("planar")).score;
    at_most("planar", number(&line, "mean_density") / 4.0 - 1.0, 0.02);
    at_most("planar", number(&line, "mean_density_error"), 0.02);
    at_most("planar", number(&line, "density_l1"), 0.06);
    let plane = run::<2>(&noh("cylindrical")).score;
    at_most("cylindrical", number(&plane, "mean_density_error"), 0.3);
}
