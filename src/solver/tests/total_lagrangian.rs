//! Kernels of the total-Lagrangian frame.

use serde_json::{Value, json};

use super::fixture::{Fixture, close};

fn method() -> Value {
    json!({"method": {"frame": "total_lagrangian", "stepping": "midpoint"}})
}

const COMPONENTS: [&str; 4] = ["xx", "xy", "yx", "yy"];

/// Components of a tensor of the first particle.
fn tensor(f: &Fixture<2>, name: &str) -> [f64; 4] {
    COMPONENTS.map(|component| f.get(&format!("{name}_{component}"))[0])
}

fn set_tensor(f: &mut Fixture<2>, name: &str, values: [f64; 4]) {
    for (component, value) in COMPONENTS.into_iter().zip(values) {
        f.set(&format!("{name}_{component}"), &[value, value]);
    }
}

fn product(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    [
        a[0] * b[0] + a[1] * b[2],
        a[0] * b[1] + a[1] * b[3],
        a[2] * b[0] + a[3] * b[2],
        a[2] * b[1] + a[3] * b[3],
    ]
}

/// F, and L that makes it (2.02, 0.61; 0.06, 1.055) after 0.05 s.
const F: [f64; 4] = [2.0, 0.5, 0.0, 1.0];
const L: [f64; 4] = [0.2, 2.1, 0.6, 0.8];
const F_HALF: [f64; 4] = [2.02, 0.5 + 0.05 * (0.1 + 2.1), 0.06, 1.0 + 0.05 * (0.3 + 0.8)];

#[test]
fn the_inverse_deformation_is_that_of_the_time_of_the_forces() {
    let mut f = Fixture::<1>::new(method());
    f.set("jacobian_mid", &[0.5, 4.0]);
    f.run(0.1, |s, step, patch| s.invert_deformation(patch, 0.05, step.jacobian));
    close(&f.get("inverse_deformation_xx"), &[2.0, 0.25]);
    let mut f = Fixture::<2>::new(method());
    set_tensor(&mut f, "deformation", F);
    set_tensor(&mut f, "velocity_gradient", L);
    f.run(0.1, |s, step, patch| s.invert_deformation(patch, 0.05, step.jacobian));
    let one = product(tensor(&f, "inverse_deformation"), F_HALF);
    close(&one, &[1.0, 0.0, 0.0, 1.0]);
    assert_eq!(f.fault(), None);
    set_tensor(&mut f, "velocity_gradient", [-40.0, 0.0, 0.0, 0.0]);
    f.run(0.1, |s, step, patch| s.invert_deformation(patch, 0.05, step.jacobian));
    assert_eq!(f.fault(), Some("it is turned inside out within one step"));
}

#[test]
fn the_deformation_follows_the_displacements_of_the_grid() {
    let mut f = Fixture::<2>::new(method());
    set_tensor(&mut f, "deformation", F);
    set_tensor(&mut f, "velocity_gradient", L);
    f.run(0.1, |s, step, patch| s.invert_deformation(patch, 0.05, step.jacobian));
    // gradient with respect to the initial positions (3, 5; 7, 11), all the step
    let flow = [(2.0, [3.0, 5.0]), (7.0, [7.0, 11.0])];
    f.set_flow(flow, flow);
    f.gather_midpoint(0.1);
    close(&tensor(&f, "deformation"), &[2.3, 1.0, 0.7, 2.1]);
    // pushed forward: l F_h is that gradient
    close(&product(tensor(&f, "velocity_gradient"), F_HALF), &[3.0, 5.0, 7.0, 11.0]);
}

#[test]
fn gradients_are_pulled_back_to_the_initial_positions() {
    let mut f = Fixture::<2>::new(method());
    let sheared = [2.0, 0.5, 0.25, 1.0];
    set_tensor(&mut f, "deformation", sheared);
    set_tensor(&mut f, "velocity_gradient", L);
    f.run(0.1, |s, step, patch| {
        let gradient = s.columns.velocity_gradient.unwrap();
        s.pull_gradient(patch, gradient, step.jacobian);
    });
    close(&tensor(&f, "velocity_gradient"), &product(L, sheared));
    let mut f = Fixture::<1>::new(method());
    f.set("velocity_gradient", &[3.0, 5.0]).set("jacobian_mid", &[0.5, 4.0]);
    f.run(0.1, |s, step, patch| {
        let gradient = s.columns.divergence;
        s.pull_gradient(patch, gradient, step.jacobian);
    });
    close(&f.get("velocity_gradient"), &[1.5, 20.0]);
}

#[test]
fn cells_and_domains_are_those_of_the_start() {
    let mut f = Fixture::<2>::new({
        let mut scene = method();
        scene["method"]["shape"] = json!("cpdi");
        scene
    });
    f.set("position_x", &[6.1, 6.9]).set("velocity_x", &[9.0, 9.0]);
    set_tensor(&mut f, "deformation", F);
    f.run(0.1, |s, step, patch| s.find_cells(patch, 0.05, step.jacobian));
    assert_eq!(f.patch.block.cells, [[3, 3], [4, 3]]);
    close(&f.get("cell_fraction_x"), &[0.5, 0.5]);
    for (column, half) in ["1_x", "1_y", "2_x", "2_y"].into_iter().zip([0.5, 0.0, 0.0, 0.5]) {
        close(&f.get(&format!("cell_edge{column}")), &[half; 2]);
    }
}

#[test]
fn contact_knows_displacements_and_current_volumes() {
    let body = |name: &str, from: f64| {
        json!({"name": name, "material": "fluid", "particles_per_cell": [1],
            "box": {"lower": [from], "upper": [from + 1.0]}})
    };
    let mut scene = method();
    scene["contact"] = json!({"type": "frictionless"});
    scene["bodies"] = json!([body("a", 3.0), body("b", 4.0)]);
    let mut f = Fixture::<1>::new(scene);
    f.set("position", &[3.75, 4.0]).set("velocity", &[2.0, -4.0]).set("jacobian_mid", &[0.5, 3.0]);
    f.run(0.1, |s, step, patch| s.find_cells(patch, 0.05, step.jacobian));
    close(&f.get("displacement"), &[0.25 + 0.1, -0.5 - 0.2]);
    close(&f.get("current_volume"), &[0.5, 3.0]);
}

#[test]
fn the_radius_is_the_current_one() {
    let mut scene = method();
    scene["method"]["shape"] = json!("gimp");
    let mut f = Fixture::<2>::axisymmetric(scene);
    f.set("position_x", &[3.75, 4.0]).set("velocity_x", &[2.0, -4.0]);
    f.run(0.1, |s, step, patch| s.find_cells(patch, 0.05, step.jacobian));
    close(&f.get("radius"), &[3.85, 3.8]);
}

#[test]
fn a_wall_acts_on_what_touched_it_at_the_start_alone() {
    let mut scene = method();
    scene["boundary"] = json!({"x_upper": "wall"});
    let mut f = Fixture::<1>::new(scene);
    for (at, passes) in [(7.9, false), (8.1, true)] {
        f.set("position", &[3.5, at]);
        f.run(0.1, |s, step, patch| s.find_cells(patch, 0.0, step.jacobian));
        assert_eq!(f.fault().is_some_and(|what| what.contains("passes a wall")), passes);
    }
}
