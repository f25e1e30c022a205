//! What runs long, runs out, or stays at rest.

use serde_json::json;

use super::scenes::shipped;
use super::tools::{failed, greatest, hard, lump, metals, run, scene_of, until};
use super::{Figure, figure};

/// An aluminium plate between two walls, struck once by a part of itself, for 50 transits.
pub fn fifty_transits() -> Vec<Figure> {
    let transit = 100.0 * 1e-5 / 5386.0;
    let value = hard("struck_between_walls.json");
    let drift = |transits: f64| {
        let ended = run(&until(&value, &[transits * transit]));
        ended.map_or_else(|e| failed("50 transits", &e), |ended| ended.energy_drift())
    };
    let (first, last) = (drift(1.0), drift(50.0));
    let standard = run(&until(&shipped("flyer.json"), &[0.2e-6]));
    let standard = standard.map_or(f64::NAN, |ended| ended.energy_drift().abs());
    vec![
        // rounding is no drift
        figure("50 transits: energy after the first", first, standard.max(1e-12)),
        figure("50 transits: energy, of each one after", (last - first) / 49.0, 2e-4),
    ]
}

/// Into the void: a gas to a tenth of its density, metals torn with and without a limit.
pub fn rarefaction() -> Vec<Figure> {
    let mut figures = Vec::new();
    let value = hard("expansion.json");
    match run(&value) {
        Ok(ended) => {
            let least = ended.column("density").iter().copied().fold(f64::INFINITY, f64::min);
            figures.push(figure(
                "gas into the void: least density over the first",
                least / 100.0,
                0.1,
            ));
            figures.push(figure("gas into the void: energy", ended.energy_drift(), 1e-10));
        }
        Err(e) => figures.push(figure("gas into the void", failed("gas", &e), 0.0)),
    }
    let limited = hard("torn.json");
    let mut torn = limited.clone();
    let eos = torn["materials"]["copper"]["eos"].as_object_mut().expect("an equation of state");
    eos.remove("tension_cutoff");
    let is_refused = match run(&torn) {
        Err(e) => e.contains("tension_cutoff") && e.contains("particle "),
        Ok(_) => false,
    };
    figures.push(figure("metal torn without a limit: no message", f64::from(!is_refused), 0.0));
    let energy = run(&limited).map_or_else(|e| failed("torn", &e), |ended| ended.energy_drift());
    figures.push(figure("metal torn with a limit: energy", energy, 1e-10));
    figures
}

/// Nothing moves: everything stays what it is.
pub fn cold() -> Vec<Figure> {
    let mut figures = Vec::new();
    let bodies = json!([
        lump("one", "copper", [10.0, 30.0], 0.0),
        lump("other", "aluminium", [30.0, 61.0], 0.0),
    ]);
    for (what, patches) in [("one patch", 1), ("seven patches", 7)] {
        let mut value = scene_of(90, 2e-7, &metals(), &bodies);
        value["domain"]["patches"] = json!([patches]);
        value["decomposition"] = json!({"skip_quiescent": false});
        match run(&until(&value, &[1e-10, 2e-7])) {
            Ok(ended) => {
                let moved = |name: &str| greatest(ended.column(name));
                let most = moved("velocity").max(moved("pressure"));
                let most = most.max(moved("specific_internal_energy"));
                let same = ended.tables[0].column("x") == ended.tables[1].column("x");
                figures.push(figure(format!("cold start, {what}: anything but 0"), most, 0.0));
                figures.push(figure(format!("cold start, {what}: moved"), f64::from(!same), 0.0));
            }
            Err(e) => figures.push(figure(what, failed(what, &e), 0.0)),
        }
    }
    figures
}

/// A wave between two walls, for 10^6 steps.
pub fn standing_wave() -> Vec<Figure> {
    let mut pressed = lump("pressed", "aluminium", [0.0, 5.0], 0.0);
    pressed["pressure"] = json!(1e6);
    let bodies = json!([pressed, lump("rest", "aluminium", [5.0, 10.0], 0.0)]);
    let mut value = scene_of(10, 1.0, &metals(), &bodies);
    value["boundary"] = json!({"x_lower": "wall", "x_upper": "wall"});
    // 0.4 of a cell's transit a step
    let end = 1e6 * 0.4 * 1e-5 / 5390.0;
    match run(&until(&value, &[end])) {
        Ok(ended) => vec![
            figure("10^6 steps: fewer by", (1e6 - ended.steps as f64).max(0.0), 2e4),
            figure("10^6 steps: energy", ended.energy_drift(), 1e-9),
            figure(
                "10^6 steps: greatest pressure over the first",
                greatest(ended.column("pressure")) / 1e6,
                1.0,
            ),
        ],
        Err(e) => vec![figure("10^6 steps", failed("10^6 steps", &e), 0.0)],
    }
}

/// Subnormal velocities, -0.0, and masses near the least number.
pub fn denormals() -> Vec<Figure> {
    let mut figures = Vec::new();
    for (what, velocity) in [("subnormal", 5e-320), ("tiny", 1e-200), ("-0.0", -0.0)] {
        let bodies = json!([
            lump("one", "copper", [10.0, 30.0], velocity),
            lump("other", "aluminium", [30.0, 61.0], 0.0),
        ]);
        let value = until(&scene_of(90, 2e-8, &metals(), &bodies), &[2e-8]);
        let most =
            run(&value).map_or_else(|e| failed(what, &e), |e| greatest(e.column("velocity")));
        figures.push(figure(format!("{what} velocity: greatest"), most, 2.0 * f64::abs(velocity)));
    }
    let bodies = json!([
        lump("one", "copper", [10.0, 30.0], 500.0),
        lump("other", "aluminium", [30.0, 61.0], 0.0),
    ]);
    let lighter = |power: i32| {
        let mut materials = metals();
        for name in ["copper", "aluminium"] {
            let density = materials[name]["density"].as_f64().expect("a number");
            materials[name]["density"] = json!(density * 2f64.powi(power));
        }
        run(&until(&scene_of(90, 5e-8, &materials, &bodies), &[5e-8]))
    };
    let off = match (lighter(-500), lighter(0)) {
        (Ok(light), Ok(usual)) => {
            super::tools::apart(light.column("velocity"), usual.column("velocity"))
        }
        (Err(e), _) | (_, Err(e)) => failed("light", &e),
    };
    figures.push(figure("densities of 2^-500: velocity, from the usual", off, 1e-12));
    // where squares of pressures fall below the least number the scene is refused
    let text = lighter(-950).is_err_and(|e| e.contains("no finite stiffness"));
    figures.push(figure("densities of 2^-950: not refused", f64::from(!text), 0.0));
    figures
}
