//! Tests on one patch with two particles: see [`Fixture`].

use serde_json::{Value, json};

use crate::solver::effect::{Account, Phase};
use crate::solver::tests::fixture::{Fixture, close};

/// Fails at a tension of 5 Pa.
fn brittle(changes: Value) -> Fixture<1> {
    let mut scene = json!({"materials": {"fluid": {
        "failure": {"type": "tension_limit", "stress": 5.0}}}});
    for (key, value) in changes.as_object().unwrap() {
        match key.as_str() {
            "strength" => scene["materials"]["fluid"]["strength"] = value.clone(),
            _ => scene[key] = value.clone(),
        }
    }
    Fixture::new(scene)
}

#[test]
fn tension_is_released_as_heat() {
    let mut f = brittle(json!({}));
    f.set("pressure", &[-6.0, -4.0]).set("jacobian", &[0.5, 0.5]).act(Phase::End, 0.1);
    assert_eq!(f.get("damage"), [1.0, 0.0]);
    assert_eq!(f.get("pressure"), [0.0, -4.0]);
    // p^2/(2 K) V with K = rho c^2 = 4 x 100 Pa
    close(&f.get("released_energy"), &[36.0 / 800.0 * 0.5, 0.0]);
    assert_eq!(f.account(Account::FailedParticles, [0.0]), 1.0);
    assert_eq!(f.account(Account::DamagedParticles, [0.0]), 0.0);
    close(&[f.account(Account::ReleasedEnergy, [0.0])], &[0.0225]);
}

#[test]
fn a_damaged_particle_has_not_failed() {
    let mut f = brittle(json!({}));
    f.set("damage", &[0.25, 1.0]);
    assert_eq!(f.account(Account::DamagedParticles, [0.0]), 1.0);
    assert_eq!(f.account(Account::FailedParticles, [0.0]), 1.0);
}

#[test]
fn shear_is_released_too() {
    let strength = json!({"type": "von_mises", "shear_modulus": 30.0, "yield_stress": 6.0});
    let mut f = brittle(json!({"strength": strength}));
    f.set("pressure", &[-4.0, -2.0]).set("deviator_xx", &[2.0, 2.0]);
    // c^2 = K/rho + 4/3 G/rho = 120
    close(&f.get("sound_speed"), &[120f64.sqrt(); 2]);
    f.act(Phase::End, 0.1);
    // -p + s is 6 and 4 Pa; p^2/(2 K) + s:s/(4 G) with s:s = 3/2 s_xx^2
    assert_eq!(f.get("damage"), [1.0, 0.0]);
    close(&f.get("released_energy"), &[16.0 / 400.0 + 6.0 / 120.0, 0.0]);
    assert_eq!((f.get("deviator_xx"), f.get("stress_xx")[0]), (vec![0.0, 2.0], 0.0));
}

#[test]
fn failed_particles_keep_compression_and_viscosity_at_the_middle_of_the_step() {
    let mut f = brittle(json!({
        "method": {"stepping": "midpoint", "shape": "linear", "transfer": "flip",
            "pressure_relaxation": {"rate": 0.1, "interval": 1}},
        "artificial_viscosity": {"linear": 0.5, "quadratic": 0.0},
    }));
    for (stress, left, mid) in [(-5.0, 3.0 * 0.8, 0.0), (9.0, 9.0, 2.0)] {
        f.set("damage", &[1.0, 0.5]).set("stress_volume", &[stress, -5.0]);
        f.set("artificial_viscosity", &[3.0, 3.0]).set("jacobian_mid", &[0.8, 0.8]);
        f.set("pressure_mid", &[2.0, 2.0]).set("compliance", &[4.0, 4.0]);
        f.act(Phase::MidStress, 0.1);
        close(&f.get("stress_volume"), &[left, -5.0]);
        assert_eq!(f.get("pressure_mid"), [mid, 2.0]);
        assert_eq!(f.get("compliance"), [2.0 * mid, 4.0]);
    }
}

#[test]
fn the_tension_of_failed_particles_does_no_work_in_a_leapfrog_step() {
    let mut f = brittle(json!({}));
    f.set("damage", &[1.0, 0.0]).set("velocity_gradient", &[5.0, 5.0]);
    f.update_stress(0.1);
    let pressure = 200.0 * (1.0 / 1.5 - 1.0);
    close(&f.get("pressure"), &[0.0, pressure]);
    close(&f.get("specific_internal_energy"), &[0.0, -0.5 * pressure * 0.5 / 2.0]);
}

#[test]
fn failed_particles_in_tension_have_no_pressure_at_the_end() {
    let mut f = brittle(json!({}));
    f.set("damage", &[1.0, 1.0]).set("jacobian", &[1.25, 0.8]);
    f.refresh();
    close(&f.get("pressure"), &[0.0, 50.0]);
    f.set("damage", &[0.0, 0.0]);
    f.refresh();
    close(&f.get("pressure"), &[-40.0, 50.0]);
}
