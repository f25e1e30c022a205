//! Profile times: met exactly, without a trace in the physics.

use decomp::Serial;
use flyer_mpm::simulation::Simulation;
use serde_json::json;

use crate::tools::{apart, at_most, checked, column, ending, inputs, run, shipped, short};

#[test]
fn the_step_after_a_shortened_one_is_whole() {
    for name in ["flyer.json", "flyer_uintah.json"] {
        let scene = checked(&short(name, 0.2e-6));
        let mut run = Simulation::<1>::new(&scene, &Serial, 1).unwrap();
        while run.time() < 1e-7 {
            run.advance(1e-7).unwrap();
        }
        let whole = run.time_step();
        let time = run.time() + 1e-3 * whole;
        run.advance(time).unwrap();
        assert_eq!(run.time(), time);
        // the state has hardly moved, and so has its stable step
        at_most("next step", run.time_step() / whole - 1.0, 0.01);
        let start = run.time();
        let next = run.time_step();
        run.advance(0.2e-6).unwrap();
        assert_eq!(run.time(), start + next);
    }
}

#[test]
fn profiles_leave_no_trace() {
    for name in ["flyer.json", "flyer_uintah.json"] {
        let plain = short(name, 0.2e-6);
        let mut often = plain.clone();
        let times: Vec<f64> = (1..=40).map(|k| 0.2e-6 * f64::from(k) / 40.0).collect();
        often["output"]["profiles"]["times"] = json!(times);
        let (a, b) = (run(&plain), run(&often));
        let (p, q) = (column(a.last(), "pressure"), column(b.last(), "pressure"));
        let sum: f64 = p.iter().map(|p| p.abs()).sum();
        let difference: f64 = p.iter().zip(q).map(|(p, q)| (p - q).abs()).sum();
        at_most(&format!("pressure of {name}"), difference / sum, 0.02);
        at_most("x", apart(column(a.last(), "x"), column(b.last(), "x")), 1e-3);
        // the default keeps energy in shortened steps too
        if name == "flyer.json" {
            at_most("energy", b.energy_drift(), 1e-12);
        }
    }
}

#[test]
fn a_last_step_of_almost_nothing() {
    for name in ["flyer.json", "flyer_uintah.json"] {
        let mut value = short(name, 5e-8);
        let before = run(&value);
        for little in [1e-16, 1e-20] {
            value["time"]["end"] = json!(5e-8 + little);
            value["output"]["profiles"]["times"] = json!([5e-8]);
            let outcome = run(&value);
            assert_eq!(outcome.tables.len(), 1, "a profile at 50 ns");
            assert_eq!(outcome.tables[0], before.tables[0], "the end is not seen before");
            value["output"]["profiles"]["times"] = json!([5e-8, 5e-8 + little]);
            let times: Vec<f64> = run(&value).tables.iter().map(|table| table.time).collect();
            assert_eq!(times, [5e-8, 5e-8 + little]);
        }
    }
}

#[test]
fn an_end_within_the_first_step() {
    for name in ["flyer.json", "flyer_uintah.json", "sod.json", "piston.json"] {
        let mut value = shipped(name);
        let end = value["time"]["end"].as_f64().unwrap() * 1e-6;
        ending(&mut value, end);
        let outcome = run(&value);
        assert_eq!(outcome.last().time, end);
        // leapfrog steps keep energy in the limit of short ones alone
        let bound = if name == "flyer_uintah.json" { 1e-5 } else { 1e-12 };
        at_most(&format!("energy of {name}"), outcome.energy_drift(), bound);
    }
}

/// Every shipped scene on a line makes its first steps.
#[test]
fn every_shipped_scene_runs() {
    for file in inputs() {
        let name = file.file_name().unwrap().to_str().unwrap().to_owned();
        let mut value = shipped(&name);
        if value["domain"]["lower"].as_array().unwrap().len() > 1 {
            continue;
        }
        let end = checked(&value).scene.time.end;
        ending(&mut value, 0.01 * end);
        let outcome = run(&value);
        let table = outcome.last();
        assert!(column(table, "pressure").iter().all(|p| p.is_finite()), "{name}");
        assert_eq!(outcome.start.mass, outcome.end.mass, "{name}");
        // a rod at rest starts with none: what its warm side gives is all there is
        let [start, end] = [&outcome.start, &outcome.end].map(|t| t.kinetic + t.internal);
        if start == 0.0 && outcome.end.conducted == 0.0 {
            continue; // a piston gives all there is, as tests/plane/pistons.rs has it
        }
        let drift = (end - start - outcome.end.conducted) / start.max(end);
        assert!(drift.abs() < 0.1, "{name}: {drift}");
    }
}
