//! Temperature from the energy and from plastic work.

use serde_json::json;

use crate::tools::{at_most, run, shipped};

#[test]
fn a_shock_heats_as_the_isentrope_and_its_energy_say() {
    let mut scene = shipped("piston.json");
    scene["domain"]["cell_size"] = json!(2.5e-5);
    scene["time"]["end"] = json!(0.4e-6);
    scene["output"] = json!({});
    scene["materials"]["aluminium"]["thermal"] =
        json!({"specific_heat": 896.0, "reference_temperature": 293.0});
    let outcome = run::<1>(&scene);
    let (x, t) = (outcome.column("x"), outcome.column("temperature"));
    // at 1 km/s: J = 1 - 1000/6725, e = 500 kJ/kg; the isentrope by the mid-point rule
    let (j, mut e, steps) = (1.0 - 1000.0 / 6725.0, 0.0, 20000);
    let pressure = |j: f64, e: f64| {
        let chi = 1.0 - j;
        let cold = 2785.0 * 5386.0 * 5386.0 * chi * (1.0 - 1.05 * chi);
        cold / (1.0 - 1.339 * chi).powi(2) + 2.1 * 2785.0 * e
    };
    let h = (j - 1.0) / steps as f64;
    for k in 0..steps {
        let at = 1.0 + h * k as f64;
        let half = e - 0.5 * h * pressure(at, e) / 2785.0;
        e -= h * pressure(at + 0.5 * h, half) / 2785.0;
    }
    let exact = 293.0 * (2.1 * (1.0 - j)).exp() + (5e5 - e) / 896.0;
    let behind: Vec<f64> =
        (0..x.len()).filter(|&r| (6e-4..1.6e-3).contains(&x[r])).map(|r| t[r]).collect();
    assert!(behind.len() > 50);
    // the energy differs from particle to particle by a per cent, the pressure does not
    behind.iter().for_each(|t| at_most("temperature behind the shock", t / exact - 1.0, 0.025));
    let mean = behind.iter().sum::<f64>() / behind.len() as f64;
    at_most("mean temperature behind the shock", mean / exact - 1.0, 0.003);
    let ahead = (0..x.len()).filter(|&r| x[r] > 3e-3).map(|r| t[r]);
    ahead.for_each(|t| at_most("temperature ahead", t - 293.0, 1e-6));
}

/// The plastic piston with a temperature.
fn plastic(thermal: serde_json::Value) -> crate::tools::Outcome<1> {
    let mut scene = shipped("piston_elastic_plastic.json");
    scene["domain"]["cell_size"] = json!(5e-5);
    scene["time"]["end"] = json!(0.5e-6);
    scene["output"] = json!({});
    scene["materials"]["aluminium"]["thermal"] = thermal;
    run::<1>(&scene)
}

#[test]
fn plastic_work_heats_by_its_share() {
    let heated = |share: f64| {
        plastic(json!({"specific_heat": 900.0, "reference_temperature": 300.0,
            "source": "plastic_work", "taylor_quinney": share}))
    };
    let (all, half) = (heated(1.0), heated(0.5));
    let (strain, t) = (all.column("plastic_strain"), all.column("temperature"));
    let rho = all.column("density");
    for r in (0..t.len()).filter(|&r| strain[r] > 0.0) {
        // perfectly plastic: Y ep over rho cv, rho changing by under 2 % on the way
        let rise = 0.26e9 * strain[r] / (900.0 * rho[r]);
        at_most("rise", (t[r] - 300.0) / rise - 1.0, 0.02);
    }
    let ratio = (half.greatest("temperature") - 300.0) / (all.greatest("temperature") - 300.0);
    at_most("half of the work", ratio - 0.5, 1e-9);
}

#[test]
fn work_that_is_stored_does_not_heat() {
    let heated = |share: f64| {
        plastic(json!({"specific_heat": 900.0, "reference_temperature": 300.0,
            "taylor_quinney": share}))
    };
    let (all, part) = (heated(1.0), heated(0.6));
    let strain = all.column("plastic_strain");
    let (t, cool, rho) =
        (all.column("temperature"), part.column("temperature"), all.column("density"));
    for r in (0..t.len()).filter(|&r| strain[r] > 0.0) {
        let stored = 0.4 * 0.26e9 * strain[r] / (900.0 * rho[r]);
        at_most("what is stored", (t[r] - cool[r]) / stored - 1.0, 0.02);
    }
}

#[test]
fn heat_softens() {
    let strain = |melt: f64| {
        let mut scene = shipped("piston_elastic_plastic.json");
        scene["domain"]["cell_size"] = json!(5e-5);
        scene["bodies"][0]["velocity"] = json!([-300.0]);
        scene["time"]["end"] = json!(0.3e-6);
        scene["output"] = json!({});
        scene["materials"]["aluminium"]["strength"] = json!({"type": "johnson_cook",
            "shear_modulus": 28.6e9, "a": 0.26e9, "b": 0.4e9, "n": 0.3, "c": 0.015,
            "softening": {"m": 1.0, "reference_temperature": 293.0, "melt_temperature": melt}});
        scene["materials"]["aluminium"]["thermal"] =
            json!({"specific_heat": 900.0, "reference_temperature": 293.0});
        let outcome = run::<1>(&scene);
        let (xx, zz) = (outcome.column("stress_xx"), outcome.column("stress_zz"));
        (0..20).map(|r| zz[r] - xx[r]).sum::<f64>() / 20.0
    };
    let [hard, soft] = [1e6, 600.0].map(strain);
    assert!(soft < 0.95 * hard && soft > 0.5 * hard, "{soft:e} {hard:e}");
}
