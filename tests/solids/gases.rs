//! Noh's problem: gases without any energy that meet, at low resolution.

use serde_json::{Value, json};

use crate::tools::{Outcome, at_most, run, shipped};

/// Noh's problem of `scene` with `cells` a metre.
fn noh<const D: usize>(scene: &str, cells: f64) -> Outcome<D>
where
    flyer_mpm::solver::Stepper<D>: flyer_mpm::simulation::Compiled<D>,
{
    let mut value = shipped(scene);
    value["domain"]["cell_size"] = json!(1.0 / cells);
    let outcome = run::<D>(&value);
    at_most("energy", outcome.energy_drift(), 1e-12);
    outcome
}

fn number(score: &Value, name: &str) -> f64 {
    score[name].as_f64().unwrap_or_else(|| panic!("no {name} in {score}"))
}

#[test]
fn a_cold_gas_is_stopped_by_a_wall() {
    let [coarse, fine] = [50.0, 100.0].map(|cells| noh::<1>("noh_planar.json", cells));
    at_most("mean density", number(&fine.score, "mean_density_error"), 0.015);
    let [coarse_l1, l1] = [&coarse, &fine].map(|run| number(&run.score, "density_l1"));
    assert!(l1 < 0.6 * coarse_l1, "{l1} {coarse_l1}");
    // one pressure behind the shock, though the density is not even
    let (x, p) = (fine.column("x"), fine.column("pressure"));
    let behind: Vec<f64> = (0..x.len()).filter(|&r| x[r] < 0.15).map(|r| p[r]).collect();
    let mean = behind.iter().sum::<f64>() / behind.len() as f64;
    assert!(fine.column("density")[0] > 3.6, "heated wall: {:?}", fine.column("density"));
    at_most("mean pressure", mean / (4.0 / 3.0) - 1.0, 0.03);
    behind.iter().skip(8).for_each(|p| at_most("pressure", p / mean - 1.0, 0.02));
    // and none ahead of it
    let ahead = (0..x.len()).filter(|&r| x[r] > 0.3);
    ahead.for_each(|r| at_most("pressure ahead", p[r], 1e-6));
}

#[test]
fn a_cold_gas_closes_in_on_an_axis() {
    let score = |scene: &str, cells: f64| noh::<2>(scene, cells).score;
    for (scene, bound) in [("noh_cylindrical.json", 0.05), ("noh_axis.json", 0.07)] {
        let [coarse, fine] = [25.0, 50.0].map(|cells| score(scene, cells));
        at_most(scene, number(&fine, "mean_density_error"), bound);
        // with the coarse cells the mean reaches into the shock
        for (name, ratio) in [("mean_density_error", 1.0), ("density_l1", 0.6)] {
            let [coarse, fine] = [&coarse, &fine].map(|score| number(score, name).abs());
            assert!(fine < ratio * coarse, "{scene}: {name} {fine} {coarse}");
        }
    }
}

/// A disk of hot gas in a gas of low pressure: small particles at its edge are beside particles with
/// a much larger pressure.
#[test]
fn a_hot_disk_expands_with_the_default_method() {
    let disk = json!({"centre": [0.0, 0.0], "radius": 0.1});
    let body = |name: &str, pressure: f64| json!({"name": name, "material": "gas", "pressure": pressure, "particles_per_cell": [2, 2]});
    let [mut hot, mut cold] = [body("hot", 1e4), body("cold", 1.0)];
    hot["disk"] = disk.clone();
    cold["difference"] =
        json!([{"box": {"lower": [0.0, 0.0], "upper": [0.3, 0.3]}}, {"disk": disk}]);
    let scene = json!({
        "title": "blast", "time": {"end": 1e-3},
        "domain": {"lower": [0.0, 0.0], "upper": [0.3, 0.3], "cell_size": 0.01},
        "materials": {"gas": {"density": 1.0, "eos": {"type": "ideal_gas", "gamma": 1.4}}},
        "bodies": [hot, cold],
        "boundary": {"x_lower": "symmetry", "y_lower": "symmetry", "x_upper": "symmetry",
            "y_upper": "symmetry"},
    });
    let outcome = run::<2>(&scene);
    at_most("energy", outcome.energy_drift(), 1e-12);
    assert!(outcome.column("pressure").iter().all(|&p| p > 0.0));
}

/// A disk of gas expands into empty space: its particles become longer in both directions.
#[test]
fn a_disk_of_gas_expands_into_empty_space_with_the_default_method() {
    let scene = json!({
        "title": "expansion", "time": {"end": 0.8},
        "domain": {"lower": [0.0, 0.0], "upper": [3.6, 3.6], "cell_size": 0.02},
        "materials": {"gas": {"density": 1.0, "eos": {"type": "ideal_gas", "gamma": 1.4}}},
        "bodies": [{"name": "disk", "material": "gas", "pressure": 1.0,
            "disk": {"centre": [0.0, 0.0], "radius": 0.2}, "particles_per_cell": [2, 2]}],
        "boundary": {"x_lower": "symmetry", "y_lower": "symmetry"},
    });
    let outcome = run::<2>(&scene);
    at_most("energy", outcome.energy_drift(), 1e-12);
    let [x, y] = ["x", "y"].map(|name| outcome.column(name));
    let radius = x.iter().zip(y).map(|(x, y)| f64::hypot(*x, *y)).fold(0.0, f64::max);
    // no gas is faster than 2 c/(gamma - 1), and its edge is nearly as fast
    let greatest = 0.2 + 0.8 * 5.0 * 1.4f64.sqrt();
    assert!(radius > 0.5 * greatest && radius < greatest, "{radius} {greatest}");
}

#[test]
fn other_schemes_bear_a_gas_without_energy() {
    for (scheme, keeps) in [
        (json!({"shape": "cpdi", "transfer": "flip"}), false),
        (json!({"shape": "gimp", "transfer": "flip", "stress_update": "first"}), false),
        (
            json!({"shape": "bspline_quadratic", "transfer": {"fmpm": 4}, "stepping": "midpoint",
                "energy": "compatible", "filter_heat": true}),
            true,
        ),
        (
            json!({"shape": "cpdi", "transfer": "flip", "stepping": "midpoint",
                "energy": "compatible"}),
            true,
        ),
    ] {
        let mut value = shipped("noh_planar.json");
        value["domain"]["cell_size"] = json!(0.01);
        value["artificial_viscosity"] = json!({"linear": 0.2, "quadratic": 2.0});
        value["method"] = scheme.clone();
        let outcome = run::<1>(&value);
        let what = scheme.to_string();
        at_most(&what, number(&outcome.score, "mean_density_error"), 0.1);
        if keeps {
            at_most(&what, outcome.energy_drift(), 1e-12);
        }
        assert!(outcome.column("pressure").iter().all(|&p| p >= 0.0), "{what}: tension");
    }
}
