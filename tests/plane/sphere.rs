//! A sphere that strikes a block: hot edges of the contact are warned of.

use decomp::Serial;
use flyer_mpm::simulation::Simulation;
use serde_json::{Value, json};

use crate::tools::checked;

/// Copper on copper at 3 km/s about an axis, a sphere or a plate, and what the run warns of.
fn warnings(shape: &Value) -> Vec<String> {
    let mut striker = shape.clone();
    striker["name"] = json!("striker");
    striker["material"] = json!("copper");
    striker["velocity"] = json!([0.0, -3000.0]);
    striker["particles_per_cell"] = json!([2, 2]);
    let value = json!({
        "title": "sphere on a block",
        "domain": {
            "lower": [0.0, -0.003], "upper": [0.006, 0.003], "cell_size": 2.5e-4,
            "geometry": "axisymmetric",
        },
        "time": {"end": 1.5e-7, "courant": 0.4},
        "method": {
            "shape": "cpdi_bspline_quadratic", "transfer": {"fmpm": 4}, "stepping": "midpoint",
            "energy": "compatible", "filter_heat": true, "edge_mask": 0.3, "domain_limit": 1.0,
            "pressure_relaxation": {"rate": 0.1, "interval": 1},
        },
        "materials": {"copper": {
            "density": 8930.0,
            "eos": {"type": "mie_gruneisen", "c0": 3940.0, "s": 1.489, "gamma0": 1.96},
            "thermal": {"specific_heat": 383.0, "reference_temperature": 300.0},
        }},
        "boundary": {"x_lower": "symmetry", "x_upper": "outflow", "y_upper": "outflow"},
        "bodies": [
            {
                "name": "block", "material": "copper", "particles_per_cell": [2, 2],
                "box": {"lower": [0.0, -0.0025], "upper": [0.005, 0.0]},
            },
            striker,
        ],
        "artificial_viscosity": {"linear": 0.1, "quadratic": 1.25, "limiter": "christensen"},
    });
    let scene = checked(&value);
    let mut simulation = Simulation::<2>::new(&scene, &Serial, 1).unwrap();
    while simulation.time() < scene.scene.time.end {
        simulation.advance(scene.scene.time.end).unwrap();
    }
    simulation.peaks().warnings()
}

/// The edge of the contact of a sphere outruns the shock, so that its pressure is some times that
/// of a plane impact (Lesser 1981); a plate at the same speed is not warned of.
#[test]
fn heat_far_beyond_the_hugoniot_is_warned_of() {
    let sphere = json!({"intersection": [
        {"disk": {"centre": [0.0, 0.0025], "radius": 0.0025}},
        {"box": {"lower": [0.0, 0.0], "upper": [0.005, 0.0025]}},
    ]});
    let hot = warnings(&sphere);
    assert!(hot.len() == 1 && hot[0].contains("beyond the Hugoniot"), "{hot:?}");
    let plate = json!({"box": {"lower": [0.0, 0.0], "upper": [0.005, 0.0025]}});
    assert_eq!(warnings(&plate), Vec::<String>::new());
}
