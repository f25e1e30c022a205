//! Scenes that random search has found to end otherwise than they should.

use serde_json::json;

use crate::in_process::end_of;
use crate::layouts::Layout;

/// A gas runs out through an open side: short particles in the last cell, long ones behind them,
/// whose stencils are padded. The products of the pressure's projection read past the arrays.
#[test]
fn a_gas_that_expands_through_an_open_side() {
    let body = json!({
        "name": "gas",
        "material": "gas",
        "box": {"lower": [9e-5], "upper": [1.5e-4]},
        "pressure": 1e8,
        "particles_per_cell": [1],
    });
    let scene = json!({
        "title": "a gas that expands through an open side",
        "domain": {"lower": [0.0], "upper": [2e-4], "cell_size": 1e-5},
        "time": {"end": 6.5e-8},
        "method": {
            "shape": "cpdi",
            "transfer": "apic",
            "stepping": "midpoint",
            "pressure_relaxation": {"rate": 0.2, "interval": 1},
        },
        "materials": {"gas": {"density": 50.0, "eos": {"type": "ideal_gas", "gamma": 1.4}}},
        "bodies": [body],
        "boundary": {"x_upper": "outflow"},
    });
    let whole = end_of(&scene, &Layout::WHOLE);
    let stretched = |message: &String| message.contains("further than its shape function reaches");
    assert!(whole.as_ref().is_err_and(stretched), "{whole:?}");
    for layout in Layout::covering().iter().filter(|l| l.patches <= 20) {
        assert_eq!(end_of(&scene, layout), whole, "{layout}");
    }
}

/// Gas that comes towards gas, with contact: a limiter looks on in the flow of the other body where a
/// patch has no nodes of that body to compute.
#[test]
fn a_limiter_that_looks_into_another_body() {
    let body = |name: &str, x: [f64; 2], velocity: f64| {
        json!({
            "name": name,
            "material": "gas",
            "box": {"lower": [x[0]], "upper": [x[1]]},
            "velocity": [velocity],
            "pressure": 1e8,
            "particles_per_cell": [2],
        })
    };
    let scene = json!({
        "title": "gas that comes towards gas",
        "domain": {"lower": [0.0], "upper": [6.2e-4], "cell_size": 1e-5},
        "time": {"end": 4e-8, "courant": 0.4},
        "method": {"shape": "linear", "transfer": {"flip_pic": 0.0}, "stepping": "midpoint"},
        "materials": {"gas": {"density": 50.0, "eos": {"type": "ideal_gas", "gamma": 1.4}}},
        "bodies": [
            body("left", [2.392e-4, 2.992e-4], 1347.0),
            body("right", [3.772e-4, 4.372e-4], -134.0),
        ],
        "artificial_viscosity": {"linear": 0.1, "quadratic": 1.0, "limiter": "christensen"},
        "contact": {"type": "frictionless"},
        // hat functions fling a particle at a surface
        "monitor": {"courant": 1e3, "speed": 1e3},
    });
    let whole = end_of(&scene, &Layout::WHOLE);
    assert!(whole.is_ok(), "{whole:?}");
    for patches in [7, 14, 19, 21, 30] {
        let layout = Layout { patches, filter_halo: Some("exchange"), ..Layout::WHOLE };
        assert_eq!(end_of(&scene, &layout), whole, "{layout}");
    }
}

/// A piston drives two bodies of many particles a cell, on cubic splines: the nodal limiter takes nothing
/// away in most of them, and a rank's column of it held -0 where the whole domain's held 0.
#[test]
fn a_limiter_that_takes_nothing_away() {
    let body = |name: &str, x: [f64; 2]| {
        json!({
            "name": name,
            "material": "aluminium",
            "box": {"lower": [x[0]], "upper": [x[1]]},
            "particles_per_cell": [16],
        })
    };
    let eos = json!({"type": "mie_gruneisen", "c0": 5386.0, "s": 1.339, "gamma0": 2.1});
    let scene = json!({
        "title": "a limiter that takes nothing away",
        "domain": {"lower": [0.0], "upper": [3.2e-4], "cell_size": 1e-5},
        "time": {"end": 2e-8, "courant": 0.477697916676459},
        "method": {
            "shape": "bspline_cubic",
            "transfer": "apic",
            "stepping": "midpoint",
            "filter_heat": false,
        },
        "materials": {"aluminium": {"density": 2785.0, "eos": eos}},
        "bodies": [body("left", [0.0, 6e-5]), body("right", [6e-5, 1.4035534885836116e-4])],
        "boundary": {"x_lower": {"velocity": 400.0}, "x_upper": "outflow"},
        "artificial_viscosity": {"linear": 0.1, "quadratic": 1.0, "limiter": "nodal"},
        "monitor": {"on_courant_exceeded": "reduce"},
    });
    let whole = end_of(&scene, &Layout::WHOLE);
    assert!(whole.is_ok(), "{whole:?}");
    for layout in Layout::covering().iter().filter(|l| l.patches <= 32) {
        assert_eq!(end_of(&scene, layout), whole, "{layout}");
    }
}

/// A gas in the middle of its periodic domain spreads to both sides alike, and its two outer particles
/// are stretched too far in the same step: which of them is named must not depend on the patches.
#[test]
fn two_particles_that_fail_at_once() {
    let body = json!({
        "name": "gas",
        "material": "gas",
        "box": {"lower": [0.0], "upper": [6e-5]},
        "pressure": 1e8,
        "particles_per_cell": [1],
    });
    let scene = json!({
        "title": "two particles that fail at once",
        "domain": {"lower": [0.0], "upper": [3.6e-4], "cell_size": 1e-5},
        "time": {"end": 5.480768856297618e-8, "courant": 0.8089017170206839},
        "method": {
            "shape": "cpdi",
            "transfer": "apic",
            "stepping": "midpoint",
            "filter_heat": false,
            "pressure_relaxation": {"rate": 0.2, "interval": 1},
        },
        "materials": {"gas": {"density": 50.0, "eos": {"type": "ideal_gas", "gamma": 1.4}}},
        "bodies": [body],
        "boundary": {"x_lower": "periodic", "x_upper": "periodic"},
        "artificial_viscosity": {"linear": 0.1, "quadratic": 1.0},
        "monitor": {"on_courant_exceeded": "reduce"},
    });
    let whole = end_of(&scene, &Layout::WHOLE);
    let stretched = |message: &String| message.contains("further than its shape function reaches");
    assert!(whole.as_ref().is_err_and(stretched), "{whole:?}");
    for layout in Layout::covering().iter().filter(|l| l.patches <= 36) {
        assert_eq!(end_of(&scene, layout), whole, "{layout}");
    }
}

/// Gas without viscosity between two solids: a particle is flung over two cells in one step. Ghosts
/// are exchanged for moves to the next cell, so that narrow patches lost its share of a node.
#[test]
fn a_particle_that_passes_a_cell_in_one_step() {
    let body = |name: &str, material: &str, x: [f64; 2], velocity: f64, pressure: f64| {
        json!({
            "name": name,
            "material": material,
            "box": {"lower": [x[0]], "upper": [x[1]]},
            "velocity": [velocity],
            "pressure": pressure,
            "particles_per_cell": [if name == "solid" { 2 } else { 1 }],
        })
    };
    let eos = json!({"type": "mie_gruneisen", "c0": 5386.0, "s": 1.339, "gamma0": 2.1});
    let scene = json!({
        "title": "gas between solids",
        "domain": {"lower": [0.0], "upper": [3.3e-4], "cell_size": 1e-5},
        "time": {"end": 4e-8},
        "method": {"shape": "linear", "stress_update": "first", "transfer": {"fmpm": 6}},
        "materials": {
            "aluminium": {"density": 2785.0, "eos": eos},
            "gas": {"density": 50.0, "eos": {"type": "ideal_gas", "gamma": 1.4}},
        },
        "bodies": [
            body("striker", "aluminium", [0.0, 6e-5], -725.1184709913746, 0.0),
            body("gas", "gas", [6e-5, 1.2e-4], 0.0, 1e8),
            body("solid", "aluminium", [1.2625059405137564e-4, 1.8625059405137564e-4], 0.0, 0.0),
        ],
        "boundary": {"x_lower": {"velocity": 400.0}, "x_upper": "outflow"},
    });
    let whole = end_of(&scene, &Layout::WHOLE);
    let far = |message: &String| message.contains("moves by 2 cells in one step");
    assert!(whole.as_ref().is_err_and(far), "{whole:?}");
    for layout in Layout::covering().iter().filter(|l| l.patches <= 33) {
        assert_eq!(end_of(&scene, layout), whole, "{layout}");
    }
}
