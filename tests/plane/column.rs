//! One column of cells between planes of symmetry is a line.

use serde_json::{Value, json};

use crate::tools::{Outcome, checked, run};

/// Largest difference between a line and its column, of a field's largest value.
fn apart(line: &Outcome<1>, column: &Outcome<2>, names: [&str; 2]) -> f64 {
    let (line, column) = (line.column(names[0]), column.column(names[1]));
    assert_eq!(column.len(), 2 * line.len());
    let scale = line.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let worst = column.iter().enumerate().map(|(k, v)| (v - line[k / 2]).abs());
    worst.fold(0.0, f64::max) / scale
}

/// The scene of a line, and the same with a y.
fn pair(method: Value, limiter: Value) -> [Value; 2] {
    let text = std::fs::read_to_string("inputs/flyer.json").unwrap();
    let mut line: Value = serde_json::from_str(&text).unwrap();
    line["domain"] = json!({"lower": [-0.001], "upper": [0.003], "cell_size": 2e-5});
    line["bodies"][1]["box"]["upper"] = json!([0.002]);
    line["method"] = method;
    line["artificial_viscosity"]["limiter"] = limiter;
    line["time"]["end"] = json!(1.5e-7);
    line["output"] = json!({});
    line["reference"] = Value::Null;
    let mut column = line.clone();
    column["domain"] = json!({"lower": [-0.001, 0.0], "upper": [0.003, 2e-5], "cell_size": 2e-5});
    column["boundary"] = json!({"y_lower": "symmetry", "y_upper": "symmetry"});
    for body in column["bodies"].as_array_mut().unwrap() {
        body["box"]["lower"].as_array_mut().unwrap().push(json!(0.0));
        body["box"]["upper"].as_array_mut().unwrap().push(json!(2e-5));
        body["velocity"].as_array_mut().unwrap().push(json!(0.0));
        body["particles_per_cell"] = json!([2, 2]);
    }
    [line, column]
}

#[track_caller]
fn same(method: Value, limiter: Value, bound: f64) {
    let what = method.to_string();
    let [line, column] = pair(method, limiter);
    assert_eq!(checked(&column).particles, 2 * checked(&line).particles);
    let (line, column) = (run::<1>(&line), run::<2>(&column));
    for names in [
        ["x", "x"],
        ["velocity", "velocity_x"],
        ["pressure", "pressure"],
        ["density", "density"],
        ["specific_internal_energy", "specific_internal_energy"],
    ] {
        let apart = apart(&line, &column, names);
        assert!(apart < bound, "{what}: {} {apart:e}", names[0]);
    }
    assert!(column.column("velocity_y").iter().all(|v| v.abs() < 1e-9), "{what}");
}

#[test]
fn the_default_scheme() {
    let text = std::fs::read_to_string("inputs/flyer.json").unwrap();
    let scene: Value = serde_json::from_str(&text).unwrap();
    same(scene["method"].clone(), json!("christensen"), 1e-12);
    same(scene["method"].clone(), json!("nodal"), 1e-12);
}

#[test]
fn every_shape_and_transfer() {
    for shape in ["gimp", "cpdi", "bspline_quadratic", "bspline_cubic", "cpdi_bspline_quadratic"] {
        for transfer in [
            json!("flip"),
            json!("apic"),
            json!({"flip_pic": 0.9}),
            json!({"xpic": 3}),
            json!({"fmpm": 3}),
        ] {
            // points without extent and boxes of constant size let noise grow
            let bound = if shape.starts_with("cpdi") { 1e-11 } else { 1e-6 };
            same(json!({"shape": shape, "transfer": transfer}), Value::Null, bound);
        }
    }
}
