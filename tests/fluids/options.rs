//! Each key of an equation of state changes what is computed.

use flyer_mpm::material::constitutive::equation;
use flyer_mpm::scene::Material;
use serde_json::{Value, json};

/// Pressure at J and e of material that has its first history.
fn pressure(density: f64, eos: &Value, jacobian: f64, energy: f64) -> f64 {
    let material = json!({"density": density, "eos": eos});
    let material: Material = serde_json::from_value(material).unwrap();
    let eos = equation(&material).unwrap().unwrap();
    eos.at(jacobian, energy, eos.first_history().unwrap_or(0.0)).0.pressure
}

/// Each key with another value, and where that is felt.
#[track_caller]
fn felt(density: f64, eos: &Value, keys: &[(&str, Value)], states: &[(f64, f64)]) {
    for (key, value) in keys {
        let mut other = eos.clone();
        other[key] = value.clone();
        let apart = states.iter().any(|&(j, e)| {
            let (a, b) = (pressure(density, eos, j, e), pressure(density, &other, j, e));
            (a - b).abs() > 1e-3 * a.abs().max(b.abs())
        });
        assert!(apart, "{key} of {}", eos["type"]);
    }
}

#[test]
fn keys_change_the_pressure() {
    let eos = json!({"type": "mie_gruneisen", "c0": 5386.0, "s": 1.339, "gamma0": 2.1});
    let keys = [
        ("c0", json!(5000.0)),
        ("s", json!(1.2)),
        ("s2", json!(2e-5)),
        ("gamma0", json!(2.0)),
        ("gruneisen", json!("gamma_constant")),
        ("tension_cutoff", json!(1e8)),
    ];
    felt(2785.0, &eos, &keys, &[(0.8, 2e6), (1.02, 0.0)]);
    let eos = json!({"type": "stiffened_gas", "gamma": 4.4, "p_inf": 6e8});
    let keys = [("gamma", json!(4.0)), ("p_inf", json!(5e8)), ("tension_cutoff", json!(1e7))];
    felt(1000.0, &eos, &keys, &[(0.8, 1e5), (1.05, 0.0)]);
    let eos = json!({"type": "tait", "bulk_modulus": 2.1e9, "exponent": 7.0});
    let keys =
        [("bulk_modulus", json!(2e9)), ("exponent", json!(6.0)), ("tension_cutoff", json!(1e7))];
    felt(1000.0, &eos, &keys, &[(0.8, 0.0), (1.05, 0.0)]);
    let eos = json!({
        "type": "tillotson", "a": 0.5, "b": 1.63, "bulk_modulus": 75.2e9, "second_modulus": 65e9,
        "alpha": 5.0, "beta": 5.0, "e0": 5e6, "e_iv": 3e6, "e_cv": 13.9e6
    });
    let keys = [
        ("a", json!(0.4)),
        ("b", json!(1.5)),
        ("bulk_modulus", json!(70e9)),
        ("second_modulus", json!(60e9)),
        ("alpha", json!(4.0)),
        ("beta", json!(4.0)),
        ("e0", json!(6e6)),
        ("e_iv", json!(2e6)),
        ("e_cv", json!(12e6)),
        ("tension_cutoff", json!(1e8)),
    ];
    felt(2700.0, &eos, &keys, &[(0.7, 2e6), (1.3, 8e6), (1.3, 2e7), (1.05, 0.0)]);
    let eos = json!({
        "type": "jwl", "a": 371.2e9, "b": 3.231e9, "r1": 4.15, "r2": 0.95, "omega": 0.3,
        "energy": 7e9, "burn": "complete",
    });
    let keys = [
        ("a", json!(300e9)),
        ("b", json!(3e9)),
        ("r1", json!(4.0)),
        ("r2", json!(1.0)),
        ("omega", json!(0.35)),
    ];
    felt(1630.0, &eos, &keys, &[(1.0, 4e6)]);
    let solid = json!({"type": "mie_gruneisen", "c0": 3940.0, "s": 1.489, "gamma0": 1.96});
    let mut soft = solid.clone();
    soft["c0"] = json!(3000.0);
    let eos = json!({
        "type": "p_alpha", "solid": solid, "solid_density": 8930.0, "elastic_pressure": 1e8,
        "full_compaction_pressure": 1.6e9,
    });
    let keys = [
        ("solid", soft),
        ("solid_density", json!(9500.0)),
        ("elastic_pressure", json!(3e8)),
        ("full_compaction_pressure", json!(1e9)),
    ];
    felt(7144.0, &eos, &keys, &[(0.95, 0.0), (0.75, 1e5)]);
    let values = |scale: f64| {
        let rows = [[-5.2e9, -3e9], [-2e8, 2e9], [4.8e9, 7e9]];
        json!({
            "density": [1000.0, 1500.0, 2000.0],
            "specific_internal_energy": [-1e5, 1e6],
            "pressure": rows.map(|row| row.map(|p| scale * p)),
        })
    };
    let eos = json!({"type": "tabular", "table": values(1.0), "tension_cutoff": 3e9});
    let keys = [("table", values(1.1)), ("tension_cutoff", json!(1e9))];
    felt(1500.0, &eos, &keys, &[(0.9, 1e5), (1.3, 0.0)]);
}

#[test]
fn the_energy_of_detonation_is_that_at_the_start() {
    let energy = |value: f64| {
        let eos = json!({
            "type": "jwl", "a": 371.2e9, "b": 3.231e9, "r1": 4.15, "r2": 0.95, "omega": 0.3,
            "energy": value, "burn": "complete",
        });
        let material = json!({"density": 1630.0, "eos": eos});
        let material: Material = serde_json::from_value(material).unwrap();
        equation(&material).unwrap().unwrap().energy_at(0.0)
    };
    assert_eq!([energy(7e9), energy(6e9)], [7e9 / 1630.0, 6e9 / 1630.0]);
}
