//! Bodies with velocity fields of their own, on a line: they part, meet and press as they should.

use decomp::Serial;
use decomp::comm::local::run_ranks;
use flyer_mpm::exact::{Accuracy, Impact, ImpactBody, Separation};
use flyer_mpm::simulation::ParticleTable;
use flyer_mpm::simulation::Simulation;
use serde_json::{Value, json};

use crate::tools::{
    SHAPES, at_most, checked, column, run, run_scene, scored, shipped, transfers, with,
};

/// Pressure behind the shocks of aluminium at 1500 m/s on copper and of copper at 1000 m/s on
/// aluminium [Pa].
const P2: [f64; 2] = [19.42e9, 12.144294e9];

/// Contact forces (time at the step's end, force) of a run, and its particles at the end.
fn forces(value: &Value) -> (Vec<(f64, f64)>, ParticleTable) {
    let scene = checked(value);
    let mut simulation = Simulation::<1>::new(&scene, &Serial, 1).unwrap();
    let mut forces = Vec::new();
    while simulation.time() < scene.scene.time.end {
        simulation.advance(scene.scene.time.end).unwrap();
        forces.push((simulation.time(), simulation.contact_force()[0]));
    }
    (forces, simulation.gather().unwrap().0)
}

/// The impact of a scene's two bodies.
fn impact(value: &Value) -> Impact {
    let scene = checked(value);
    let body = |i: usize| {
        let (material, extent) = (scene.material_of(i), &value["bodies"][i]["box"]);
        let at = |key: &str| extent[key][0].as_f64().unwrap();
        ImpactBody {
            material: material.eos.straight(material.density).unwrap(),
            lower: at("lower"),
            upper: at("upper"),
            velocity: scene.bodies[i].velocity[0],
        }
    };
    Impact::new(body(0), body(1)).unwrap()
}

/// A scene cut to a target of 2 mm, until `end`.
fn cut(name: &str, end: f64) -> Value {
    let edit = json!({
        "domain": {"upper": [0.003]},
        "time": {"end": end},
        "output": {"profiles": {"times": [end]}},
    });
    let mut value = with(&shipped(name), &edit);
    value["bodies"][1]["box"]["upper"] = json!([0.0024]);
    value
}

/// Distance between the facing edges of the two bodies.
fn gap(table: &ParticleTable, halves: [f64; 2]) -> f64 {
    let x = column(table, "x");
    let of = |body: u32| (0..x.len()).filter(move |&r| table.body[r] == body);
    let density = column(table, "density");
    let last = of(0).max_by(|&a, &b| x[a].total_cmp(&x[b])).unwrap();
    let first = of(1).min_by(|&a, &b| x[a].total_cmp(&x[b])).unwrap();
    x[first] - halves[1] / density[first] - x[last] - halves[0] / density[last]
}

#[test]
fn a_softer_flyer_parts_in_time() {
    parts_in_time(&json!({}), [0.02, 0.03]);
}

#[test]
fn a_softer_flyer_parts_in_time_in_the_total_lagrangian_frame() {
    // it comes off a little later
    parts_in_time(&json!({"method": {"frame": "total_lagrangian"}}), [0.025, 0.035]);
}

#[track_caller]
fn parts_in_time(edit: &Value, gaps: [f64; 2]) {
    let cell = 1e-5;
    // the thicker one has parted only just, so its gap is small
    for (thickness, end, bound) in [(0.5e-3, 0.4e-6, gaps[0]), (1e-3, 0.4e-6, gaps[1])] {
        let mut value = with(&cut("soft_flyer.json", end), edit);
        value["domain"]["lower"] = json!([-0.0012]);
        value["bodies"][0]["box"]["lower"] = json!([-thickness]);
        let separation = Separation::new(&impact(&value), end, Accuracy::default());
        let separation = separation.unwrap().unwrap();
        let (forces, table) = forces(&value);
        let level = 0.01 * separation.peak_pressure;
        let last = forces.iter().filter(|f| f.1 > level).map(|f| f.0).fold(0.0, f64::max);
        let exact = separation.falls_to(0.01);
        let bound_of_time = (0.01 * exact).max(2.0 * cell / 5386.0);
        at_most(&format!("parting of {thickness}"), last - exact, bound_of_time);
        // plates that a shock has pressed together carry no tension
        let pull = forces.iter().map(|f| -f.1 / separation.peak_pressure).fold(0.0, f64::max);
        at_most("tension", pull, 1e-3);
        let parted = forces.iter().rfind(|f| f.1.abs() > 1e-3 * separation.peak_pressure);
        let late = parted.unwrap().0 - separation.falls_to(1e-3);
        at_most("last force", late, 2.0 * cell / 5386.0);
        let middle = forces.iter().find(|f| f.0 > 0.08e-6).unwrap().1;
        at_most("force in contact", middle / separation.peak_pressure - 1.0, 0.01);
        let masses = [2785.0 * 0.25 * cell, 8930.0 * 0.25 * cell];
        let error = separation.gap_error(gap(&table, masses), end).unwrap();
        at_most(&format!("gap of {thickness}"), error, bound);
        let (outcome, errors) = scored(&value);
        at_most("L1", errors[0].l1.unwrap(), 0.02);
        at_most("energy drift", outcome.energy_drift(), 1e-12);
        at_most("momentum drift", outcome.momentum_drift(), 1e-12);
    }
}

#[test]
fn a_gap_closes_before_anything_happens() {
    let (forces, _) = forces(&cut("gap.json", 1.2e-7));
    let first = forces.iter().find(|f| f.1 != 0.0).unwrap().0;
    at_most("closing time", first - 100e-9, 2e-9);
    let before = run(&cut("gap.json", 0.99e-7));
    assert!(column(before.last(), "velocity").iter().all(|v| *v == 0.0 || (v - 1e3).abs() < 1e-9));
    // from then on it is the impact, late
    let (outcome, errors) = scored(&cut("gap.json", 3e-7));
    at_most("L1", errors[0].l1.unwrap(), 0.012);
    at_most("energy drift", outcome.energy_drift(), 1e-12);
}

/// Pressures of the same particles in two scenes, by the peak of the impact.
fn differ(a: &Value, b: &Value, peak: f64) -> f64 {
    let [a, b] = [a, b].map(|value| run(value));
    let [p, q] = [&a, &b].map(|o| column(o.last(), "pressure"));
    p.iter().zip(q).fold(0.0f64, |most, (p, q)| most.max((p - q).abs())) / peak
}

#[test]
fn two_fields_in_contact_are_as_good_as_one() {
    let one = cut("flyer.json", 2e-7);
    let two = with(&one, &json!({"contact": {"type": "frictionless"}}));
    at_most("copper on aluminium", differ(&one, &two, P2[1]), 1e-3);
    let stick = with(&one, &json!({"contact": {"type": "stick"}}));
    assert_eq!(run(&one).digest, run(&stick).digest, "one field for all");
}

#[test]
fn a_plate_cut_in_two_is_one_plate() {
    let one = cut("flyer.json", 2e-7);
    // a weak shock swings longest ahead of itself, and opens the cut before it is pressed
    for (at, speed, peak, bound) in
        [(0.5e-3, 1e3, P2[1], 1e-6), (0.3e-3, 1e3, P2[1], 1e-6), (0.505e-3, 100.0, 1.0e9, 2e-3)]
    {
        let mut one = one.clone();
        one["bodies"][0]["velocity"] = json!([speed]);
        let mut two = with(&one, &json!({"contact": {"type": "frictionless"}}));
        let mut rear = two["bodies"][1].clone();
        rear["name"] = json!("rear");
        rear["box"]["lower"] = json!([at]);
        two["bodies"][1]["box"]["upper"] = json!([at]);
        two["bodies"].as_array_mut().unwrap().push(rear);
        at_most(&format!("cut at {at}, {speed} m/s"), differ(&one, &two, peak), bound);
        let calm =
            json!({"artificial_viscosity": {"linear": 0.1, "quadratic": 1.25, "growth": null}});
        let [one, two] = [&one, &two].map(|scene| with(scene, &calm));
        at_most(&format!("calm cut at {at}, {speed} m/s"), differ(&one, &two, peak), 1e-3);
    }
}

#[test]
fn plates_pressed_together_from_the_start_are_one() {
    let mut two = cut("flyer.json", 2e-7);
    two["reference"] = json!(null);
    two["boundary"] = json!({"x_lower": "wall", "x_upper": "wall"});
    two["domain"] = json!({"lower": [0.0], "upper": [0.0024], "cell_size": 1e-5});
    two["materials"].as_object_mut().unwrap().remove("copper");
    let mut front = two["bodies"][1].clone();
    let mut rear = front.clone();
    front["name"] = json!("front");
    front["velocity"] = json!([20.0]);
    front["box"]["upper"] = json!([0.0005]);
    rear["box"]["lower"] = json!([0.0005]);
    two["bodies"] = json!([front, rear]);
    for body in two["bodies"].as_array_mut().unwrap() {
        body["pressure"] = json!(1e9);
    }
    two["contact"] = json!({"type": "frictionless"});
    let one = with(&two, &json!({"contact": {"type": "stick"}}));
    // of what the front strikes with, half of rho c u
    at_most("as one", differ(&one, &two, 0.5 * 2785.0 * 5386.0 * 20.0), 1e-3);
}

#[test]
fn bodies_that_touch_and_recede_do_not_pull() {
    let mut value = cut("flyer.json", 5e-8);
    value["contact"] = json!({"type": "frictionless"});
    value["bodies"][0]["velocity"] = json!([-20.0]);
    value["bodies"][0]["box"]["lower"] = json!([-0.0003]);
    value["reference"] = json!(null);
    let outcome = run(&value);
    let fault = |v: &f64| v.abs().min((v + 20.0).abs());
    let velocity = column(outcome.last(), "velocity");
    assert!(velocity.iter().all(|v| fault(v) < 1e-12), "{velocity:?}");
}

#[test]
fn every_scheme_has_contact_in_leapfrog() {
    // hat functions at points tear the material apart
    for shape in SHAPES.into_iter().filter(|shape| *shape != "linear") {
        for transfer in transfers() {
            let mut value = cut("soft_flyer.json", 1e-7);
            value["bodies"][0]["box"]["lower"] = json!([-0.0001]);
            value["bodies"][1]["box"]["upper"] = json!([0.0009]);
            value["domain"]["upper"] = json!([0.0012]);
            value["method"] = json!({"shape": shape, "transfer": transfer});
            value["artificial_viscosity"] = json!({"linear": 0.2, "quadratic": 2.0});
            let outcome =
                run_scene(&checked(&value), 1).unwrap_or_else(|e| panic!("{shape} {transfer} {e}"));
            at_most(&format!("{shape} {transfer}"), outcome.momentum_drift(), 1e-12);
            // they have parted
            let [a, b] = [0, 1].map(|body| {
                let x = column(outcome.last(), "x").iter().zip(&outcome.last().body);
                let x = x.filter(|(_, b)| **b == body).map(|(x, _)| *x);
                if body == 0 { x.fold(f64::MIN, f64::max) } else { x.fold(f64::MAX, f64::min) }
            });
            assert!(b - a > 1e-5, "{shape} {transfer}: {}", b - a);
        }
    }
}

/// Gases that have been pressed to within a twentieth of a cell of each other press on each other:
/// the faces between them are held, those outside fly off.
#[test]
fn compressed_gases_a_hair_apart_press_on_each_other() {
    for method in [
        json!({"shape": "cpdi_bspline_quadratic", "transfer": {"fmpm": 4}, "stepping": "midpoint"}),
        json!({"shape": "cpdi", "transfer": "flip"}),
    ] {
        let gas = |name: &str, lower: f64| {
            json!({
                "name": name, "material": "gas", "velocity": [0.0], "pressure": 1e5,
                "particles_per_cell": [2],
                "box": {"lower": [lower], "upper": [lower + 0.5]}
            })
        };
        let outcome = run(&json!({
            "title": "two gases",
            "domain": {"lower": [-0.1], "upper": [1.1], "cell_size": 0.01},
            "time": {"end": 1e-6},
            "method": method,
            "materials": {"gas": {"density": 1.0, "eos": {"type": "ideal_gas", "gamma": 1.4}}},
            "bodies": [gas("left", 0.0), gas("right", 0.5005)],
            "output": {"profiles": {"times": [1e-6]}},
            "contact": {"type": "frictionless"}
        }));
        let velocity = column(outcome.last(), "velocity");
        let outer = velocity[velocity.len() - 1];
        assert!(outer > 10.0, "{outer}");
        for inner in &velocity[99..101] {
            at_most(&method.to_string(), inner / outer, 0.05);
        }
    }
}

/// A patch that moves to another rank at a step's end takes nothing away from the force of that
/// step.
#[test]
fn a_force_is_reported_whole_when_patches_move() {
    let mut value = cut("soft_flyer.json", 2e-8);
    value["domain"]["patches"] = json!([16]);
    value["decomposition"] = json!({"balance": {"every": 3, "cost": "particles"}});
    let scene = checked(&value);
    let ends = run_ranks(2, |rank| {
        let mut simulation = Simulation::<1>::new(&scene, rank, 1).unwrap();
        let mut forces = Vec::new();
        while simulation.time() < scene.scene.time.end {
            simulation.advance(scene.scene.time.end).unwrap();
            forces.push((simulation.time(), simulation.contact_force()[0]));
        }
        (forces, simulation.tally().balances)
    });
    assert!(ends[0].1 > 0, "no patch moves");
    assert_eq!(ends[0].0, forces(&value).0);
}
