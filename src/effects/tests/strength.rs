//! Tests on one patch with two particles: see [`Fixture`].

use serde_json::{Value, json};

use crate::solver::effect::Phase;
use crate::solver::tests::fixture::{Fixture, close};

/// Shear modulus 30 Pa, yield stress 6 Pa: on a line ds = 4/3 x 30 Pa D dt up to 2/3 x 6 Pa.
fn strong(method: Value, failure: Value) -> Fixture<1> {
    let strength = json!({"type": "von_mises", "shear_modulus": 30.0, "yield_stress": 6.0});
    let material = json!({"strength": strength, "failure": failure});
    Fixture::new(json!({"method": method, "materials": {"fluid": material}}))
}

#[test]
fn a_leapfrog_step_shears_yields_and_heats() {
    let mut f = strong(json!({}), Value::Null);
    f.set("velocity_gradient", &[0.5, 5.0]).set("plastic_strain", &[0.0, 0.5]);
    f.update_stress(0.1);
    close(&f.get("deviator_xx"), &[2.0, 4.0]);
    // the trial stress of 20 Pa is 30 Pa by von Mises: (30 - 6)/(3 x 30) of plastic strain
    let plastic = 24.0 / 90.0;
    close(&f.get("plastic_strain"), &[0.0, 0.5 + plastic]);
    close(&f.get("plastic_increment"), &[0.0, plastic]);
    close(&f.get("plastic_work"), &[0.0, 6.0 * plastic]);
    // -(p + p')/2 dV/m + dt (s + s')/2 D V/m with V of the mean J
    let energy = [(1.05f64, 2.0, 0.5), (1.5, 4.0, 5.0)].map(|(j, s, d)| {
        let pressure = 200.0 * (1.0 / j - 1.0);
        -0.5 * pressure * (j - 1.0) / 2.0 + 0.1 * 0.5 * s * d * 0.5 * (1.0 + j) / 2.0
    });
    close(&f.get("specific_internal_energy"), &energy);
}

#[test]
fn a_mid_point_step_shears_by_half_then_by_the_mean_velocity() {
    let mut f = strong(json!({"stepping": "midpoint"}), Value::Null);
    f.set("velocity_gradient", &[0.5, -0.5]).set("jacobian_mid", &[1.1, 0.9]);
    f.set("deviator_xx", &[1.0, 0.0]).set("specific_internal_energy", &[7.0, 7.0]);
    f.act(Phase::MidState, 0.1);
    // 40 Pa x 0.05 s x D on top
    close(&f.get("stress_xx"), &[2.0, -1.0]);
    close(&f.get("deviator_xx"), &[1.0, 0.0]);
    // dt/2 (s + s_h)/2 D V_h/m
    let energy = [7.0 + 0.05 * 1.5 * 0.5 * 1.1 / 2.0, 7.0 + 0.05 * 0.5 * 0.5 * 0.9 / 2.0];
    close(&f.get("energy_mid"), &energy);
    // gradients 0.1 and 0.5/s at the start and the end
    f.set_flow([(0.0, [0.1])], [(0.0, [0.5])]);
    f.act(Phase::Gather, 0.1).act(Phase::Gathered, 0.1);
    close(&f.get("rate_xx"), &[0.3, 0.3]);
    close(&f.get("deviator_xx"), &[1.0 + 1.2, 1.2]);
}

#[test]
fn in_a_plane_shear_is_half_of_both_gradients() {
    let strength = json!({"type": "von_mises", "shear_modulus": 30.0, "yield_stress": 600.0});
    let mut f = Fixture::<2>::new(json!({"materials": {"fluid": {"strength": strength}}}));
    f.set("velocity_gradient_xx", &[0.6, 0.0]).set("velocity_gradient_xy", &[0.0, 0.2]);
    f.set("velocity_gradient_yx", &[0.0, 0.2]).set("velocity_gradient", &[0.6, 0.0]);
    f.update_stress(0.1);
    // 2 G dt (D - tr D/3)
    close(&f.get("deviator_xx"), &[6.0 * 0.4, 0.0]);
    close(&f.get("deviator_yy"), &[6.0 * -0.2, 0.0]);
    close(&f.get("deviator_xy"), &[0.0, 6.0 * 0.2]);
    // without volume change the work is dt s'/2 : D V/m = dt s_xy l_xy/2
    close(&f.get("specific_internal_energy")[1..], &[0.1 * 1.2 * 0.2 / 2.0]);
}

#[test]
fn longitudinal_waves_are_faster_than_sound() {
    let mut f = strong(json!({}), Value::Null);
    f.set("jacobian", &[1.0, 0.5]);
    f.refresh();
    // c^2 + 4/3 G/rho with rho = 2 and 4 kg/m3
    close(&f.get("sound_speed"), &[120f64.sqrt(), 110f64.sqrt()]);
    // sigma = s - p
    f.set("jacobian", &[1.0, 0.8]).set("deviator_xx", &[3.0, 3.0]);
    f.refresh();
    close(&f.get("stress_xx"), &[3.0, 3.0 - 50.0]);
}

#[test]
fn failed_particles_carry_no_shear() {
    let mut f = strong(json!({}), json!({"type": "tension_limit", "stress": 5.0}));
    f.set("velocity_gradient", &[0.5, 0.5]).set("damage", &[1.0, 0.0]);
    f.update_stress(0.1);
    close(&f.get("deviator_xx"), &[0.0, 2.0]);
}
