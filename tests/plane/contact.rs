//! Bodies with velocity fields of their own in a plane.

use decomp::Serial;
use flyer_mpm::simulation::Simulation;
use serde_json::{Value, json};

use crate::tools::{Outcome, checked, default_method, impact, metals, run};

/// Momentum of each body at the end [kg m/s per m].
fn momenta(outcome: &Outcome<2>) -> [[f64; 2]; 2] {
    let [rho, volume, x, y] =
        ["density", "volume", "velocity_x", "velocity_y"].map(|n| outcome.column(n));
    let mut sums = [[0.0; 2]; 2];
    for (r, &body) in outcome.table.body.iter().enumerate() {
        let mass = rho[r] * volume[r];
        sums[body as usize][0] += mass * x[r];
        sums[body as usize][1] += mass * y[r];
    }
    sums
}

#[track_caller]
fn keeps(outcome: &Outcome<2>) {
    assert!(outcome.energy_drift().abs() < 1e-11, "{:e}", outcome.energy_drift());
    let [start, end] = outcome.totals;
    for a in 0..2 {
        let drift = (end.momentum[a] - start.momentum[a]) / start.absolute_momentum;
        assert!(drift.abs() < 1e-12, "{drift:e}");
    }
}

/// Two blocks of 0.5 mm of aluminium at `pressure` between walls, the upper one at `speed`.
fn blocks(contact: Value, transfer: Value, speed: f64, pressure: f64) -> Value {
    let block = |name: &str, y: f64, v: f64| {
        json!({
            "name": name, "material": "aluminium", "velocity": [v, 0.0], "pressure": pressure,
            "box": {"lower": [0.0, y], "upper": [5e-4, y + 5e-4]}, "particles_per_cell": [2, 2]
        })
    };
    json!({
        "title": "a block slides on a block",
        "domain": {"lower": [0.0, 0.0], "upper": [5e-4, 1e-3], "cell_size": 5e-5},
        "time": {"end": 1e-7},
        "method": {
            "shape": "cpdi_bspline_quadratic", "transfer": transfer, "stepping": "midpoint",
            "energy": "compatible", "filter_heat": transfer != "flip"
        },
        "materials": {"aluminium": metals()["aluminium"]},
        "bodies": [block("lower", 0.0, 0.0), block("upper", 5e-4, speed)],
        "boundary": {
            "x_lower": "periodic", "x_upper": "periodic", "y_lower": "wall", "y_upper": "wall"
        },
        "contact": contact
    })
}

#[test]
fn without_friction_a_block_slides_on() {
    let scene = blocks(json!({"type": "frictionless"}), json!({"fmpm": 4}), 100.0, 1e9);
    let outcome = run::<2>(&scene);
    for (v, body) in outcome.column("velocity_x").iter().zip(&outcome.table.body) {
        assert!((v - 100.0 * f64::from(*body)).abs() < 1e-6, "{v}");
    }
}

#[test]
fn coulombs_friction_slows_a_block() {
    for (coefficient, speed, bound) in [(0.1, 200.0, 0.03), (0.3, 500.0, 0.05)] {
        let contact = json!({"type": "friction", "coefficient": coefficient});
        for transfer in [json!("pic"), json!("flip")] {
            let outcome = run::<2>(&blocks(contact.clone(), transfer.clone(), speed, 1e9));
            assert!(outcome.energy_drift().abs() < 1e-11, "{:e}", outcome.energy_drift());
            // mu p A t
            let exact = coefficient * 1e9 * 5e-4 * 1e-7;
            let given = momenta(&outcome)[0][0];
            assert!((given / exact - 1.0).abs() < bound, "{transfer}: {given:e} of {exact:e}");
        }
    }
}

#[test]
fn the_reported_force_is_that_of_pressure_and_friction() {
    let friction = json!({"type": "friction", "coefficient": 0.1});
    for (sides, contact, speed, share) in
        [("periodic", friction, 200.0, 0.1), ("wall", json!({"type": "frictionless"}), 0.0, 0.0)]
    {
        let mut scene = blocks(contact, json!("pic"), speed, 1e9);
        scene["boundary"]["x_lower"] = json!(sides);
        scene["boundary"]["x_upper"] = json!(sides);
        let scene = checked(&scene);
        let mut simulation = Simulation::<2>::new(&scene, &Serial, 1).unwrap();
        for _ in 0..5 {
            simulation.advance(scene.scene.time.end).unwrap();
        }
        let [normal, across] = simulation.contact_force();
        assert!((normal / (1e9 * 5e-4) - 1.0).abs() < 0.03, "{sides}: {normal:e}");
        assert!((across / normal - share).abs() < 0.01, "{sides}: {across:e} of {normal:e}");
    }
}

#[test]
fn below_the_threshold_blocks_stick() {
    // the layers in contact share their velocity, so that no more than the first slip is lost
    let slip = |coefficient: f64| {
        let contact = json!({"type": "friction", "coefficient": coefficient});
        let outcome = run::<2>(&blocks(contact, json!({"fmpm": 2}), 10.0, 1e9));
        let y = outcome.column("y");
        let mean = |lower: f64, upper: f64| {
            let rows = (0..y.len()).filter(|&r| y[r] > lower && y[r] < upper);
            let v: Vec<f64> = rows.map(|r| outcome.column("velocity_x")[r]).collect();
            v.iter().sum::<f64>() / v.len() as f64
        };
        mean(5e-4, 5.25e-4) - mean(4.75e-4, 5e-4)
    };
    let (held, slides) = (slip(5.0), slip(1e-3));
    assert!(held.abs() < 2.5 && slides > 8.0, "{held} {slides}");
}

/// A square turned by an angle strikes a plate.
fn oblique(contact: Value) -> Value {
    let square = json!({"box": {"lower": [-0.0004, -0.0002], "upper": [-0.00001, 0.0002]}});
    let turned = json!({"rotation": {"angle": 25.0, "about": [0.0, 0.0], "of": square}});
    let plate = json!({"box": {"lower": [0.0, -0.0004], "upper": [0.0004, 0.0004]}});
    let plate = json!({"rotation": {"angle": 25.0, "about": [0.0, 0.0], "of": plate}});
    let mut scene = impact([[-0.001, -0.001], [0.001, 0.001]], [turned, plate], [0.0, 0.0]);
    scene["method"] = default_method();
    let (c, s) = (25.0f64.to_radians().cos(), 25.0f64.to_radians().sin());
    scene["bodies"][0]["velocity"] = json!([500.0 * c, 500.0 * s]);
    scene["contact"] = contact;
    scene["time"]["end"] = json!(6e-8);
    scene
}

#[test]
fn oblique_bodies_meet_when_their_edges_do() {
    for normals in ["volume_gradient", "logistic_regression"] {
        let contact = json!({"type": "frictionless", "normals": normals});
        // 10 um at 500 m/s are 20 ns; particles at a border at an angle are squares, which stick
        // out of it, so that bodies meet up to a quarter of a cell early
        let mut early = oblique(contact.clone());
        early["time"]["end"] = json!(8e-9);
        let outcome = run::<2>(&early);
        assert!(outcome.column("pressure").iter().all(|p| p.abs() < 1e6), "{normals}");
        let outcome = run::<2>(&oblique(contact));
        keeps(&outcome);
        let most = outcome.column("pressure").iter().copied().fold(0.0, f64::max);
        assert!(most > 2e9, "{normals}: {most:e}");
        // what each gives the other is along the normal, but for the corners' part
        let [_, plate] = momenta(&outcome);
        let across = plate[1] * 25.0f64.to_radians().cos() - plate[0] * 25.0f64.to_radians().sin();
        assert!(across.abs() < 0.05 * plate[0].hypot(plate[1]), "{normals}: {plate:?}");
    }
}

#[test]
fn friction_between_oblique_bodies_keeps_energy_and_momentum() {
    let contact = json!({
        "type": "friction", "coefficient": 0.3, "normals": "logistic_regression"
    });
    let mut scene = oblique(contact);
    scene["bodies"][1]["velocity"] = json!([100.0, -300.0]);
    keeps(&run::<2>(&scene));
    // three bodies about one place
    scene["bodies"][0].as_object_mut().unwrap().remove("rotation");
    scene["bodies"][1].as_object_mut().unwrap().remove("rotation");
    scene["bodies"][0]["box"] = json!({"lower": [-0.0004, -0.0002], "upper": [0.0, 0.0002]});
    scene["bodies"][1]["box"] = json!({"lower": [0.0, 0.0], "upper": [0.0004, 0.0004]});
    let mut third = scene["bodies"][1].clone();
    third["name"] = json!("third");
    third["velocity"] = json!([-50.0, 100.0]);
    third["box"] = json!({"lower": [0.0, -0.0004], "upper": [0.0004, 0.0]});
    scene["bodies"].as_array_mut().unwrap().push(third);
    keeps(&run::<2>(&scene));
}

/// A disk strikes one along their axis and comes off it, in metres and in other units of length: what
/// says whether two bodies touch, or whether a node holds anything, adds and compares like with
/// like, so that bits are the same.
#[test]
fn in_other_units_of_length_disks_meet_and_part_alike() {
    let scene = |unit: f64| {
        let corner = |x: f64, y: f64| json!([x * unit, y * unit]);
        let disk = |name: &str, material: &str, y: [f64; 2], speed: f64| {
            json!({
                "name": name, "material": material, "velocity": corner(0.0, speed),
                "particles_per_cell": [2, 2],
                "box": {"lower": corner(0.0, y[0]), "upper": corner(4e-4, y[1])}
            })
        };
        let mut materials = metals();
        for material in materials.as_object_mut().unwrap().values_mut() {
            let [rho, c0] = [&material["density"], &material["eos"]["c0"]];
            let [rho, c0] = [rho, c0].map(|v| v.as_f64().unwrap());
            material["density"] = json!(rho / unit.powi(3));
            material["eos"]["c0"] = json!(c0 * unit);
        }
        json!({
            "title": "two disks",
            "domain": {
                "lower": [0.0, 0.0], "upper": corner(8e-4, 8e-4), "cell_size": 4e-5 * unit,
                "geometry": "axisymmetric"
            },
            "time": {"end": 2e-7},
            "method": default_method(),
            "materials": materials,
            "bodies": [
                disk("flyer", "aluminium", [1e-4, 3e-4], 500.0),
                disk("target", "copper", [3e-4, 7e-4], 0.0)
            ],
            "boundary": {"x_lower": "symmetry"},
            "artificial_viscosity": {"linear": 0.1, "quadratic": 0.75, "limiter": "nodal"},
            "contact": {"type": "frictionless"}
        })
    };
    let metres = run::<2>(&scene(1.0));
    for unit in [2f64.powi(20), 2f64.powi(-20)] {
        let others = run::<2>(&scene(unit));
        for (name, factor) in [
            ("x", unit),
            ("y", unit),
            ("velocity_x", unit),
            ("velocity_y", unit),
            ("pressure", 1.0 / unit),
        ] {
            for (row, (a, b)) in metres.column(name).iter().zip(others.column(name)).enumerate() {
                let a = a * factor;
                assert!(a.to_bits() == b.to_bits(), "{name} of row {row} is {b:e}, not {a:e}");
            }
        }
    }
    // the flyer has been stopped, and falls behind
    let mean = |body: u32| {
        let pairs = metres.column("velocity_y").iter().zip(&metres.table.body);
        let of: Vec<f64> = pairs.filter(|(_, b)| **b == body).map(|(v, _)| *v).collect();
        of.iter().sum::<f64>() / of.len() as f64
    };
    assert!(mean(0) < 0.9 * mean(1), "{} {}", mean(0), mean(1));
}
