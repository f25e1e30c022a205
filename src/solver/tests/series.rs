//! Series with the mass matrix: filtered velocity, acceleration, and the velocity that works.
//!
//! One particle of mass m between two nodes has N = (3/4, 1/4), so that A = m^-1 M maps a nodal
//! vector to its mean at the particle, on both nodes, and K = 1 - A leaves the rest: K K = K.

use serde_json::{Value, json};

use super::fixture::{Fixture, close, solve};

/// Solves a step of 1/2 s from the velocities 1, 5 m/s and accelerations 2, -2 m/s2 on the nodes 3
/// and 4: means 2 m/s and 1 m/s2.
fn solved(method: Value) -> Fixture<1> {
    solved_with(json!({"method": method}), [2.0, -2.0])
}

/// The same of a scene with other keys, from other accelerations of the nodes 3 and 4.
fn solved_with(scene: Value, acceleration: [f64; 2]) -> Fixture<1> {
    let mut f = Fixture::<1>::new(scene);
    f.set("position", &[3.25, 6.5]);
    f.nodal(0.5, |s, step, nodal| {
        nodal.each("start", |patch| {
            s.scatter(patch, true, step);
            for (field, values) in
                [(s.fields.lumped_velocity, [1.0, 5.0]), (s.fields.acceleration, acceleration)]
            {
                for (node, value) in [3, 4].into_iter().zip(values) {
                    let at = patch.nodes.nodes.flat([node]);
                    patch.nodes.fields[field][at] = value;
                }
            }
            s.start_series(patch);
        });
        solve(s, step, nodal);
    });
    f
}

#[test]
fn velocities_of_a_step() {
    for (transfer, velocity, end) in [
        (json!("flip"), [1.0, 5.0], [2.0, 4.0]),
        // v = vL + K vL, b = f/m
        (json!({"xpic": 2}), [1.0 - 1.0, 5.0 + 3.0], [1.0, 7.0]),
        // v = vL + 2 K vL
        (json!({"xpic": 3}), [1.0 - 2.0, 5.0 + 6.0], [0.0, 10.0]),
        // b = f/m + K f/m = (2 + 1, -2 - 3)
        (json!({"fmpm": 2}), [0.0, 8.0], [0.0 + 1.5, 8.0 - 2.5]),
    ] {
        let f = solved(json!({"transfer": transfer}));
        close(&f.line("velocity", 3..=4), &velocity);
        close(&f.line("velocity_star", 3..=4), &end);
    }
    // the last term of the series, K^2 vL
    close(&solved(json!({"transfer": {"xpic": 3}})).line("filter_residual", 3..=4), &[-1.0, 3.0]);
}

#[test]
fn the_velocity_that_works() {
    let of = |transfer: Value| {
        let method = json!({"transfer": transfer, "stepping": "midpoint", "energy": "compatible"});
        solved(method).line("work", 3..=4)
    };
    // (vL + A v')/2 with A v' = 3/4 + 7/4
    close(&of(json!({"xpic": 2})), &[(1.0 + 2.5) / 2.0, (5.0 + 2.5) / 2.0]);
    // w0 + K w0 = 2 w0 - A w0 with w0 = (1.75, 3.75), as A v' = 2.5 here too
    close(&of(json!({"fmpm": 2})), &[3.5 - 2.25, 7.5 - 2.25]);
    // a vL + A ((1 - a) vL + dt b/2) = vL/4 + (1.5 + 0.25)
    close(&of(json!({"flip_pic": 0.25})), &[0.25 + 1.75, 1.25 + 1.75]);
}

#[test]
fn a_partly_lumped_mass_matrix() {
    let method = json!({"transfer": {"fmpm": 3}, "stepping": "midpoint", "energy": "compatible",
        "mass_lumping": 0.25});
    let f = solved(method);
    // vL + 2 K vL, and f/m + (a + a^2) K f/m with a = 3/4
    close(&f.line("velocity", 3..=4), &[-1.0, 11.0]);
    close(&f.line("acceleration", 3..=4), &[2.0 + 1.3125, -2.0 - 3.9375]);
    // w0 = (1.75, 3.75), as A v' = 2.5 here too
    close(&f.line("work", 3..=4), &[1.75 - 1.3125 / 2.0, 3.75 + 1.3125 * 1.5]);
}

#[test]
fn the_edge_mask_leaves_nodes_with_little_material_out_of_the_force() {
    let method = json!({"transfer": {"fmpm": 2}, "stepping": "midpoint", "edge_mask": 0.3});
    let f = solved(method);
    // node 4 is filled by 1/4: K chi f/m = (2, 0) - 3/2; the velocity has no mask
    close(&f.line("velocity", 3..=4), &[0.0, 8.0]);
    close(&f.line("acceleration", 3..=4), &[2.0 + 0.5, -2.0 - 1.5]);
}

#[test]
fn the_edge_mask_of_the_work() {
    let method = json!({"transfer": {"fmpm": 2}, "stepping": "midpoint", "edge_mask": 0.3,
        "energy": "compatible"});
    let f = solved(method);
    // v' = (1.25, 6.25), A v' = 2.5, w0 = (1.75, 3.75): only node 3 gets K w0 = 1.75 - 2.25
    close(&f.line("work", 3..=4), &[1.75 - 0.5, 3.75]);
}

/// Accelerations and velocities of the work of a step of a scene with a body force, whose edge mask
/// acts on pairs, with a share `lumping` of the lumped mass. It removes node 4, which is filled by
/// 1/4.
fn masked_pairs(acceleration: [f64; 2], lumping: Option<f64>) -> [Vec<f64>; 2] {
    let method = json!({"transfer": {"fmpm": 3}, "stepping": "midpoint", "edge_mask": 0.3,
        "energy": "compatible", "mass_lumping": lumping});
    let scene = json!({"method": method, "body_force": {"gravity": [1.0]}});
    let f = solved_with(scene, acceleration);
    [f.line("acceleration", 3..=4), f.line("work", 3..=4)]
}

#[test]
fn with_a_body_force_the_edge_mask_leaves_pairs_of_nodes_out() {
    // the only pair of nodes is left out, and f/m stays; w0 = (vL + A v')/2 likewise
    let [acceleration, work] = masked_pairs([2.0, -2.0], None);
    close(&acceleration, &[2.0, -2.0]);
    // the velocity has no mask: vL + 2 K vL = (-1, 11), v' = (0, 10), A v' = 2.5
    close(&work, &[1.75, 3.75]);
}

#[test]
fn with_a_body_force_a_uniform_acceleration_stays_uniform() {
    for lumping in [None, Some(0.25)] {
        let [acceleration, _] = masked_pairs([7.0, 7.0], lumping);
        close(&acceleration, &[7.0, 7.0]);
    }
}
