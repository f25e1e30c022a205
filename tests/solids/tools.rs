//! Scenes to edit and runs to look at.

use decomp::Serial;
use flyer_mpm::accuracy::reference::PlaneReference;
use flyer_mpm::input;
use flyer_mpm::scene::CheckedScene;
use flyer_mpm::simulation::{Compiled, ParticleTable};
use flyer_mpm::simulation::{RemovedByKind, Simulation, Totals};
use flyer_mpm::solver::Stepper;
use serde_json::{Value, json};

/// A shipped scene, to be edited.
pub fn shipped(name: &str) -> Value {
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs").join(name);
    serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap()
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
pub struct Outcome<const D: usize> {
    /// Particles at the end.
    pub last: ParticleTable,
    /// Digest of the state at the end.
    pub digest: String,
    /// Sums at the start and at the end.
    pub totals: [Totals<D>; 2],
    /// What has left.
    pub ways: RemovedByKind<D>,
    /// Score of the end, where the scene names a solution.
    pub score: Value,
}

impl<const D: usize> Outcome<D> {
    /// Change of the total energy, what has left counted, less the work of a body force, over the
    /// greater of the energies.
    pub fn energy_drift(&self) -> f64 {
        let [start, end] = self.totals.map(|t| t.kinetic + t.internal);
        let left = self.ways.outflow.and(&self.ways.erosion);
        let end = end + (left.kinetic + left.internal);
        (end - start - self.totals[1].body_force_work) / start.max(end)
    }

    /// The greatest component of the change of momentum less that of a body force, over `scale`.
    pub fn momentum_drift(&self, scale: f64) -> f64 {
        let [start, end] = self.totals;
        let left = |a: usize| end.momentum[a] - start.momentum[a] - end.body_force_impulse[a];
        (0..D).fold(0.0f64, |most, a| most.max(left(a).abs())) / scale
    }

    /// A column of the particles at the end.
    #[track_caller]
    pub fn column(&self, name: &str) -> &[f64] {
        self.last.column(name).unwrap_or_else(|| panic!("no column {name}"))
    }

    /// Greatest magnitude in a column.
    #[track_caller]
    pub fn greatest(&self, name: &str) -> f64 {
        self.column(name).iter().fold(0.0, |most, v| most.max(v.abs()))
    }
}

/// Runs a scene to its end; it must succeed.
#[track_caller]
pub fn run<const D: usize>(value: &Value) -> Outcome<D>
where
    Stepper<D>: Compiled<D>,
{
    let scene = checked(value);
    assert_eq!(scene.dimension, D);
    let mut simulation = Simulation::<D>::new(&scene, &Serial, 1).unwrap();
    let first = simulation.totals();
    let start = simulation.gather().map(|(table, _)| table);
    let end = scene.scene.time.end;
    while simulation.time() < end {
        if let Err(error) = simulation.advance(end) {
            panic!("{error}");
        }
    }
    let (last, digest) = simulation.gather().unwrap();
    let score = PlaneReference::new(&scene)
        .and_then(|r| r.score(&scene, &last, start.as_ref()))
        .unwrap_or_default();
    let ways = simulation.ways();
    Outcome { last, digest, totals: [first, simulation.totals()], ways, score }
}

/// The method of mid-point steps with this shape function and transfer, and all that keeps energy.
pub fn midpoint(shape: &str, transfer: Value) -> Value {
    let mut method = json!({"shape": shape, "transfer": transfer, "stepping": "midpoint"});
    if transfer != "apic" {
        method["energy"] = json!("compatible");
        method["filter_heat"] = json!(transfer != "flip");
    }
    method
}

/// Asserts a magnitude.
#[track_caller]
pub fn at_most(what: &str, value: f64, bound: f64) {
    assert!(value.abs() <= bound, "{what}: {value:e}, allowed {bound:e}");
}
