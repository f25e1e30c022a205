//! Scenes of one slab, and runs to look at.

use std::path::Path;

use decomp::Serial;
use flyer_mpm::accuracy::reference::ReferenceSolution;
use flyer_mpm::exact::Errors;
use flyer_mpm::input;
use flyer_mpm::scene::CheckedScene;
use flyer_mpm::simulation::ParticleTable;
use flyer_mpm::simulation::{Simulation, Totals};
use serde_json::{Value, json};

/// A shipped scene, to be edited.
pub fn shipped(name: &str) -> Value {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs").join(name);
    serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap()
}

/// `piston.json` of another material, cut to 120 cells of unit length: a slab that runs into a wall
/// at `speed` until the shock, at `shock_speed` or less, has passed 70 of 100 cells.
pub fn slab(density: f64, eos: Value, speed: f64, shock_speed: f64) -> Value {
    let mut value = shipped("piston.json");
    value["domain"] = json!({"lower": [0.0], "upper": [0.0012], "cell_size": 1e-5});
    value["materials"] = json!({"aluminium": {"density": density, "eos": eos}});
    value["bodies"][0]["box"]["upper"] = json!([0.001]);
    value["bodies"][0]["velocity"] = json!([-speed]);
    let end = 0.0007 / shock_speed;
    value["time"]["end"] = json!(end);
    value["output"] = json!({"profiles": {"times": [end]}});
    if value["materials"]["aluminium"]["eos"]["type"] == "p_alpha" {
        value["artificial_viscosity"] =
            shipped("porous_impact.json")["artificial_viscosity"].clone();
    }
    value
}

/// A scene that must pass its check.
#[track_caller]
pub fn checked(value: &Value) -> CheckedScene {
    match input::parse(value.to_string().as_bytes(), "test.json", &[]) {
        Ok(scene) => scene,
        Err(error) => panic!("{error}"),
    }
}

/// What a run leaves.
pub struct Outcome {
    /// Particles at the end.
    pub last: ParticleTable,
    /// Digest of the state at the end.
    pub digest: String,
    /// Score of the end, where the scene names a solution.
    pub errors: Option<Errors>,
    /// Sums at the start and at the end.
    pub totals: [Totals<1>; 2],
}

impl Outcome {
    /// A column of the particles at the end.
    #[track_caller]
    pub fn column(&self, name: &str) -> &[f64] {
        self.last.column(name).unwrap_or_else(|| panic!("no column {name}"))
    }

    /// Relative change of the total energy.
    pub fn energy_drift(&self) -> f64 {
        let [start, end] = self.totals.map(|t| t.kinetic + t.internal);
        end / start - 1.0
    }
}

/// Runs a scene to its end; the error is what ended it.
pub fn try_run(value: &Value) -> Result<Outcome, String> {
    let scene = checked(value);
    let mut simulation =
        Simulation::<1>::new(&scene, &Serial, 1).map_err(|error| error.to_string())?;
    let first = simulation.totals();
    let end = scene.scene.time.end;
    while simulation.time() < end {
        simulation.advance(end).map_err(|error| error.to_string())?;
    }
    let (last, digest) = simulation.gather().unwrap();
    let reference = ReferenceSolution::new(&scene).unwrap();
    let errors = reference.and_then(|r| r.score(&scene, 0, &last)).map(|(errors, _)| errors);
    Ok(Outcome { last, digest, errors, totals: [first, simulation.totals()] })
}

/// Runs a scene to its end; it must succeed.
#[track_caller]
pub fn run(value: &Value) -> Outcome {
    match try_run(value) {
        Ok(outcome) => outcome,
        Err(error) => panic!("{error}"),
    }
}

/// Asserts a magnitude.
#[track_caller]
pub fn at_most(what: &str, value: f64, bound: f64) {
    assert!(value.abs() <= bound, "{what}: {value:e}, allowed {bound:e}");
}

/// Leapfrog steps with the textbook's energy instead of mid-point ones, and viscosity that keeps
/// them quiet.
pub fn leapfrog(mut value: Value, update: &str) -> Value {
    value["method"] = json!({
        "shape": "gimp", "transfer": "flip", "stepping": "leapfrog", "stress_update": update
    });
    value["artificial_viscosity"] = json!({"linear": 0.5, "quadratic": 2.0});
    value
}
