//! Scenes to edit and runs to look at.

use std::path::{Path, PathBuf};

use decomp::Serial;
use flyer_mpm::accuracy::reference::ReferenceSolution;
use flyer_mpm::exact::Errors;
use flyer_mpm::input;
use flyer_mpm::scene::CheckedScene;
use flyer_mpm::simulation::ParticleTable;
use flyer_mpm::simulation::Removed;
use flyer_mpm::simulation::{Simulation, Totals};
use serde_json::{Value, json};

pub use crate::scenes::{SHAPES, shipped, with};
pub use crate::small_scenes::ending;

/// Transfers, one or two of each kind.
pub fn transfers() -> [Value; 8] {
    [
        json!("flip"),
        json!("pic"),
        json!("apic"),
        json!({"flip_pic": 0.9}),
        json!({"xpic": 2}),
        json!({"xpic": 5}),
        json!({"fmpm": 2}),
        json!({"fmpm": 4}),
    ]
}

/// Files of the shipped scenes.
pub fn inputs() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs");
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> =
        entries.filter(|path| path.extension().is_some_and(|e| e == "json")).collect();
    files.sort();
    files
}

/// The standard problem or one like it, cut short: a target of 2 mm, ending after `end` [s].
/// Nothing that happens to the waves until 0.3 us is changed by that.
pub fn short(name: &str, end: f64) -> Value {
    let mut value = shipped(name);
    value["domain"]["upper"] = json!([0.0033]);
    value["domain"]["lower"] = json!([-0.0007]);
    value["bodies"][1]["box"]["upper"] = json!([0.0026]);
    ending(&mut value, end);
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
    /// Particles at each profile time.
    pub tables: Vec<ParticleTable>,
    /// Digest of the state at the end.
    pub digest: String,
    /// Sums at the start.
    pub start: Totals<1>,
    /// Sums at the end.
    pub end: Totals<1>,
    /// What has left by outflows.
    pub left: Removed<1>,
}

impl Outcome {
    /// Relative change of the total energy.
    pub fn energy_drift(&self) -> f64 {
        let [start, end] = [self.start, self.end].map(|t| t.kinetic + t.internal);
        end / start - 1.0
    }

    /// Change of momentum over sum m |v| at the start.
    pub fn momentum_drift(&self) -> f64 {
        (self.end.momentum[0] - self.start.momentum[0]) / self.start.absolute_momentum
    }

    /// The particles at the last profile time.
    pub fn last(&self) -> &ParticleTable {
        self.tables.last().unwrap()
    }
}

/// Runs a checked scene to its end.
pub fn run_scene(scene: &CheckedScene, threads: usize) -> Result<Outcome, String> {
    let mut simulation =
        Simulation::<1>::new(scene, &Serial, threads).map_err(|e| format!("at set-up: {e}"))?;
    let start = simulation.totals();
    let mut tables = Vec::new();
    for &time in &scene.profile_times {
        while simulation.time() < time {
            simulation.advance(time).map_err(|e| e.to_string())?;
        }
        assert_eq!(simulation.time(), time, "profile times are met exactly");
        tables.push(simulation.gather().expect("rank 0").0);
    }
    while simulation.time() < scene.scene.time.end {
        simulation.advance(scene.scene.time.end).map_err(|e| e.to_string())?;
    }
    let digest = simulation.gather().expect("rank 0").1;
    let (end, left) = (simulation.totals(), simulation.left());
    Ok(Outcome { tables, digest, start, end, left })
}

/// Runs a scene to its end on one thread; it must succeed.
#[track_caller]
pub fn run(value: &Value) -> Outcome {
    match run_scene(&checked(value), 1) {
        Ok(outcome) => outcome,
        Err(error) => panic!("{error}"),
    }
}

/// Runs a scene and scores its profiles, particle by particle.
#[track_caller]
pub fn scored(value: &Value) -> (Outcome, Vec<Errors>) {
    let scene = checked(value);
    let outcome = run_scene(&scene, 1).unwrap_or_else(|error| panic!("{error}"));
    let reference = ReferenceSolution::new(&scene).unwrap().expect("a scene with a reference");
    let tables = outcome.tables.iter().enumerate();
    let errors =
        tables.map(|(k, table)| reference.score(&scene, k, table).expect("an exact profile").0);
    let errors = errors.collect();
    (outcome, errors)
}

/// A column of a table.
pub fn column<'a>(table: &'a ParticleTable, name: &str) -> &'a [f64] {
    table.column(name).unwrap()
}

/// Greatest magnitude.
pub fn greatest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// Greatest difference over the greatest magnitude of `b`.
pub fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let most = a.iter().zip(b).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
    if most == 0.0 { 0.0 } else { most / greatest(b) }
}

/// A value within a bound; the message has both.
#[track_caller]
pub fn at_most(what: &str, value: f64, bound: f64) {
    assert!(value.abs() <= bound, "{what}: {value:e}, allowed: {bound:e}");
}
