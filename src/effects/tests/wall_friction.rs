//! Tests on one patch with two particles: see [`Fixture`].

use serde_json::{Value, json};

use crate::solver::tests::fixture::{Fixture, close};

/// A particle of 8 kg above a wall, with the velocity (4, -2) m/s; another one is far away.
fn above(coefficient: f64, method: Value, place: [f64; 2]) -> Fixture<2> {
    let boundary = json!({"y_lower": {"friction": coefficient}});
    let mut f = Fixture::<2>::new(json!({"boundary": boundary, "method": method}));
    f.set("position_x", &[place[0], 6.5]).set("position_y", &[place[1], 6.5]);
    f.set("mass", &[8.0, 1.0]).set("velocity_x", &[4.0, 0.0]).set("velocity_y", &[-2.0, 0.0]);
    f
}

#[test]
fn friction_is_bounded_by_the_normal_impulse() {
    let mut f = above(0.3, json!({"transfer": "pic"}), [3.25, 0.25]);
    f.solve(0.1);
    // 4.5 kg on node (3, 0) strike with 9 N s; with the image 5.4 of 36 N s are lost
    close(&[f.node("velocity_star_x", [3, 0])], &[4.0 - 5.4 / 9.0]);
    assert_eq!(f.node("velocity_star_x", [3, 1]), 4.0);
}

#[test]
fn a_rough_wall_holds() {
    let mut f = above(10.0, json!({"transfer": "pic"}), [3.25, 0.25]);
    f.solve(0.1);
    close(&[f.node("velocity_star_x", [3, 0])], &[0.0]);
    close(&[f.node("velocity_star_x", [3, 1])], &[4.0]);
    // a body slides with half the speed in the mean: all of its work is heat of the body
    close(&[f.node("heat", [3, 0])], &[0.5 * 16.0]);
}

#[test]
fn pressure_holds_where_flip_keeps_the_velocity() {
    let mut f = above(0.3, json!({"transfer": "flip"}), [3.25, 0.25]);
    f.set("stress_volume", &[40.0, 0.0]).solve(0.1);
    // the particle presses with 40 x 3/4 N; along x -30 N push itself and its image
    close(&[f.node("velocity_star_x", [3, 0])], &[4.0 - 0.1 * (60.0 + 2.0 * 0.3 * 30.0) / 9.0]);
}

#[test]
fn a_particle_that_reaches_through_the_wall_strikes_with_what_it_loses() {
    // from -0.25 to 0.75 m: shares 1/32, 22/32 and 9/32 on the nodes -1, 0 and 1
    let mut f = above(0.3, json!({"transfer": "pic", "shape": "gimp"}), [3.5, 0.25]);
    f.solve(0.1);
    // 4 kg of it stand above node 3: 8 N s before, 1.6 N s after, as node 1 moves at
    // -2 (9 - 1)/(9 + 1) m/s and node -1 the other way
    let most = 0.3 * (8.0 - 1.6);
    close(&[f.node("velocity_star_x", [3, 0])], &[4.0 - 2.0 * most / 5.5]);
}

#[test]
fn the_affine_velocity_strikes_too() {
    let mut f = above(0.3, json!({"transfer": "apic"}), [3.25, 0.25]);
    f.set("affine_yx", &[4.0, 0.0]).set("affine_yy", &[8.0, 0.0]).solve(0.1);
    // at the node (3, 0) the particle moves by -2 - 4/4 - 8/4 m/s
    close(&[f.node("velocity_star_x", [3, 0])], &[4.0 - 2.0 * 0.3 * 4.5 * 5.0 / 9.0]);
}

/// Friction is that of the momentum that the particle loses, for any filter.
#[test]
fn friction_is_that_of_the_impulse_that_acts() {
    for method in [
        json!({"transfer": "pic"}),
        json!({"transfer": {"xpic": 2}}),
        json!({"transfer": {"fmpm": 4}}),
        json!({"transfer": {"fmpm": 3}, "shape": "gimp"}),
    ] {
        let mut f = above(0.3, method.clone(), [3.5, 0.375]);
        f.set("stress_volume", &[4.0, 0.0]).solve(0.1);
        let pushed = &f.patch.side_forces;
        let friction: f64 = pushed.iter().map(|side| 0.1 * side.share * side.force[0]).sum();
        f.run(0.1, |s, step, patch| s.gather_leapfrog(patch, step.dt, false));
        let normal = 8.0 * (f.get("velocity_y")[0] + 2.0);
        assert!((friction + 0.3 * normal).abs() < 1e-12, "{method}: {friction} of {normal}");
    }
}
