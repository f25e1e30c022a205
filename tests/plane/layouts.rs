//! Any layout of a plane leaves the same bits.

use serde_json::{Value, json};

use crate::tools::{digest_on, impact};

/// Plates whose corners and free sides lie within many patches.
fn plates() -> Value {
    let flyer = json!({"box": {"lower": [-0.0003, 0.0], "upper": [0.0, 0.0004]}});
    let target = json!({"box": {"lower": [0.0, -0.0002], "upper": [0.0006, 0.0006]}});
    let mut scene = impact([[-0.0006, -0.0004], [0.001, 0.0008]], [flyer, target], [1e3, 2e2]);
    scene["time"]["end"] = json!(1.2e-8);
    scene
}

const LAYOUTS: [[usize; 2]; 5] = [[1, 1], [4, 1], [1, 4], [3, 5], [8, 8]];

#[track_caller]
fn same(mut scene: Value, what: &str) {
    scene["domain"]["patches"] = json!([1, 1]);
    scene["decomposition"] = json!({"skip_quiescent": false, "filter_halo": "exchange"});
    let whole = digest_on(&scene, 1, 1);
    for (k, layout) in LAYOUTS.into_iter().enumerate() {
        for ranks in 1..=4 {
            // every option meets every layout and number of ranks in turn
            let mut shared = scene.clone();
            shared["domain"]["patches"] = json!(layout);
            shared["decomposition"] = json!({
                "skip_quiescent": (k + ranks) % 2 == 0,
                "overlap": (k / 2 + ranks) % 2 == 0,
                "filter_halo": (["exchange", "redundant"][(k + ranks / 2) % 2]),
                "balance": {"every": 7 * (ranks % 2), "cost": "particles"}
            });
            let threads = 1 + (k + ranks) % 2;
            assert_eq!(digest_on(&shared, ranks, threads), whole, "{what}: {shared}");
        }
    }
}

#[test]
fn the_default_scheme() {
    same(plates(), "default");
}

/// Ghosts carry spin, and a mirror reverses it.
#[test]
fn particles_with_spin() {
    let mut scene = plates();
    let order = json!({"preset": "default", "spin": true, "transfer": {"fmpm": 4}});
    scene["method"] = order;
    scene["domain"]["lower"] = json!([-0.0006, -0.0002]);
    scene["boundary"] = json!({"y_lower": "symmetry"});
    scene["bodies"][0]["velocity"] = json!([1e3, 3e2]);
    same(scene, "spin");
}

/// Particles compare their volumes with the space at nodes that other patches own.
#[test]
fn volumes_relaxed_to_the_space_that_there_is() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/inputs/gresho.json");
    let mut scene: Value = serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap();
    scene.as_object_mut().unwrap().remove("reference");
    scene["bodies"][0]["particles_per_cell"] = json!([2, 2]);
    scene["time"]["end"] = json!(0.01);
    scene["output"] = json!({});
    same(scene.clone(), "volume relaxation on splines");
    scene["method"]["shape"] = json!("cpdi_bspline_quadratic");
    scene["method"]["domain_limit"] = json!(0.7);
    same(scene, "volume relaxation on parallelograms");
}

#[test]
fn the_total_lagrangian_frame() {
    for (shape, transfer) in
        [("cpdi_bspline_quadratic", json!({"fmpm": 4})), ("gimp", json!("flip"))]
    {
        let mut scene = plates();
        scene["method"] = json!({
            "frame": "total_lagrangian", "shape": shape, "transfer": transfer,
            "stepping": "midpoint"
        });
        same(scene, shape);
    }
}

#[test]
fn other_schemes() {
    for (shape, transfer) in [
        ("linear", json!("flip")),
        ("cpdi", json!("apic")),
        ("gimp", json!({"xpic": 2})),
        ("bspline_cubic", json!({"fmpm": 3})),
    ] {
        let mut scene = plates();
        scene["method"] = json!({"shape": shape, "transfer": transfer});
        scene["time"]["end"] = json!(6e-9);
        same(scene, shape);
    }
}

#[test]
fn bodies_in_contact() {
    for (contact, end) in [
        (json!({"type": "frictionless"}), 1.2e-8),
        (json!({"type": "friction", "coefficient": 0.3, "normals": "logistic_regression"}), 6e-9),
    ] {
        let mut scene = plates();
        scene["contact"] = contact;
        scene["time"]["end"] = json!(end);
        // they meet within the run
        scene["bodies"][0]["box"] = json!({"lower": [-0.000303, 0.0], "upper": [-3e-6, 0.0004]});
        same(scene.clone(), "contact");
        scene["method"] = json!({"shape": "gimp", "transfer": "apic"});
        scene["time"]["end"] = json!(6e-9);
        same(scene, "contact");
    }
}

#[test]
fn about_an_axis() {
    let mut scene = plates();
    scene["domain"]["lower"] = json!([0.0, -0.0004]);
    scene["domain"]["geometry"] = json!("axisymmetric");
    scene["boundary"] = json!({"x_lower": "symmetry"});
    scene["bodies"][0]["box"] = json!({"lower": [0.0, -0.0002], "upper": [0.0003, 0.0]});
    scene["bodies"][1]["box"] = json!({"lower": [0.0, 0.0], "upper": [0.0006, 0.0004]});
    scene["bodies"][0]["velocity"] = json!([0.0, 1e3]);
    same(scene, "axisymmetric");
}

#[test]
fn round_bodies_between_periodic_sides() {
    let mut scene = plates();
    scene["bodies"][0] = json!({
        "name": "flyer", "material": "copper", "velocity": [1e3, 3e2], "particles_per_cell": [2, 2],
        "disk": {"centre": [-0.0003, 0.0007], "radius": 0.0002}
    });
    scene["bodies"][1] = json!({
        "name": "target", "material": "aluminium", "particles_per_cell": [2, 2],
        "box": {"lower": [-0.0001, -0.0004], "upper": [0.0004, 0.0008]}
    });
    scene["boundary"] = json!({"y_lower": "periodic", "y_upper": "periodic"});
    scene["domain"]["lower"] = json!([-0.0006, -0.0004]);
    scene["bodies"][0]["disk"]["centre"] = json!([-0.0003, 0.0005]);
    same(scene, "periodic");
}

/// A plate driven against a wall that rubs, out of a side that waves pass, between walls that it
/// sticks to; a fluid and a solid.
#[test]
fn sides_that_push() {
    let flyer = json!({"box": {"lower": [-0.0003, 0.0], "upper": [0.0, 0.0004]}});
    let target = json!({"box": {"lower": [0.0, -0.0002], "upper": [0.00006, 0.0006]}});
    let domain = [[-0.0006, -0.0002], [0.00006, 0.0006]];
    let mut scene = impact(domain, [flyer, target], [1e3, 2e2]);
    scene["time"]["end"] = json!(1.5e-8);
    scene["boundary"] =
        json!({"x_upper": "transmitting", "y_lower": {"friction": 0.4}, "y_upper": "no_slip"});
    same(scene.clone(), "a fluid");
    scene["materials"]["aluminium"]["eos"] =
        json!({"type": "neo_hookean", "youngs_modulus": 7e10, "poissons_ratio": 0.33});
    scene["bodies"][0]["velocity"] = json!([200.0, 100.0]);
    scene["boundary"]["y_lower"] = json!("no_slip");
    scene["boundary"]["y_upper"] = json!("transmitting");
    same(scene.clone(), "a solid");
    scene["method"] = json!({"shape": "gimp", "transfer": "apic"});
    scene["contact"] = json!({"type": "friction", "coefficient": 0.2});
    scene["boundary"]["y_upper"] = json!({"friction": 0.4});
    scene["time"]["end"] = json!(6e-9);
    same(scene, "contact");
}
