//! Particles that are too hot: at the edge of the contact of a sphere and a block, and at the rims of
//! plates.

use std::path::Path;

use decomp::Serial;
use flyer_mpm::input;
use flyer_mpm::scene::CheckedScene;
use flyer_mpm::simulation::{Compiled, Simulation};
use flyer_mpm::solver::Stepper;
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
    warnings_of::<2>(&checked(&value))
}

/// Warnings of a run to its end.
fn warnings_of<const D: usize>(scene: &CheckedScene) -> Vec<String>
where
    Stepper<D>: Compiled<D>,
{
    let mut simulation = Simulation::<D>::new(scene, &Serial, 1).unwrap();
    while simulation.time() < scene.scene.time.end {
        simulation.advance(scene.scene.time.end).unwrap();
    }
    simulation.peaks().warnings()
}

/// A template of `flyer-mpm new` with changed values.
fn template(name: &str, sets: &[&str]) -> CheckedScene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs/templates");
    let bytes = input::read(&folder.join(name)).unwrap();
    let sets: Vec<String> = sets.iter().map(|set| set.to_string()).collect();
    input::parse(&bytes, name, &sets).unwrap()
}

/// Two plates of iron about an axis, by the default method with `spreading` of heat. The lower one is
/// wider, and the rim of the upper one is pressed outwards.
fn plates(spreading: &Value) -> Vec<String> {
    let value = json!({
        "title": "plates",
        "domain": {"lower": [0.0, -0.0021], "upper": [0.003, 0.0018], "cell_size": 7.5e-5,
            "geometry": "axisymmetric"},
        "time": {"end": 2.7e-7},
        "method": {"preset": "default", "heat_spreading": spreading},
        "materials": {"iron": {"library": "iron"}},
        "boundary": {"x_lower": "symmetry"},
        "contact": {"type": "frictionless"},
        "bodies": [
            {"name": "flyer", "material": "iron", "velocity": [0.0, -957.0],
                "box": {"lower": [0.0, 0.0], "upper": [0.0021, 0.0009]}},
            {"name": "target", "material": "iron",
                "box": {"lower": [0.0, -0.0015], "upper": [0.0024, 0.0]}},
        ],
    });
    let scene = input::parse(value.to_string().as_bytes(), "plates.json", &[]).unwrap();
    warnings_of::<2>(&scene)
}

#[test]
fn numerical_heat_at_a_rim_is_warned_of_unless_it_is_spread() {
    let alone = plates(&Value::Null);
    assert!(alone.len() == 1 && alone[0].contains("hotter than one shock"), "{alone:?}");
    assert_eq!(plates(&json!({"steps": 50})), Vec::<String>::new());
}

/// Elastic energy is not heat: neither in elastic solids nor in joined plates under tension.
#[test]
fn elastic_energy_is_not_warned_of() {
    let disks = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs/disks.json");
    let coarse = ["domain.cell_size=0.025".to_string(), "output={}".to_string()];
    let disks = input::parse(&input::read(&disks).unwrap(), "disks.json", &coarse).unwrap();
    assert_eq!(warnings_of::<2>(&disks), Vec::<String>::new());
    let plates = json!({
        "title": "joined plates",
        "domain": {"lower": [-0.0027, -0.0025], "upper": [0.0027, 0.0013], "cell_size": 1e-4},
        "time": {"end": 3.7e-7},
        "materials": {"aluminium": {"library": "aluminium_2024"}, "tungsten": {"library": "tungsten"}},
        "bodies": [
            {"name": "flyer", "material": "aluminium", "velocity": [0.0, -357.0],
                "box": {"lower": [-0.0011, 0.0], "upper": [0.0011, 0.00095]}},
            {"name": "target", "material": "tungsten",
                "box": {"lower": [-0.00225, -0.0021], "upper": [0.00225, 0.0]}},
        ],
    });
    let scene = input::parse(plates.to_string().as_bytes(), "plates.json", &[]).unwrap();
    assert_eq!(warnings_of::<2>(&scene), Vec::<String>::new());
}

/// Seven times the heat of the shock is plastic work in the foot of a bar; four times this heat is
/// that of the tension which a spall releases.
#[test]
fn heat_of_plastic_work_and_of_failure_is_not_warned_of() {
    let coarse = ["domain.cell_size=8e-4", "time.end=2e-5", "output={}"];
    let bar = template("taylor_bar.json", &coarse);
    assert_eq!(warnings_of::<2>(&bar), Vec::<String>::new());
    let spall = template("spall.json", &[]);
    assert_eq!(warnings_of::<1>(&spall), Vec::<String>::new());
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
    assert!(hot.len() == 1 && hot[0].contains("hotter than one shock can make them"), "{hot:?}");
    let plate = json!({"box": {"lower": [0.0, 0.0], "upper": [0.005, 0.0025]}});
    assert_eq!(warnings(&plate), Vec::<String>::new());
}
