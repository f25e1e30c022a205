//! A metal with strength, failure and heat, for scenes that hold bits: the check of restarts takes it, too.

use serde_json::{Value, json};

/// A metal that yields, softens, fails and is warm.
pub fn metal(density: f64, c0: f64, limit: f64) -> Value {
    json!({
        "density": density,
        "eos": {"type": "mie_gruneisen", "c0": c0, "s": 1.4, "gamma0": 2.0},
        "strength": {"type": "johnson_cook", "shear_modulus": 40e9, "a": 0.3e9, "b": 0.4e9,
            "n": 0.3, "c": 0.01, "softening":
            {"m": 1.1, "reference_temperature": 293.0, "melt_temperature": 1300.0}},
        "failure": {"type": "tension_limit", "stress": limit},
        "thermal": {"specific_heat": 400.0, "reference_temperature": 293.0,
            "taylor_quinney": 0.9, "conductivity": 2e3}
    })
}
