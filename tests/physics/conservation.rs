//! What is kept: momentum, energy, uniform motion, rest.

use serde_json::{Value, json};

use crate::tools::{SHAPES, apart, at_most, checked, column, greatest, run, run_scene};
use crate::tools::{short, transfers, with};

#[test]
fn any_number_of_particles_a_cell_keeps_energy() {
    for count in [1, 3, 4] {
        let mut value = short("flyer.json", 0.2e-6);
        for body in 0..2 {
            value["bodies"][body]["particles_per_cell"] = json!([count]);
        }
        let outcome = run(&value);
        at_most("energy", outcome.energy_drift(), 1e-12);
        at_most("momentum", outcome.momentum_drift(), 1e-12);
    }
}

#[test]
fn both_limiters_and_every_interval_keep_energy() {
    for edit in [
        json!({"artificial_viscosity": {"limiter": "nodal"}}),
        json!({"artificial_viscosity": {"limited": "both"}}),
        json!({"method": {"pressure_relaxation": {"rate": 0.2, "interval": 5}}}),
        json!({"method": {"edge_mask": 0.5}}),
        json!({"method": {"mass_lumping": 0.1}}),
        json!({"artificial_viscosity": null}),
    ] {
        let outcome = run(&with(&short("flyer.json", 0.2e-6), &edit));
        at_most(&format!("energy with {edit}"), outcome.energy_drift(), 1e-12);
        at_most(&format!("momentum with {edit}"), outcome.momentum_drift(), 1e-12);
    }
}

#[test]
fn walls_keep_energy() {
    for name in ["piston.json", "sod.json"] {
        let outcome = run(&crate::tools::shipped(name));
        at_most(&format!("energy of {name}"), outcome.energy_drift(), 1e-12);
    }
}

/// One gas under pressure, all through a joined domain, in uniform motion.
fn moving_gas(shape: &str, transfer: &Value, midpoint: bool) -> Value {
    let method = if midpoint {
        json!({"shape": shape, "transfer": transfer, "stepping": "midpoint"})
    } else {
        json!({"shape": shape, "transfer": transfer})
    };
    json!({
        "title": "Uniform motion",
        "domain": {"lower": [0.0], "upper": [0.3], "cell_size": 0.01},
        "time": {"end": 0.5},
        "method": method,
        "materials": {"gas": {"density": 1.2, "eos": {"type": "ideal_gas", "gamma": 1.4}}},
        "bodies": [{
            "name": "gas", "material": "gas", "box": {"lower": [0.0], "upper": [0.3]},
            "velocity": [1.3], "pressure": 1.0, "particles_per_cell": [2]
        }],
        "artificial_viscosity": {"linear": 0.2, "quadratic": 2.0},
        "boundary": {"x_lower": "periodic", "x_upper": "periodic"}
    })
}

#[test]
fn uniform_motion_round_a_joined_domain_lasts() {
    let mut faults = Vec::new();
    for shape in SHAPES {
        for transfer in transfers() {
            for midpoint in [false, true] {
                let value = moving_gas(shape, &transfer, midpoint);
                let outcome = match run_scene(&checked(&value), 1) {
                    Ok(outcome) => outcome,
                    Err(error) => {
                        faults.push(format!("{shape} {transfer} midpoint {midpoint}: {error}"));
                        continue;
                    }
                };
                let table = outcome.last();
                let spread = |name: &str, exact: f64| {
                    let off: Vec<f64> =
                        column(table, name).iter().map(|v| v / exact - 1.0).collect();
                    greatest(&off)
                };
                let (v, p) = (spread("velocity", 1.3), spread("pressure", 1.0));
                // hat functions kick a particle that passes into another cell
                if v.max(p) > 1e-9 {
                    faults
                        .push(format!("{shape} {transfer} midpoint {midpoint}: v {v:e}, p {p:e}"));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn nothing_moves_where_nothing_strikes() {
    for name in ["flyer.json", "flyer_uintah.json"] {
        for shape in SHAPES {
            for stress_update in ["last", "first", "modified_last"] {
                if name == "flyer.json" && stress_update != "last" {
                    continue;
                }
                let mut value = short(name, 2e-8);
                value["method"]["shape"] = json!(shape);
                value["method"]["stress_update"] = json!(stress_update);
                value["bodies"][0]["velocity"] = json!([0.0]);
                value.as_object_mut().unwrap().remove("reference");
                let outcome = run(&value);
                let table = outcome.last();
                for column_name in ["velocity", "pressure", "specific_internal_energy"] {
                    let most = greatest(column(table, column_name));
                    assert_eq!(most, 0.0, "{name} {shape} {column_name}");
                }
                assert_eq!(outcome.end.kinetic + outcome.end.internal, 0.0);
            }
        }
    }
}

/// A plate in free flight stays whole and without pressure.
#[test]
fn free_flight_makes_no_pressure() {
    for shape in SHAPES {
        for (name, bound) in [("flyer.json", 1e-9), ("flyer_uintah.json", 1e-9)] {
            let mut value = short(name, 2e-7);
            value["method"]["shape"] = json!(shape);
            value.as_object_mut().unwrap().remove("reference");
            value["bodies"].as_array_mut().unwrap().pop();
            value["materials"].as_object_mut().unwrap().remove("aluminium");
            let outcome = run(&value);
            let table = outcome.last();
            let exact = vec![1000.0; table.len()];
            at_most(&format!("{shape} velocity"), apart(column(table, "velocity"), &exact), bound);
            // against the bulk modulus
            let pressure = greatest(column(table, "pressure")) / (8930.0 * 3940.0 * 3940.0);
            at_most(&format!("{shape} pressure"), pressure, bound);
        }
    }
}

/// A block of copper that falls freely, off the lines of the grid.
fn falling(method: &Value) -> Value {
    json!({
        "title": "Free fall",
        "domain": {"lower": [-1.03e-4], "upper": [3.97e-4], "cell_size": 1e-5},
        "time": {"end": 5e-7},
        "method": method,
        "materials": {"copper": {"library": "copper"}},
        "bodies": [{"name": "block", "material": "copper",
            "box": {"lower": [0.0], "upper": [2e-4]}, "particles_per_cell": [2]}],
        "body_force": {"gravity": [1e8]}
    })
}

#[test]
fn a_block_in_free_fall_carries_no_stress() {
    for frame in ["updated_lagrangian", "total_lagrangian"] {
        for (order, mask) in [(2, 0.3), (4, 0.3), (8, 0.4), (8, 0.9)] {
            let method = json!({"preset": "default", "frame": frame, "transfer": {"fmpm": order},
                "edge_mask": mask});
            let outcome = run(&falling(&method));
            let pressure = greatest(column(outcome.last(), "pressure"));
            let (weight, stiffness) = (8930.0 * 1e8 * 2e-4, 8930.0 * 3940.0 * 3940.0);
            let limit = f64::max(1e-10 * weight, 1e-12 * stiffness);
            at_most(&format!("{frame}, FMPM({order}), mask {mask}: pressure"), pressure, limit);
            let v: Vec<f64> =
                column(outcome.last(), "velocity").iter().map(|v| v / 50.0 - 1.0).collect();
            at_most(&format!("{frame}, FMPM({order}), mask {mask}: speed"), greatest(&v), 1e-12);
        }
    }
}

#[test]
fn a_smoothed_impact_has_the_same_momentum() {
    let base = short("flyer.json", 2e-8);
    let sharp = run(&base);
    for cells in [1.0, 2.0] {
        let smooth = run(&with(&base, &json!({"impact_smoothing": cells})));
        let momentum = smooth.start.momentum[0] / sharp.start.momentum[0] - 1.0;
        at_most(&format!("{cells} cells: change of momentum"), momentum, 1e-13);
        let kinetic = 1.0 - smooth.start.kinetic / sharp.start.kinetic;
        assert!(kinetic > 1e-3 * cells, "{cells} cells: loss of kinetic energy {kinetic}");
        at_most("energy", smooth.energy_drift(), 1e-12);
    }
}
