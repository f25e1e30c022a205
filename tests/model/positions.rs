//! Bodies with positions of their own count with all their particles.

use decomp::Serial;
use flyer_mpm::input;
use flyer_mpm::perf_model::Work;
use flyer_mpm::scene::CheckedScene;
use flyer_mpm::simulation::Simulation;
use serde_json::{Value, json};

fn flyer_plate() -> CheckedScene {
    input::parse(include_bytes!("../../inputs/flyer.json"), "flyer.json", &[]).expect("a scene")
}

#[test]
fn each_position_is_a_particle() {
    let mut flyer: Value =
        serde_json::from_slice(include_bytes!("../../inputs/flyer.json")).expect("JSON");
    let body = &mut flyer["bodies"][0];
    body.as_object_mut().expect("a body").remove("particles_per_cell");
    body["positions"] = json!((0..80).map(|k| [-4.97e-4 + 6.25e-6 * k as f64]).collect::<Vec<_>>());
    let scene = input::parse(flyer.to_string().as_bytes(), "positions.json", &[]).expect("a scene");
    // it stopped in an assertion: the body was one particle of its whole length
    let work = Work::new(&scene);
    assert_eq!(work.reach.cells(), Work::new(&flyer_plate()).reach.cells());
    let share = Work::share(&scene, 2, 1, None, 0.0);
    let patches = share.layout.ranks.iter().flat_map(|rank| &rank.patches);
    assert_eq!(patches.map(|patch| patch.own).sum::<u64>(), scene.particles);
}

/// The check and the step have the same room for long particles: up to the limit a scene runs, beyond
/// it is refused and does not stop in an assertion.
#[test]
fn particles_too_long_for_a_step_are_refused() {
    const SHAPES: [&str; 6] =
        ["linear", "gimp", "cpdi", "bspline_quadratic", "bspline_cubic", "cpdi_bspline_quadratic"];
    let (mut run, mut refused) = (0, 0);
    for shape in SHAPES {
        for cells in 1..=20 {
            let cell = 1e-5;
            let length = cells as f64 * cell;
            let scene = json!({
                "title": "long particles",
                "domain": {"lower": [0.0], "upper": [8e-4], "cell_size": cell},
                "time": {"end": 1e-9},
                "method": {"shape": shape, "transfer": "flip"},
                "materials": {"copper": {"library": "copper"}},
                "bodies": [{"name": "plate", "material": "copper",
                            "box": {"lower": [2e-4], "upper": [2e-4 + 2.0 * length]},
                            "positions": [[2e-4 + 0.5 * length], [2e-4 + 1.5 * length]]}],
            });
            match input::parse(scene.to_string().as_bytes(), "long.json", &[]) {
                Ok(scene) => {
                    Simulation::<1>::new(&scene, &Serial, 1).expect("it starts");
                    run += 1;
                }
                Err(error) => {
                    let error = error.to_string();
                    assert!(error.contains("bodies.plate.positions: too few"), "{error}");
                    // what the step has room for is not refused
                    assert!(cells > 10, "{shape}: {error}");
                    refused += 1;
                }
            }
        }
    }
    assert!(run > 70 && refused > 15, "{run} {refused}");
}
