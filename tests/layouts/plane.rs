//! Planes with particles that have become longer than a cell: their patches have wide windows, in which
//! the others keep the sums of narrow ones. On another layout the same particles are in other patches.

use decomp::comm::local::run_ranks;
use flyer_mpm::input;
use flyer_mpm::simulation::Simulation;
use serde_json::{Value, json};

use crate::scenes::{shipped, with};

/// Digest of the final state of the flyer of finite width on `ranks`, the longest particle [cells] and
/// the change of energy over that of the bodies [-].
fn end(method: &Value, ranks: usize, patches: [usize; 2]) -> (String, [f64; 2]) {
    let changes = json!({
        "domain": {"cell_size": 1.5e-4, "patches": patches},
        "time": {"end": 5e-7},
        "output": {"profiles": {"times": [5e-7]}},
        "reference": null,
        "method": null,
    });
    let scene = with(&with(&shipped("flyer_2d.json"), &changes), &json!({"method": method}));
    end_of(&scene, ranks)
}

/// The same of a whole `scene`.
fn end_of(scene: &Value, ranks: usize) -> (String, [f64; 2]) {
    let scene = input::parse(scene.to_string().as_bytes(), "plane", &[])
        .unwrap_or_else(|error| panic!("{error}"));
    let ends = run_ranks(ranks, |comm| {
        let mut simulation = Simulation::<2>::new(&scene, comm, 1).expect("a start");
        let end = scene.scene.time.end;
        while simulation.time() < end {
            simulation.advance(end).expect("a step");
        }
        let measured = [simulation.longest(), simulation.energy_change()];
        (simulation.gather().map(|(_, digest)| digest), measured)
    });
    let (digest, measured) = ends.into_iter().next().expect("rank 0");
    (digest.expect("rank 0 has the digest"), measured)
}

#[test]
fn long_particles_leave_the_same_bits_on_any_layout() {
    let midpoint = |transfer: Value, spin: bool| {
        json!({
            "shape": "cpdi_bspline_quadratic",
            "transfer": transfer,
            "stepping": "midpoint",
            "energy": "compatible",
            "filter_heat": true,
            "spin": spin,
            "pressure_relaxation": {"rate": 0.2, "interval": 1},
            "edge_mask": 0.3,
            "domain_limit": 1.0,
        })
    };
    let leapfrog = |shape: &str, transfer: Value| {
        json!({"shape": shape, "transfer": transfer,
        "stress_update": "modified_last"})
    };
    for method in [
        midpoint(json!({"fmpm": 4}), false),
        midpoint(json!({"fmpm": 3}), true),
        leapfrog("cpdi_bspline_quadratic", json!({"fmpm": 2})),
        leapfrog("cpdi", json!("flip")),
    ] {
        let (whole, [longest, energy]) = end(&method, 1, [1, 1]);
        assert!(longest > 1.0, "{method}: {longest} cells");
        // nodes that a long particle does not add to, or take from, cost energy
        let is_exact = method["energy"] == "compatible";
        assert!(!is_exact || energy.abs() < 1e-12, "{method}: energy {energy:e}");
        for (ranks, patches) in [(1, [2, 1]), (2, [3, 2]), (3, [2, 1])] {
            let (digest, _) = end(&method, ranks, patches);
            assert_eq!(digest, whole, "{method}: {ranks} ranks, {patches:?} patches");
        }
    }
}

/// A cold gas that flies apart from its centre, where particles become several cells long; patches meet
/// there.
#[test]
fn particles_of_several_cells_at_the_edge_of_a_patch() {
    for update in ["last", "first", "modified_last"] {
        let scene = |patches: [usize; 2]| {
            json!({
                "title": "gas that flies apart",
                "domain": {
                    "lower": [-1.0, -1.0],
                    "upper": [1.0, 1.0],
                    "cell_size": 0.1,
                    "patches": patches,
                },
                "time": {"end": 0.45, "courant": 0.3},
                "method": {"shape": "cpdi", "transfer": "flip", "stress_update": update},
                "materials": {"gas": {"density": 1.0, "eos": {"type": "ideal_gas", "gamma": 1.4}}},
                "bodies": [{
                    "name": "gas",
                    "material": "gas",
                    "box": {"lower": [-0.4, -0.4], "upper": [0.4, 0.4]},
                    "velocity_field": {"radial": {"about": [0.0, 0.0], "speed": 1.0}},
                    "pressure": 0.01,
                    "particles_per_cell": [1, 1],
                }],
                "output": {"profiles": {"times": [0.45]}},
            })
        };
        let (whole, [longest, _]) = end_of(&scene([1, 1]), 1);
        assert!(longest > 4.0, "{update}: {longest} cells");
        for (ranks, patches) in [(1, [2, 2]), (2, [3, 2]), (3, [2, 5])] {
            let (digest, _) = end_of(&scene(patches), ranks);
            assert_eq!(digest, whole, "{update}: {ranks} ranks, {patches:?} patches");
        }
    }
}
