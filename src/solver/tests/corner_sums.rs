//! Sums over the corners of particles against sums by their weights on the nodes.

use serde_json::{Value, json};

use super::fixture::Fixture;

/// 30 particles in cells of 1 by 0.5 m beside two walls, with an uneven velocity that shears them. The
/// nodal limiter forces sums by weights. It reduces the linear viscosity alone, which is 0 here, so that
/// the results are the same.
fn flow(update: &str, by_weights: bool) -> Fixture<2> {
    let mut viscosity = json!({"linear": 0.0, "quadratic": 0.5});
    if by_weights {
        viscosity["limiter"] = json!("nodal");
    }
    let mut f = Fixture::<2>::new(json!({
        "method": {"shape": "cpdi", "transfer": "flip", "stress_update": update},
        "artificial_viscosity": viscosity,
        "domain": {"cell_size": [1.0, 0.5]},
        "boundary": {"x_lower": "wall", "y_lower": "wall"},
        "bodies": [{
            "name": "body",
            "material": "fluid",
            "box": {"lower": [0.0, 0.0], "upper": [5.0, 0.75]},
            "particles_per_cell": [2, 2],
        }],
    }));
    let own = f.patch.block.own();
    assert_eq!((own, f.stepper.sums_corners()), (30, !by_weights));
    let wave =
        |a: usize| -> Vec<f64> { (0..own).map(|r| 0.5 * ((7 * r + 3 * a) as f64).sin()).collect() };
    f.set("velocity_x", &wave(0)).set("velocity_y", &wave(1));
    f
}

const COLUMNS: [&str; 9] = [
    "position_x",
    "position_y",
    "velocity_x",
    "velocity_y",
    "jacobian",
    "deformation_xx",
    "deformation_xy",
    "deformation_yx",
    "pressure",
];

#[test]
fn steps_by_corners_are_those_by_weights() {
    for update in ["last", "first", "modified_last"] {
        let [mut corners, mut weights] = [false, true].map(|by_weights| flow(update, by_weights));
        for _ in 0..12 {
            corners.advance(0.02);
            weights.advance(0.02);
        }
        let shear = corners.get("deformation_xy");
        assert!(shear.iter().any(|xy| xy.abs() > 0.01), "{update}: {shear:?}");
        for column in COLUMNS {
            let (a, b) = (corners.get(column), weights.get(column));
            let most = b.iter().fold(0.0, |most: f64, b| most.max(b.abs()));
            for (r, (a, b)) in a.iter().zip(&b).enumerate() {
                assert!((a - b).abs() <= 1e-12 * most, "{update}, {column} of {r}: {a} and {b}");
            }
        }
        let [x, y] = [0, 1].map(|a| (0..4).map(move |i| [i + a, i]));
        for index in x.chain(y) {
            let fields = [
                "mass",
                "lumped_velocity_x",
                "lumped_velocity_y",
                "acceleration_x",
                "acceleration_y",
            ];
            for field in fields {
                let (a, b) = (corners.node(field, index), weights.node(field, index));
                assert!((a - b).abs() <= 1e-11 * (1.0 + b.abs()), "{field}: {a} and {b}");
            }
        }
    }
}

/// All that needs the weights of particles on nodes takes them.
#[test]
fn other_schemes_sum_by_weights() {
    let sums = |changes: Value| Fixture::<2>::new(changes).stepper.sums_corners();
    let method = |changes: Value| {
        let mut method = json!({"shape": "cpdi", "transfer": "flip"});
        let keys = changes.as_object().expect("keys").clone();
        method.as_object_mut().expect("keys").extend(keys);
        sums(json!({"method": method}))
    };
    for transfer in [json!("flip"), json!("pic"), json!({"flip_pic": 0.9}), json!({"xpic": 1})] {
        assert!(method(json!({"transfer": transfer})), "{transfer}");
    }
    for changes in [
        json!({"shape": "gimp"}),
        json!({"transfer": "apic"}),
        json!({"transfer": {"fmpm": 2}}),
        json!({"transfer": {"xpic": 2}}),
        json!({"stepping": "midpoint"}),
        json!({"frame": "total_lagrangian"}),
    ] {
        assert!(!method(changes.clone()), "{changes}");
    }
    for changes in [
        json!({"body_force": {"gravity": [0.0, -1.0]}}),
        json!({"boundary": {"x_lower": "no_slip"}}),
        json!({"domain": {"geometry": "axisymmetric"}, "boundary": {"x_lower": "symmetry"}}),
    ] {
        let mut all = json!({"method": {"shape": "cpdi", "transfer": "flip"}});
        all.as_object_mut().expect("keys").extend(changes.as_object().expect("keys").clone());
        assert!(!sums(all), "{changes}");
    }
    let solid = json!({"method": {"shape": "cpdi", "transfer": "flip"}});
    assert!(!Fixture::<2>::solid(solid).stepper.sums_corners());
}
