//! Pistons whose velocity changes: the grid accelerates with them.

use flyer_mpm::input;
use flyer_mpm::scene::{Course, Side};
use flyer_mpm::simulation::Compiled;
use flyer_mpm::solver::Stepper;
use serde_json::{Value, json};

use crate::tools::{Outcome, at_most, checked, default_method, metals, run, same_bits};

/// Density and sound speed of the copper.
const RHO: f64 = 8930.0;
const C0: f64 = 3940.0;

/// Copper of 2 mm at rest, driven at its lower end until `end` [s].
fn slab(velocity: Value, end: f64) -> Value {
    let mut method = default_method();
    method.as_object_mut().unwrap().remove("domain_limit");
    method.as_object_mut().unwrap().remove("edge_mask");
    json!({
        "title": "a piston",
        "domain": {"lower": [0.0], "upper": [2.4e-3], "cell_size": 2e-5},
        "time": {"end": end},
        "method": method,
        "materials": metals(),
        "bodies": [{"name": "slab", "material": "copper", "velocity": [0.0],
            "particles_per_cell": [2], "box": {"lower": [0.0], "upper": [2e-3]}}],
        "boundary": {"x_lower": {"velocity": velocity}}
    })
}

/// The same in a plane.
fn plate(velocity: Value, end: f64) -> Value {
    let mut scene = slab(velocity, end);
    scene["domain"] = json!({"lower": [0.0, 0.0], "upper": [6e-4, 4e-4], "cell_size": 2e-5});
    scene["bodies"][0]["velocity"] = json!([0.0, 0.0]);
    scene["bodies"][0]["particles_per_cell"] = json!([2, 2]);
    scene["bodies"][0]["box"] = json!({"lower": [0.0, 1e-4], "upper": [5e-4, 4e-4]});
    scene
}

/// Change of the energy in the scene that is not booked, over that at the end.
fn unbooked<const D: usize>(scene: &Value, outcome: &Outcome<D>) -> f64 {
    let checked = checked(scene);
    let frame = checked.frame::<D>();
    let [start, end] = &outcome.totals;
    let ahead = frame.energy_ahead(checked.scene.time.end, end.mass, &end.momentum)
        - frame.energy_ahead(0.0, start.mass, &start.momentum);
    let whole = end.kinetic + end.internal;
    outcome.unbooked_energy() - ahead / whole
}

fn ramp(to: f64, duration: f64) -> Value {
    json!({"to": to, "duration": duration})
}

#[test]
fn energy_and_momentum_are_booked_to_rounding() {
    let driven = slab(ramp(300.0, 3e-7), 4e-7);
    let mut pulled = slab(json!([[0.0, 0.0], [5e-8, 200.0], [1e-7, 50.0]]), 4e-7);
    pulled["body_force"] = json!({"gravity": [3e8]});
    // the far side travels with the grid, into the slab
    let mut leaving = slab(ramp(-200.0, 1e-7), 6e-7);
    leaving["domain"]["upper"] = json!([2e-3]);
    leaving["boundary"]["x_upper"] = json!("transmitting");
    leaving["method"]["edge_mask"] = json!(0.3);
    for scene in [&driven, &pulled, &leaving] {
        let outcome = run::<1>(scene);
        at_most("energy", unbooked(scene, &outcome), 1e-12);
    }
    assert!(run::<1>(&leaving).left.count > 5, "nothing has left");
    let mut plate = plate(ramp(300.0, 3e-8), 6e-8);
    plate["body_force"] = json!({"gravity": [1e9, -2e9]});
    plate["boundary"]["y_upper"] = json!({"velocity": [[0.0, 0.0], [5e-8, -100.0]]});
    let outcome = run::<2>(&plate);
    at_most("energy in a plane", unbooked(&plate, &outcome), 1e-12);
}

/// p = rho C u along the wave, whose integral over the piston's way is its work.
#[test]
fn work_is_that_of_the_pressure_on_the_piston() {
    let (to, duration, end) = (100.0, 1e-7, 3e-7);
    let scene = slab(ramp(to, duration), end);
    let outcome = run::<1>(&scene);
    let frame = checked(&scene).frame::<1>();
    // C = c0 + 2 s u - ... on the isentrope: the Hugoniot's Us has half of its slope
    let pressure = |u: f64| RHO * (C0 + 1.489 * u) * u;
    let n = 20_000;
    let work: f64 = (0..n)
        .map(|k| frame.velocity(end * (f64::from(k) + 0.5) / f64::from(n))[0])
        .map(|u| pressure(u) * u * end / f64::from(n))
        .sum();
    let [_, end] = &outcome.totals;
    at_most("work", (end.kinetic + end.internal) / work - 1.0, 2e-3);
}

/// What no wave has reached stays where it is, and a body that the piston does not touch is not
/// moved by the grid's travel.
#[test]
fn what_is_at_rest_stays_at_rest() {
    let mut scene = slab(ramp(300.0, 1.5e-7), 2.5e-7);
    let free = json!({"name": "free", "material": "aluminium", "velocity": [0.0],
        "particles_per_cell": [2], "box": {"lower": [1.6e-3], "upper": [2e-3]}});
    scene["bodies"][0]["box"]["upper"] = json!([1.2e-3]);
    scene["bodies"].as_array_mut().unwrap().push(free);
    let outcome = run::<1>(&scene);
    let mut seen = 0;
    for (x, v) in outcome.column("x").iter().zip(outcome.column("velocity")) {
        if *x > 1.5e-3 {
            seen += 1;
            at_most("velocity", v / 300.0, 1e-11);
            // particles stand at a quarter and three quarters of their cells
            let place = x / 1e-5 - 0.5;
            at_most("place [particles]", place - place.round(), 1e-4);
        }
    }
    assert_eq!(seen, 40);
}

/// A transmitting side that travels with the grid knows how fast it does at the middle of a step:
/// what no wave has reached passes it, or comes off it, without being pushed.
#[test]
fn a_transmitting_side_that_travels_leaves_what_rests_at_rest() {
    for method in [
        json!({"shape": "cpdi", "transfer": "flip"}),
        json!({"shape": "cpdi", "transfer": "flip", "stress_update": "first"}),
        json!({"shape": "cpdi", "transfer": "flip", "stepping": "midpoint"}),
    ] {
        for speed in [300.0, -300.0] {
            let mut scene = slab(json!([[0.0, 0.0], [2e-7, speed]]), 1.4e-7);
            scene["method"] = method.clone();
            scene["artificial_viscosity"] = json!({"linear": 0.2, "quadratic": 2.0});
            scene["domain"]["upper"] = json!([2e-3]);
            scene["bodies"][0]["pressure"] = json!(1e9);
            scene["boundary"]["x_upper"] = json!("transmitting");
            let outcome = run::<1>(&scene);
            let rows = outcome.column("velocity").iter().zip(outcome.column("pressure"));
            let far = rows.zip(outcome.column("x")).filter(|(_, x)| **x > 1.5e-3);
            let mut seen = 0;
            for ((v, p), _) in far {
                seen += 1;
                at_most(&format!("{method}: velocity"), v / 300.0, 1e-10);
                at_most(&format!("{method}: pressure"), p / 1e9 - 1.0, 1e-10);
            }
            assert!(seen > 40, "{seen}");
        }
    }
}

#[test]
fn one_velocity_is_a_course_that_does_not_change() {
    for method in [
        default_method(),
        json!({"shape": "cpdi", "transfer": "apic", "stress_update": "modified_last"}),
        json!({"shape": "bspline_quadratic", "transfer": "flip", "stress_update": "last"}),
    ] {
        let mut number = slab(json!(200.0), 2e-7);
        number["method"] = method;
        if let Some(method) = number["method"].as_object_mut() {
            method.remove("domain_limit");
        }
        number["artificial_viscosity"] = json!({"linear": 0.2, "quadratic": 2.0});
        let mut pairs = number.clone();
        pairs["boundary"]["x_lower"]["velocity"] = json!([[1e-7, 200.0], [2e-7, 200.0]]);
        let [a, b] = [number, pairs].map(|scene| run::<1>(&scene));
        for name in ["x", "pressure", "velocity"] {
            for (a, b) in a.column(name).iter().zip(b.column(name)) {
                at_most(name, (a - b) / a.abs().max(1e-6), 1e-9);
            }
        }
    }
}

fn order<const D: usize>(scene: &Value, coarse: f64) -> f64
where
    Stepper<D>: Compiled<D>,
{
    let error = |cell: f64| {
        let mut scene = scene.clone();
        scene["domain"]["cell_size"] = json!(cell);
        let scene = checked(&scene);
        let table = run::<D>(&serde_json::to_value(&scene.scene).unwrap()).table;
        let reference =
            flyer_mpm::accuracy::reference::ReferenceSolution::new(&scene).unwrap().unwrap();
        let (errors, _) = reference.score(&scene, 0, &table).unwrap();
        errors.l2.unwrap()
    };
    (error(coarse) / error(0.5 * coarse)).log2()
}

/// Second order in L2 of pressure, in time and in space, while a wave is smooth.
#[test]
fn a_simple_wave_is_of_second_order() {
    let mut scene = slab(ramp(100.0, 1.5e-7), 3e-7);
    scene["reference"] = json!({"simple_wave": {"body": "slab"}});
    let shapes = [("cpdi_bspline_quadratic", 0.1), ("cpdi", 0.3)];
    for (shape, rate) in shapes {
        scene["method"]["shape"] = json!(shape);
        scene["method"]["pressure_relaxation"]["rate"] = json!(rate);
        scene.as_object_mut().unwrap().remove("artificial_viscosity");
        let order_without = order::<1>(&scene, 2e-5);
        assert!(order_without >= 1.8, "{shape}: {order_without}");
        scene["artificial_viscosity"] = json!({
            "linear": 0.1, "quadratic": 1.25, "limiter": "christensen", "limited": "linear"
        });
        let order_with = order::<1>(&scene, 2e-5);
        assert!(order_with >= 1.8, "{shape} with viscosity: {order_with}");
    }
}

#[test]
fn any_layout_has_the_same_bits() {
    let mut scene = plate(ramp(400.0, 2e-8), 4e-8);
    scene["method"] = default_method();
    scene["boundary"]["x_upper"] = json!("transmitting");
    scene["bodies"][0]["box"]["upper"] = json!([6e-4, 4e-4]);
    scene["boundary"]["y_upper"] = json!({"velocity": [[0.0, 0.0], [5e-8, -200.0]]});
    same_bits(&scene);
}

#[test]
fn a_file_beside_the_scene_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.json");
    std::fs::write(&file, slab(json!("drive.csv"), 1e-8).to_string()).unwrap();
    std::fs::write(folder.path().join("drive.csv"), "time,pressure\n0,10\n1e-8,20\n").unwrap();
    let message = input::read(&file).unwrap_err().to_string();
    assert!(message.contains("drive.csv") && message.contains("time,velocity"), "{message}");
    std::fs::write(folder.path().join("drive.csv"), "time,velocity\n0,10\n1e-8,20\n").unwrap();
    let read = input::parse(&input::read(&file).unwrap(), "scene.json", &[]).unwrap();
    let points = vec![[0.0, 10.0], [1e-8, 20.0]];
    assert_eq!(read.sides::<1>()[0][0], Side::Velocity(Course::Series(points)));
}

#[test]
fn what_makes_no_piston_is_refused() {
    let message = |edit: &dyn Fn(&mut Value)| {
        let mut scene = slab(ramp(300.0, 1e-7), 1e-7);
        edit(&mut scene);
        match input::parse(scene.to_string().as_bytes(), "scene.json", &[]) {
            Ok(_) => panic!("it was taken: {scene}"),
            Err(error) => error.to_string(),
        }
    };
    let velocity =
        |v: Value| message(&|scene| scene["boundary"]["x_lower"]["velocity"] = v.clone());
    for (v, words) in [
        (json!([[1e-7, 0.0], [1e-7, 5.0]]), "boundary.x_lower.velocity[1]"),
        (json!("drive.csv"), "with the scene's own file alone"),
        (json!({"to": 5.0}), "boundary.x_lower"),
        (json!({"to": 5.0, "duration": 0.0}), "boundary.x_lower"),
        (json!([]), "boundary.x_lower"),
    ] {
        let message = velocity(v);
        assert!(message.contains(words), "{message}");
    }
    let opposite = message(&|scene| scene["boundary"]["x_upper"] = json!("wall"));
    assert!(opposite.contains("the grid travels with a piston"), "{opposite}");
    let wave = json!({"simple_wave": {"body": "slab"}});
    let fast = message(&|scene| {
        scene["reference"] = wave.clone();
        scene["bodies"][0]["velocity"] = json!([-10.0]);
    });
    assert!(fast.contains("which is a shock"), "{fast}");
    let still = message(&|scene| {
        scene["reference"] = wave.clone();
        scene["boundary"]["x_lower"] = json!("free");
    });
    assert!(still.contains("touches no piston"), "{still}");
    let steady = message(&|scene| {
        scene["reference"] = json!({"wall_impact": {"body": "slab"}});
        scene["bodies"][0]["velocity"] = json!([-10.0]);
    });
    assert!(steady.contains("whose velocity changes"), "{steady}");
}
