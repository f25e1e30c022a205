//! Scenes in a plane, and runs of them.

use decomp::comm::local::run_ranks;
use decomp::{Comm, Serial};
use flyer_mpm::input;
use flyer_mpm::scene::CheckedScene;
use flyer_mpm::simulation::{BoundaryWork, Removed, Simulation, Totals};
use flyer_mpm::simulation::{Compiled, ParticleTable};
use flyer_mpm::solver::Stepper;
use serde_json::{Value, json};

/// Makes a checked scene.
pub fn checked(scene: &Value) -> CheckedScene {
    input::parse(scene.to_string().as_bytes(), "scene.json", &[])
        .unwrap_or_else(|error| panic!("{error}"))
}

/// What a run leaves.
pub struct Outcome<const D: usize> {
    /// All particles at the end.
    pub table: ParticleTable,
    /// Digest of the state at the end.
    pub digest: String,
    /// Sums at the start and at the end.
    pub totals: [Totals<D>; 2],
    /// What has left by open sides.
    pub left: Removed<D>,
    /// What the sides have given.
    pub given: BoundaryWork<D>,
}

impl<const D: usize> Outcome<D> {
    /// Relative change of the total energy.
    pub fn energy_drift(&self) -> f64 {
        let [start, end] = self.totals.map(|t| t.kinetic + t.internal);
        end / start - 1.0
    }

    /// Change of the total energy that is not booked, over the greatest of what there is.
    pub fn unbooked_energy(&self) -> f64 {
        let [start, end] = self.totals.map(|t| t.kinetic + t.internal);
        let gone = self.left.kinetic + self.left.internal;
        let work = self.given.work + self.totals[1].body_force_work;
        (end + gone - start - work) / start.max(end)
    }

    /// Change of the momentum along `a` that is not booked [N s].
    pub fn unbooked_momentum(&self, a: usize) -> f64 {
        let [start, end] = self.totals;
        let impulse = self.given.impulse[a] + end.body_force_impulse[a];
        end.momentum[a] + self.left.momentum[a] - start.momentum[a] - impulse
    }

    /// Mean of a column.
    pub fn mean(&self, name: &str) -> f64 {
        let column = self.column(name);
        column.iter().sum::<f64>() / column.len() as f64
    }

    /// A column of the last table.
    pub fn column(&self, name: &str) -> &[f64] {
        self.table.column(name).unwrap_or_else(|| panic!("no column {name}"))
    }
}

fn run_rank<const D: usize>(
    scene: &CheckedScene,
    comm: &dyn Comm,
    threads: usize,
) -> Option<Outcome<D>>
where
    Stepper<D>: Compiled<D>,
{
    let mut simulation = Simulation::<D>::new(scene, comm, threads).unwrap();
    let start = simulation.totals();
    while simulation.time() < scene.scene.time.end {
        simulation.advance(scene.scene.time.end).unwrap();
    }
    let totals = [start, simulation.totals()];
    let (left, given) = (simulation.left(), simulation.given());
    let (table, digest) = simulation.gather()?;
    Some(Outcome { table, digest, totals, left, given })
}

/// Runs a scene on one rank.
pub fn run<const D: usize>(scene: &Value) -> Outcome<D>
where
    Stepper<D>: Compiled<D>,
{
    run_rank(&checked(scene), &Serial, 1).expect("rank 0")
}

/// The digest of the state that ranks and threads leave, and what the sides have booked.
pub fn digest_on(scene: &Value, ranks: usize, threads: usize) -> String {
    let scene = checked(scene);
    let outcomes = run_ranks(ranks, |comm| run_rank::<2>(&scene, comm, threads));
    let outcome = outcomes.into_iter().flatten().next().expect("rank 0");
    format!("{} {:?} {:?}", outcome.digest, outcome.left, outcome.given)
}

/// Asserts that a scene leaves the same bits, books and all, on some layouts as on one patch.
#[track_caller]
pub fn same_bits(scene: &Value) {
    let on = |patches: [usize; 2], ranks: usize| {
        let mut scene = scene.clone();
        scene["domain"]["patches"] = json!(patches);
        digest_on(&scene, ranks, 1)
    };
    let whole = on([1, 1], 1);
    for (patches, ranks) in [([4, 1], 2), ([3, 5], 4), ([6, 4], 1)] {
        assert_eq!(on(patches, ranks), whole, "{patches:?} on {ranks}");
    }
}

/// Asserts a magnitude.
#[track_caller]
pub fn at_most(what: &str, value: f64, bound: f64) {
    assert!(value.abs() <= bound, "{what}: {value:e}, allowed {bound:e}");
}

/// Copper and aluminium.
pub fn metals() -> Value {
    let eos = |c0: f64, s: f64, gamma0: f64| json!({"type": "mie_gruneisen", "c0": c0, "s": s, "gamma0": gamma0});
    json!({
        "copper": {"density": 8930.0, "eos": eos(3940.0, 1.489, 1.96)},
        "aluminium": {"density": 2785.0, "eos": eos(5386.0, 1.339, 2.1)}
    })
}

/// The default scheme of the plane.
pub fn default_method() -> Value {
    json!({
        "shape": "cpdi_bspline_quadratic", "transfer": {"fmpm": 4}, "stepping": "midpoint",
        "energy": "compatible", "filter_heat": true,
        "pressure_relaxation": {"rate": 0.1, "interval": 1}, "edge_mask": 0.3, "domain_limit": 1.0
    })
}

/// A body of copper at 1 km/s on one of aluminium, both of `regions`, on cells of 20 um.
pub fn impact(domain: [[f64; 2]; 2], regions: [Value; 2], velocity: [f64; 2]) -> Value {
    let [mut flyer, mut target] = regions;
    let common = [
        (&mut flyer, "flyer", "copper", velocity),
        (&mut target, "target", "aluminium", [0.0, 0.0]),
    ];
    for (body, name, material, velocity) in common {
        body["name"] = json!(name);
        body["material"] = json!(material);
        body["velocity"] = json!(velocity);
        body["particles_per_cell"] = json!([2, 2]);
    }
    json!({
        "title": "an impact in a plane",
        "domain": {"lower": domain[0], "upper": domain[1], "cell_size": 2e-5},
        "time": {"end": 2e-8},
        "method": default_method(),
        "materials": metals(),
        "bodies": [flyer, target],
        "artificial_viscosity": {"linear": 0.1, "quadratic": 0.75, "limiter": "nodal"}
    })
}
