//! Explosives: products that expand, and fronts that light them.

use decomp::Serial;
use flyer_mpm::simulation::Simulation;
use serde_json::{Value, json};

use crate::tools::{at_most, checked, leapfrog, run, shipped};

const TNT: [f64; 6] = [371.2e9, 3.231e9, 4.15, 0.95, 0.3, 7.0e9];

/// p on the isentrope of TNT burnt at its own volume.
fn isentrope(v: f64) -> f64 {
    let [a, b, r1, r2, w, energy] = TNT;
    let cold = |v: f64| a * (-r1 * v).exp() + b * (-r2 * v).exp();
    let start = a * (1.0 - w / r1) * (-r1).exp() + b * (1.0 - w / r2) * (-r2).exp() + w * energy;
    cold(v) + (start - cold(1.0)) * v.powf(-1.0 - w)
}

fn coarse(name: &str, cell: f64, end: f64) -> Value {
    let mut value = shipped(name);
    value["domain"]["cell_size"] = json!(cell);
    value["time"]["end"] = json!(end);
    value["output"] = json!({"profiles": {"times": [end]}});
    value
}

#[test]
fn products_stay_on_their_isentrope() {
    let outcome = run(&coarse("jwl_expansion.json", 2e-4, 1e-5));
    let (rho, p) = (outcome.column("density"), outcome.column("pressure"));
    let products: Vec<usize> = (0..rho.len()).filter(|&r| rho[r] < 3000.0).collect();
    let greatest = products.iter().map(|&r| 1630.0 / rho[r]).fold(0.0, f64::max);
    assert!(greatest > 1.5, "they expand: {greatest}");
    for r in products {
        at_most("isentrope", p[r] / isentrope(1630.0 / rho[r]) - 1.0, 0.02);
    }
    at_most("energy", outcome.energy_drift(), 1e-13);
}

/// The front of a run of `detonation.json`: where half has burnt.
fn front(value: &Value) -> f64 {
    let outcome = run(value);
    let (x, f) = (outcome.column("x"), outcome.column("burn_fraction"));
    assert!(f.iter().all(|f| (0.0..=1.0).contains(f)));
    let lit = f.iter().zip(x).filter(|(f, _)| **f >= 0.5);
    lit.map(|(_, x)| *x).fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn the_front_arrives_in_time() {
    let value = coarse("detonation.json", 2e-4, 2e-6);
    let value = {
        let mut value = value;
        value["materials"]["tnt"]["eos"]["burn"]["width"] = json!(8e-4);
        value
    };
    let exact = 6930.0 * 2e-6 - 4e-4;
    at_most("place [cells]", (front(&value) - exact) / 2e-4, 1.0);
    let mut late = value.clone();
    late["materials"]["tnt"]["eos"]["burn"]["start"] = json!(0.5e-6);
    at_most("start [cells]", (front(&late) - (exact - 6930.0 * 0.5e-6)) / 2e-4, 1.0);
    let mut points = value.clone();
    let burn = &mut points["materials"]["tnt"]["eos"]["burn"];
    burn["plane"] = Value::Null;
    burn.as_object_mut().unwrap().remove("plane");
    burn["points"] = json!([[0.0]]);
    assert_eq!(front(&points), front(&value));
    for update in ["first", "modified_last"] {
        let x = front(&leapfrog(value.clone(), update));
        at_most("leapfrog [cells]", (x - exact) / 2e-4, 1.0);
    }
}

#[test]
fn what_waits_for_the_front_does_not_sleep() {
    // a start so late that all patches have long been at rest
    let mut value = coarse("detonation.json", 2e-4, 2e-6);
    value["domain"]["patches"] = json!([5]);
    value["materials"]["tnt"]["eos"]["burn"]["start"] = json!(1e-6);
    let slept = front(&value);
    value["decomposition"] = json!({"skip_quiescent": false});
    assert!(slept > 5e-3 && slept == front(&value), "{slept}");
}

#[test]
fn the_pressure_behind_the_front_is_that_of_the_products() {
    let mut value = coarse("detonation.json", 1e-4, 2.5e-6);
    value["materials"]["tnt"]["eos"]["burn"]["width"] = json!(4e-4);
    let outcome = run(&value);
    let greatest = outcome.column("pressure").iter().copied().fold(0.0, f64::max);
    // Chapman and Jouguet's 21.0 GPa, cut by the width of the front
    assert!(greatest > 0.85 * 21.0e9 && greatest < 1.05 * 21.0e9, "{greatest:e}");
    at_most("energy", outcome.energy_drift(), 1e-13);
}

#[test]
fn compression_burns_where_asked() {
    let run = |compression: bool| {
        let mut value = coarse("detonation.json", 2e-4, 1e-6);
        // a front that is late for the blow
        value["materials"]["tnt"]["eos"]["burn"]["start"] = json!(1.0);
        value["materials"]["tnt"]["eos"]["burn"]["compression"] = json!(compression);
        value["bodies"][0]["velocity"] = json!([-300.0]);
        run(&value).column("burn_fraction").iter().copied().fold(0.0, f64::max)
    };
    assert_eq!(run(false), 0.0);
    // until what has burnt stops the blow
    let burnt = run(true);
    assert!(burnt > 0.05 && burnt < 1.0, "{burnt}");
}

/// A charge that burns by being thrown on a wall, before any front comes, and then spreads far
/// past its first volume.
#[test]
fn what_has_burnt_stays_burnt() {
    let fractions = |time: f64| {
        let mut value = coarse("detonation.json", 2e-4, time);
        let burn = &mut value["materials"]["tnt"]["eos"]["burn"];
        burn["start"] = json!(1.0);
        burn["compression"] = json!(true);
        value["domain"]["upper"] = json!([0.012]);
        value["bodies"][0]["box"]["upper"] = json!([0.002]);
        value["bodies"][0]["velocity"] = json!([-1000.0]);
        let outcome = run(&value);
        [outcome.column("burn_fraction"), outcome.column("density")].map(<[f64]>::to_vec)
    };
    let times = [0.3e-6, 0.6e-6, 1.2e-6, 2.4e-6];
    let states = times.map(fractions);
    for pair in states.windows(2) {
        for (before, after) in pair[0][0].iter().zip(&pair[1][0]) {
            assert!(after >= before, "{after} of {before}");
        }
    }
    let [burnt, density] = &states[3];
    assert!(burnt.iter().all(|f| *f > 0.05) && density.iter().all(|rho| *rho < 1630.0));
}

/// The greatest pressure, over that of Chapman and Jouguet, after a front has passed so many cells
/// of 25 um, and what the run warns of.
fn front_pressure(value: &Value, cells: f64) -> (f64, Vec<String>) {
    let mut value = value.clone();
    let (cell, length) = (2.5e-5, cells * 2.5e-5);
    value["domain"] = json!({"lower": [0.0], "upper": [length + 0.002], "cell_size": cell});
    value["bodies"][0]["box"]["upper"] = json!([length + 0.001]);
    value["materials"]["tnt"]["eos"]["burn"]["width"] = json!(4.0 * cell);
    let end = length / 6930.0;
    value["time"]["end"] = json!(end);
    value["output"] = json!({"profiles": {"times": [end]}});
    let scene = checked(&value);
    let mut simulation = Simulation::<1>::new(&scene, &Serial, 1).unwrap();
    while simulation.time() < end {
        simulation.advance(end).unwrap();
    }
    let (table, _) = simulation.gather().unwrap();
    let greatest = table.column("pressure").unwrap().iter().copied().fold(0.0, f64::max);
    (greatest / 21.0e9, simulation.peaks().warnings())
}

#[test]
fn the_front_does_not_grow_with_the_cells_that_it_passes() {
    let shipped = shipped("detonation.json");
    let [(near, _), (far, warnings)] = [200.0, 800.0].map(|n| front_pressure(&shipped, n));
    assert!(near > 0.85 && far < 1.02 && far / near < 1.1, "{near} {far}");
    assert_eq!(warnings, Vec::<String>::new());
}

/// With a filter of high order it grows still: the check and the run warn of it.
#[test]
fn a_front_that_grows_is_warned_of() {
    let mut value = shipped("detonation.json");
    let of_filter = |value: &Value| {
        checked(value).warnings.iter().any(|w| w.contains("grows with the number of cells"))
    };
    assert!(!of_filter(&value));
    value["method"]["transfer"] = json!({"xpic": 8});
    value["method"].as_object_mut().unwrap().remove("edge_mask");
    assert!(!of_filter(&value));
    value["method"]["transfer"] = json!({"fmpm": 8});
    value["method"]["edge_mask"] = json!(0.3);
    assert!(of_filter(&value));
    let (pressure, warnings) = front_pressure(&value, 800.0);
    assert!(pressure > 1.15, "{pressure}");
    assert!(warnings.iter().any(|w| w.contains("Chapman-Jouguet")), "{warnings:?}");
}
