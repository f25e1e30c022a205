//! Sides that press on what touches them.

use flyer_mpm::input;
use flyer_mpm::scene::{CheckedScene, Course, Side};
use flyer_mpm::simulation::Compiled;
use flyer_mpm::solver::Stepper;
use serde_json::{Value, json};

use crate::tools::{at_most, checked, default_method, metals, run, same_bits};

/// Density and sound speed of the aluminium.
const RHO: f64 = 2785.0;
const C0: f64 = 5386.0;

/// Aluminium of 2 mm at rest, loaded at its lower end until `end` [s].
fn slab(load: Value, end: f64) -> Value {
    let mut method = default_method();
    method.as_object_mut().unwrap().remove("domain_limit");
    json!({
        "title": "a load",
        "domain": {"lower": [0.0], "upper": [2.2e-3], "cell_size": 1e-5},
        "time": {"end": end},
        "method": method,
        "materials": metals(),
        "bodies": [{"name": "slab", "material": "aluminium", "velocity": [0.0],
            "particles_per_cell": [2], "box": {"lower": [0.0], "upper": [2e-3]}}],
        "artificial_viscosity": {
            "linear": 0.1, "quadratic": 1.25, "limiter": "christensen", "limited": "linear"
        },
        "boundary": {"x_lower": {"pressure": load}}
    })
}

#[test]
fn a_pressure_drives_the_shock_of_its_jump() {
    // p = rho (c0 + s u) u
    let (speed, end) = (600.0, 2e-7);
    let shock = C0 + 1.339 * speed;
    let pressure = RHO * shock * speed;
    let outcome = run::<1>(&slab(json!(pressure), end));
    let rows = outcome.column("x").iter().zip(outcome.column("velocity"));
    let behind = rows.filter(|(x, _)| (2e-4..0.9 * shock * end).contains(*x));
    let (sum, count) = behind.fold((0.0, 0.0), |(sum, n), (_, v)| (sum + v, n + 1.0));
    at_most("velocity", sum / count / speed - 1.0, 1e-3);
    let surface = outcome.column("x")[0] - 0.25e-5 * RHO / outcome.column("density")[0];
    at_most("surface [cells]", (surface - speed * end) / 1e-5, 0.3);
    at_most("energy", outcome.unbooked_energy(), 1e-12);
    let impulse = pressure * end;
    // the surface is as exact as the internal force, whose quadrature a shock disturbs
    at_most("impulse", outcome.given.impulse[0] / impulse - 1.0, 2e-3);
    at_most("momentum", outcome.unbooked_momentum(0) / impulse, 1e-12);
    at_most("work", outcome.given.work / (impulse * speed) - 1.0, 0.02);
}

#[test]
fn a_ramp_runs_in_as_sound() {
    for method in [None, Some(json!({"shape": "cpdi", "transfer": "apic"}))] {
        let mut scene = slab(json!([[2e-8, 0.0], [1.2e-7, 1e7]]), 2.2e-7);
        method.into_iter().for_each(|method| scene["method"] = method);
        let outcome = run::<1>(&scene);
        let rows = outcome.column("x").iter().zip(outcome.column("velocity"));
        for (x, v) in rows {
            let share = ((2e-7 - x / C0) / 1e-7).clamp(0.0, 1.0);
            at_most("velocity", v / (1e7 / (RHO * C0)) - share, 0.03);
        }
    }
}

/// The pressure of a step is that of its middle: exact while it grows evenly.
#[test]
fn a_ramp_gives_the_impulse_under_it() {
    let outcome = run::<1>(&slab(json!([[2e-8, 0.0], [1.2e-7, 1e7]]), 2.2e-7));
    at_most("impulse", outcome.given.impulse[0] / (1e7 * 1.5e-7) - 1.0, 1e-3);
}

/// A body under the pressure of its sides stays as it is.
#[test]
fn a_body_under_its_own_pressure_is_at_rest() {
    fn check<const D: usize>(method: Value)
    where
        Stepper<D>: Compiled<D>,
    {
        let what = method.to_string();
        let mut scene = slab(json!(2e9), 5e-8);
        scene["method"] = method;
        scene["domain"] = json!({"lower": vec![0.0; D], "upper": vec![2e-4; D], "cell_size": 1e-5});
        scene["bodies"][0]["box"] = json!({"lower": vec![0.0; D], "upper": vec![2e-4; D]});
        scene["bodies"][0]["velocity"] = json!(vec![0.0; D]);
        scene["bodies"][0]["particles_per_cell"] = json!(vec![2; D]);
        scene["bodies"][0]["pressure"] = json!(2e9);
        let sides = &["x_lower", "x_upper", "y_lower", "y_upper"][..2 * D];
        scene["boundary"] = sides.iter().map(|side| (*side, json!({"pressure": 2e9}))).collect();
        let outcome = run::<D>(&scene);
        let names = if D == 2 { &["velocity_x", "velocity_y"][..] } else { &["velocity"][..] };
        for v in names.iter().flat_map(|name| outcome.column(name)) {
            at_most(&what, v / C0, 1e-11);
        }
        for p in outcome.column("pressure") {
            at_most(&what, p / 2e9 - 1.0, 1e-10);
        }
    }
    let mut method = default_method();
    method.as_object_mut().unwrap().remove("domain_limit");
    check::<1>(method.clone());
    check::<1>(json!({"shape": "cpdi", "transfer": "flip"}));
    check::<2>(method);
    check::<2>(json!({"shape": "cpdi", "transfer": "apic"}));
}

#[test]
fn any_layout_has_the_same_bits() {
    let mut scene = slab(json!(null), 3e-8);
    scene["method"] = default_method();
    scene["domain"] = json!({"lower": [0.0, 0.0], "upper": [6e-4, 4e-4], "cell_size": 2e-5});
    let mut body = scene["bodies"][0].clone();
    body["velocity"] = json!([0.0, 0.0]);
    body["particles_per_cell"] = json!([2, 2]);
    body["box"] = json!({"lower": [0.0, 1e-4], "upper": [3e-4, 4e-4]});
    scene["bodies"] = json!([body]);
    scene["boundary"] = json!({
        "x_lower": {"pressure": [[0.0, 2e9], [2e-8, 4e9]]}, "y_upper": {"pressure": 3e9}
    });
    same_bits(&scene);
    let outcome = run::<2>(&scene);
    at_most("energy", outcome.unbooked_energy(), 1e-12);
    let impulse = outcome.given.impulse;
    for a in 0..2 {
        at_most("momentum", outcome.unbooked_momentum(a) / impulse[a], 1e-12);
    }
    // over an edge of 0.3 mm each
    at_most("impulse along x", impulse[0] / (3e-4 * (3e9 * 2e-8 + 4e9 * 1e-8)) - 1.0, 0.05);
    at_most("impulse along y", impulse[1] / (-3e-4 * 3e9 * 3e-8) - 1.0, 0.05);
}

#[test]
fn a_file_beside_the_scene_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.json");
    std::fs::write(&file, slab(json!("ramp.csv"), 1e-8).to_string()).unwrap();
    let message = input::read(&file).unwrap_err().to_string();
    assert!(message.contains("ramp.csv") && message.contains("cannot be read"), "{message}");
    std::fs::write(folder.path().join("ramp.csv"), "time,pressure\n0,1e9\n1e-8,x\n").unwrap();
    let message = input::read(&file).unwrap_err().to_string();
    assert!(message.contains("ramp.csv") && message.contains("line 3"), "{message}");
    std::fs::write(folder.path().join("ramp.csv"), "time,pressure\n0,1e9\n1e-8,2e9\n").unwrap();
    let read = input::parse(&input::read(&file).unwrap(), "scene.json", &[]).unwrap();
    let points = vec![[0.0, 1e9], [1e-8, 2e9]];
    assert_eq!(read.sides::<1>()[0][0], Side::Pressure(Course::Series(points)));
}

#[test]
fn what_cannot_press_is_refused() {
    #[track_caller]
    fn refused(load: Value, sets: &[&str], fragments: &[&str]) {
        let sets: Vec<String> = sets.iter().map(|set| set.to_string()).collect();
        let text = slab(load, 1e-8).to_string();
        let message = input::parse(text.as_bytes(), "s.json", &sets).unwrap_err().to_string();
        for fragment in fragments {
            assert!(message.contains(fragment), "{message}\nhas no {fragment}");
        }
    }
    let path = "boundary.x_lower.pressure";
    refused(json!(true), &[], &[path, "true", "a number"]);
    refused(json!([]), &[], &[path, "[]"]);
    refused(json!([[0.0, 1e9], [0.0, 2e9]]), &[], &[path, "[1]", "ascend"]);
    refused(json!([[0.0]]), &[], &[path, "[0] = [0.0]", "an array of 2 entries"]);
    refused(json!([[0.0, 1e9, 3.0]]), &[], &[path, "3.0]", "an array of 2 entries"]);
    refused(json!("ramp.csv"), &[], &[path, "ramp.csv", "scene's own file"]);
    refused(json!(1e9), &["domain.lower=[-1e-5]"], &[path, "no body does"]);
    let set = "reference={\"wall_impact\": {\"body\": \"slab\"}}";
    refused(json!(1e9), &[set], &[path, "not in any exact solution"]);
    let both = "boundary.x_upper=periodic";
    refused(json!(1e9), &[both], &["boundary.x_lower", "periodic"]);
    let blunt = ["method.edge_mask=null", "method.transfer={\"fmpm\": 4}"];
    let text = slab(json!(1e9), 1e-8).to_string();
    let loaded = input::parse(text.as_bytes(), "s.json", &blunt.map(String::from)).unwrap();
    let warned = |scene: &CheckedScene| scene.warnings.iter().any(|w| w.contains("pressure"));
    assert!(warned(&loaded) && !warned(&checked(&slab(json!(1e9), 1e-8))));
}
