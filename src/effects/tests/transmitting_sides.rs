//! Tests on one patch with two particles: see [`Fixture`].

use serde_json::{Value, json};

use crate::solver::effect::Phase;
use crate::solver::tests::fixture::{Fixture, close};

/// Two particles of 2 kg up to a transmitting side at the node 8, with an impedance of 20 Pa s/m.
fn transmitting(changes: Value) -> Fixture<1> {
    let mut body = json!({"name": "body", "material": "fluid", "particles_per_cell": [1],
        "box": {"lower": [6.0], "upper": [8.0]}});
    body.as_object_mut().unwrap().extend(changes.as_object().unwrap().clone());
    Fixture::new(json!({"boundary": {"x_upper": "transmitting"}, "bodies": [body]}))
}

/// Nodal accelerations at 6, 7 and 8 m in a step of 0.1 s.
fn accelerations(f: &mut Fixture<1>) -> Vec<f64> {
    f.act(Phase::ParticleForce, 0.1).scatter(0.1);
    f.line("acceleration", 6..=8)
}

#[test]
fn the_traction_is_that_of_an_outgoing_wave() {
    let mut f = transmitting(json!({}));
    f.set("velocity", &[3.0, 3.0]);
    // 1 kg at the side: the mean velocity of the step is 3/(1 + 0.05 x 20), the traction -20 times it
    close(&accelerations(&mut f), &[0.0, 0.0, -20.0 * 1.5]);
    // half of what the current material has, 40 Pa s/m, and of the impedance at rest
    f.set("sound_speed", &[20.0, 20.0]);
    close(&accelerations(&mut f), &[0.0, 0.0, -30.0 * 3.0 / 2.5]);
}

#[test]
fn the_velocity_is_extrapolated_to_the_side() {
    let mut f = transmitting(json!({}));
    f.set("velocity", &[3.0, 3.0]).set("velocity_gradient", &[4.0, 4.0]);
    f.set("side_gradient_before_xx", &[2.0, 2.0]);
    // gradient 4 + (4 - 2)/2 at the middle of the step, half a cell from the particle
    close(&accelerations(&mut f), &[0.0, 0.0, -20.0 * (3.0 + 2.5) / 2.0]);
    close(&f.get("side_gradient_before_xx"), &[4.0, 4.0]);
}

#[test]
fn a_body_in_its_initial_motion_is_left_alone() {
    let mut f = transmitting(json!({"velocity": [3.0]}));
    close(&accelerations(&mut f), &[0.0; 3]);
}

#[test]
fn the_initial_pressure_is_balanced() {
    let gas = json!({"density": 2.0, "eos": {"type": "ideal_gas", "gamma": 1.4}});
    let mut f = Fixture::<1>::new(json!({
        "boundary": {"x_lower": "transmitting"},
        "materials": {"gas": gas},
        "bodies": [{"name": "body", "material": "gas", "particles_per_cell": [1],
            "box": {"lower": [0.0], "upper": [2.0]}, "pressure": 5.0}],
    }));
    close(&f.get("pressure"), &[5.0, 5.0]);
    f.set("stress_volume", &[5.0, 5.0]).act(Phase::ParticleForce, 0.1).scatter(0.1);
    close(&f.line("acceleration", 0..=2), &[0.0, 0.0, 5.0]);
}

#[test]
fn shear_waves_leave_with_their_own_impedance() {
    let mut f = Fixture::<2>::solid(json!({
        "boundary": {"x_upper": "transmitting"},
        "bodies": [{"name": "body", "material": "fluid", "particles_per_cell": [1, 1],
            "box": {"lower": [6.0, 3.0], "upper": [8.0, 4.0]}}],
    }));
    f.set("velocity_y", &[3.0, 3.0]).act(Phase::ParticleForce, 0.1).scatter(0.1);
    // rho c_s = sqrt(2 x 40) Pa s/m on half a metre, with 1/2 kg
    let z = 80f64.sqrt();
    close(&[f.node("acceleration_y", [8, 3])], &[-z * 3.0 / (1.0 + 0.05 * z)]);
    close(&[f.node("acceleration_x", [8, 3])], &[0.0]);
}

#[test]
fn the_distance_to_the_side_is_in_metres() {
    let mut f = Fixture::<1>::new(json!({
        "domain": {"upper": [4.0], "cell_size": 0.5},
        "boundary": {"x_upper": "transmitting"},
        "bodies": [{"name": "body", "material": "fluid", "particles_per_cell": [1],
            "box": {"lower": [3.0], "upper": [4.0]}}],
    }));
    f.set("velocity", &[3.0, 3.0]).set("velocity_gradient", &[4.0, 4.0]);
    f.set("side_gradient_before_xx", &[4.0, 4.0]);
    // 4/s over 1/4 m, on 1/2 kg: the mean velocity of the step is 4 (1/2)/(1/2 + 0.05 x 20)
    close(&accelerations(&mut f), &[0.0, 0.0, -20.0 * (4.0 / 3.0) / 0.5]);
}

#[test]
fn material_at_rest_is_left_alone_by_a_grid_that_accelerates() {
    let mut f = Fixture::<1>::new(json!({
        "boundary": {"x_lower": {"velocity": [[0.0, 0.0], [1.0, 4.0]]}, "x_upper": "transmitting"},
        "bodies": [{"name": "body", "material": "fluid", "particles_per_cell": [1],
            "box": {"lower": [0.0], "upper": [8.0]}}],
    }));
    // 0.8 m/s behind the grid after 0.2 s, 1 m/s in the middle of the step: inertia alone acts
    f.time = 0.2;
    f.set("velocity", &[-0.8; 8]);
    close(&accelerations(&mut f), &[-4.0; 3]);
}

#[test]
fn in_a_plane_the_whole_gradient_is_kept() {
    let mut f = Fixture::<2>::new(json!({
        "method": {"stepping": "midpoint"},
        "boundary": {"x_upper": "transmitting"},
        "bodies": [{"name": "body", "material": "fluid", "particles_per_cell": [1, 1],
            "box": {"lower": [6.0, 3.0], "upper": [8.0, 4.0]}}],
    }));
    f.set_flow([(0.0, [0.0; 2]); 2], [(0.0, [4.0, 8.0]), (0.0, [3.0, -2.0])]);
    f.gather_midpoint(0.1);
    // relative to the volume at the end, 1.1 of that at the middle
    for (of, value) in [("xx", 4.0), ("xy", 8.0), ("yx", 3.0), ("yy", -2.0)] {
        close(&f.get(&format!("velocity_gradient_{of}")), &[value / 1.1; 2]);
    }
}
