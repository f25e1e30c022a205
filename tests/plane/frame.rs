//! The total-Lagrangian frame in a plane: a column is a line.

use serde_json::{Value, json};

use crate::tools::{Outcome, impact, run};

/// Plates without end along y, or turned about, along x.
fn plates(axis: usize) -> Value {
    let turn = |x: f64, y: f64| if axis == 0 { [x, y] } else { [y, x] };
    let region =
        |from: f64, to: f64| json!({"box": {"lower": turn(from, 0.0), "upper": turn(to, 1e-4)}});
    let domain = [turn(-4e-4, 0.0), turn(6e-4, 1e-4)];
    let regions = [region(-2e-4, 0.0), region(0.0, 4e-4)];
    let mut scene = impact(domain, regions, turn(1e3, 0.0));
    let across = if axis == 0 { "y" } else { "x" };
    scene["boundary"] = json!({"x_lower": "free", "x_upper": "free"});
    for end in ["lower", "upper"] {
        scene["boundary"][format!("{across}_{end}")] = json!("symmetry");
    }
    scene["method"]["frame"] = json!("total_lagrangian");
    let method = scene["method"].as_object_mut().unwrap();
    method.remove("domain_limit");
    // it moves J alone, and in a plane gradients are pushed forward with F
    method.remove("pressure_relaxation");
    scene["time"]["end"] = json!(4e-8);
    scene
}

/// The same on a line.
fn line() -> Value {
    let mut scene = plates(0);
    for key in ["lower", "upper"] {
        let first = scene["domain"][key][0].clone();
        scene["domain"][key] = json!([first]);
        for body in 0..2 {
            let first = scene["bodies"][body]["box"][key][0].clone();
            scene["bodies"][body]["box"][key] = json!([first]);
        }
    }
    for body in scene["bodies"].as_array_mut().unwrap() {
        body["velocity"] = json!([body["velocity"][0]]);
        body["particles_per_cell"] = json!([2]);
    }
    scene["boundary"] = json!({"x_lower": "free", "x_upper": "free"});
    scene
}

/// Values of a column by place along `axis`, the particles of a column of them all alike.
fn profile<const D: usize>(outcome: &Outcome<D>, place: &str, name: &str) -> Vec<(f64, f64)> {
    let (x, values) = (outcome.column(place), outcome.column(name));
    let mut all: Vec<(f64, f64)> = x.iter().copied().zip(values.iter().copied()).collect();
    all.sort_by(|a, b| a.partial_cmp(b).unwrap());
    all
}

#[test]
fn a_column_is_a_line() {
    for limiter in ["nodal", "christensen"] {
        let with = |mut scene: Value| {
            scene["artificial_viscosity"]["limiter"] = json!(limiter);
            scene
        };
        let line = run::<1>(&with(line()));
        let on_line = profile(&line, "x", "pressure");
        let most = on_line.iter().fold(0.0f64, |m, p| m.max(p.1.abs()));
        assert!(most > 1e10, "{most:e}");
        for (axis, place) in [(0, "x"), (1, "y")] {
            let plane = run::<2>(&with(plates(axis)));
            assert!(plane.energy_drift().abs() < 1e-12, "{:e}", plane.energy_drift());
            let column = profile(&plane, place, "pressure");
            let across = column.len() / on_line.len();
            for (k, (x, pressure)) in column.into_iter().enumerate() {
                let (at, of_line) = on_line[k / across];
                assert!((x - at).abs() < 1e-12, "{x:e} for {at:e}");
                assert!((pressure - of_line).abs() < 1e-8 * most, "{pressure:e} for {of_line:e}");
            }
        }
    }
}
