//! What stands at the sides of the domain: outflow, free, wall and piston.

use serde_json::{Value, json};

use crate::tools::{
    Outcome, apart, at_most, checked, column, run, run_scene, scored, shipped, short, with,
};

/// A flyer that pushes the target's end out of the domain.
fn pushed_out(name: &str, side: &str) -> Value {
    let mut value = short(name, 0.25e-6);
    value["domain"]["upper"] = json!([0.00061]);
    value["bodies"][1]["box"]["upper"] = json!([0.0006]);
    value["boundary"] = json!({"x_upper": side});
    value
}

#[test]
fn an_outflow_books_what_leaves() {
    for name in ["flyer.json", "flyer_uintah.json"] {
        let outcome = run(&pushed_out(name, "outflow"));
        let (start, end, left) = (outcome.start, outcome.end, outcome.left);
        assert!(left.count > 10, "{} have left", left.count);
        assert_eq!(left.count as usize + outcome.last().len(), 220);
        at_most("mass", (end.mass + left.mass) / start.mass - 1.0, 1e-14);
        let momentum = (end.momentum[0] + left.momentum[0]) / start.momentum[0] - 1.0;
        at_most("momentum", momentum, 1e-12);
        if name == "flyer.json" {
            let gone = left.kinetic + left.internal;
            let energy = (end.kinetic + end.internal + gone) / (start.kinetic + start.internal);
            at_most("energy", energy - 1.0, 1e-12);
        }
    }
}

/// The grid travels with the piston; what leaves is booked as the scene sees it all the same.
#[test]
fn an_outflow_before_a_piston_is_booked_in_the_frame_of_the_scene() {
    const SPEED: f64 = 1000.0;
    let mut value = shipped("piston.json");
    value["boundary"] = json!({"x_lower": {"velocity": SPEED}, "x_upper": "outflow"});
    value["bodies"][0]["velocity"] = json!([0.0]);
    value["bodies"][0]["box"]["upper"] = json!([0.001]);
    value["domain"]["upper"] = json!([0.0012]);
    value["time"]["end"] = json!(0.9e-6);
    let Outcome { start, end, left, .. } = run(&value);
    assert!(left.count > 5, "{} have left", left.count);
    // faster than the piston, which has driven them out
    assert!(left.momentum[0] > SPEED * left.mass, "{left:?}");
    let impulse = end.momentum[0] + left.momentum[0] - start.momentum[0];
    let gained = end.kinetic + end.internal + left.kinetic + left.internal - start.internal;
    at_most("work of the piston", gained / (SPEED * impulse) - 1.0, 1e-12);
}

#[test]
fn a_particle_that_passes_a_free_side_is_named() {
    for name in ["flyer.json", "flyer_uintah.json"] {
        let error = run_scene(&checked(&pushed_out(name, "free")), 1).err().unwrap();
        let mut cut = pushed_out(name, "free");
        cut["domain"]["patches"] = json!([16]);
        assert_eq!(run_scene(&checked(&cut), 2).err().unwrap(), error);
        for part in ["particle 219 of body `target`", "x = 6.", "time ", "upper side"] {
            assert!(error.contains(part), "no `{part}` in: {error}");
        }
    }
}

/// A piston into a body at rest is a wall that the body runs into, seen from elsewhere.
#[test]
fn a_piston_is_a_wall_in_another_frame() {
    for edit in [json!({}), json!({"method": {"shape": "cpdi", "transfer": {"fmpm": 4}}})] {
        let wall = with(&shipped("piston.json"), &edit);
        let mut piston = wall.clone();
        piston["boundary"] = json!({"x_lower": {"velocity": 1000.0}});
        piston["bodies"][0]["velocity"] = json!([0.0]);
        let ((a, a_errors), (b, b_errors)) = (scored(&wall), scored(&piston));
        for (a, b) in a.tables.iter().zip(&b.tables) {
            let x: Vec<f64> = column(a, "x").iter().map(|x| x + 1000.0 * a.time).collect();
            let v: Vec<f64> = column(a, "velocity").iter().map(|v| v + 1000.0).collect();
            at_most("x", apart(&x, column(b, "x")), 1e-9);
            at_most("velocity", apart(&v, column(b, "velocity")), 1e-9);
            for name in ["pressure", "density", "specific_internal_energy"] {
                at_most(name, apart(column(a, name), column(b, name)), 1e-9);
            }
        }
        for e in a_errors.iter().chain(&b_errors) {
            at_most("plateau", e.plateau.unwrap(), 1e-3);
        }
    }
}

/// The upper side serves as the lower one does.
#[test]
fn a_wall_at_the_upper_side_is_the_mirror_image() {
    let lower = shipped("piston.json");
    let mut upper = lower.clone();
    upper["domain"]["lower"] = json!([-0.005]);
    upper["domain"]["upper"] = json!([0.0]);
    upper["bodies"][0]["box"] = json!({"lower": [-0.004], "upper": [0.0]});
    upper["bodies"][0]["velocity"] = json!([1000.0]);
    upper["boundary"] = json!({"x_upper": "wall"});
    let (a, b) = (run(&lower), run(&upper));
    for (a, b) in a.tables.iter().zip(&b.tables) {
        let turned = |name, sign: f64| -> Vec<f64> {
            column(b, name).iter().rev().map(|v| sign * v).collect()
        };
        at_most("x", apart(&turned("x", -1.0), column(a, "x")), 1e-9);
        at_most("velocity", apart(&turned("velocity", -1.0), column(a, "velocity")), 1e-9);
        at_most("pressure", apart(&turned("pressure", 1.0), column(a, "pressure")), 1e-9);
    }
}

/// Two plates that meet at half the speed each are one that meets a wall.
#[test]
fn a_plane_of_symmetry_is_half_of_a_symmetric_run() {
    let mut whole = shipped("piston.json");
    whole["domain"]["lower"] = json!([-0.005]);
    whole["boundary"] = json!({});
    whole.as_object_mut().unwrap().remove("reference");
    let mut twin = whole["bodies"][0].clone();
    twin["name"] = json!("twin");
    twin["box"] = json!({"lower": [-0.004], "upper": [0.0]});
    twin["velocity"] = json!([1000.0]);
    whole["bodies"].as_array_mut().unwrap().push(twin);
    let (half, whole) = (run(&shipped("piston.json")), run(&whole));
    for (half, whole) in half.tables.iter().zip(&whole.tables) {
        for name in ["x", "velocity", "pressure", "density", "specific_internal_energy"] {
            let upper = &column(whole, name)[half.len()..];
            at_most(name, apart(upper, column(half, name)), 1e-9);
        }
    }
}
