//! Every effect on, on any layout: the same bits.

use decomp::Comm;
use decomp::comm::local::run_ranks;
use flyer_mpm::scene::CheckedScene;
use flyer_mpm::simulation::{Compiled, Simulation};
use flyer_mpm::solver::Stepper;
use serde_json::{Value, json};

use crate::metal::metal;
use crate::tools::{checked, midpoint, shipped};

fn digest<const D: usize>(scene: &CheckedScene, comm: &dyn Comm) -> Option<String>
where
    Stepper<D>: Compiled<D>,
{
    let mut simulation = Simulation::<D>::new(scene, comm, 1).unwrap();
    while simulation.time() < scene.scene.time.end {
        simulation.advance(scene.scene.time.end).unwrap();
    }
    simulation.gather().map(|(_, digest)| digest)
}

fn on<const D: usize>(scene: &Value, patches: Value, ranks: usize) -> String
where
    Stepper<D>: Compiled<D>,
{
    let mut scene = scene.clone();
    scene["domain"]["patches"] = patches;
    let scene = checked(&scene);
    let all = run_ranks(ranks, |comm| digest::<D>(&scene, comm));
    all.into_iter().flatten().next().expect("rank 0")
}

#[test]
fn on_a_line() {
    let mut scene = shipped("flyer.json");
    scene["materials"] =
        json!({"copper": metal(8930.0, 3940.0, 1e9), "aluminium": metal(2785.0, 5386.0, 0.5e9)});
    scene["domain"]["cell_size"] = json!(5e-5);
    scene["bodies"][1]["box"]["upper"] = json!([0.001]);
    scene["time"]["end"] = json!(0.4e-6);
    scene["contact"] = json!({"type": "frictionless"});
    scene["heat_mixing"] = json!({"coefficient": 10.0});
    scene["output"] = json!({});
    scene.as_object_mut().unwrap().remove("reference");
    let whole = on::<1>(&scene, json!([1]), 1);
    for (patches, ranks) in [(2, 2), (5, 3), (9, 4), (9, 1)] {
        assert_eq!(on::<1>(&scene, json!([patches]), ranks), whole, "{patches} on {ranks}");
    }
    scene["time"]["end"] = json!(0.2e-6);
    assert_ne!(on::<1>(&scene, json!([1]), 1), whole);
}

#[test]
fn about_an_axis_and_in_a_plane() {
    let mut spreading = midpoint("cpdi_bspline_quadratic", json!({"fmpm": 2}));
    spreading["heat_spreading"] = json!({"steps": 10});
    for (geometry, method) in [
        ("axisymmetric", spreading),
        ("plane_strain", json!({"shape": "gimp", "transfer": "apic"})),
    ] {
        let scene = json!({
            "title": "bar", "method": method,
            "domain": {"lower": [0.0, 0.0], "upper": [0.003, 0.005], "cell_size": 2.5e-4,
                "geometry": geometry},
            "time": {"end": 0.6e-6, "courant": 0.3},
            "materials": {"metal": metal(7800.0, 4600.0, 0.4e9)},
            "bodies": [{"name": "bar", "material": "metal",
                "box": {"lower": [0.0, 0.0], "upper": [0.0013, 0.003]},
                "velocity": [0.0, -400.0], "particles_per_cell": [2, 2]}],
            "artificial_viscosity": {"linear": 0.2, "quadratic": 2.0},
            "heat_mixing": {"coefficient": 10.0},
            "boundary": {"x_lower": "symmetry", "y_lower": "wall",
                "temperature": {"y_lower": 600.0}}
        });
        let whole = on::<2>(&scene, json!([1, 1]), 1);
        for (patches, ranks) in [([2, 1], 2), ([1, 3], 3), ([3, 5], 4), ([3, 5], 1)] {
            let same = on::<2>(&scene, json!(patches), ranks);
            assert_eq!(same, whole, "{geometry}: {patches:?} on {ranks}");
        }
    }
}
