//! Body forces, and what is booked of them.

use flyer_mpm::simulation::Compiled;
use flyer_mpm::solver::Stepper;
use serde_json::{Value, json};

use crate::tools::{at_most, midpoint, run, shipped};

/// A block of solid and one of gas that fall freely, in a plane or on a line.
fn falling(plane: bool, method: Value) -> Value {
    let both = |x: f64, y: f64| if plane { json!([x, y]) } else { json!([x]) };
    let count = if plane { json!([2, 2]) } else { json!([2]) };
    let body = |name: &str, material: &str, from: f64, pressure: f64| {
        json!({
            "name": name, "material": material, "pressure": pressure,
            "velocity": both(0.7, 0.2), "particles_per_cell": count,
            "box": {"lower": both(from, 4.0), "upper": both(from + 0.5, 4.5)}
        })
    };
    json!({
        "title": "Free fall",
        "domain": {"lower": both(-1.0, 0.0), "upper": both(6.0, 5.0), "cell_size": 0.1},
        "time": {"end": 0.5},
        "method": method,
        "materials": {
            "solid": {"density": 2.0, "eos":
                {"type": "neo_hookean", "youngs_modulus": 2.6, "poissons_ratio": 0.3}},
            "gas": {"density": 1.0, "eos": {"type": "ideal_gas", "gamma": 1.4}}
        },
        "bodies": [body("solid", "solid", 0.0, 0.0), body("gas", "gas", 1.5, 0.1)],
        "body_force": {"gravity": both(-3.0, -9.81)}
    })
}

fn check<const D: usize>(method: Value, bound: f64)
where
    Stepper<D>: Compiled<D>,
{
    let what = method.to_string();
    let outcome = run::<D>(&falling(D == 2, method));
    let [start, end] = outcome.totals;
    let g = [-3.0, -9.81];
    for a in 0..D {
        let exact = start.momentum[a] + start.mass * g[a] * 0.5;
        at_most(&what, end.momentum[a] / exact - 1.0, 1e-12);
    }
    at_most(&what, outcome.momentum_drift(start.absolute_momentum), 1e-13);
    at_most(&what, outcome.energy_drift(), bound);
    // the solid falls as a whole
    let fallen = 0.25 + 0.7 * 0.5 - 0.5 * 3.0 * 0.25;
    let x = outcome.column("x");
    let rows = || (0..x.len()).filter(|&r| outcome.last.body[r] == 0);
    let mean = rows().map(|r| x[r]).sum::<f64>() / rows().count() as f64;
    at_most(&what, mean - fallen, if bound < 1e-9 { 1e-12 } else { 0.05 });
}

#[test]
fn energy_and_momentum_are_kept_in_free_fall() {
    for transfer in [json!("flip"), json!({"fmpm": 4}), json!({"xpic": 3})] {
        check::<2>(midpoint("cpdi_bspline_quadratic", transfer.clone()), 1e-12);
        check::<1>(midpoint("bspline_quadratic", transfer), 1e-12);
    }
}

#[test]
fn leapfrog_steps_fall_too() {
    check::<2>(json!({"shape": "gimp", "transfer": "flip"}), 0.02);
}

#[test]
fn a_leapfrog_step_moves_by_the_velocity_at_its_end() {
    let mut scene = falling(true, json!({"shape": "gimp", "transfer": "flip"}));
    // less than a step
    let end = 1e-3;
    scene["time"]["end"] = json!(end);
    let outcome = run::<2>(&scene);
    let x = outcome.column("x");
    let rows = || (0..x.len()).filter(|&r| outcome.last.body[r] == 0);
    let mean = rows().map(|r| x[r]).sum::<f64>() / rows().count() as f64;
    at_most("moved", mean - (0.25 + 0.7 * end - 3.0 * end * end), 1e-12);
}

#[test]
fn a_vortex_keeps_its_booked_energy() {
    let mut value = shipped("vortex.json");
    value["domain"]["cell_size"] = json!(0.125);
    let outcome = run::<2>(&value);
    // the force has turned half of the motion into strain
    assert!(outcome.totals[1].body_force_work.abs() > 0.05 * outcome.totals[0].kinetic);
    at_most("energy", outcome.energy_drift(), 1e-13);
}
