//! Profiles against exact solutions.

use serde_json::{Value, json};

use crate::tools::{at_most, column, run, scored, shipped, with};

/// Density \[kg/m3\], c0 \[m/s\], s \[-\], gamma0 \[-\] of a metal.
fn metal([density, c0, s, gamma0]: [f64; 4]) -> Value {
    json!({
        "density": density,
        "eos": {"type": "mie_gruneisen", "c0": c0, "s": s, "gamma0": gamma0}
    })
}

#[test]
fn the_flyer_holds_its_bounds() {
    let (outcome, errors) = scored(&shipped("flyer.json"));
    for (time, e) in ["0.5 us", "1 us"].iter().zip(&errors[1..]) {
        let holds = |what: &str, value: Option<f64>, bound| {
            at_most(&format!("{what} at {time}"), value.expect(what), bound);
        };
        holds("L1", e.l1, 0.01);
        holds("plateau", e.plateau, 5e-4);
        holds("noise", e.noise, 1e-3);
        holds("second plateau", e.second_plateau, 2e-3);
        holds("shock position", e.shock_position_cells, 0.2);
        holds("rise", e.rise_cells, 2.5);
        holds("overshoot", e.overshoot, 0.02);
    }
    at_most("energy drift", outcome.energy_drift(), 1e-12);
    at_most("momentum drift", outcome.momentum_drift(), 1e-12);
}

/// Zinc on polycarbonate at 2286 m/s: particles fill the space behind the shock at every Courant
/// number, so that the pressure there is right.
#[test]
fn relaxation_leaves_the_pressure_behind_a_shock() {
    for (frame, bound) in [("updated_lagrangian", 2e-4), ("total_lagrangian", 5e-5)] {
        for courant in [0.15, 0.4, 0.6] {
            let mut scene = with(
                &shipped("flyer.json"),
                &json!({
                    "domain": {"lower": [-0.001], "upper": [0.0025], "cell_size": 5e-6},
                    "time": {"end": 1.5e-7, "courant": courant},
                    "method": {"frame": frame},
                    "materials": {
                        "copper": metal([7138.0, 3005.0, 1.581, 1.96]),
                        "aluminium": metal([1193.0, 1933.0, 1.42, 0.61]),
                    },
                    "output": {"profiles": {"times": [1.5e-7]}, "histories": null}
                }),
            );
            scene["bodies"][0]["box"]["lower"] = json!([-0.0004]);
            scene["bodies"][0]["velocity"] = json!([2286.0]);
            scene["bodies"][1]["box"]["upper"] = json!([0.0016]);
            let plateau = scored(&scene).1[0].plateau.unwrap();
            at_most(&format!("{frame}, Courant {courant}: plateau"), plateau, bound);
        }
    }
}

#[test]
fn linear_cpdi_holds_its_bounds() {
    let method = json!({"method": {"shape": "cpdi", "transfer": {"fmpm": 4}}});
    let (outcome, errors) = scored(&with(&shipped("flyer.json"), &method));
    for e in &errors[1..] {
        at_most("L1", e.l1.unwrap(), 0.013);
    }
    at_most("energy drift", outcome.energy_drift(), 1e-12);
}

#[test]
fn the_error_falls_with_the_cells() {
    let last = |cell: f64| {
        let scene = with(&shipped("flyer.json"), &json!({"domain": {"cell_size": cell}}));
        scored(&scene).1.last().unwrap().l1.unwrap()
    };
    let order = (last(2e-5) / last(5e-6)).log(4.0);
    assert!(order >= 0.95, "order of convergence {order}");
}

#[test]
fn density_of_the_shock_tube() {
    let (outcome, errors) = scored(&shipped("sod.json"));
    at_most("L1 of density", errors[0].density_l1.unwrap(), 0.003);
    at_most("energy drift", outcome.energy_drift(), 1e-12);
}

#[test]
fn pressure_of_the_symmetric_impact() {
    let (outcome, errors) = scored(&shipped("symmetric_impact.json"));
    for (table, e) in outcome.tables.iter().zip(&errors) {
        at_most("plateau", e.plateau.unwrap(), 5e-4);
        at_most("shock position", e.shock_position_cells.unwrap(), 0.2);
        // the reference says the same as the jump conditions
        let (interface, shock) = (500.0 * table.time, 4684.5 * table.time);
        let inside: Vec<f64> = column(table, "x")
            .iter()
            .zip(column(table, "pressure"))
            .filter(|(x, _)| (**x - interface) / (shock - interface) > 0.3)
            .filter(|(x, _)| (**x - interface) / (shock - interface) < 0.7)
            .map(|(_, p)| *p)
            .collect();
        let mean = inside.iter().sum::<f64>() / inside.len() as f64;
        at_most("pressure against 20.916 GPa", mean / 20.916e9 - 1.0, 1e-3);
    }
}

#[test]
fn other_metals_and_speeds() {
    let nickel = metal([8874.0, 4602.0, 1.437, 1.93]);
    let tantalum = metal([16650.0, 3410.0, 1.20, 1.67]);
    for (flyer, speed, end) in [(nickel, 500.0, 1e-6), (tantalum, 2000.0, 0.8e-6)] {
        let mut scene = shipped("flyer.json");
        scene["materials"]["copper"] = flyer;
        scene["bodies"][0]["velocity"] = json!([speed]);
        scene["time"]["end"] = json!(end);
        scene["output"]["profiles"]["times"] = json!([0.5 * end, end]);
        let (outcome, errors) = scored(&scene);
        for e in &errors {
            at_most(&format!("E1 at {speed} m/s"), e.e1_cells.unwrap(), 2.5);
        }
        at_most("plateau", errors[0].plateau.unwrap(), 1e-3);
        at_most("noise", errors[0].noise.unwrap(), 2e-3);
        at_most("energy drift", outcome.energy_drift(), 1e-12);
    }
}

#[test]
fn plateau_before_a_wall() {
    let (_, errors) = scored(&shipped("piston.json"));
    for e in &errors {
        at_most("plateau", e.plateau.unwrap(), 5e-4);
        at_most("noise", e.noise.unwrap(), 1e-3);
        at_most("shock position", e.shock_position_cells.unwrap(), 0.3);
    }
}

#[test]
fn steep_and_ringing_with_the_documents_settings() {
    let (_, errors) = scored(&shipped("flyer_uintah.json"));
    for e in &errors[1..] {
        let l1 = e.l1.unwrap();
        assert!((0.03..0.18).contains(&l1), "L1 {l1}");
        assert!(e.overshoot.unwrap() > 0.1, "it rings");
        at_most("rise", e.rise_cells.unwrap(), 4.0);
    }
    let outcome = run(&shipped("flyer_defaults.json"));
    at_most("momentum drift", outcome.momentum_drift(), 1e-12);
}
