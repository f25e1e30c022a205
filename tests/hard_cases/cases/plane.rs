//! In a plane: turning and sheared bodies, jets, a shock through a corner of patches, debris, a
//! triple point.

use decomp::Serial;
use decomp::comm::local::run_ranks;
use serde_json::{Value, json};

use super::scenes::{shipped, with};
use super::tools::{CELL, Ended, failed, metals, run_on};
use super::{Figure, figure};

/// A scene in a plane of so many cells, with the scheme of the standard problem.
fn plane(cells: [usize; 2], end: f64, bodies: Value) -> Value {
    // what is shipped for a plane: with the viscosity of flyer.json corners jet, and the monitor ends
    // the run
    let flyer = shipped("flyer_2d.json");
    let upper: Vec<f64> = cells.iter().map(|&n| n as f64 * CELL).collect();
    let mut value = json!({
        "title": "hard, in a plane",
        "domain": {"lower": [0.0, 0.0], "upper": upper, "cell_size": CELL},
        "time": {"end": end},
        "method": flyer["method"],
        "artificial_viscosity": flyer["artificial_viscosity"],
        "materials": metals(),
        "bodies": bodies,
        "output": {"profiles": {"times": [end]}},
    });
    // as the shipped scenes in a plane have it, without which corners tear
    value["method"]["domain_limit"] = json!(1.0);
    value
}

fn block(name: &str, material: &str, x: [f64; 2], y: [f64; 2], velocity: [f64; 2]) -> Value {
    json!({
        "name": name,
        "material": material,
        "box": {"lower": [x[0] * CELL, y[0] * CELL], "upper": [x[1] * CELL, y[1] * CELL]},
        "velocity": velocity,
        "particles_per_cell": [2, 2],
    })
}

fn run(value: &Value) -> Result<Ended<2>, String> {
    run_on(value, &Serial)
}

fn energy(what: &str, value: &Value) -> Figure {
    let drift = run(value).map_or_else(|e| failed(what, &e), |ended| ended.energy_drift());
    figure(format!("{what}: energy"), drift, 1e-9)
}

/// A block on a plate, which sends a shock through a corner of four patches.
fn struck() -> Value {
    plane(
        [40, 32],
        5e-8,
        json!([
            block("flyer", "copper", [8.0, 16.0], [8.0, 24.0], [800.0, 0.0]),
            block("target", "aluminium", [16.0, 32.0], [4.0, 28.0], [0.0, 0.0]),
        ]),
    )
}

/// Corners, jets, a corner of four patches, a triple point under contact.
pub fn check() -> Vec<Figure> {
    let mut figures = vec![energy("a block on a plate", &struck())];
    let digest = |patches: [usize; 2], ranks: usize| {
        let value = with(&struck(), &json!({"domain": {"patches": patches}}));
        let ends = run_ranks(ranks, |comm| run_on::<2>(&value, comm).map(|e| e.digest));
        ends.into_iter().next().expect("rank 0").unwrap_or_else(|e| e)
    };
    let whole = digest([1, 1], 1);
    for (patches, ranks) in [([2, 2], 1), ([2, 2], 2), ([2, 2], 4), ([5, 3], 3)] {
        let what = format!("a corner of patches {patches:?} on {ranks} ranks: other bits");
        figures.push(figure(what, f64::from(digest(patches, ranks) != whole), 0.0));
    }
    // two wedges of plates that meet under an angle jet
    let slab = |name: &str, sign: f64| {
        let y = |a: f64| (16.0 + sign * a) * CELL;
        let points = [[32.0, 1.0], [50.0, 7.0], [50.0, 11.0], [32.0, 5.0]];
        let mut corners: Vec<[f64; 2]> = points.iter().map(|p| [p[0] * CELL, y(p[1])]).collect();
        if sign < 0.0 {
            corners.reverse();
        }
        json!({
            "name": name,
            "material": "aluminium",
            "polygon": {"vertices": corners},
            "velocity": [0.0, -sign * 1500.0],
            "particles_per_cell": [2, 2],
        })
    };
    let mut jets = plane([60, 32], 6e-8, json!([slab("upper", 1.0), slab("lower", -1.0)]));
    // what jets is pulled thin
    jets["materials"]["aluminium"]["eos"]["tension_cutoff"] = json!(1e9);
    figures.push(energy("a jet of two plates", &jets));
    let mut triple = plane(
        [32, 32],
        4e-8,
        json!([
            block("left", "copper", [6.0, 16.0], [6.0, 16.0], [300.0, 0.0]),
            block("right", "aluminium", [16.0, 26.0], [6.0, 16.0], [0.0, 0.0]),
            block("top", "aluminium", [8.0, 24.0], [16.0, 24.0], [0.0, -300.0]),
        ]),
    );
    triple["contact"] = json!({"type": "frictionless"});
    figures.push(energy("contact at a triple point", &triple));
    figures
}

/// Single particles as debris, one of which meets a body.
pub fn debris() -> Vec<Figure> {
    let bit = |name: &str, at: [f64; 2], velocity: [f64; 2]| {
        let mut bit = block(name, "copper", [at[0], at[0] + 0.5], [at[1], at[1] + 0.5], velocity);
        bit["particles_per_cell"] = json!([2, 2]);
        bit
    };
    let value = plane(
        [32, 24],
        4e-8,
        json!([
            bit("one", [3.2, 11.3], [2000.0, 0.0]),
            bit("other", [6.1, 3.4], [0.0, 700.0]),
            block("target", "aluminium", [10.0, 20.0], [6.0, 18.0], [0.0, 0.0]),
        ]),
    );
    vec![energy("debris", &value)]
}
