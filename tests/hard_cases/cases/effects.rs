//! Effects at their ends: strength at large strain, spall with one particle left, conduction with
//! a tiny step.

use serde_json::{Value, json};

use super::scenes::shipped;
use super::tools::{failed, greatest, lump, metals, run, scene_of, until};
use super::{Figure, figure};

fn energy(what: &str, value: &Value) -> Figure {
    let drift = run(value).map_or_else(|e| failed(what, &e), |ended| ended.energy_drift());
    figure(format!("{what}: energy"), drift, 1e-9)
}

/// All three.
pub fn check() -> Vec<Figure> {
    let mut strong = metals();
    for name in ["copper", "aluminium"] {
        let strength = json!({"type": "von_mises", "shear_modulus": 2.76e10, "yield_stress": 3e8});
        strong[name]["strength"] = strength;
    }
    let bodies = json!([
        lump("flyer", "copper", [10.0, 40.0], 8000.0),
        lump("target", "aluminium", [40.0, 100.0], 0.0),
    ]);
    let value = until(&scene_of(260, 1e-7, &strong, &bodies), &[1e-7]);
    let mut figures = vec![energy("strength at 8 km/s", &value)];
    // the release of a thin flyer parts a target of two cells down to single particles
    let mut brittle = metals();
    for name in ["copper", "aluminium"] {
        brittle[name]["failure"] = json!({"type": "tension_limit", "stress": 1e8});
    }
    for (what, cells) in [("spall of four cells", 4.0), ("spall of half a cell", 0.5)] {
        let bodies = json!([
            lump("flyer", "aluminium", [40.0 - cells, 40.0], 600.0),
            lump("target", "aluminium", [40.0, 40.0 + cells], 0.0),
        ]);
        figures.push(energy(what, &until(&scene_of(100, 1e-7, &brittle, &bodies), &[1e-7])));
    }
    // a conductivity so large that its step is a thousandth of the waves'
    let mut rod = shipped("heat_rod.json");
    rod["materials"]["rod"]["thermal"]["conductivity"] = json!(1e6);
    rod["time"]["end"] = json!(1e-6);
    rod["output"]["profiles"]["times"] = json!([1e-6]);
    match run(&rod) {
        Ok(ended) => {
            let hottest = greatest(ended.column("temperature"));
            figures.push(figure(
                "conduction in tiny steps: hottest over the held end",
                hottest / 400.0,
                1.0 + 1e-9,
            ));
        }
        Err(e) => figures.push(figure("conduction", failed("conduction", &e), 0.0)),
    }
    figures
}
