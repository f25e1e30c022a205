//! Whole steps of two particles of 2 kg and 1 m on a line, p = 200 Pa (1/J - 1): the order of their
//! kernels.

use serde_json::{Value, json};

use super::fixture::{Fixture, close};

/// Particles with J = 0.8 and 1, pressures 50 and 0 Pa, after a step of 0.1 s.
fn step(method: Value, velocity: [f64; 2], gradient: f64) -> Fixture<1> {
    let mut f = Fixture::new(json!({"method": method}));
    f.set("jacobian", &[0.8, 1.0]).set("pressure", &[50.0, 0.0]).set("velocity", &velocity);
    f.set("velocity_gradient", &[gradient; 2]).advance(0.1);
    f
}

#[test]
fn stress_last() {
    let f = step(json!({"transfer": "flip"}), [0.0; 2], 0.0);
    // S = 40 J: forces (-40, 40, 0) N on 1, 2, 1 kg; v' = (-4, 2, 0)
    close(&f.get("velocity"), &[-1.0, 1.0]);
    close(&f.get("position"), &[3.4, 4.6]);
    close(&f.get("jacobian"), &[0.8 * (1.0 + 0.1 * 6.0), 1.0 - 0.1 * 2.0]);
    close(&f.get("pressure"), &[200.0 * (1.0 / 1.28 - 1.0), 50.0]);
    // -(p + p')/2 dV/m
    let energy = [-0.5 * (50.0 - 43.75) * 0.48 / 2.0, 0.5 * 50.0 * 0.2 / 2.0];
    close(&f.get("specific_internal_energy"), &energy);
}

#[test]
fn stress_first() {
    let f = step(json!({"transfer": "flip", "stress_update": "first"}), [1.0, -1.0], 0.0);
    // from the velocities (1, 0, -1): J = 0.72 and 0.9, S = 200 (1 - J) = 56 and 20 J;
    // accelerations (-56, 18, 20), v' = (-4.6, 1.8, 1)
    close(&f.get("jacobian"), &[0.72, 0.9]);
    close(&f.get("velocity"), &[1.0 - 1.9, -1.0 + 1.9]);
    close(&f.get("position"), &[3.5 - 0.14, 4.5 + 0.14]);
}

#[test]
fn stress_modified_last() {
    let method = json!({"transfer": "flip", "stress_update": "modified_last"});
    let mut f = Fixture::<1>::new(json!({"method": method}));
    f.set("jacobian", &[0.8, 1.0]).set("pressure", &[50.0, 0.0]).set("mass", &[4.0, 4.0]);
    f.advance(0.1);
    // as stress last on 2, 4 and 2 kg, but strained by the particle velocities on the grid,
    // (-1/2, 0, 1/2)
    close(&f.get("velocity"), &[-0.5, 0.5]);
    close(&f.get("jacobian"), &[0.8 * 1.05, 1.05]);
}

#[test]
fn stress_at_the_middle() {
    let f = step(json!({"transfer": "flip", "stepping": "midpoint"}), [1.0, -1.0], -1.0);
    // at 3.55 and 4.45 m with J = 0.76 and 0.95: S = 200 (1 - J) = 48 and 10 J on masses 0.9, 2.2
    // and 0.9 kg with the velocities (1, 0, -1)
    let gained = [-4.8 / 0.9, 3.8 / 2.2, 1.0 / 0.9];
    let end = [1.0 + gained[0], gained[1], -1.0 + gained[2]];
    let change = [0.45 * gained[0] + 0.55 * gained[1], 0.55 * gained[1] + 0.45 * gained[2]];
    close(&f.get("velocity"), &[1.0 + change[0], -1.0 + change[1]]);
    let mean = [0.5 * (1.0 + end[0]), 0.5 * end[1], 0.5 * (-1.0 + end[2])];
    let moved = [0.45 * mean[0] + 0.55 * mean[1], 0.55 * mean[1] + 0.45 * mean[2]];
    close(&f.get("position"), &[3.5 + 0.1 * moved[0], 4.5 + 0.1 * moved[1]]);
    let rate = [mean[1] - mean[0], mean[2] - mean[1]];
    let j = [0.8 + 0.1 * 0.76 * rate[0], 1.0 + 0.1 * 0.95 * rate[1]];
    close(&f.get("jacobian"), &j);
    close(&f.get("specific_internal_energy"), &[-4.8 * rate[0] / 2.0, -rate[1] / 2.0]);
    // relative to the volume at the end
    let gradient = [(end[1] - end[0]) * 0.76 / j[0], (end[2] - end[1]) * 0.95 / j[1]];
    close(&f.get("velocity_gradient"), &gradient);
}

#[test]
fn compatible_energy_closes_the_balance_to_rounding() {
    for transfer in [json!("flip"), json!("pic"), json!({"xpic": 2}), json!({"fmpm": 3})] {
        let heat = transfer != json!("flip");
        let method = json!({"transfer": transfer, "stepping": "midpoint", "energy": "compatible",
            "filter_heat": heat});
        let f = step(method, [1.0, -1.0], -1.0);
        let (v, e) = (f.get("velocity"), f.get("specific_internal_energy"));
        // 2 kg of each, at first (1 + 1)/2 J/kg
        close(&[v[0] * v[0] + v[1] * v[1] + 2.0 * (e[0] + e[1])], &[2.0]);
        close(&[v[0] + v[1]], &[0.0]);
    }
}

#[test]
fn the_first_gradient_is_that_of_the_initial_velocity() {
    let bodies = json!([{"name": "body", "material": "fluid", "particles_per_cell": [1],
        "box": {"lower": [1.0], "upper": [7.0]},
        "velocity_field": {"radial": {"about": [4.0], "speed": 2.0}}}]);
    let f = Fixture::<1>::new(json!({"method": {"stepping": "midpoint"}, "bodies": bodies}));
    // -2 m/s below 4 m and 2 m/s above: the middle node is at rest, so are gradients further out
    close(&f.get("velocity_gradient"), &[0.0, 0.0, 2.0, 2.0, 0.0, 0.0]);
}
