//! Tests on one patch with two particles: see [`Fixture`].

use serde_json::json;

use crate::solver::effect::{Account, Phase};
use crate::solver::tests::fixture::{Fixture, close};

#[test]
fn gravity_accelerates_all_alike_and_counts_its_work() {
    let mut f = Fixture::<2>::new(json!({"body_force": {"gravity": [3.0, -5.0]}}));
    f.set("mass", &[2.0, 4.0]).act(Phase::ParticleForce, 0.1);
    close(&f.get("body_force_x"), &[6.0, 12.0]);
    close(&f.get("body_force_y"), &[-10.0, -20.0]);
    f.advance(0.1);
    close(&f.get("velocity_x"), &[0.3, 0.3]);
    close(&f.get("velocity_y"), &[-0.5, -0.5]);
    // m g . (v + v')/2 dt
    close(&f.get("body_force_work"), &[2.0 * 0.17, 4.0 * 0.17]);
    close(&f.get("body_force_impulse_x"), &[0.6, 1.2]);
    close(&f.get("body_force_impulse_y"), &[-1.0, -2.0]);
    // seen from a grid that moves at 7 m/s along x, its travel works too
    close(&[f.account(Account::ExternalWork, [7.0, 0.0])], &[6.0 * 0.17 + 7.0 * 1.8]);
    close(&[f.account(Account::ExternalImpulse(1), [0.0; 2])], &[-3.0]);
}

#[test]
fn with_compatible_energy_its_work_is_the_gain_of_kinetic_energy() {
    let method = json!({"transfer": {"xpic": 2}, "stepping": "midpoint", "energy": "compatible",
        "filter_heat": true});
    let mut f = Fixture::<1>::new(json!({"method": method, "body_force": {"gravity": [3.0]}}));
    f.set("velocity", &[1.0, -1.0]).advance(0.1);
    let (v, e) = (f.get("velocity"), f.get("specific_internal_energy"));
    let energy = v[0] * v[0] + v[1] * v[1] + 2.0 * (e[0] + e[1]);
    close(&[2.0 + f.account(Account::ExternalWork, [0.0])], &[energy]);
}

#[test]
fn a_force_that_depends_on_time_is_that_of_the_time_of_the_forces() {
    let force = |stepping: &str, time: f64| {
        let ring = json!({"amplitude": 1.0, "period": 1.0, "inner": 1.0, "outer": 7.0});
        let mut f = Fixture::<2>::solid(json!({"method": {"stepping": stepping},
            "body_force": {"vortex": ring}}));
        f.time = time;
        // it is that of the initial position
        f.set("position_x", &[1.5, 1.5]).act(Phase::ParticleForce, 0.1);
        f.get("body_force_x")
    };
    let start = force("leapfrog", 0.25);
    assert!(start[0] != 0.0 && start[0] != start[1]);
    close(&force("midpoint", 0.2), &start);
    assert_ne!(force("leapfrog", 0.2), start);
}

#[test]
fn the_travel_of_an_accelerated_grid_works_too() {
    // a piston that is 4 t m/s fast, in the step from 0.2 to 0.3 s
    let mut f = Fixture::<1>::new(json!({
        "boundary": {"x_lower": {"velocity": [[0.0, 0.0], [1.0, 4.0]]}},
        "bodies": [{"name": "body", "material": "fluid", "particles_per_cell": [1],
            "box": {"lower": [0.0], "upper": [2.0]}}],
        "body_force": {"gravity": [3.0]},
    }));
    f.time = 0.2;
    f.act(Phase::ParticleForce, 0.1);
    f.set_flow([(1.0, [0.0])], [(3.0, [0.0])]);
    f.act(Phase::Gathered, 0.1);
    // the grid moves at 1 m/s in the middle of the step: 6 N x 0.1 m move to the body force, beside
    // its own 6 N x 2 m/s x 0.1 s
    close(&[f.patch.boundary_work[0].work], &[-1.6 - 0.6]);
    close(&f.get("body_force_work"), &[1.2 + 0.6; 2]);
}
