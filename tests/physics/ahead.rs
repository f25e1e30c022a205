//! Oscillations that run ahead of a shock are warned of, release and precursors are not.

use decomp::Serial;
use flyer_mpm::simulation::Simulation;
use flyer_mpm::simulation::monitor::Peaks;
use serde_json::{Value, json};

use crate::tools::{checked, ending, shipped, with};

/// Greatest values of a run to its end, left and gone on with after `halves` of it.
fn peaks(value: &Value, threads: usize, halves: &[f64]) -> Peaks {
    let scene = checked(value);
    let end = scene.scene.time.end;
    let mut simulation = Simulation::<1>::new(&scene, &Serial, threads).unwrap();
    for half in halves.iter().chain(&[1.0]) {
        while simulation.time() < half * end {
            simulation.advance(end).unwrap();
        }
        let saved = simulation.save();
        simulation = Simulation::new(&scene, &Serial, threads).unwrap();
        simulation.restore(&saved).unwrap();
    }
    *simulation.peaks()
}

fn rings(peaks: &Peaks) -> bool {
    peaks.warnings().iter().any(|w| w.contains("ahead of the first wave"))
}

/// The standard problem with next to no viscosity.
fn ringing() -> Value {
    let viscosity = json!({"linear": 0.001, "quadratic": 0.01, "growth": null});
    let mut value = with(&shipped("flyer.json"), &json!({"artificial_viscosity": viscosity}));
    ending(&mut value, 1e-7);
    value
}

#[test]
fn an_oscillation_ahead_of_the_shock_is_warned_of() {
    let value = ringing();
    let whole = peaks(&value, 1, &[]);
    assert!(whole.tension > 0.15 && whole.against > 0.15, "{whole:?}");
    assert!(rings(&whole));
    // the same on any layout, and for a run that was left
    let patches = with(&value, &json!({"domain": {"patches": [7]}}));
    assert_eq!(peaks(&patches, 2, &[]), whole);
    assert_eq!(peaks(&value, 1, &[0.6, 0.7]), whole);
}

/// The standard problem as it stands, and its mirror image from the side of the moving plate.
#[test]
fn the_standard_problem_is_silent() {
    let mut value = shipped("flyer.json");
    for velocities in [[1000.0, 0.0], [0.0, -1000.0], [300.0, -700.0]] {
        for (body, velocity) in velocities.into_iter().enumerate() {
            value["bodies"][body]["velocity"] = json!([velocity]);
        }
        ending(&mut value, 2e-7);
        let found = peaks(&value, 1, &[]);
        assert!(found.tension > 0.01 && found.against > 0.01, "{found:?}");
        assert!(found.tension < 0.08 && found.against < 0.08, "{found:?}");
        assert!(!rings(&found));
    }
}

/// Spall pulls on the whole target, behind the shock.
#[test]
fn release_is_silent() {
    let value = shipped("spall.json");
    let found = peaks(&value, 1, &[]);
    assert!(!rings(&found), "{found:?}");
}
