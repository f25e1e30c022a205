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
