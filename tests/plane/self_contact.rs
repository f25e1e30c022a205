//! Bodies that touch themselves: the run reports the first place.

use decomp::Comm;
use decomp::comm::local::run_ranks;
use flyer_mpm::scene::CheckedScene;
use flyer_mpm::simulation::monitor::SelfContactEvent;
use flyer_mpm::simulation::{Saved, Simulation};
use serde_json::{Value, json};

use crate::tools::checked;

/// Edge of a cell [m].
const CELL: f64 = 0.01;

/// A clamp of rubber with a slot of `slot` cells, whose upper arm a hammer strikes at 4 m/s.
fn clamp(slot: f64) -> Value {
    let top = 0.05 + slot * CELL;
    let region = json!([
        {"box": {"lower": [0.0, 0.0], "upper": [0.2, top + 0.03]}},
        {"box": {"lower": [0.06, 0.05], "upper": [0.3, top]}}
    ]);
    let hammer = json!({"lower": [0.13, top + 0.03], "upper": [0.2, top + 0.1]});
    json!({
        "title": "clamp",
        "domain": {"lower": [-0.04, 0.0], "upper": [0.28, 0.26], "cell_size": CELL},
        "time": {"end": 6e-3},
        "materials": {"rubber": {"density": 1000.0, "eos": {
            "type": "neo_hookean", "youngs_modulus": 1e6, "poissons_ratio": 0.3
        }}},
        "bodies": [
            {"name": "hammer", "material": "rubber", "box": hammer, "velocity": [0.0, -4.0]},
            {"name": "clamp", "material": "rubber", "difference": region}
        ],
        "contact": {"type": "frictionless"},
        "boundary": {"y_lower": "no_slip"},
        "monitor": {"interval": 8}
    })
}

/// The event of a run, and the state at the step `saved_at`.
fn run(
    scene: &CheckedScene,
    comm: &dyn Comm,
    threads: usize,
    from: Option<&Saved>,
    saved_at: u64,
) -> (Option<SelfContactEvent>, Option<Saved>) {
    let mut run = Simulation::<2>::new(scene, comm, threads).unwrap();
    if let Some(saved) = from {
        run.restore(saved).unwrap();
    }
    let mut saved = None;
    while run.time() < scene.scene.time.end {
        run.advance(scene.scene.time.end).unwrap();
        if run.steps() == saved_at {
            saved = Some(run.save());
        }
    }
    (run.self_contact().copied(), saved)
}

fn event(scene: &Value) -> Option<SelfContactEvent> {
    let event = |comm: &_| run(&checked(scene), comm, 1, None, 0).0;
    run_ranks(1, |comm| event(comm)).remove(0)
}

#[test]
fn a_slot_that_closes_is_reported() {
    let event = event(&clamp(2.0)).expect("the arm reaches the other one");
    assert_eq!(event.body, 1);
    // the arm is 2 cells away and moves at most with the hammer
    assert!((2.5e-3..6e-3).contains(&event.time), "{event:?}");
    assert!((0.3..1.0).contains(&event.gap), "{event:?}");
    assert!((0.06..0.2).contains(&event.place[0]), "{event:?}");
    assert!((0.045..0.07).contains(&event.place[1]), "{event:?}");
}

#[test]
fn a_slot_that_stays_open_is_not() {
    assert_eq!(event(&clamp(6.0)), None);
}

#[test]
fn without_contact_nothing_is_searched() {
    let mut scene = clamp(2.0);
    scene.as_object_mut().unwrap().remove("contact");
    assert_eq!(event(&scene), None);
}

/// A mirror shows a body to itself, 0.6 cells away.
#[test]
fn a_body_that_meets_its_image_is_not() {
    let mut scene = clamp(2.0);
    scene["domain"]["upper"] = json!([0.28, 0.2]);
    scene["time"]["end"] = json!(1e-3);
    scene["boundary"] = json!({"y_upper": "symmetry"});
    scene["monitor"]["interval"] = json!(1);
    // oblique, so that several particles above each other carry the same face
    let square = json!({"box": {"lower": [0.12, 0.132], "upper": [0.18, 0.192]}});
    scene["bodies"][0] = json!({
        "name": "square", "material": "rubber", "velocity": [0.0, 4.0],
        "rotation": {"angle": 10.0, "about": [0.15, 0.162], "of": square}
    });
    scene["bodies"][1] = json!({
        "name": "base", "material": "rubber", "box": {"lower": [0.0, 0.0], "upper": [0.1, 0.04]}
    });
    assert_eq!(event(&scene), None);
}

#[test]
fn every_layout_and_restart_reports_the_same() {
    let scene = clamp(2.0);
    let whole = checked(&scene);
    let ends = run_ranks(1, |comm| run(&whole, comm, 1, None, 24));
    let (event, saved) = ends.into_iter().next().unwrap();
    assert!(event.is_some());
    let again = run_ranks(1, |comm| run(&whole, comm, 1, saved.as_ref(), 0).0);
    assert_eq!(again, [event]);
    for (ranks, patches) in [(1, [4, 3]), (2, [2, 1]), (3, [3, 4]), (4, [1, 8])] {
        let mut shared = scene.clone();
        shared["domain"]["patches"] = json!(patches);
        let shared = checked(&shared);
        let all = run_ranks(ranks, |comm| run(&shared, comm, 1, None, 0).0);
        assert!(all.iter().all(|found| *found == event), "{all:?} {event:?}");
    }
}

/// A run that continues from a state after the event does not search again.
#[test]
fn a_state_keeps_what_was_found() {
    let scene = checked(&clamp(2.0));
    let last = run_ranks(1, |comm| {
        let mut run = Simulation::<2>::new(&scene, comm, 1).unwrap();
        while run.self_contact().is_none() {
            run.advance(scene.scene.time.end).unwrap();
        }
        let mut next = Simulation::<2>::new(&scene, comm, 1).unwrap();
        next.restore(&run.save()).unwrap();
        (run.self_contact().copied(), next.self_contact().copied())
    });
    assert_eq!(last[0].0, last[0].1);
}
