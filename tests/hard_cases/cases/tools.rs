//! Runs in memory and what is taken from them.

use decomp::{Comm, Serial};
use flyer_mpm::accuracy::reference::ReferenceSolution;
use flyer_mpm::exact::Errors;
use flyer_mpm::input;
use flyer_mpm::scene::CheckedScene;
use flyer_mpm::simulation::{Compiled, ParticleTable};
use flyer_mpm::simulation::{Simulation, Totals};
use flyer_mpm::solver::Stepper;
use serde_json::{Value, json};

use super::scenes::{shipped, with};

/// What a run leaves at the times of its profiles and at its end.
pub struct Ended<const D: usize> {
    /// Particles at each profile time.
    pub tables: Vec<ParticleTable>,
    /// Digest of the state at the end.
    pub digest: String,
    /// Sums at the start and at the end.
    pub totals: [Totals<D>; 2],
    /// Steps made.
    pub steps: u64,
}

impl<const D: usize> Ended<D> {
    /// Relative change of total energy.
    pub fn energy_drift(&self) -> f64 {
        let [start, end] = self.totals.map(|t| t.kinetic + t.internal);
        (end - start) / if start == 0.0 { 1.0 } else { start }
    }

    /// The particles at the last profile time.
    pub fn last(&self) -> &ParticleTable {
        self.tables.last().expect("a profile at the end")
    }

    /// A column at the last profile time.
    pub fn column(&self, name: &str) -> &[f64] {
        self.last().column(name).expect("a column of the table")
    }
}

/// Checks a scene.
pub fn checked(value: &Value) -> Result<CheckedScene, String> {
    input::parse(value.to_string().as_bytes(), "hard.json", &[]).map_err(|e| e.to_string())
}

/// Runs a scene on this rank of `comm`. Collective.
pub fn run_on<const D: usize>(value: &Value, comm: &dyn Comm) -> Result<Ended<D>, String>
where
    Stepper<D>: Compiled<D>,
{
    let scene = checked(value)?;
    let mut simulation =
        Simulation::<D>::new(&scene, comm, 1).map_err(|e| format!("at set-up: {e}"))?;
    let start = simulation.totals();
    let mut tables = Vec::new();
    let mut digest = String::new();
    let end = scene.scene.time.end;
    let ends = if scene.profile_times.last() == Some(&end) { None } else { Some(end) };
    for time in scene.profile_times.iter().copied().chain(ends) {
        while simulation.time() < time {
            simulation.advance(time).map_err(|e| e.to_string())?;
        }
        if let Some((table, last)) = simulation.gather() {
            tables.push(table);
            digest = last;
        }
    }
    let totals = [start, simulation.totals()];
    Ok(Ended { tables, digest, totals, steps: simulation.steps() })
}

/// Runs a scene on a line.
pub fn run(value: &Value) -> Result<Ended<1>, String> {
    run_on(value, &Serial)
}

/// Runs a scene and scores its profiles, particle by particle.
pub fn scored(value: &Value) -> Result<(Ended<1>, Vec<Errors>), String> {
    let scene = checked(value)?;
    let ended = run(value)?;
    let reference = ReferenceSolution::new(&scene).map_err(|e| e.to_string())?;
    let reference = reference.ok_or("a scene without a reference")?;
    let score = |(k, table)| reference.score(&scene, k, table).map(|(raw, _)| raw);
    let errors: Option<Vec<Errors>> =
        ended.tables.iter().take(scene.profile_times.len()).enumerate().map(score).collect();
    Ok((ended, errors.ok_or("a profile without an exact one")?))
}

/// `inputs/flyer.json` until its second profile, 0.5 us.
pub fn flyer() -> Value {
    until(&shipped("flyer.json"), &[0.2e-6, 0.5e-6])
}

/// A scene of `inputs/hard` with the scheme and viscosity of `inputs/flyer.json`.
pub fn hard(name: &str) -> Value {
    with_flyers_scheme(shipped(&format!("hard/{name}")))
}

/// A scene with the scheme and viscosity of `inputs/flyer.json` in place of its own.
pub fn with_flyers_scheme(mut value: Value) -> Value {
    let own = shipped("flyer.json");
    value["method"] = own["method"].clone();
    value["artificial_viscosity"] = own["artificial_viscosity"].clone();
    value
}

/// A scene that ends with the last of its profiles, at `times` [s].
pub fn until(value: &Value, times: &[f64]) -> Value {
    let edit = json!({
        "time": {"end": times.last()},
        "output": {"profiles": {"times": times}, "pictures": false, "hdf5": false},
    });
    with(value, &edit)
}

/// The flyer with a target of 2 mm, until `end` [s], without a score.
pub fn short(end: f64) -> Value {
    let mut value = until(&shipped("flyer.json"), &[end]);
    value["domain"]["lower"] = json!([-0.0007]);
    value["domain"]["upper"] = json!([0.0033]);
    value["bodies"][1]["box"]["upper"] = json!([0.0026]);
    value
}

/// A scene with the scheme and viscosity of `inputs/flyer.json`, in a domain from 0 to `cells`
/// cells of 10 um, until `end` [s].
pub fn scene_of(cells: usize, end: f64, materials: &Value, bodies: &Value) -> Value {
    let flyer = shipped("flyer.json");
    json!({
        "title": "hard",
        "domain": {"lower": [0.0], "upper": [cells as f64 * CELL], "cell_size": CELL},
        "time": {"end": end},
        "method": flyer["method"],
        "artificial_viscosity": flyer["artificial_viscosity"],
        "materials": materials,
        "bodies": bodies,
    })
}

/// Edge of a cell of the standard problem [m].
pub const CELL: f64 = 1e-5;

/// A body of such a scene, between two cells.
pub fn lump(name: &str, material: &str, cells: [f64; 2], velocity: f64) -> Value {
    json!({
        "name": name,
        "material": material,
        "box": {"lower": [cells[0] * CELL], "upper": [cells[1] * CELL]},
        "velocity": [velocity],
        "particles_per_cell": [2],
    })
}

/// The materials of the standard problem.
pub fn metals() -> Value {
    shipped("flyer.json")["materials"].clone()
}

/// Greatest magnitude.
pub fn greatest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most: f64, value| most.max(value.abs()))
}

/// Greatest difference over the greatest magnitude of `b`.
pub fn apart(a: &[f64], b: &[f64]) -> f64 {
    if a.len() != b.len() {
        return f64::NAN;
    }
    let most = a.iter().zip(b).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
    if most == 0.0 { 0.0 } else { most / greatest(b) }
}

/// NaN, and the message on standard error.
pub fn failed(what: &str, message: &str) -> f64 {
    eprintln!("{what}: {message}");
    f64::NAN
}

/// Columns of state that are compared between two runs.
pub const FIELDS: [&str; 5] =
    ["pressure", "velocity", "density", "specific_internal_energy", "artificial_viscosity"];
