//! Spin of particles: angular momentum and energy of a disk, and scenes without spin.

use flyer_mpm::input;
use serde_json::{Value, json};

use crate::tools::run;

/// A rubber disk of five cells' radius, a tenth of a turn.
fn disk(method: Value) -> Value {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/inputs/spinning_disk.json");
    let mut scene: Value = serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap();
    scene["domain"]["cell_size"] = json!(0.1);
    scene["time"]["end"] = json!(2.7);
    scene["output"] = json!({});
    scene.as_object_mut().unwrap().remove("reference");
    scene["method"] = json!({"shape": "cpdi_bspline_quadratic", "stepping": "midpoint",
        "energy": "compatible", "filter_heat": true});
    for (key, value) in method.as_object().unwrap() {
        scene["method"][key] = value.clone();
    }
    scene
}

/// Relative losses of angular momentum from the first to the last table, and of energy.
fn losses(scene: &Value) -> [f64; 2] {
    let moment = |at_end: bool| {
        let mut scene = scene.clone();
        if !at_end {
            scene["time"]["end"] = json!(1e-9);
        }
        let outcome = run::<2>(&scene);
        let column = |name: &str| outcome.table.column(name).map(|values| values.to_vec());
        let get = |name: &str| column(name).unwrap();
        let (x, y) = (get("x"), get("y"));
        let (u, v) = (get("velocity_x"), get("velocity_y"));
        let mass: Vec<f64> =
            get("density").iter().zip(get("volume")).map(|(rho, volume)| rho * volume).collect();
        let spin = column("spin").unwrap_or(vec![0.0; x.len()]);
        let sum: f64 = (0..x.len()).map(|r| mass[r] * (x[r] * v[r] - y[r] * u[r] + spin[r])).sum();
        (sum, outcome.energy_drift())
    };
    let (start, (end, drift)) = (moment(false).0, moment(true));
    [1.0 - end / start, drift]
}

#[test]
fn a_spinning_disk_keeps_its_angular_momentum_and_energy() {
    for (order, lumping) in [(2, None), (4, None), (7, None), (4, Some(0.2))] {
        let method = json!({"transfer": {"fmpm": order}, "spin": true, "mass_lumping": lumping});
        let [moment, energy] = losses(&disk(method));
        let what = format!("{order} {lumping:?}: {moment:e} {energy:e}");
        assert!(moment.abs() < 1e-12 && energy.abs() < 1e-13, "{what}");
    }
    let [moment, energy] = losses(&disk(json!({"transfer": {"fmpm": 4}})));
    assert!(moment > 0.02 && energy.abs() < 1e-13, "without: {moment:e} {energy:e}");
}

/// A block that strikes a wall aslant, normal to x or y.
fn block_at_a_wall(side: &str, kind: Value) -> Value {
    let axis = usize::from(side.starts_with('y'));
    let turned = |along: f64, away: f64| if axis == 0 { [away, along] } else { [along, away] };
    json!({
        "title": "a block strikes a wall",
        "domain": {"lower": turned(-0.1, 0.0), "upper": turned(0.1, 0.1), "cell_size": 0.01},
        "time": {"end": 3e-3},
        "method": {
            "shape": "cpdi_bspline_quadratic", "transfer": {"fmpm": 4}, "stepping": "midpoint",
            "energy": "compatible", "filter_heat": true, "spin": true
        },
        "materials": {"rubber": {"density": 1000.0, "eos": {"type": "neo_hookean",
            "youngs_modulus": 1e6, "poissons_ratio": 0.3}}},
        "bodies": [{
            "name": "block", "material": "rubber", "particles_per_cell": [2, 2],
            "box": {"lower": turned(-0.03, 0.0), "upper": turned(0.03, 0.04)},
            "velocity": turned(0.3, -1.0)
        }],
        "boundary": {side: kind}
    })
}

#[test]
fn a_block_with_spin_keeps_its_energy_at_walls() {
    for side in ["x_lower", "y_lower"] {
        for kind in ["symmetry", "no_slip"] {
            let drift = run::<2>(&block_at_a_wall(side, json!(kind))).energy_drift();
            assert!(drift.abs() < 1e-13, "{side} {kind}: {drift:e}");
        }
    }
}

#[test]
fn schemes_that_cannot_have_spin_are_refused() {
    let cases = [
        (json!({"transfer": {"xpic": 3}}), "method.transfer"),
        (json!({"transfer": {"fmpm": 3}, "shape": "linear"}), "method.shape"),
        (json!({"transfer": {"fmpm": 3}, "frame": "total_lagrangian"}), "method.frame"),
        (
            json!({"transfer": {"fmpm": 3}, "stepping": "leapfrog", "energy": "textbook",
                "filter_heat": false}),
            "method.stepping",
        ),
    ];
    for (mut method, other) in cases {
        method["spin"] = json!(true);
        let scene = disk(method);
        let error = input::parse(scene.to_string().as_bytes(), "scene.json", &[]).unwrap_err();
        let text = error.to_string();
        assert!(text.contains("method.spin") && text.contains(other), "{text}");
    }
}
