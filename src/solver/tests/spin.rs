//! Spin of particles in the mass matrix: one step of six particles of 1/2 kg.

use serde_json::{Value, json};

use super::fixture::{Fixture, close};

const DT: f64 = 0.01;

/// Three by two particles with spin, in a step at the middle, by FMPM of an order.
fn six(shape: &str, order: u32, changes: Value) -> Fixture<2> {
    let body = json!({"name": "body", "material": "fluid", "particles_per_cell": [1, 1],
        "box": {"lower": [2.0, 3.0], "upper": [5.0, 5.0]}});
    let mut scene = json!({"bodies": [body], "method": {"shape": shape, "transfer": {"fmpm": order},
        "stepping": "midpoint", "energy": "compatible", "filter_heat": true, "spin": true}});
    scene.as_object_mut().unwrap().extend(changes.as_object().cloned().unwrap_or_default());
    let mut f = Fixture::new(scene);
    f.set("velocity_x", &[0.3, -1.0, 2.0, 0.7, 0.1, -0.4]);
    f.set("velocity_y", &[1.5, 0.2, -0.9, 0.8, -2.0, 0.6]);
    f.set("spin", &[0.2, -0.3, 0.1, 0.5, 0.0, -0.4]);
    f.set("jacobian", &[0.9, 1.0, 0.95, 1.0, 0.8, 1.0]);
    f
}

/// Angular momentum about the origin, and energy.
fn kept(f: &Fixture<2>) -> [f64; 2] {
    let of = |name: &str| f.get(name);
    let (m, e) = (of("mass"), of("specific_internal_energy"));
    let [x, y, vx, vy] = ["position_x", "position_y", "velocity_x", "velocity_y"].map(of);
    let (spin, inertia) = (of("spin"), of("spin_inertia"));
    let sum = |term: &dyn Fn(usize) -> f64| (0..m.len()).map(|r| m[r] * term(r)).sum();
    [
        sum(&|r| x[r] * vy[r] - y[r] * vx[r] + spin[r]),
        sum(&|r| {
            let spin = spin[r] * spin[r] / inertia[r];
            0.5 * (vx[r] * vx[r] + vy[r] * vy[r] + spin) + e[r]
        }),
    ]
}

#[test]
fn angular_momentum_and_energy_stay_at_any_order() {
    for shape in ["gimp", "cpdi", "bspline_quadratic", "bspline_cubic", "cpdi_bspline_quadratic"] {
        for order in [1, 2, 5] {
            for changes in
                [json!({}), json!({"boundary": {"x_lower": "periodic", "x_upper": "periodic"}})]
            {
                let mut f = six(shape, order, changes);
                let before = kept(&f);
                f.advance(DT).advance(DT);
                for (before, after) in before.into_iter().zip(kept(&f)) {
                    let off = after - before;
                    assert!(off.abs() < 2e-13 * before.abs().max(10.0), "{shape} {order}: {off:e}");
                }
                assert!(f.get("spin").iter().all(|b| b.abs() > 1e-6), "{shape} {order}");
            }
        }
    }
}

/// A rigid rotation is no noise: its nodes turn rigidly, and no heat arises.
#[test]
fn a_rigid_rotation_is_in_the_kernel_of_the_filter() {
    for order in [2, 6] {
        let mut f = six("cpdi_bspline_quadratic", order, json!({}));
        let (x, y) = (f.get("position_x"), f.get("position_y"));
        let speed = 1e-3;
        let of =
            |values: &[f64], factor: f64| values.iter().map(|v| factor * v).collect::<Vec<_>>();
        f.set("velocity_x", &of(&y, -speed)).set("velocity_y", &of(&x, speed));
        let inertia = f.get("spin_inertia");
        f.set("spin", &of(&inertia, speed)).set("jacobian", &[1.0; 6]);
        f.set("velocity_gradient", &[0.0; 6]);
        f.solve(0.0);
        for node in [[2, 3], [3, 4], [5, 5], [1, 2]] {
            let exact = [-speed * node[1] as f64, speed * node[0] as f64];
            close(&[f.node("velocity_x", node), f.node("velocity_y", node)], &exact);
            assert!(f.node("filter_residual_x", node).abs() < 1e-15);
        }
    }
}

/// In a mirror a spin changes its direction, so that a wall holds the particles next to it alike.
#[test]
fn a_mirror_reverses_the_spin() {
    let wall = json!({"boundary": {"x_lower": "wall"}, "bodies": [{"name": "body",
        "material": "fluid", "particles_per_cell": [1, 1],
        "box": {"lower": [0.0, 3.0], "upper": [1.0, 5.0]}}]});
    let mut f = two_at_a_wall(wall);
    f.solve(0.1);
    for node in [[0, 3], [0, 4], [0, 5]] {
        assert_eq!(f.node("velocity_x", node), 0.0);
    }
    let [right, left] = [1, -1].map(|x| f.node("velocity_y", [x, 4]));
    assert!(right != 0.0 && right == left, "{right} {left}");
}

fn two_at_a_wall(changes: Value) -> Fixture<2> {
    let mut scene = json!({"method": {"shape": "bspline_quadratic", "transfer": {"fmpm": 3},
        "stepping": "midpoint", "energy": "compatible", "filter_heat": true, "spin": true}});
    scene.as_object_mut().unwrap().extend(changes.as_object().cloned().unwrap_or_default());
    let mut f = Fixture::new(scene);
    f.set("spin", &[0.7, -0.2]).set("velocity_x", &[1.0, 0.5]);
    f
}
