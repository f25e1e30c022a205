//! Updates of particles from nodal velocities.

use serde_json::{Value, json};

use super::fixture::{Fixture, close};

/// Masses 2 and 4 kg at 3.25 and 4.5 m with velocities 3 and -1 m/s, between the nodes 3, 4 and 5
/// with velocities 10, 20, 40 m/s at the start and 14, 28, 32 m/s at the end of the step.
fn pair(method: Value) -> Fixture<1> {
    let mut f = Fixture::<1>::new(json!({"method": method}));
    f.set("position", &[3.25, 4.5]).set("mass", &[2.0, 4.0]).set("velocity", &[3.0, -1.0]);
    f.scatter(0.1);
    for (node, start, end) in [(3, 10.0, 14.0), (4, 20.0, 28.0), (5, 40.0, 32.0)] {
        f.set_node("lumped_velocity", [node], start);
        f.set_node("velocity", [node], start).set_node("velocity_star", [node], end);
    }
    f
}

/// N v at both particles, at the start and at the end of the step.
const START: [f64; 2] = [12.5, 30.0];
const END: [f64; 2] = [17.5, 30.0];

#[test]
fn transfers_of_velocity_in_a_leapfrog_step() {
    let blend = |a: f64| {
        // a v + (1 - a) N vL + N (v' - vL)
        [a * 3.0 + (1.0 - a) * START[0] + 5.0, -a + (1.0 - a) * START[1]]
    };
    for (transfer, velocity) in [
        (json!("flip"), [3.0 + 5.0, -1.0]),
        (json!("pic"), END),
        (json!({"flip_pic": 0.25}), blend(0.25)),
        (json!({"xpic": 2}), END),
        (json!({"fmpm": 2}), END),
        (json!("apic"), END),
    ] {
        let mut f = pair(json!({"transfer": transfer}));
        f.run(0.1, |s, step, patch| s.gather_leapfrog(patch, step.dt, true));
        close(&f.get("velocity"), &velocity);
        // x += dt N v', and the gradient of v'
        close(&f.get("position"), &[3.25 + 1.75, 4.5 + 3.0]);
        close(&f.get("velocity_gradient"), &[14.0, 4.0]);
    }
}

#[test]
fn one_pass_in_a_plane_has_the_bits_of_two() {
    let mut f = super::scatter::moved_square();
    let star = f.stepper.fields.velocity_star;
    for (k, field) in f.patch.nodes.fields[star..star + 2].iter_mut().enumerate() {
        let number = |i: usize| ((i * i * 13 + i * 29 + k) % 89) as f64 / 9.0 - 5.0;
        field.iter_mut().enumerate().for_each(|(i, v)| *v = number(i));
    }
    let bits = |f: &Fixture<2>| {
        ["position_x", "position_y", "velocity_x", "velocity_y", "velocity_gradient"]
            .map(|name| f.get(name).into_iter().map(f64::to_bits).collect::<Vec<_>>())
    };
    let before = f.patch.block.columns.clone();
    f.run(0.1, |s, step, patch| s.gather_leapfrog(patch, step.dt, true));
    let in_one = bits(&f);
    f.patch.block.columns = before;
    // sums one by one
    f.run(0.1, |s, _, patch| s.gather_gradient(patch));
    f.run(0.1, |s, step, patch| s.gather_leapfrog(patch, step.dt, false));
    assert_eq!(in_one, bits(&f));
}

#[test]
fn positions_in_a_mid_point_step() {
    for (transfer, velocity, moved) in [
        // dt N (v + v')/2
        (json!("flip"), [8.0, -1.0], [1.5, 3.0]),
        (json!("pic"), END, [1.5, 3.0]),
        // dt (v_p + v_p')/2
        (json!({"xpic": 2}), END, [0.05 * 20.5, 0.05 * 29.0]),
        (json!({"fmpm": 2}), END, [0.05 * 20.5, 0.05 * 29.0]),
        (json!("apic"), END, [0.05 * 20.5, 0.05 * 29.0]),
    ] {
        let mut f = pair(json!({"transfer": transfer, "stepping": "midpoint"}));
        f.gather_midpoint(0.1);
        close(&f.get("velocity"), &velocity);
        close(&f.get("position"), &[3.25 + moved[0], 4.5 + moved[1]]);
        // relative to the volume at the end, from J = 1 at the middle
        let j = f.get("jacobian");
        assert!(j.iter().all(|j| *j > 2.0), "{j:?}");
        close(&f.get("velocity_gradient"), &[14.0 / j[0], 4.0 / j[1]]);
    }
}

/// Volume ratios and energies after a mid-point step of 0.1 s; `work` are values of w on the nodes.
fn heated(method: Value, work: [f64; 3], lost: Option<[f64; 3]>) -> [Vec<f64>; 2] {
    let mut whole = json!({"stepping": "midpoint"});
    let method = method.as_object().unwrap().clone();
    whole.as_object_mut().unwrap().extend(method);
    let mut f = pair(whole);
    f.set("stress_volume", &[5.0, 7.0]).set("jacobian_mid", &[0.9, 1.1]);
    for (k, node) in (3..=5).enumerate() {
        f.set_node("work", [node], work[k]);
        if let Some(lost) = lost {
            f.set_node("filter_residual", [node], lost[k]);
        }
    }
    f.gather_midpoint(0.1);
    ["jacobian", "specific_internal_energy"].map(|column| f.get(column))
}

#[test]
fn volume_and_work_of_a_mid_point_step() {
    let [jacobian, energy] = heated(json!({"transfer": "flip"}), [0.0; 3], None);
    // the mean velocity has the gradient 12/s at both: J += dt J_h D, e -= S dt D/m
    close(&jacobian, &[1.0 + 0.1 * 0.9 * 12.0, 1.0 + 0.1 * 1.1 * 12.0]);
    close(&energy, &[-5.0 * 0.1 * 12.0 / 2.0, -7.0 * 0.1 * 12.0 / 4.0]);
    // with compatible energy the gradient of w works
    let method = json!({"transfer": "flip", "energy": "compatible"});
    let [jacobian, energy] = heated(method, [2.0, 4.0, 10.0], None);
    close(&jacobian, &[1.0 + 0.1 * 0.9 * 12.0, 1.0 + 0.1 * 1.1 * 12.0]);
    close(&energy, &[-5.0 * 0.1 * 2.0 / 2.0, -7.0 * 0.1 * 6.0 / 4.0]);
}

#[test]
fn heat_of_what_a_blend_forgets() {
    // v - N v and the variance N v^2 - (N v)^2 of the nodal velocity at the start
    let (rest, variance) = ([3.0 - 12.5, -1.0 - 30.0], [175.0 - 156.25, 1000.0 - 900.0]);
    for (transfer, a) in [(json!("pic"), 0.0), (json!({"flip_pic": 0.25}), 0.25)] {
        let method = json!({"transfer": transfer, "filter_heat": true});
        let [_, energy] = heated(method, [0.0; 3], None);
        let heat = |r: usize| 0.5 * (1.0 - a * a) * rest[r] * rest[r] + (1.0 - a) * variance[r];
        close(&energy, &[heat(0) - 3.0, heat(1) - 2.1]);
    }
}

#[test]
fn heat_of_what_a_filter_forgets() {
    let lost = [1.0, -2.0, 4.0];
    let method = json!({"transfer": {"xpic": 2}, "filter_heat": true});
    let [_, energy] = heated(method, [0.0; 3], Some(lost));
    // (v - N v)^2/2 + N (u w) - N u N w with the mean velocity w = 12, 24, 36
    let first = 0.5 * 9.5 * 9.5 + (0.75 * 12.0 - 0.25 * 48.0) - 0.25 * 15.0;
    let second = 0.5 * 31.0 * 31.0 + (-0.5 * 48.0 + 0.5 * 144.0) - 1.0 * 30.0;
    close(&energy, &[first - 3.0, second - 2.1]);
}

#[test]
fn the_affine_velocity_is_the_gradient() {
    let mut f = pair(json!({"transfer": "apic"}));
    f.run(0.1, |s, step, patch| s.gather_leapfrog(patch, step.dt, false));
    close(&f.get("affine_velocity"), &[14.0, 4.0]);
    // on a node, where its moments vanish, the gradient of the hat functions above it
    let mut f = pair(json!({"transfer": "apic"}));
    f.set("position", &[3.25, 4.0]).scatter(0.1);
    for (node, end) in [(3, 14.0), (4, 28.0), (5, 32.0)] {
        f.set_node("velocity_star", [node], end);
    }
    f.run(0.1, |s, step, patch| s.gather_leapfrog(patch, step.dt, false));
    close(&f.get("affine_velocity"), &[14.0, 4.0]);
}

/// A plane with the velocity (2 + 3 x + 5 y, 7 + 11 x + 13 y) m/s on the nodes at the end.
fn flow(mut f: Fixture<2>) -> Fixture<2> {
    f.set_flow([(0.0, [0.0; 2]); 2], [(2.0, [3.0, 5.0]), (7.0, [11.0, 13.0])]);
    f
}

#[test]
fn in_a_plane_linear_velocities_are_exact() {
    for shape in ["linear", "gimp", "bspline_quadratic", "bspline_cubic"] {
        let mut f = flow(Fixture::new(json!({"method": {"shape": shape, "transfer": "pic"}})));
        f.run(0.1, |s, step, patch| s.gather_leapfrog(patch, step.dt, true));
        // at (3.5, 3.5) and (4.5, 3.5)
        close(&f.get("velocity_x"), &[2.0 + 8.0 * 3.5, 2.0 + 8.0 * 3.5 + 3.0]);
        close(&f.get("velocity_y"), &[7.0 + 24.0 * 3.5, 7.0 + 24.0 * 3.5 + 11.0]);
        close(&f.get("velocity_gradient"), &[3.0 + 13.0; 2]);
    }
}

#[test]
fn the_affine_velocity_of_sheared_domains_is_exact() {
    let mut f = Fixture::<2>::new(json!({"method": {"shape": "cpdi", "transfer": "apic"}}));
    f.set("deformation_xy", &[0.5, 0.2]).set("position_x", &[3.3, 4.4]);
    f.set_flow([(0.0, [0.0; 2]); 2], [(2.0, [3.0, 5.0]), (7.0, [11.0, 13.0])]);
    f.run(0.1, |s, step, patch| s.gather_leapfrog(patch, step.dt, true));
    for (of, value) in [("xx", 3.0), ("xy", 5.0), ("yx", 11.0), ("yy", 13.0)] {
        close(&f.get(&format!("affine_{of}")), &[value; 2]);
        close(&f.get(&format!("velocity_gradient_{of}")), &[value; 2]);
    }
}

#[test]
fn with_axial_symmetry_radial_motion_strains_the_hoop() {
    let mut f = flow(Fixture::axisymmetric(json!({})));
    f.run(0.1, |s, step, patch| s.gather_leapfrog(patch, step.dt, true));
    // 3 + 13 + v_x/x
    let hoop = |x: f64| (2.0 + 3.0 * x + 5.0 * 3.5) / x;
    close(&f.get("velocity_gradient"), &[16.0 + hoop(3.5), 16.0 + hoop(4.5)]);
}

#[test]
fn a_rotation_turns_the_deformation_and_does_not_stretch_it() {
    let method = json!({"shape": "cpdi", "transfer": "flip", "stepping": "midpoint"});
    let mut f = Fixture::<2>::new(json!({"method": method}));
    // tan(angle/2) = w dt/2 = 1/2: cosine 3/5, sine 4/5
    let turning = [(0.0, [0.0, -10.0]), (0.0, [10.0, 0.0])];
    f.set("deformation_xx", &[2.0, 1.0]).set("deformation_xy", &[0.0, 1.0]);
    f.set_flow(turning, turning);
    f.gather_midpoint(0.1);
    close(&f.get("deformation_xx"), &[2.0 * 0.6, 0.6]);
    close(&f.get("deformation_xy"), &[-0.8, 0.6 - 0.8]);
    close(&f.get("deformation_yx"), &[2.0 * 0.8, 0.8]);
    close(&f.get("deformation_yy"), &[0.6, 0.8 + 0.6]);
    close(&f.get("jacobian"), &[1.0; 2]);
}

#[test]
fn the_deformation_of_a_mid_point_step_is_cayleys_form() {
    let method = json!({"shape": "cpdi", "transfer": "flip", "stepping": "midpoint"});
    let mut f = Fixture::<2>::new(json!({"method": method}));
    // mean gradient (2, 4; 0, -1), at the end (4, 8; 0, -2)
    f.set_flow([(0.0, [0.0; 2]); 2], [(0.0, [4.0, 8.0]), (0.0, [0.0, -2.0])]);
    f.gather_midpoint(0.1);
    // (1 - dt/2 l)^-1 (1 + dt/2 l) with dt/2 l = (0.1, 0.2; 0, -0.05):
    // yy = 0.95/1.05, xx = 1.1/0.9, xy = (0.2 + 0.2 yy)/0.9
    close(&f.get("deformation_xx"), &[1.1 / 0.9; 2]);
    close(&f.get("deformation_xy"), &[0.2 * (1.0 + 0.95 / 1.05) / 0.9; 2]);
    close(&f.get("deformation_yy"), &[0.95 / 1.05; 2]);
    assert_eq!(f.get("deformation_yx"), [0.0; 2]);
    close(&f.get("jacobian"), &[1.0 + 0.1 * (2.0 - 1.0); 2]);
    // relative to the volume at the end, 1.1 of that at the middle
    close(&f.get("velocity_gradient_xy"), &[8.0 / 1.1; 2]);
    close(&f.get("velocity_gradient_yy"), &[-2.0 / 1.1; 2]);
    close(&f.get("velocity_gradient"), &[(4.0 - 2.0) / 1.1; 2]);
}

#[test]
fn the_work_of_a_stress_tensor() {
    let mut f =
        Fixture::<2>::solid(json!({"method": {"transfer": "flip", "stepping": "midpoint"}}));
    let flow = [(2.0, [3.0, 5.0]), (7.0, [11.0, 13.0])];
    f.set_flow(flow, flow);
    for (column, value) in
        [("stress_volume_xx", 4.0), ("stress_volume_yy", 6.0), ("stress_volume_xy", 10.0)]
    {
        f.set(column, &[value, 0.0]);
    }
    let before = f.get("specific_internal_energy");
    f.gather_midpoint(0.1);
    // e -= dt S : l/m with m = 2 kg
    let work = 0.1 * (4.0 * 3.0 + 6.0 * 13.0 + 10.0 * (5.0 + 11.0));
    close(&f.get("specific_internal_energy"), &[before[0] - work / 2.0, before[1]]);
}
