//! Particles that are taken out at a limit of strain or volume: they go, the books balance, and any
//! layout leaves the same bits.

use decomp::Comm;
use decomp::comm::local::run_ranks;
use flyer_mpm::effects::columns;
use flyer_mpm::scene::CheckedScene;
use flyer_mpm::simulation::{Compiled, Simulation};
use flyer_mpm::solver::Stepper;
use serde_json::{Value, json};

use crate::tools::{Outcome, at_most, checked, midpoint, run, shipped};

/// A short bar that strikes a wall about an axis, in an updated frame.
fn bar(method: Value) -> Value {
    json!({
        "title": "bar", "method": method,
        "domain": {"lower": [0.0, 0.0], "upper": [0.003, 0.004], "cell_size": 2.5e-4,
            "geometry": "axisymmetric"},
        "time": {"end": 1.5e-6, "courant": 0.3},
        "materials": {"metal": {
            "density": 7800.0,
            "eos": {"type": "mie_gruneisen", "c0": 4600.0, "s": 1.4, "gamma0": 2.0},
            "strength": {"type": "von_mises", "shear_modulus": 77e9, "yield_stress": 0.4e9},
            "erosion": {"plastic_strain": 0.3}
        }},
        "bodies": [{"name": "bar", "material": "metal",
            "box": {"lower": [0.0, 0.0], "upper": [0.0013, 0.002]},
            "velocity": [0.0, -600.0], "particles_per_cell": [2, 2]}],
        "artificial_viscosity": {"linear": 0.2, "quadratic": 2.0},
        "boundary": {"x_lower": "symmetry", "y_lower": "wall"}
    })
}

/// Aluminium with strength that parts behind its wave, limited.
fn slab(erosion: Value) -> Value {
    let mut scene = shipped("piston_elastic_plastic.json");
    scene["domain"]["cell_size"] = json!(5e-5);
    scene["bodies"][0]["velocity"] = json!([-400.0]);
    scene["time"]["end"] = json!(0.3e-6);
    scene["output"] = json!({});
    scene["materials"]["aluminium"]["erosion"] = erosion;
    scene
}

/// A plate of copper that strikes one of aluminium at rest, limited.
fn plates(frame: &str, erosion: Value) -> Value {
    let mut scene = shipped("flyer_strength.json");
    scene["domain"]["cell_size"] = json!(2e-5);
    scene["method"]["frame"] = json!(frame);
    scene["time"]["end"] = json!(0.1e-6);
    scene["output"] = json!({});
    for material in scene["materials"].as_object_mut().unwrap().values_mut() {
        material["erosion"] = erosion.clone();
    }
    scene
}

fn count<const D: usize>(outcome: &Outcome<D>) -> usize {
    outcome.ways.erosion.count as usize
}

/// Asserts that mass and energy, and along `a` momentum, are there or booked.
#[track_caller]
fn booked<const D: usize>(outcome: &Outcome<D>, momentum: Option<usize>) {
    let ([start, end], left) = (outcome.totals, outcome.ways.erosion);
    at_most("mass", (end.mass + left.mass) / start.mass - 1.0, 1e-12);
    at_most("energy", outcome.energy_drift(), 1e-12);
    if let Some(a) = momentum {
        let now = end.momentum[a] + left.momentum[a];
        at_most("momentum", now / start.momentum[a] - 1.0, 1e-12);
    }
}

#[test]
fn particles_go_at_the_limit_and_the_books_balance() {
    let method = midpoint("cpdi_bspline_quadratic", json!({"fmpm": 2}));
    let outcome = run::<2>(&bar(method.clone()));
    assert!(count(&outcome) > 5, "{}", count(&outcome));
    assert!(outcome.greatest("plastic_strain") < 0.3);
    booked(&outcome, None);
    // without a limit they stay, and are strained further
    let mut whole = bar(method);
    whole["materials"]["metal"].as_object_mut().unwrap().remove("erosion");
    let whole = run::<2>(&whole);
    assert_eq!(outcome.last.len() + count(&outcome), whole.last.len());
    assert!(whole.greatest("plastic_strain") > 0.3);
}

#[test]
fn momentum_is_booked_where_nothing_pushes() {
    for frame in ["updated_lagrangian", "total_lagrangian"] {
        let outcome = run::<1>(&plates(frame, json!({"plastic_strain": 0.05})));
        assert!(count(&outcome) > 5, "{frame}: {}", count(&outcome));
        booked(&outcome, Some(0));
    }
}

#[test]
fn what_spreads_goes() {
    // a gas into a void
    let mut scene = shipped("sod.json");
    scene["output"] = json!({});
    scene["bodies"].as_array_mut().unwrap().truncate(1);
    scene.as_object_mut().unwrap().remove("reference");
    let thinnest = |outcome: &Outcome<1>| {
        outcome.column("density").iter().fold(f64::INFINITY, |least: f64, d| least.min(*d))
    };
    let whole = run::<1>(&scene);
    assert!(thinnest(&whole) < 1.0 / 1.6, "{}", thinnest(&whole));
    scene["materials"]["gas_left"]["erosion"] = json!({"volume_ratio": 1.5});
    let outcome = run::<1>(&scene);
    assert!(count(&outcome) > 3, "{}", count(&outcome));
    assert_eq!(outcome.last.len() + count(&outcome), whole.last.len());
    assert!(thinnest(&outcome) > 1.0 / 1.5, "{}", thinnest(&outcome));
    booked(&outcome, None);
}

#[test]
fn every_kind_of_step_erodes() {
    for update in ["first", "last", "modified_last"] {
        let mut scene = slab(json!({"plastic_strain": 0.03}));
        scene["method"] = json!({"shape": "cpdi", "transfer": "flip", "stress_update": update});
        let outcome = run::<1>(&scene);
        assert!(count(&outcome) > 3, "{update}: {}", count(&outcome));
        assert!(outcome.greatest("plastic_strain") < 0.03, "{update}");
        let ([start, end], left) = (outcome.totals, outcome.ways.erosion);
        at_most(update, (end.mass + left.mass) / start.mass - 1.0, 1e-12);
    }
}

/// A grid that travels ever faster with a piston: what goes takes its share of the piston's work.
#[test]
fn books_balance_where_the_grid_accelerates() {
    let mut scene = slab(json!({"plastic_strain": 0.01}));
    scene["bodies"][0]["velocity"] = json!([0.0]);
    scene["boundary"]["x_lower"] = json!({"velocity": {"to": 400.0, "duration": 1e-7}});
    scene.as_object_mut().unwrap().remove("reference");
    let checked = checked(&scene);
    let mut simulation = Simulation::<1>::new(&checked, &decomp::Serial, 1).unwrap();
    let start = simulation.totals();
    while simulation.time() < checked.scene.time.end {
        simulation.advance(checked.scene.time.end).unwrap();
    }
    let (end, left) = (simulation.totals(), simulation.left());
    let frame = checked.frame::<1>();
    let ahead = frame.energy_ahead(checked.scene.time.end, end.mass, &end.momentum)
        - frame.energy_ahead(0.0, start.mass, &start.momentum);
    let work = ahead + simulation.given().work;
    let whole = end.kinetic + end.internal + left.kinetic + left.internal;
    assert!(left.count > 5, "{}", left.count);
    at_most("energy", (whole - start.kinetic - start.internal - work) / whole, 1e-12);
}

#[test]
fn what_is_not_reached_costs_nothing_and_changes_no_bit() {
    let mut scene = slab(json!({"plastic_strain": 10.0, "volume_ratio": 10.0}));
    let limited = run::<1>(&scene);
    assert_eq!(count(&limited), 0);
    let count = columns(&checked(&scene)).specs.len();
    scene["materials"]["aluminium"].as_object_mut().unwrap().remove("erosion");
    assert_eq!(run::<1>(&scene).digest, limited.digest);
    assert_eq!(columns(&checked(&scene)).specs.len(), count);
}

fn end_of<const D: usize>(scene: &CheckedScene, comm: &dyn Comm) -> Option<String>
where
    Stepper<D>: Compiled<D>,
{
    let mut simulation = Simulation::<D>::new(scene, comm, 1).unwrap();
    while simulation.time() < scene.scene.time.end {
        simulation.advance(scene.scene.time.end).unwrap();
    }
    let (ways, totals, steps) = (simulation.ways(), simulation.totals(), simulation.steps());
    simulation.gather().map(|(_, digest)| format!("{digest} {ways:?} {totals:?} {steps}"))
}

fn on<const D: usize>(scene: &Value, patches: &Value, ranks: usize) -> String
where
    Stepper<D>: Compiled<D>,
{
    let mut scene = scene.clone();
    scene["domain"]["patches"] = patches.clone();
    let scene = checked(&scene);
    let all = run_ranks(ranks, |comm| end_of::<D>(&scene, comm));
    all.into_iter().flatten().next().expect("rank 0")
}

#[track_caller]
fn same<const D: usize>(scene: &Value, layouts: &[(Value, usize)])
where
    Stepper<D>: Compiled<D>,
{
    let one = json!(vec![1; D]);
    let whole = on::<D>(scene, &one, 1);
    assert!(!whole.contains("erosion: Left { count: 0"), "{whole}");
    for (patches, ranks) in layouts {
        assert_eq!(on::<D>(scene, patches, *ranks), whole, "{patches} on {ranks}");
    }
}

#[test]
fn any_layout_has_the_same_bits() {
    let wide = midpoint("cpdi_bspline_quadratic", json!({"fmpm": 2}));
    let layouts = [(json!([1, 2]), 2), (json!([3, 3]), 3), (json!([3, 4]), 1)];
    for method in [wide, json!({"shape": "gimp", "transfer": "apic"})] {
        same::<2>(&bar(method), &layouts);
    }
    // at the front of the wave, where patches at rest wake, with ghosts of either kind
    let layouts = [(json!([2]), 2), (json!([7]), 3), (json!([11]), 1)];
    for halo in ["exchange", "redundant"] {
        let mut scene = plates("updated_lagrangian", json!({"plastic_strain": 1e-6}));
        scene["decomposition"] = json!({"filter_halo": halo});
        same::<1>(&scene, &layouts);
    }
}
