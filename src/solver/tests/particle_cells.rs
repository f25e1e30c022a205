//! Cells of particles, and particles that pass a side.

use serde_json::{Value, json};

use super::fixture::{Fixture, close};

fn line(changes: Value) -> Fixture<1> {
    Fixture::new(changes)
}

#[test]
fn cells_are_found_ahead() {
    let mut f = line(json!({}));
    f.set("position", &[3.25, 4.5]).set("velocity", &[1.0, -2.0]);
    f.run(0.1, |s, step, patch| s.find_cells(patch, 0.5, step.jacobian));
    // 3.75 and 3.5
    assert_eq!(f.patch.block.cells, [[3], [3]]);
    close(&f.get("cell_fraction"), &[0.75, 0.5]);
    close(&f.get("position"), &[3.25, 4.5]);
}

/// Cells of the particles at 3.5 and 8.5 m, beyond the upper side.
fn beyond(boundary: Value) -> Fixture<1> {
    let mut f = line(json!({"boundary": boundary}));
    f.set("position", &[3.5, 8.5]).set("velocity", &[1.0, 2.0]).set("mass", &[2.0, 4.0]);
    f.set("specific_internal_energy", &[5.0, 6.0]).place();
    f.run(0.1, |s, step, patch| s.find_cells(patch, 0.0, step.jacobian));
    f
}

#[test]
fn particles_beyond_a_side() {
    let free = beyond(json!({}));
    assert_eq!(free.fault(), Some("it leaves the domain by its upper side"));
    let joined = beyond(json!({"x_lower": "periodic", "x_upper": "periodic"}));
    assert_eq!((joined.fault(), joined.patch.block.cells[1]), (None, [0]));
    let open = beyond(json!({"x_upper": "outflow"}));
    assert_eq!((open.fault(), open.patch.block.own()), (None, 1));
    let gone = open.patch.removed[0];
    assert_eq!((gone.id, gone.mass, gone.velocity, gone.energy), (1, 4.0, [2.0], 6.0));
}

#[test]
fn a_particle_that_passes_a_wall_by_little_is_returned() {
    // particles beyond the wall, ahead of their position beyond it, and too far beyond it
    let found = |side: &str, places: [f64; 2], velocities: [f64; 2]| {
        let mut f = line(json!({"boundary": {side: "wall"}}));
        let before = places.map(|x| x.clamp(0.5, 7.5));
        f.set("position", &before).place().set("position", &places).set("velocity", &velocities);
        f.run(0.1, |s, step, patch| s.find_cells(patch, 0.5, step.jacobian));
        f
    };
    for (side, wall, sign, cell) in [("x_upper", 8.0, 1.0, 7), ("x_lower", 0.0, -1.0, 0)] {
        let beyond = |by: f64| wall + sign * by;
        let f = found(side, [beyond(0.001), beyond(-0.001)], [sign * 0.002, sign * 0.01]);
        assert_eq!((f.fault(), f.patch.block.cells.as_slice()), (None, &[[cell], [cell]][..]));
        close(&f.get("position"), &[beyond(-0.001), beyond(-0.001)]);
        close(&f.get("velocity"), &[sign * 0.002, sign * 0.01]);
        let on_wall = if cell == 0 { 0.0 } else { 1.0 };
        close(&f.get("cell_fraction"), &[on_wall, on_wall]);
        let far = found(side, [beyond(0.03), 4.0], [0.0, 0.0]);
        assert!(far.fault().is_some_and(|fault| fault.starts_with("it leaves the domain by its")));
    }
}
