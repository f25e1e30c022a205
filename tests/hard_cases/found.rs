//! Classes of scenes that were once ended or let pass wrongly: cold bodies, conduction at rest,
//! bodies that start in tension, gases that escape into empty space. Random variants of each.

use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use serde_json::{Value, json};

use crate::verdict::{Verdict, verdict};

/// Variants of a class, unless `VARIANTS` gives their number.
const VARIANTS: u32 = 60;

fn each(strategy: impl Strategy<Value = Value>, holds: impl Fn(&Verdict) -> bool) {
    let cases = std::env::var("VARIANTS").ok().and_then(|n| n.parse().ok()).unwrap_or(VARIANTS);
    let config =
        Config { cases, failure_persistence: None, max_shrink_iters: 40, ..Config::default() };
    TestRunner::new_with_rng(
        config,
        proptest::test_runner::TestRng::deterministic_rng(
            proptest::test_runner::RngAlgorithm::ChaCha,
        ),
    )
    .run(&strategy, |value| {
        let end = verdict(&value, 1);
        prop_assert!(holds(&end), "{end:?}\n{value}");
        Ok(())
    })
    .unwrap_or_else(|error| panic!("{error}"));
}

fn method(frame: &str) -> Value {
    json!({
        "shape": "cpdi_bspline_quadratic",
        "frame": frame,
        "transfer": {"fmpm": 6},
        "stepping": "midpoint",
        "energy": "compatible",
        "filter_heat": true,
        "pressure_relaxation": {"rate": 0.1, "interval": 1},
        "edge_mask": 0.3,
    })
}

fn scene(cells: usize, cell: f64, end: f64, materials: Value, bodies: Value) -> Value {
    json!({
        "title": "found",
        "domain": {"lower": [0.0], "upper": [cells as f64 * cell], "cell_size": cell},
        "time": {"end": end, "courant": 0.4},
        "method": method("updated_lagrangian"),
        "materials": materials,
        "bodies": bodies,
        "artificial_viscosity": {"linear": 0.1, "quadratic": 1.25, "limiter": "christensen"},
    })
}

/// Metals: density, c0, s, Gamma0, specific heat.
const METALS: [[f64; 5]; 4] = [
    [8930.0, 3940.0, 1.489, 1.96, 385.0],
    [2785.0, 5386.0, 1.339, 2.1, 903.0],
    [16654.0, 3410.0, 1.2, 1.67, 140.0],
    [7896.0, 4569.0, 1.49, 2.17, 452.0],
];

fn metal(which: usize, reference: f64, conductivity: Option<f64>) -> Value {
    let [density, c0, s, gamma0, specific_heat] = METALS[which];
    let mut thermal = json!({"specific_heat": specific_heat, "reference_temperature": reference});
    if let Some(conductivity) = conductivity {
        thermal["conductivity"] = json!(conductivity);
    }
    json!({
        "density": density,
        "eos": {"type": "mie_gruneisen", "c0": c0, "s": s, "gamma0": gamma0},
        "thermal": thermal,
    })
}

/// Plates of two metals, one or both colder than their reference temperature.
fn cold() -> impl Strategy<Value = Value> {
    let temperature = || prop_oneof![Just(4.0), Just(299.0), 4.0..300.0f64];
    (0..4usize, 0..4usize, temperature(), temperature(), 1.0..1500.0f64, 6.0..20.0f64).prop_map(
        |(a, b, cold_a, cold_b, velocity, length)| {
            let cell = 1e-5;
            let at = |x: f64| json!([x * cell]);
            let bodies = json!([
                {"name": "a", "material": "a", "box": {"lower": at(20.0), "upper": at(20.0 + length)},
                 "velocity": [velocity], "temperature": cold_a, "particles_per_cell": [2]},
                {"name": "b", "material": "b", "box": {"lower": at(20.0 + length), "upper": at(70.0)},
                 "temperature": cold_b, "particles_per_cell": [2]},
            ]);
            let materials = json!({"a": metal(a, 300.0, None), "b": metal(b, 300.0, None)});
            scene(100, cell, 4e-8, materials, bodies)
        },
    )
}

#[test]
fn cold_bodies_run() {
    each(cold(), |end| matches!(end, Verdict::Well(_)));
}

/// A body at rest that conducts heat, at one temperature or at two.
fn conducting() -> impl Strategy<Value = Value> {
    let temperature = prop_oneof![Just(300.0), 20.0..900.0f64];
    (0..4usize, temperature, any::<bool>(), 1.0..500.0f64, 1e-5..1e-3f64, 8.0..30.0f64).prop_map(
        |(which, temperature, two, conductivity, cell, length)| {
            let at = |x: f64| json!([x * cell]);
            let mut bodies = vec![json!({
                "name": "a", "material": "m", "particles_per_cell": [2],
                "box": {"lower": at(5.0), "upper": at(5.0 + length)},
            })];
            if two {
                bodies.push(json!({
                    "name": "b", "material": "m", "particles_per_cell": [2],
                    "box": {"lower": at(5.0 + length), "upper": at(10.0 + length)},
                    "temperature": temperature,
                }));
            } else if temperature != 300.0 {
                bodies[0]["temperature"] = json!(temperature);
            }
            let materials = json!({"m": metal(which, 300.0, Some(conductivity))});
            scene(45, cell, 30.0 * cell / 4e3, materials, json!(bodies))
        },
    )
}

#[test]
fn conduction_at_rest_runs() {
    each(conducting(), |end| matches!(end, Verdict::Well(_)));
}

/// Bodies that start in tension, or one in tension and one under pressure.
fn tense() -> impl Strategy<Value = Value> {
    let pressure = || prop_oneof![Just(0.0), -3e9..3e9f64, -1e7..1e7f64];
    (0..5usize, pressure(), pressure(), -50.0..50.0f64, any::<bool>()).prop_map(
        |(which, first, second, velocity, exact)| {
            let cell = 1e-5;
            let at = |x: f64| json!([x * cell]);
            let material = match which {
                4 => json!({"library": "iron_tillotson"}),
                _ => {
                    let mut value = metal(which, 300.0, None);
                    value.as_object_mut().unwrap().remove("thermal");
                    value
                }
            };
            let bodies = json!([
                {"name": "a", "material": "m", "box": {"lower": at(20.0), "upper": at(35.0)},
                 "velocity": [velocity], "pressure": first, "particles_per_cell": [2]},
                {"name": "b", "material": "m", "box": {"lower": at(38.0), "upper": at(60.0)},
                 "pressure": second, "particles_per_cell": [2]},
            ]);
            let mut value = scene(90, cell, 1e-7, json!({"m": material}), bodies);
            if !exact {
                let method = value["method"].as_object_mut().unwrap();
                method.remove("energy");
                method.remove("filter_heat");
            }
            value
        },
    )
}

/// Energy stays within its bounds, or the monitor ends the run.
#[test]
fn bodies_that_start_in_tension_keep_their_energy() {
    each(tense(), |end| !matches!(end, Verdict::Wrong(_)));
}

/// A gas that escapes from a wall into empty space.
fn escaping() -> impl Strategy<Value = Value> {
    (1.2..1.7f64, 0.3..30.0f64, 40usize..160, 1usize..=3).prop_map(
        |(gamma, pressure, cells, count)| {
            let cell = 1.0 / cells as f64;
            let materials =
                json!({"g": {"density": 1.0, "eos": {"type": "ideal_gas", "gamma": gamma}}});
            let bodies = json!([{
                "name": "g", "material": "g", "box": {"lower": [0.0], "upper": [1.0]},
                "pressure": pressure, "particles_per_cell": [count],
            }]);
            // until the gas has come three times its width; the fastest escapes at 2 c/(gamma - 1)
            let escape = 2.0 / (gamma - 1.0) * (gamma * pressure).sqrt();
            let mut value = scene(4 * cells, cell, 2.8 / escape, materials, bodies);
            value["boundary"] = json!({"x_lower": "wall", "x_upper": "outflow"});
            value
        },
    )
}

#[test]
fn a_gas_escapes_into_empty_space_with_a_limit_on_domains() {
    let limited = escaping().prop_map(|mut value| {
        value["method"]["domain_limit"] = json!(1.0);
        value
    });
    each(limited, |end| matches!(end, Verdict::Well(_)));
}

#[test]
fn a_gas_escapes_into_empty_space_in_the_total_lagrangian_frame() {
    let total = escaping().prop_map(|mut value| {
        value["method"] = method("total_lagrangian");
        value["boundary"]["x_upper"] = json!("free");
        value
    });
    each(total, |end| matches!(end, Verdict::Well(_)));
}

/// Where domains grow without a limit the message says what the expansion is and what helps.
#[test]
fn a_gas_that_outgrows_its_stencil_is_explained() {
    each(escaping(), |end| match end {
        Verdict::Well(_) => true,
        Verdict::Alarm(what) => {
            let words = ["expands freely", "total_lagrangian", "method.domain_limit", "outflow"];
            words.iter().all(|word| what.contains(word)) && !what.contains("not stable")
        }
        _ => false,
    });
}
