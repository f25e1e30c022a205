//! Contact of two bodies at the nodes between them.

use serde_json::{Value, json};

use super::fixture::{Fixture, close};

fn body(name: &str, lower: Value, upper: Value, velocity: Value) -> Value {
    let ones = vec![1; lower.as_array().unwrap().len()];
    json!({"name": name, "material": "fluid", "box": {"lower": lower, "upper": upper},
        "velocity": velocity, "particles_per_cell": ones})
}

/// Two particles of 2 kg in the cells on both sides of node 4, of bodies that meet at 3 m/s: the
/// greatest impulse of adhesion is 0.02 x 2 kg/m3 x 1 m x 3 m/s = 0.12 Pa s.
fn pair(transfer: &str) -> Fixture<1> {
    let bodies = [
        body("a", json!([3.0]), json!([4.0]), json!([2.0])),
        body("b", json!([4.0]), json!([5.0]), json!([-1.0])),
    ];
    let contact = json!({"type": "frictionless"});
    let method = json!({"transfer": transfer});
    Fixture::new(json!({"bodies": bodies, "contact": contact, "method": method}))
}

/// Values of a field at node 4 for both bodies.
fn both(f: &Fixture<1>, field: &str) -> [f64; 2] {
    [f.node_of(0, field, [4]), f.node_of(1, field, [4])]
}

#[test]
fn bodies_that_meet_share_momentum_and_force() {
    for (transfer, taken) in [("pic", 1.0), ("flip", 0.0)] {
        let mut f = pair(transfer);
        f.set("stress_volume", &[6.0, 2.0]).scatter(0.1);
        // 1 kg of each: velocities 2 and -1 m/s, accelerations 6 and -2 m/s2
        assert_eq!(both(&f, "mass"), [1.0, 1.0]);
        close(&both(&f, "lumped_velocity"), &[0.5, 0.5]);
        close(&both(&f, "acceleration"), &[2.0, 2.0]);
        close(
            &[f.node_of(0, "lumped_velocity", [3]), f.node_of(1, "lumped_velocity", [5])],
            &[2.0, -1.0],
        );
        let constraint = f.patch.contact.constraints[0];
        assert_eq!(constraint.normal, [1.0]);
        // impulse and force of the second on the first
        close(&[constraint.given[0][0], constraint.given[1][0]], &[-1.5, -4.0]);
        f.run(0.1, |s, step, patch| s.gather_contact(patch, step.dt));
        close(&f.patch.contact.forces[0], &[taken * 15.0 + 4.0, 0.0]);
    }
}

#[test]
fn bodies_do_not_pull_each_other() {
    let mut f = pair("pic");
    f.set("velocity", &[-2.0, 1.0]).scatter(0.1);
    assert!(f.patch.contact.constraints.is_empty());
    close(&both(&f, "lumped_velocity"), &[-2.0, 1.0]);
}

#[test]
fn bodies_touch_if_they_would_overlap_by_the_end_of_the_step() {
    // m u + A s dt > 0 with the reduced mass 1/2 kg, u = -3 m/s, A = 1, dt = 0.1 s: above 15 Pa
    for (stress, touches) in [(14.0, false), (16.0, true)] {
        let mut f = pair("pic");
        f.set("velocity", &[-2.0, 1.0]).set("stress_volume", &[stress, stress]).scatter(0.1);
        assert_eq!(f.patch.contact.constraints.len(), usize::from(touches), "{stress} Pa");
    }
}

#[test]
fn a_gap_keeps_bodies_apart() {
    // closed below 0.01 cells, and under stress below 0.01 + s/(rho c^2) with rho c^2 = 200 Pa
    for (gap, stress, touches) in
        [(0.02, 0.0, false), (0.008, 0.0, true), (0.05, 10.0, true), (0.07, 10.0, false)]
    {
        let mut f = pair("pic");
        f.set("position", &[3.5 - 0.5 * gap, 4.5 + 0.5 * gap]);
        f.set("stress_volume", &[stress, stress]).scatter(0.1);
        assert_eq!(f.patch.contact.constraints.len(), usize::from(touches), "{gap}, {stress} Pa");
    }
}

#[test]
fn bodies_that_were_pressed_together_adhere_for_a_while() {
    // 0.1 Pa s are left of 0.12; a tension of 2 Pa takes more in a step
    for (stress, adheres) in [(0.0, true), (-0.9, true), (-2.0, false)] {
        let mut f = pair("pic");
        f.set("velocity", &[-2.0, 1.0]).set("contact_impulse", &[0.1, 0.0]);
        f.set("stress_volume", &[stress, stress]).scatter(0.1);
        assert_eq!(f.patch.contact.constraints.len(), usize::from(adheres), "{stress} Pa");
    }
    // above 1.2 Pa s a wave has pressed on one of them
    for (impulse, adheres) in [(1.19, true), (1.21, false)] {
        let mut f = pair("pic");
        f.set("velocity", &[-2.0, 1.0]).set("contact_impulse", &[0.1, impulse]).scatter(0.1);
        assert_eq!(f.patch.contact.constraints.len(), usize::from(adheres), "{impulse} Pa s");
    }
    // the impulse of the start, a tenth of it, holds against a slow separation alone
    for (speed, adheres) in [(0.1, true), (0.2, false)] {
        let mut f = pair("pic");
        f.set("velocity", &[-speed, 0.0]).scatter(0.1);
        assert_eq!(f.patch.contact.constraints.len(), usize::from(adheres), "{speed} m/s");
    }
}

#[test]
fn pressure_adds_to_the_contact_impulse() {
    let mut f = pair("pic");
    let mut impulse = |before: [f64; 2], stress: [f64; 2]| {
        f.set("contact_impulse", &before).set("jacobian", &[0.5, 1.0]);
        f.set("stress_volume", &stress);
        f.run(0.1, |s, step, patch| s.find_contact_impulse(patch, step.jacobian, step.dt));
        f.get("contact_impulse")
    };
    // 0.05 + 0.1 s of 0.6 Pa, and of -0.2 Pa
    close(&impulse([0.05; 2], [0.3, -0.2]), &[0.11, 0.03]);
    // tension takes from 0.12 Pa s at most, and leaves no less than 0
    close(&impulse([0.5; 2], [3.0, -0.2]), &[1.1, 0.1]);
    close(&impulse([0.05; 2], [-3.0, -2.0]), &[0.0, 0.0]);
    // 1.2 Pa s without interruption are the most, and stay
    close(&impulse([0.7, 1.21], [3.0, -2.0]), &[1.2, 1.2]);
}

/// Two particles of 2 kg below and above y = 4; the upper one slides at 8 m/s and sinks at 2 m/s.
fn sliding(transfer: impl Into<Value>, coefficient: f64) -> Fixture<2> {
    let bodies = [
        body("lower", json!([3.0, 3.0]), json!([4.0, 4.0]), json!([0.0, 0.0])),
        body("upper", json!([3.0, 4.0]), json!([4.0, 5.0]), json!([8.0, -2.0])),
    ];
    let contact = json!({"type": "friction", "coefficient": coefficient});
    Fixture::new(json!({"bodies": bodies, "contact": contact,
        "method": {"transfer": transfer.into()}}))
}

/// Values of a vector at the node (3, 4) for both bodies: x, x, y, y.
fn between(f: &Fixture<2>, field: &str) -> [f64; 4] {
    let at = |body: usize, axis: &str| f.node_of(body, &format!("{field}_{axis}"), [3, 4]);
    [at(0, "x"), at(1, "x"), at(0, "y"), at(1, "y")]
}

#[test]
fn friction_is_bounded_by_coulombs_law() {
    let mut f = sliding("pic", 0.3);
    f.solve(0.1);
    // 1/2 kg of each at the node: N = 1/4 kg x 2 m/s, friction 0.3 N = 0.15 N s against the slip
    close(&between(&f, "lumped_velocity"), &[0.0, 8.0, -1.0, -1.0]);
    close(&between(&f, "velocity_star"), &[0.3, 7.7, -1.0, -1.0]);
    f.run(0.1, |s, step, patch| s.gather_contact(patch, step.dt));
    // 1/2 kg x 1 m/s in 0.1 s, and 0.15 N s
    close(&f.patch.contact.forces[0], &[5.0, 1.5]);
}

#[test]
fn bodies_stick_below_coulombs_bound() {
    let mut f = sliding("pic", 5.0);
    f.solve(0.1);
    // T = 1/4 kg x 8 m/s is below 5 N: one velocity
    close(&between(&f, "velocity_star"), &[4.0, 4.0, -1.0, -1.0]);
}

#[test]
fn with_flip_sticking_needs_a_force() {
    let mut f = sliding("flip", 5.0);
    f.set("stress_volume", &[20.0, 20.0]).solve(0.1);
    // both are pushed together by 10 N, N = 1/4 kg x 0.1 s x 40 m/s2; T = 2 N s is below 5 N; along
    // x both are also pushed by -10 N
    close(&between(&f, "velocity_star"), &[2.0, 2.0, -1.0, -1.0]);
    close(&between(&f, "lumped_velocity")[..2], &[0.0, 8.0]);
}

#[test]
fn the_friction_of_a_filter_is_that_of_the_impulse_that_acts() {
    for transfer in [json!("pic"), json!({"xpic": 2}), json!({"fmpm": 3})] {
        let mut f = sliding(transfer, 0.3);
        f.solve(0.1);
        let momentum = |axis: &str| -> f64 {
            let nodes = (2..=5).flat_map(|x| (2..=5).map(move |y| [x, y]));
            let name = format!("velocity_star_{axis}");
            nodes.map(|at| f.node_of(0, "mass", at) * f.node_of(0, &name, at)).sum()
        };
        // the lower body was at rest
        close(&[momentum("x")], &[-0.3 * momentum("y")]);
    }
}

#[test]
fn friction_heats_both_bodies() {
    let mut f = sliding("pic", 0.3);
    f.set("mass", &[2.0, 6.0]).solve(0.1);
    // 0.3 x 3/8 kg x 2 m/s in 0.1 s are 2.25 N on 1/2 and 3/2 kg: mean velocities 0.225 and
    // 7.925 m/s; half of the work 2.25 N x 7.7 m/s x 0.1 s each
    let heat = [0.5, 1.5].map(|mass| 0.5 * 2.25 * 7.7 * 0.1 / mass);
    close(&[f.node_of(0, "heat", [3, 4]), f.node_of(1, "heat", [3, 4])], &heat);
    f.run(0.1, |s, step, patch| s.gather_contact(patch, step.dt));
    // N = 1/4 at each of the two nodes
    close(&f.get("specific_internal_energy"), &heat.map(|heat| 0.5 * heat));
    close(&f.get("friction_heat"), &heat.map(|heat| 0.5 * heat));
}

#[test]
fn three_bodies_at_a_node_get_one_velocity() {
    let bodies = [
        body("a", json!([3.0]), json!([4.0]), json!([6.0])),
        body("b", json!([4.0]), json!([4.5]), json!([0.0])),
        body("c", json!([4.5]), json!([5.5]), json!([-3.0])),
    ];
    let contact = json!({"type": "frictionless"});
    let mut f = Fixture::<1>::new(json!({"bodies": bodies, "contact": contact,
        "method": {"shape": "gimp", "transfer": "pic"}}));
    f.scatter(0.1);
    // at node 4 stand 1 kg of a, 3/4 kg of b and 1/4 kg of c
    let at = |field: &str| [0, 1, 2].map(|body| f.node_of(body, field, [4]));
    close(&at("mass"), &[1.0, 0.75, 0.25]);
    close(&at("lumped_velocity"), &[(6.0 - 0.75) / 2.0; 3]);
    assert_eq!(f.patch.contact.multi_body.len(), 1);
}

#[test]
fn a_filter_acts_on_velocities_that_bodies_share() {
    let bodies = [
        body("a", json!([3.0]), json!([4.0]), json!([2.0])),
        body("b", json!([4.0]), json!([5.0]), json!([-1.0])),
    ];
    let mut f = Fixture::<1>::new(json!({"bodies": bodies, "contact": {"type": "frictionless"},
        "method": {"transfer": {"xpic": 2}}}));
    f.solve(0.0);
    // vL = 2, 1/2 | 1/2, -1; K vL = 3/4, -3/4 | 3/4, -3/4, whose mean at node 4 is 0
    close(&both(&f, "velocity"), &[0.5, 0.5]);
    close(&[f.node_of(0, "velocity", [3]), f.node_of(1, "velocity", [5])], &[2.75, -1.75]);
    // the jump of the last term is an impulse too: 1 kg x 3/4 m/s
    close(&[f.patch.contact.constraints[0].given[0][0]], &[-1.5 + 0.75]);
}

#[test]
fn bodies_in_contact_share_pressure_and_room() {
    let bodies = [
        body("a", json!([3.0]), json!([4.0]), json!([2.0])),
        body("b", json!([4.0]), json!([5.0]), json!([-1.0])),
    ];
    let method = json!({"transfer": {"fmpm": 2}, "stepping": "midpoint", "edge_mask": 0.3,
        "pressure_relaxation": {"rate": 0.1, "interval": 1}});
    let mut f = Fixture::<1>::new(json!({"bodies": bodies, "method": method,
        "contact": {"type": "frictionless"}}));
    f.set("pressure_mid", &[30.0, 10.0]).set("compliance", &[1.0, 3.0]);
    f.set("jacobian_mid", &[1.0, 1.0]);
    f.nodal(0.1, |s, step, nodal| {
        nodal.each("scatter", |patch| {
            s.scatter(patch, true, step);
            s.start_pressure(patch);
        });
    });
    // weighted by the compliances 1/2 and 3/2; filled by half a cell of each
    close(&both(&f, "pressure"), &[15.0, 15.0]);
    close(&both(&f, "volume"), &[1.0, 1.0]);
    close(&[f.node_of(0, "pressure", [3]), f.node_of(1, "volume", [5])], &[30.0, 0.5]);
}

#[test]
fn normals_by_regression_are_those_of_the_faces() {
    let bodies = [
        body("lower", json!([3.0, 3.0]), json!([4.0, 4.0]), json!([0.0, 0.0])),
        body("upper", json!([3.0, 4.0]), json!([4.0, 5.0]), json!([8.0, -2.0])),
    ];
    let contact = json!({"type": "frictionless", "normals": "logistic_regression"});
    let mut f = Fixture::<2>::new(
        json!({"bodies": bodies, "contact": contact, "method": {"transfer": "pic"}}),
    );
    f.scatter(0.1);
    close(&between(&f, "lumped_velocity"), &[0.0, 8.0, -1.0, -1.0]);
    // one of two nodes on the face
    assert_eq!(f.patch.contact.constraints.len(), 2);
    close(&f.patch.contact.constraints[0].normal, &[0.0, 1.0]);
}

#[test]
fn compressed_bodies_touch_over_a_smaller_area() {
    // V = 1/2 at 3.75 and 4.25 m: A = 1/2, 3/2 kg at the node: m u + A s dt > 0 above 45 Pa
    for (stress, touches) in [(44.0, false), (46.0, true)] {
        let mut f = pair("pic");
        f.set("position", &[3.75, 4.25]).set("jacobian", &[0.5, 0.5]);
        f.set("velocity", &[-2.0, 1.0]).set("stress_volume", &[0.5 * stress; 2]).scatter(0.1);
        assert_eq!(f.patch.contact.constraints.len(), usize::from(touches), "{stress} Pa");
    }
}

#[test]
fn about_an_axis_the_area_grows_with_the_radius() {
    // 7 kg per radian in each particle at the radius 3.5, 7/4 kg at the nodes: m u = -2.625 N s.
    // The nodes are corners with volume gradients (1/2, 1/2): A = r/sqrt(2) at the radii 3 and 4,
    // above 12.4 and 9.3 Pa
    for (stress, touching) in [(9.0, 0), (11.0, 1), (13.0, 2)] {
        let bodies = [
            body("lower", json!([3.0, 3.0]), json!([4.0, 4.0]), json!([0.0, -2.0])),
            body("upper", json!([3.0, 4.0]), json!([4.0, 5.0]), json!([0.0, 1.0])),
        ];
        let mut f = Fixture::<2>::axisymmetric(json!({"bodies": bodies,
            "contact": {"type": "frictionless"}, "method": {"transfer": "pic"}}));
        f.set("stress_volume", &[3.5 * stress; 2]).scatter(0.1);
        assert_eq!(f.patch.contact.constraints.len(), touching, "{stress} Pa");
    }
}

#[test]
fn on_a_mirror_the_force_between_bodies_counts_by_half() {
    let bodies = [
        body("lower", json!([0.0, 3.0]), json!([1.0, 4.0]), json!([0.0, 0.0])),
        body("upper", json!([0.0, 4.0]), json!([1.0, 5.0]), json!([0.0, -2.0])),
    ];
    let mut f = Fixture::<2>::new(json!({"bodies": bodies, "boundary": {"x_lower": "wall"},
        "contact": {"type": "frictionless"}, "method": {"transfer": "pic"}}));
    f.scatter(0.1);
    f.run(0.1, |s, step, patch| s.gather_contact(patch, step.dt));
    // 1/2 kg of each at the nodes (0, 4) and (1, 4), at the first one the images too
    close(&f.patch.contact.forces.concat(), &[5.0, 0.0, 5.0, 0.0]);
}

#[test]
fn the_affine_velocity_is_that_of_the_own_body() {
    let mut f = pair("apic");
    f.set("affine_velocity", &[0.0, 8.0]).scatter(0.1);
    close(
        &[f.node_of(0, "lumped_velocity", [3]), f.node_of(1, "lumped_velocity", [5])],
        &[2.0, 3.0],
    );
}
