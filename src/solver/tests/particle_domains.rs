//! Domains of particles, in cells.

use serde_json::json;

use super::fixture::{Fixture, close};

#[test]
fn lengths_on_a_line() {
    let lengths = |method: serde_json::Value| {
        let mut f = Fixture::<1>::new(json!({"method": method}));
        f.set("jacobian", &[1.5, 0.5]);
        f.run(0.1, |s, step, patch| s.find_cells(patch, 0.0, step.jacobian));
        let longest = f.run(0.1, |s, _, patch| s.longest_own(&patch.block));
        (f.get("cell_length"), longest)
    };
    assert_eq!(lengths(json!({"shape": "gimp"})), (vec![1.0, 1.0], 1.0));
    assert_eq!(lengths(json!({"shape": "cpdi"})), (vec![1.5, 0.5], 1.5));
    assert_eq!(lengths(json!({"shape": "cpdi", "domain_limit": 0.6})), (vec![1.2, 0.5], 1.2));
}

/// Half edges of two particles.
fn half_edges(f: &Fixture<2>) -> [Vec<f64>; 4] {
    ["cell_edge1_x", "cell_edge1_y", "cell_edge2_x", "cell_edge2_y"].map(|column| f.get(column))
}

fn deformed(method: serde_json::Value) -> Fixture<2> {
    let mut f = Fixture::<2>::new(json!({"method": method}));
    // stretched along x, and sheared
    f.set("deformation_xx", &[2.0, 1.0]).set("deformation_xy", &[0.0, 0.5]);
    f.set("jacobian", &[2.0, 1.0]);
    f
}

#[test]
fn parallelograms_follow_the_deformation() {
    let mut f = deformed(json!({"shape": "cpdi"}));
    f.run(0.1, |s, step, patch| s.find_cells(patch, 0.0, step.jacobian));
    let [ax, ay, bx, by] = half_edges(&f);
    close(&ax, &[1.0, 0.5]);
    close(&ay, &[0.0, 0.0]);
    close(&bx, &[0.0, 0.25]);
    close(&by, &[0.5, 0.5]);
    // the sheared one reaches over 2 (0.5 + 0.25) cells, the stretched one over 2
    close(&[f.run(0.1, |s, _, patch| s.longest_own(&patch.block))], &[2.0]);
    assert_eq!(f.run(0.1, |s, _, patch| s.first_longer(&patch.block, 1.6)), Some((0, 2.0)));
}

#[test]
fn parallelograms_are_extrapolated_by_the_velocity_gradient() {
    let mut f = deformed(json!({"shape": "cpdi"}));
    f.set("velocity_gradient_yx", &[1.0, 0.0]).set("velocity_gradient_yy", &[0.0, 5.0]);
    f.set("jacobian", &[2.0, 1.5]);
    f.run(0.1, |s, step, patch| s.find_cells(patch, 0.1, step.jacobian));
    // (1 + 0.1 L) F = (2, 0; 0.2, 1) and (1, 0.5; 0, 1.5), of the areas 2 and 1.5
    let [ax, ay, bx, by] = half_edges(&f);
    close(&ax, &[1.0, 0.5]);
    close(&ay, &[0.1, 0.0]);
    close(&bx, &[0.0, 0.25]);
    close(&by, &[0.5, 0.75]);
}

#[test]
fn a_volume_that_differs_from_the_deformation_changes_the_strained_direction() {
    let mut f = deformed(json!({"shape": "cpdi"}));
    f.set("deformation_xy", &[0.0, 0.0]).set("jacobian", &[3.0, 4.0]);
    f.run(0.1, |s, step, patch| s.find_cells(patch, 0.0, step.jacobian));
    // half as long again along x; the second is not strained and grows evenly
    let [ax, _, _, by] = half_edges(&f);
    close(&ax, &[1.5, 1.0]);
    close(&by, &[0.5, 1.0]);
}

#[test]
fn along_a_direction_between_the_axes_too() {
    let mut f = deformed(json!({"shape": "cpdi"}));
    // twice as long along (1, 1): with a volume of 3 three times, and as wide as before
    for (component, value) in [("xx", 1.5), ("xy", 0.5), ("yx", 0.5), ("yy", 1.5)] {
        f.set(&format!("deformation_{component}"), &[value, value]);
    }
    f.set("jacobian", &[2.0, 3.0]);
    f.run(0.1, |s, step, patch| s.find_cells(patch, 0.0, step.jacobian));
    let [ax, ay, bx, by] = half_edges(&f);
    close(&ax, &[0.75, 1.0]);
    close(&ay, &[0.25, 0.5]);
    close(&bx, &[0.25, 0.5]);
    close(&by, &[0.75, 1.0]);
}

#[test]
fn with_axial_symmetry_the_area_is_the_volume_over_the_radius() {
    let mut f = Fixture::<2>::axisymmetric(json!({"method": {"shape": "cpdi"}}));
    // per radian at the radii 3.5 and 4.5; the second has moved out by half a metre
    close(&f.get("volume0"), &[3.5, 4.5]);
    f.set("velocity_x", &[0.0, 5.0]);
    f.run(0.1, |s, step, patch| s.find_cells(patch, 0.1, step.jacobian));
    let [ax, _, _, by] = half_edges(&f);
    close(&[ax[0] * by[0], ax[1] * by[1]], &[0.25, 0.25 * 4.5 / 5.0]);
}

#[test]
fn boxes_keep_their_size() {
    let mut f = Fixture::<2>::new(json!({"method": {"shape": "gimp"}}));
    f.set("jacobian", &[2.0, 0.5]);
    f.run(0.1, |s, step, patch| s.find_cells(patch, 0.0, step.jacobian));
    assert_eq!((f.get("cell_width"), f.get("cell_height")), (vec![1.0; 2], vec![1.0; 2]));
}

#[test]
fn a_leapfrog_step_deforms_forward() {
    let mut f = deformed(json!({"shape": "cpdi"}));
    for (column, value) in [("xx", 1.0), ("xy", 2.0), ("yx", 3.0), ("yy", 4.0)] {
        f.set(&format!("velocity_gradient_{column}"), &[value, value]);
    }
    f.run(0.1, |s, step, patch| s.deform_forward(patch, step.dt));
    // (1 + dt L) F with 1 + dt L = (1.1, 0.2; 0.3, 1.4)
    close(&f.get("deformation_xx"), &[2.2, 1.1]);
    close(&f.get("deformation_xy"), &[0.2, 1.1 * 0.5 + 0.2]);
    close(&f.get("deformation_yx"), &[0.6, 0.3]);
    close(&f.get("deformation_yy"), &[1.4, 0.15 + 1.4]);
}
