//! Numbers of particles a cell, irregular particles, shifted grids, tiny bodies.

use serde_json::{Value, json};

use super::scenes::shipped;
use super::tools::{failed, flyer, lump, metals, run, scene_of, scored, until};
use super::{Figure, figure};

/// L1 at the last profile.
fn l1(value: &Value) -> Result<f64, String> {
    scored(value).map(|(_, errors)| errors.last().and_then(|e| e.l1).unwrap_or(f64::NAN))
}

/// L1 of scenes over that of the standard problem, each below its bound.
fn ratios(scenes: Vec<(String, Value, f64)>) -> Vec<Figure> {
    let usual = l1(&flyer()).unwrap_or_else(|e| failed("the standard problem", &e));
    let ratio = |(what, value, bound): (String, Value, f64)| {
        let error = l1(&value).unwrap_or_else(|e| failed(&what, &e));
        figure(format!("{what}: L1 over that of the standard problem"), error / usual, bound)
    };
    scenes.into_iter().map(ratio).collect()
}

/// 1 to 32 particles a cell.
pub fn counts() -> Vec<Figure> {
    let scene = |count: usize| {
        let mut value = flyer();
        for body in 0..2 {
            value["bodies"][body]["particles_per_cell"] = json!([count]);
        }
        (format!("{count} particles a cell"), value, if count == 1 { 1.5 } else { 1.2 })
    };
    ratios([1, 3, 4, 8, 16, 32].map(scene).into())
}

/// Numbers in [-1, 1) that look random and are the same everywhere (a linear congruence).
pub fn scattered(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A body's lattice, each particle moved by up to `share` of the spacing either way.
fn jittered(body: &mut Value, spacing: f64, share: f64, seed: u64) {
    let at = |key: &str| body["box"][key][0].as_f64().expect("a number");
    let (lower, upper) = (at("lower"), at("upper"));
    let count = ((upper - lower) / spacing).round() as usize;
    let mut random = scattered(seed);
    let place = |k: usize| lower + (k as f64 + 0.5 + share * random()) * spacing;
    let points: Vec<[f64; 1]> = (0..count).map(place).map(|x| [x]).collect();
    let body = body.as_object_mut().expect("a body");
    body.remove("particles_per_cell");
    body.insert("positions".into(), json!(points));
}

/// Particles moved by up to 40 % of their spacing: what is nearest to each is its own, so that
/// volumes and lengths go by the midpoints and the body is filled exactly.
pub fn irregular() -> Vec<Figure> {
    let mut value = flyer();
    for body in 0..2 {
        jittered(&mut value["bodies"][body], 0.5e-5, 0.4, 7 + body as u64);
    }
    ratios(vec![("particles moved by 40 % of their spacing".into(), value, 1.3)])
}

/// The grid shifted by parts of a cell, particles on nodes and faces, cells that divide no body.
pub fn shifted() -> Vec<Figure> {
    let mut scenes = Vec::new();
    // particles stand at a quarter and three quarters of a cell
    for (what, part) in
        [("particles on nodes", 0.25), ("shifted grid", 0.5), ("shifted grid", 0.37)]
    {
        let mut value = flyer();
        value["domain"]["lower"] = json!([-0.001 - part * 1e-5]);
        value["domain"]["upper"] = json!([0.009 - part * 1e-5]);
        scenes.push((format!("{what}, by {part} of a cell"), value, 1.3));
    }
    let mut value = flyer();
    value["domain"]["cell_size"] = json!(0.01 / 977.0);
    scenes.push(("a cell that divides no body".into(), value, 1.3));
    ratios(scenes)
}

/// One particle, one cell, two cells, one particle far off, and a sliver on a surface.
pub fn tiny() -> Vec<Figure> {
    let mut figures = Vec::new();
    let target = || lump("target", "aluminium", [40.0, 100.0], 0.0);
    let mut one = lump("one", "copper", [39.5, 40.0], 500.0);
    one["particles_per_cell"] = json!([2]);
    let mut alone = lump("alone", "copper", [5.0, 5.5], 0.0);
    alone["particles_per_cell"] = json!([2]);
    let flyer = |cells: f64| lump("flyer", "copper", [40.0 - cells, 40.0], 500.0);
    // a hundredth of a cell that stands before the target
    let mut sliver = lump("sliver", "aluminium", [39.99, 40.0], 0.0);
    sliver["particles_per_cell"] = json!([100]);
    for (what, bodies) in [
        ("one particle", json!([one, target()])),
        ("one cell", json!([flyer(1.0), target()])),
        ("two cells", json!([flyer(2.0), target()])),
        ("one particle alone", json!([alone, flyer(10.0), target()])),
        ("a sliver", json!([lump("flyer", "copper", [29.0, 39.0], 500.0), sliver, target()])),
    ] {
        let value = until(&scene_of(140, 1e-7, &metals(), &bodies), &[1e-7]);
        match run(&value) {
            Ok(ended) => {
                figures.push(figure(format!("{what}: energy"), ended.energy_drift(), 1e-10));
                let finite = ended.column("pressure").iter().all(|p| p.is_finite());
                figures.push(figure(
                    format!("{what}: pressures that are none"),
                    f64::from(!finite),
                    0.0,
                ));
            }
            Err(e) => figures.push(figure(what, failed(what, &e), 0.0)),
        }
    }
    // two cells of flyer under the exact solution, which the fan has long caught up with
    let mut thin = until(&shipped("flyer.json"), &[0.02e-6]);
    thin["bodies"][0]["box"]["lower"] = json!([-2e-5]);
    let energy = run(&thin).map_or_else(|e| failed("thin flyer", &e), |ended| ended.energy_drift());
    figures.push(figure("a flyer of two cells: energy", energy, 1e-10));
    figures
}
