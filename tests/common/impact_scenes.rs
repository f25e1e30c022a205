//! Random impacts without a method, as a user writes them: plates on a line, blocks in a plane, rods
//! on the axis; with and without strength and contact.

use proptest::prelude::*;
use proptest::sample::select;
use serde_json::{Value, json};

/// Materials of the library: fluids, and metals with strength.
const MATERIALS: [&str; 8] = [
    "copper",
    "tungsten",
    "aluminium_6061",
    "pmma",
    "water",
    "copper_johnson_cook",
    "steel_4340_johnson_cook",
    "aluminium_6061_steinberg_guinan",
];

/// Cell size [m].
const CELL: f64 = 5e-5;

/// An impact between two bodies that touch or are half a cell and more apart.
pub fn scene() -> impl Strategy<Value = Value> {
    let parts = (
        prop_oneof![3 => Just(1usize), 2 => Just(2)],
        any::<bool>(),
        [select(&MATERIALS[..]), select(&MATERIALS[..])],
        [12usize..=30, 20usize..=60],
        100.0..2000.0f64,
        (0usize..=2, any::<bool>()),
        1usize..=2,
    );
    parts.prop_map(|(dimension, axis, materials, cells, speed, (gap, contact), density)| {
        let [flyer, target] = cells.map(|n| n as f64 * CELL);
        let gap = gap as f64 * 0.5 * CELL;
        let plane = dimension == 2;
        let height = 16.0 * CELL;
        let vector = |along: f64, across: f64| match (plane, axis) {
            (false, _) => json!([along]),
            (true, false) => json!([along, across]),
            // the axis is y
            (true, true) => json!([across, along]),
        };
        let body = |name: &str, material: &str, ends: [f64; 2], velocity: f64, height: f64| {
            json!({
                "name": name,
                "material": material,
                "box": {"lower": vector(ends[0], 0.0), "upper": vector(ends[1], height)},
                "velocity": vector(velocity, 0.0),
                "particles_per_cell": vec![density; dimension],
            })
        };
        let lower = -(flyer + 8.0 * CELL);
        let mut scene = json!({
            "title": "impact",
            "domain": {
                "lower": vector(lower, 0.0),
                "upper": vector(target + 8.0 * CELL, 32.0 * CELL),
                "cell_size": CELL,
            },
            "time": {"end": (target / 5000.0).min(1e-6)},
            "materials": {
                "one": {"library": materials[0]},
                "other": {"library": materials[1]},
            },
            "bodies": [
                body("flyer", "one", [-gap - flyer, -gap], speed, 0.75 * height),
                body("target", "other", [0.0, target], 0.0, height),
            ],
        });
        if plane {
            // jets leave the domain
            let [symmetry, outer] =
                if axis { ["x_lower", "x_upper"] } else { ["y_lower", "y_upper"] };
            scene["boundary"] = json!({symmetry: "symmetry", outer: "outflow"});
            if axis {
                scene["domain"]["geometry"] = json!("axisymmetric");
            }
        }
        if contact || gap > 0.0 {
            scene["contact"] = json!({"type": "frictionless"});
        }
        scene
    })
}
