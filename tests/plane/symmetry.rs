//! A scene with its axes swapped, or mirrored, runs as before.

use serde_json::{Value, json};

use crate::tools::{Outcome, impact, run};

fn scene() -> Value {
    let flyer = json!({"box": {"lower": [-0.0002, 0.0], "upper": [0.0, 0.0003]}});
    let target = json!({"polygon": {"vertices": [[0.0, -0.0001], [0.0004, 0.0], [0.0003, 0.0005], [0.0, 0.0004]]}});
    impact([[-0.0004, -0.0002], [0.0006, 0.0006]], [flyer, target], [1e3, 1e2])
}

/// Puts `map` to every point and vector of a scene; boxes get their corners in order.
fn mapped(map: impl Fn([f64; 2]) -> [f64; 2] + Copy) -> Value {
    let mut scene = scene();
    let point = |value: &Value| map([value[0].as_f64().unwrap(), value[1].as_f64().unwrap()]);
    let corners = |extent: &Value| {
        let (a, b) = (point(&extent["lower"]), point(&extent["upper"]));
        let ends = |pick: fn(f64, f64) -> f64| json!([pick(a[0], b[0]), pick(a[1], b[1])]);
        [ends(f64::min), ends(f64::max)]
    };
    let domain = corners(&scene["domain"]);
    [scene["domain"]["lower"], scene["domain"]["upper"]] = domain;
    for body in scene["bodies"].as_array_mut().unwrap() {
        body["velocity"] = json!(point(&body["velocity"]));
        if body["box"].is_object() {
            let [lower, upper] = corners(&body["box"]);
            body["box"] = json!({"lower": lower, "upper": upper});
        } else {
            let vertices = body["polygon"]["vertices"].as_array().unwrap();
            let vertices: Vec<_> = vertices.iter().map(point).collect();
            body["polygon"]["vertices"] = json!(vertices);
        }
    }
    scene
}

/// Place, velocity, pressure and density of each particle, sorted by place; in cells and parts of
/// each field's scale.
fn fields(outcome: &Outcome<2>, map: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<[f64; 6]> {
    let column = |name| outcome.column(name);
    let at = |k: usize| {
        let x = map([column("x")[k], column("y")[k]]);
        let v = map([column("velocity_x")[k], column("velocity_y")[k]]);
        let (p, rho) = (column("pressure")[k], column("density")[k]);
        [x[0] / 2e-5, x[1] / 2e-5, v[0] / 1e3, v[1] / 1e3, p / 2e10, rho / 8930.0]
    };
    (0..outcome.table.len()).map(at).collect()
}

#[track_caller]
fn same(map: impl Fn([f64; 2]) -> [f64; 2] + Copy, back: impl Fn([f64; 2]) -> [f64; 2]) {
    let plain = fields(&run(&scene()), |v| v);
    let other = fields(&run(&mapped(map)), back);
    assert_eq!(plain.len(), other.len());
    for row in &plain {
        let apart = |other: &[f64; 6]| {
            row.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let nearest = other.iter().map(apart).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-9, "{nearest:e} at {row:?}");
    }
}

#[test]
fn axes_can_be_swapped() {
    same(|[x, y]| [y, x], |[x, y]| [y, x]);
}

#[test]
fn mirrors_change_nothing() {
    same(|[x, y]| [-x, y], |[x, y]| [-x, y]);
    same(|[x, y]| [x, -y], |[x, y]| [x, -y]);
}
