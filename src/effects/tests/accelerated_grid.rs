//! Tests on one patch with two particles: see [`Fixture`].

use serde_json::{Value, json};

use crate::solver::effect::Phase;
use crate::solver::tests::fixture::{Fixture, close};

/// A body on a piston that is 4 t m/s fast, in the step from 0.2 to 0.3 s, with the velocities 1
/// and 3 m/s of the grid before and after it.
fn piston(changes: Value) -> Fixture<1> {
    let mut scene = json!({
        "boundary": {"x_lower": {"velocity": [[0.0, 0.0], [1.0, 4.0]]}},
        "bodies": [{"name": "body", "material": "fluid", "particles_per_cell": [1],
            "box": {"lower": [0.0], "upper": [2.0]}}],
    });
    scene.as_object_mut().unwrap().extend(changes.as_object().unwrap().clone());
    let mut f = Fixture::new(scene);
    f.time = 0.2;
    f.act(Phase::ParticleForce, 0.1);
    f.set_flow([(1.0, [0.0])], [(3.0, [0.0])]);
    f
}

#[test]
fn inertia_opposes_the_acceleration_of_the_grid() {
    let mut f = piston(json!({}));
    close(&f.get("frame_force"), &[-2.0 * 4.0; 2]);
    f.scatter(0.1);
    close(&f.line("acceleration", 1..=2), &[-4.0, -4.0]);
}

#[test]
fn its_work_is_counted_in_the_frame_of_the_grid() {
    let mut f = piston(json!({}));
    f.act(Phase::Gathered, 0.1);
    for work in &f.patch.boundary_work {
        close(&[work.work, work.impulse[0]], &[-8.0 * 0.1 * 2.0, 0.0]);
    }
    assert_eq!(f.patch.boundary_work.len(), 2);
}
