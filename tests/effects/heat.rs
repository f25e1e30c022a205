//! Conduction of heat.

use serde_json::{Value, json};

use crate::tools::{Outcome, at_most, run, shipped};

/// The shipped rod on cells of `size`.
fn rod(size: f64) -> Value {
    let mut scene = shipped("heat_rod.json");
    scene["domain"]["cell_size"] = json!(size);
    scene["output"] = json!({});
    scene
}

/// The complementary error function (Abramowitz & Stegun 1964, eq. 7.1.26), to 1.5e-7.
fn erfc(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.3275911 * x);
    let sum = [1.061405429, -1.453152027, 1.421413741, -0.284496736, 0.254829592];
    sum.iter().fold(0.0, |s, c| (s + c) * t) * (-x * x).exp()
}

/// Rms of the temperature's error over the rise of 100 K.
fn error(run: &Outcome<1>, time: f64) -> f64 {
    let (x, t) = (run.column("x"), run.column("temperature"));
    let exact = |x: f64| 300.0 + 100.0 * erfc(x / (2.0 * (1e-4 * time).sqrt()));
    let squares = x.iter().zip(t).map(|(x, t)| ((t - exact(*x)) / 100.0).powi(2));
    (squares.sum::<f64>() / x.len() as f64).sqrt()
}

#[test]
fn a_rod_warms_up_from_its_end_to_second_order() {
    let [coarse, fine] = [1e-3, 5e-4].map(|size| error(&run::<1>(&rod(size)), 0.1));
    assert!(fine < 2e-3, "{fine}");
    assert!((coarse / fine).log2() > 1.7, "{coarse} {fine}");
}

/// Where sound is slow a step is as long as conduction allows.
#[test]
fn slow_sound_makes_no_step_too_long_for_conduction() {
    let mut scene = rod(5e-4);
    scene["materials"]["rod"]["eos"]["bulk_modulus"] = json!(1.0);
    let found = error(&run::<1>(&scene), 0.1);
    assert!(found < 5e-3, "{found}");
}

#[test]
fn what_comes_in_by_the_side_is_booked() {
    let outcome = run::<1>(&rod(5e-4));
    let [start, end] = outcome.totals;
    let gained = end.internal - start.internal;
    at_most("energy", (gained - end.conducted) / gained, 1e-12);
    // k (T - T0) 2 sqrt(t/(pi kappa))
    let exact = 100.0 * 100.0 * 2.0 * (0.1 / (std::f64::consts::PI * 1e-4)).sqrt();
    at_most("heat", gained / exact - 1.0, 0.01);
    assert!(outcome.greatest("velocity") < 1e-12);
}

#[test]
fn an_insulated_rod_evens_out_and_keeps_its_heat() {
    let mut scene = rod(1e-3);
    scene["boundary"].as_object_mut().unwrap().remove("temperature");
    scene["domain"]["upper"] = json!([0.01]);
    scene["bodies"] = json!([
        {"name": "hot", "material": "rod", "box": {"lower": [0.0], "upper": [0.005]},
            "temperature": 400.0, "particles_per_cell": [2]},
        {"name": "cold", "material": "rod", "box": {"lower": [0.005], "upper": [0.01]},
            "particles_per_cell": [2]}
    ]);
    scene["time"]["end"] = json!(1.5);
    let outcome = run::<1>(&scene);
    let [start, end] = outcome.totals;
    at_most("energy", end.internal / start.internal - 1.0, 1e-12);
    let t = outcome.column("temperature");
    t.iter().for_each(|t| at_most("evened out", t - 350.0, 0.5));
}

#[test]
fn in_a_plane_and_by_leapfrog_the_rod_is_the_same() {
    for method in [
        json!({"shape": "cpdi", "transfer": "flip"}),
        json!({"shape": "bspline_quadratic", "transfer": "apic", "stepping": "midpoint"}),
    ] {
        let mut scene = rod(1e-3);
        scene["method"] = method.clone();
        scene["domain"] = json!({"lower": [0.0, 0.0], "upper": [0.005, 0.05], "cell_size": 1e-3});
        scene["bodies"][0]["box"] = json!({"lower": [0.0, 0.0], "upper": [0.005, 0.05]});
        scene["bodies"][0]["particles_per_cell"] = json!([2, 2]);
        scene["boundary"] = json!({"x_lower": "wall", "x_upper": "wall", "y_lower": "wall",
            "y_upper": "wall", "temperature": {"y_lower": 400.0}});
        scene["time"]["end"] = json!(0.05);
        let outcome = run::<2>(&scene);
        let (y, t) = (outcome.column("y"), outcome.column("temperature"));
        for r in 0..y.len() {
            let exact = 300.0 + 100.0 * erfc(y[r] / (2.0 * (1e-4f64 * 0.05).sqrt()));
            at_most(&method.to_string(), t[r] - exact, 4.0);
        }
    }
}
