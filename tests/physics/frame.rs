//! The total-Lagrangian frame: exact solutions, what is kept to rounding, what it refuses.

use serde_json::{Value, json};

use crate::tools::{
    SHAPES, apart, at_most, checked, column, run, run_scene, scored, shipped, short, transfers,
    with,
};

/// `base` in the frame.
fn total(base: &Value) -> Value {
    with(base, &json!({"method": {"frame": "total_lagrangian"}}))
}

/// The standard problem with a scheme of the frame.
fn standard(shape: &str, order: u32, viscosity: [f64; 2]) -> Value {
    let edit = json!({
        "method": {"shape": shape, "transfer": {"fmpm": order}, "pressure_relaxation": null},
        "artificial_viscosity": {
            "linear": viscosity[0], "quadratic": viscosity[1], "growth": null
        }
    });
    with(&total(&shipped("flyer.json")), &edit)
}

#[test]
fn the_standard_problem() {
    for (scene, l1, overshoot) in [
        (standard("bspline_quadratic", 12, [0.06, 0.75]), [0.0073, 0.0069], 0.02),
        (standard("cpdi_bspline_quadratic", 8, [0.06, 0.75]), [0.0076, 0.0072], 0.015),
    ] {
        let (outcome, errors) = scored(&scene);
        let what = scene["method"].to_string();
        for (error, bound) in errors.iter().skip(1).zip(l1) {
            at_most(&format!("L1 of {what}"), error.l1.unwrap(), bound);
            at_most("plateau", error.plateau.unwrap(), 5e-5);
            at_most("noise", error.noise.unwrap(), 3e-4);
            at_most("shock", error.shock_position_cells.unwrap(), 0.1);
            at_most("overshoot", error.overshoot.unwrap(), overshoot);
        }
        at_most("energy", outcome.energy_drift(), 1e-12);
        at_most("momentum", outcome.momentum_drift(), 1e-12);
    }
}

#[test]
fn one_particle_a_cell_on_half_the_cells() {
    let edit = json!({"domain": {"cell_size": 5e-6}});
    let mut scene = with(&standard("cpdi_bspline_quadratic", 7, [0.04, 0.5]), &edit);
    for body in 0..2 {
        scene["bodies"][body]["particles_per_cell"] = json!([1]);
    }
    let (_, errors) = scored(&scene);
    at_most("L1", errors[1].l1.unwrap(), 0.0043);
    at_most("L1", errors[2].l1.unwrap(), 0.0040);
}

#[test]
fn a_moving_observer_sees_the_same_to_rounding() {
    for method in [json!({}), json!({"shape": "bspline_cubic", "transfer": {"fmpm": 4}})] {
        let base = with(&total(&short("flyer.json", 0.3e-6)), &json!({"method": method}));
        let there = run(&base);
        for speed in [137.0, -5000.0] {
            let mut moved = base.clone();
            for body in 0..2 {
                let v = moved["bodies"][body]["velocity"][0].as_f64().unwrap();
                moved["bodies"][body]["velocity"] = json!([v + speed]);
            }
            // it passes the sides of the domain, which bound nothing
            let seen = run(&moved);
            for name in ["pressure", "density", "specific_internal_energy"] {
                let what = format!("{name} with {speed} m/s");
                at_most(&what, apart(column(seen.last(), name), column(there.last(), name)), 1e-8);
            }
            let back: Vec<f64> =
                column(seen.last(), "x").iter().map(|x| x - speed * 0.3e-6).collect();
            at_most("x", apart(&back, column(there.last(), "x")), 1e-10);
        }
    }
}

#[test]
fn every_scheme_keeps_energy_and_momentum() {
    for shape in SHAPES {
        for transfer in transfers() {
            let mut scene = total(&short("flyer.json", 1e-7));
            let plain = transfer == "apic";
            scene["method"]["shape"] = json!(shape);
            scene["method"]["transfer"] = transfer.clone();
            scene["method"]["filter_heat"] = json!(!plain && transfer != "flip");
            scene["method"]["energy"] = json!(if plain { "textbook" } else { "compatible" });
            if transfer.get("fmpm").is_none() {
                scene["method"].as_object_mut().unwrap().remove("edge_mask");
            }
            let outcome = run(&scene);
            let what = format!("{shape} {transfer}");
            at_most(&format!("momentum of {what}"), outcome.momentum_drift(), 1e-12);
            if !plain {
                at_most(&format!("energy of {what}"), outcome.energy_drift(), 1e-12);
            }
        }
    }
}

/// A side that the material touches at the start stays its wall; contact with another side later is
/// reported.
#[test]
fn walls_are_those_that_bodies_touch() {
    let (outcome, errors) = scored(&total(&shipped("piston.json")));
    for error in errors {
        at_most("L1 of the piston", error.l1.unwrap(), 0.005);
    }
    let work = outcome.start.kinetic + outcome.start.internal;
    at_most("energy", (outcome.end.kinetic + outcome.end.internal) / work - 1.0, 1e-10);
    let mut apart = total(&short("flyer.json", 0.3e-6));
    apart["boundary"] = json!({"x_lower": "wall", "x_upper": "free"});
    apart.as_object_mut().unwrap().remove("reference");
    for body in 0..2 {
        apart["bodies"][body]["velocity"] = json!([-5000.0]);
    }
    let message = run_scene(&checked(&apart), 1).err().expect("it runs into the wall");
    assert!(message.contains("did not touch at the start"), "{message}");
}

#[test]
fn a_strong_shock_in_a_cold_gas() {
    let outcome = run(&total(&shipped("noh_planar.json")));
    let table = outcome.last();
    let (x, density) = (column(table, "x"), column(table, "density"));
    let inner: Vec<f64> = x
        .iter()
        .zip(density)
        .filter(|(x, _)| (0.05..0.16).contains(&x.abs()))
        .map(|(_, &d)| d)
        .collect();
    let mean = inner.iter().sum::<f64>() / inner.len() as f64;
    at_most("mean density", mean / 4.0 - 1.0, 0.002);
    at_most("energy", outcome.energy_drift(), 1e-10);
}

#[test]
fn patches_at_rest_change_nothing() {
    let scene = total(&short("flyer.json", 0.2e-6));
    let of = |skip: bool| {
        let edit = json!({"domain": {"patches": [16]}, "decomposition": {"skip_quiescent": skip}});
        run(&with(&scene, &edit)).digest
    };
    assert_eq!(of(true), of(false));
    assert_ne!(of(true), run(&short("flyer.json", 0.2e-6)).digest);
}
