//! Tests on one patch with two particles: see [`Fixture`].

use serde_json::{Value, json};

use crate::solver::effect::Phase;
use crate::solver::tests::fixture::{Fixture, close};

/// Two particles of 2 kg from the side at the node 0 on, under `load`.
fn loaded(load: Value) -> Fixture<1> {
    Fixture::new(json!({
        "boundary": {"x_lower": {"pressure": load}},
        "bodies": [{"name": "body", "material": "fluid", "particles_per_cell": [1],
            "box": {"lower": [0.0], "upper": [2.0]}}],
    }))
}

#[test]
fn the_pressure_pushes_the_surface_alone() {
    let mut f = loaded(json!(7.0));
    assert_eq!(f.get("load_mark"), [1.0, 0.0]);
    f.act(Phase::ParticleForce, 0.1).scatter(0.1);
    close(&f.line("acceleration", 0..=2), &[7.0, 0.0, 0.0]);
    // a body under the same pressure stays at rest
    f.set("stress_volume", &[7.0, 7.0]).act(Phase::ParticleForce, 0.1).scatter(0.1);
    close(&f.line("acceleration", 0..=1), &[0.0, 0.0]);
}

#[test]
fn the_load_is_that_of_the_time_of_the_forces() {
    let mut f = loaded(json!([[0.0, 0.0], [1.0, 10.0]]));
    f.time = 0.5;
    f.act(Phase::ParticleForce, 0.1).scatter(0.1);
    close(&[f.node("acceleration", [0])], &[5.0]);
}

#[test]
fn the_load_follows_the_volume_and_the_surface() {
    let mut f = loaded(json!(7.0));
    f.set("position", &[3.25, 4.5]).set("jacobian", &[0.5, 1.0]);
    f.act(Phase::ParticleForce, 0.1).scatter(0.1);
    // a volume of J at 3.25 m: surface J of 3/2 kg; at the node 4 the surface is 1 - 1/2 outward
    close(&f.get("load_volume"), &[0.5, 1.0]);
    close(&f.line("acceleration", 3..=5), &[3.5 / 1.5, 3.5 / 1.5, 0.0]);
}

#[test]
fn at_the_upper_side_it_pushes_back() {
    let mut f = Fixture::<2>::new(json!({
        "boundary": {"y_upper": {"pressure": 7.0}},
        "bodies": [{"name": "body", "material": "fluid", "particles_per_cell": [1, 1],
            "box": {"lower": [3.0, 6.0], "upper": [4.0, 8.0]}}],
    }));
    assert_eq!(f.get("load_mark"), [0.0, 8.0]);
    f.act(Phase::ParticleForce, 0.1).scatter(0.1);
    // half of the surface and 1/2 kg at each of the two nodes
    close(&[f.node("acceleration_y", [3, 8])], &[-7.0]);
    close(&[f.node("acceleration_x", [3, 8]), f.node("acceleration_y", [3, 7])], &[0.0, 0.0]);
}
