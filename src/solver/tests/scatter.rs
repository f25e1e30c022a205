//! Sums of mass, momentum and force over particles, and their quotients on nodes.

use serde_json::json;

use super::fixture::{Fixture, close};

/// Masses 2 and 4 kg at 3.25 and 4.5 m on a line.
fn pair(changes: serde_json::Value) -> Fixture<1> {
    let mut f = Fixture::new(changes);
    f.set("position", &[3.25, 4.5]).set("mass", &[2.0, 4.0]);
    f
}

#[test]
fn mass_momentum_and_force_of_two_particles() {
    let mut f = pair(json!({}));
    f.set("velocity", &[3.0, -1.0]).set("stress_volume", &[5.0, 7.0]).scatter(0.1);
    // N = (3/4, 1/4) and (1/2, 1/2) on the nodes 3, 4 and 4, 5
    close(&f.line("mass", 2..=6), &[0.0, 1.5, 0.5 + 2.0, 2.0, 0.0]);
    close(&f.line("inverse", 2..=6), &[0.0, 1.0 / 1.5, 0.4, 0.5, 0.0]);
    // momenta 2 x 3 N and -4 N
    close(&f.line("lumped_velocity", 3..=5), &[4.5 / 1.5, (1.5 - 2.0) / 2.5, -2.0 / 2.0]);
    // f = sum S G with G = (-1, 1): pressure pushes the nodes apart
    close(&f.line("acceleration", 3..=5), &[-5.0 / 1.5, (5.0 - 7.0) / 2.5, 7.0 / 2.0]);
}

#[test]
fn the_affine_velocity_adds_to_the_momentum() {
    let mut f = pair(json!({"method": {"transfer": "apic"}}));
    f.set("velocity", &[3.0, -1.0]).set("affine_velocity", &[4.0, 8.0]).scatter(0.1);
    // v + C (x_i - x) = 3 + 4 (-1/4), 3 + 4 (3/4) and -1 + 8 (-1/2), -1 + 8/2
    let momenta = [1.5 * 2.0, 0.5 * 6.0 + 2.0 * -5.0, 2.0 * 3.0];
    close(
        &f.line("lumped_velocity", 3..=5),
        &[momenta[0] / 1.5, momenta[1] / 2.5, momenta[2] / 2.0],
    );
}

#[test]
fn a_node_with_a_rounding_error_of_mass_is_empty_and_slow_nodes_rest() {
    let mut f = pair(json!({}));
    // densest body 2 kg/m3 in a cell: empty below 2 x 2^-90 kg
    f.set("mass", &[2f64.powi(-92), 4.0]).set("velocity", &[1.0, 10.0 * 2f64.powi(-51)]);
    f.scatter(0.1);
    close(&f.line("inverse", 3..=5), &[0.0, 0.5, 0.5]);
    // 2^-50 of the fastest wave, 10 m/s
    assert_eq!(f.line("lumped_velocity", 3..=5), [0.0; 3]);
    f.set("velocity", &[1.0, 10.0 * 2f64.powi(-49)]).scatter(0.1);
    assert!(f.node("lumped_velocity", [5]) > 0.0);
}

/// One particle of 8 kg at (3.25, 3.5) in a plane; another one is far away.
fn single(mut f: Fixture<2>) -> Fixture<2> {
    f.set("position_x", &[3.25, 6.5]).set("position_y", &[3.5, 6.5]).set("mass", &[8.0, 1.0]);
    f
}

/// 24 particles in 3 x 2 cells of a plane, four in each, which have moved by up to half a cell: some windows
/// follow each other, some come back later.
pub(super) fn moved_square() -> Fixture<2> {
    let body = json!([{
        "name": "body",
        "material": "fluid",
        "box": {"lower": [3.0, 3.0], "upper": [6.0, 5.0]},
        "particles_per_cell": [2, 2],
    }]);
    let mut f = Fixture::<2>::new(json!({"bodies": body}));
    let number = |k: usize| ((k * k * 31 + k * 17) % 97) as f64 / 97.0 - 0.5;
    let all = |from: usize, scale: f64| -> Vec<f64> {
        (from..from + 24).map(|k| scale * number(k)).collect()
    };
    let moved = |at: Vec<f64>, by: Vec<f64>| -> Vec<f64> {
        at.iter().zip(by).map(|(at, by)| at + by).collect()
    };
    let [x, y] = ["position_x", "position_y"].map(|name| f.get(name));
    f.set("position_x", &moved(x, all(0, 1.0))).set("position_y", &moved(y, all(100, 1.0)));
    f.set("velocity_x", &all(200, 7.0)).set("velocity_y", &all(300, 7.0));
    f.set("mass", &moved(vec![1.0; 24], all(400, 1.0))).set("stress_volume", &all(500, 90.0));
    f.scatter(0.1);
    f
}

#[test]
fn sums_of_whole_windows_are_those_one_by_one() {
    let mut f = moved_square();
    let at = &f.stepper.fields;
    let [mass, momentum, force] = [at.mass, at.lumped_velocity, at.acceleration];
    let bits = |f: &Fixture<2>| -> Vec<u64> {
        let fields = [mass, momentum, momentum + 1, force, force + 1].into_iter();
        fields.flat_map(|k| &f.patch.nodes.fields[k]).map(|v| v.to_bits()).collect()
    };
    f.run(0.1, |s, _, patch| s.scatter_squares(patch));
    let squares = bits(&f);
    f.run(0.1, |s, _, patch| s.scatter_width::<2, false, false, false>(patch, true));
    assert!(squares == bits(&f) && squares.iter().filter(|v| **v != 0).count() > 60);
}

/// Values of a field at the nodes (3, 3), (4, 3), (3, 4) and (4, 4).
fn corners(f: &Fixture<2>, field: &str) -> [f64; 4] {
    [[3, 3], [4, 3], [3, 4], [4, 4]].map(|index| f.node(field, index))
}

/// Shares of the particle on these nodes.
const SHARES: [f64; 4] = [0.375, 0.125, 0.375, 0.125];

#[test]
fn in_a_plane() {
    let mut f = single(Fixture::new(json!({})));
    f.set("velocity_x", &[1.0, 0.0]).set("velocity_y", &[-2.0, 0.0]);
    f.set("stress_volume", &[4.0, 0.0]).scatter(0.1);
    close(&corners(&f, "mass"), &SHARES.map(|n| 8.0 * n));
    close(&corners(&f, "lumped_velocity_x"), &[1.0; 4]);
    close(&corners(&f, "lumped_velocity_y"), &[-2.0; 4]);
    // G_x = (-1/2, 1/2) on both lines; G_y = -(3/4, 1/4) below and above the opposite
    let force = |g: [f64; 4]| std::array::from_fn::<f64, 4, _>(|k| 4.0 * g[k] / (8.0 * SHARES[k]));
    close(&corners(&f, "acceleration_x"), &force([-0.5, 0.5, -0.5, 0.5]));
    close(&corners(&f, "acceleration_y"), &force([-0.75, -0.25, 0.75, 0.25]));
}

#[test]
fn the_affine_velocity_in_a_plane() {
    let mut f = single(Fixture::new(json!({"method": {"transfer": "apic"}})));
    for (column, value) in
        [("affine_xx", 1.0), ("affine_xy", 10.0), ("affine_yx", 100.0), ("affine_yy", 1000.0)]
    {
        f.set(column, &[value, 0.0]);
    }
    f.scatter(0.1);
    // C (x_i - x) with x_i - x = (-1/4 or 3/4, -1/2 or 1/2)
    let apart = [[-0.25, -0.5], [0.75, -0.5], [-0.25, 0.5], [0.75, 0.5]];
    close(&corners(&f, "lumped_velocity_x"), &apart.map(|[x, y]| x + 10.0 * y));
    close(&corners(&f, "lumped_velocity_y"), &apart.map(|[x, y]| 100.0 * x + 1000.0 * y));
}

#[test]
fn with_axial_symmetry_pressure_pushes_outward() {
    let mut f = single(Fixture::axisymmetric(json!({})));
    f.set("stress_volume", &[4.0, 0.0]).scatter(0.1);
    // S (G_x + N/r) at the radius 3.25
    let slopes = [-0.5, 0.5, -0.5, 0.5];
    let exact = std::array::from_fn::<f64, 4, _>(|k| {
        4.0 * (slopes[k] + SHARES[k] / 3.25) / (8.0 * SHARES[k])
    });
    close(&corners(&f, "acceleration_x"), &exact);
}

#[test]
fn a_symmetric_stress_pulls_with_its_shear() {
    let mut f = single(Fixture::solid(json!({})));
    for (column, value) in
        [("stress_volume_xx", 4.0), ("stress_volume_yy", 6.0), ("stress_volume_xy", 10.0)]
    {
        f.set(column, &[value, 0.0]);
    }
    f.scatter(0.1);
    let (gx, gy) = ([-0.5, 0.5, -0.5, 0.5], [-0.75, -0.25, 0.75, 0.25]);
    let of = |x: f64, y: f64| {
        std::array::from_fn::<f64, 4, _>(|k| (x * gx[k] + y * gy[k]) / (8.0 * SHARES[k]))
    };
    close(&corners(&f, "acceleration_x"), &of(4.0, 10.0));
    close(&corners(&f, "acceleration_y"), &of(10.0, 6.0));
}

#[test]
fn images_in_a_wall_double_the_mass_and_oppose_the_momentum() {
    let mut f = pair(json!({"boundary": {"x_lower": "wall"}}));
    f.set("position", &[0.25, 4.5]).set("velocity", &[3.0, 0.0]);
    f.set("stress_volume", &[5.0, 0.0]).scatter(0.1);
    close(&f.line("mass", 0..=1), &[2.0 * 1.5, 0.5]);
    // on the wall the image takes what the particle gives; its pressure pushes the other way
    close(&f.line("lumped_velocity", 0..=1), &[0.0, 3.0]);
    close(&f.line("acceleration", 0..=1), &[0.0, 5.0 / 0.5]);
}

#[test]
fn joined_sides_share_their_node() {
    let mut f = pair(json!({"boundary": {"x_lower": "periodic", "x_upper": "periodic"}}));
    f.set("position", &[0.5, 7.75]).set("velocity", &[3.0, -1.0]);
    f.set("stress_volume", &[5.0, 7.0]).solve(0.1);
    // node 0 is node 8: half of 2 kg and three quarters of 4 kg
    close(&[f.node("mass", [0])], &[4.0]);
    for node in [0, 8] {
        close(&[f.node("velocity", [node])], &[(3.0 - 3.0) / 4.0]);
        close(&[f.node("velocity_star", [node])], &[0.1 * (7.0 - 5.0) / 4.0]);
    }
}

#[test]
fn domains_spread_a_particle_over_more_nodes() {
    // half a cell from 2.85 to 3.35 m: means of the hat functions over it
    let body = json!([{"name": "body", "material": "fluid", "particles_per_cell": [2],
        "box": {"lower": [3.0], "upper": [4.0]}}]);
    let mut f = Fixture::<1>::new(json!({"method": {"shape": "gimp"}, "bodies": body.clone()}));
    f.set("position", &[3.1, 6.5]).set("mass", &[4.0, 4.0]).set("stress_volume", &[5.0, 0.0]);
    f.scatter(0.1);
    let (left, right) = (0.5 * 0.15 * 0.15 / 0.5, 0.5 * 0.35 * 0.35 / 0.5);
    let mass = [4.0 * left, 4.0 * (1.0 - left - right), 4.0 * right];
    close(&f.line("mass", 2..=4), &mass);
    // gradients: differences of the hat functions at the ends, over the length
    let force = [5.0 * -0.15 / 0.5, 5.0 * (0.65 - 0.85) / 0.5, 5.0 * 0.35 / 0.5];
    close(&f.line("acceleration", 2..=4), &std::array::from_fn::<_, 3, _>(|k| force[k] / mass[k]));
    // stretched to 3/4 of a cell from 2.725 to 3.475 m: means of the hat functions at the ends
    let mut f = Fixture::<1>::new(json!({"method": {"shape": "cpdi"}, "bodies": body}));
    f.set("position", &[3.1, 6.5]).set("mass", &[4.0, 4.0]).set("jacobian", &[1.5, 1.0]);
    f.set("stress_volume", &[5.0, 0.0]).scatter(0.1);
    let mass = [2.0 * 0.275, 2.0 * (0.725 + 0.525), 2.0 * 0.475];
    close(&f.line("mass", 2..=4), &mass);
    let force = [5.0 * -0.275 / 0.75, 5.0 * (0.525 - 0.725) / 0.75, 5.0 * 0.475 / 0.75];
    close(&f.line("acceleration", 2..=4), &std::array::from_fn::<_, 3, _>(|k| force[k] / mass[k]));
}

#[test]
fn nodes_with_little_material_are_the_edge() {
    let method = json!({"transfer": {"fmpm": 2}, "stepping": "midpoint", "edge_mask": 0.3});
    let mut f = pair(json!({"method": method}));
    f.set("jacobian_mid", &[1.0, 0.5]).scatter(0.1);
    // filled by V N: 1 m at 3.25 and 1/2 m at 4.5
    close(&f.line("volume", 3..=5), &[0.75, 0.25 + 0.25, 0.25]);
    let edge: Vec<_> =
        f.patch.edge.iter().map(|&i| i as i64 + f.patch.nodes.nodes.lower[0]).collect();
    assert_eq!(edge, [5]);
}

#[test]
fn in_the_total_lagrangian_frame_gradients_follow_the_deformation() {
    let mut f = Fixture::<1>::new(json!({"method": {"frame": "total_lagrangian"}}));
    f.set("jacobian", &[0.5, 2.0]).set("velocity", &[3.0, -1.0]);
    // the second sum keeps weights and masses of the first one
    for stress in [[5.0, 7.0], [50.0, 70.0]] {
        f.run(0.1, |s, step, patch| s.invert_deformation(patch, 0.0, step.jacobian));
        f.set("stress_volume", &stress).scatter(0.1);
        // masses 2 kg at 3.5 and 4.5, G = (-1, 1)/J
        close(&f.line("mass", 3..=5), &[1.0, 2.0, 1.0]);
        close(&f.line("lumped_velocity", 3..=5), &[3.0, 1.0, -1.0]);
        let [a, b] = [stress[0] / 0.5, stress[1] / 2.0];
        close(&f.line("acceleration", 3..=5), &[-a, (a - b) / 2.0, b]);
    }
}

#[test]
fn beyond_an_outer_wall_the_image_is_pushed_inward() {
    let mut f = single(Fixture::axisymmetric(
        json!({"boundary": {"x_lower": "symmetry", "x_upper": "wall"}}),
    ));
    f.set("position_x", &[7.75, 3.5]).set("stress_volume", &[4.0, 0.0]).scatter(0.1);
    // the hoop stress of the particle at the radius 7.75 pushes outward, that of its image inward
    close(&[f.node("acceleration_x", [8, 3])], &[0.0]);
    close(&[f.node("acceleration_x", [7, 3])], &[4.0 * (-0.5 + 0.125 / 7.75)]);
}

#[test]
fn about_an_axis_a_node_is_empty_below_the_mass_at_the_outer_radius() {
    // 2^-90 of 2 kg/m3 x 1 m2 x 8 m; the node has 3/8 of the particle
    for (scale, empty) in [(42.0, true), (43.0, false)] {
        let mut f = single(Fixture::axisymmetric(json!({})));
        f.set("mass", &[scale * 2f64.powi(-90), 1.0]).scatter(0.1);
        assert_eq!(f.node("inverse", [3, 3]) == 0.0, empty, "{scale}");
    }
}
