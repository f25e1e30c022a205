//! A time step shortened for an output does not affect the steps after it.

use serde_json::{Value, json};

use crate::home::Home;
use crate::scenes::short;

/// The short scene with a row of histories in every step.
fn every_step(times: &[f64]) -> Value {
    let mut scene = short();
    scene["output"]["histories"] = json!({"interval": 1e-14});
    scene["output"]["profiles"]["times"] = json!(times);
    scene
}

#[test]
fn the_step_after_an_output_is_as_long_as_without() {
    let plain = Home::with(&every_step(&[1e-8])).run("run", &[]);
    let times = plain.history("time");
    assert_eq!(times.len() as u64, plain.count("steps") + 1);
    let half = times.len() / 2;
    let length = times[half + 1] - times[half];
    // a tenth of a step after the end of a step
    let at = times[half] + 0.1 * length;

    let cut = Home::with(&every_step(&[at, 1e-8])).run("run", &[]);
    assert_eq!(cut.summary["profiles"][0]["time"], json!(at));
    assert!(cut.count("steps").abs_diff(plain.count("steps")) <= 1);
    let cut_times = cut.history("time");
    // identical until the output, then one short step, then one of full length
    assert_eq!(cut_times[..=half], times[..=half]);
    assert_eq!(cut_times[half + 1], at);
    let after = cut_times[half + 2] - at;
    assert!((after / length - 1.0).abs() < 0.02, "{after} after, {length} before");
    // dt is the length of the next step
    let message = cut.history("dt")[half + 1];
    assert!((after / message - 1.0).abs() < 1e-9, "{after}, {message}");
}

#[test]
fn an_output_at_a_steps_end_adds_no_step() {
    let plain = Home::with(&every_step(&[1e-8])).run("run", &[]);
    let times = plain.history("time");
    // beyond the end of a step by a rounding error
    let at = times[times.len() / 2] * (1.0 + 1e-13);
    let cut = Home::with(&every_step(&[at, 1e-8])).run("run", &[]);
    assert_eq!(cut.count("steps"), plain.count("steps"));
    for (with, without) in cut.history("time").iter().zip(&times).skip(1) {
        assert!((with / without - 1.0).abs() < 1e-12, "{with}, {without}");
    }
}

#[test]
fn outputs_closer_than_a_step_are_all_met() {
    let close = [3e-9, 3e-9 * (1.0 + 1e-14), 3.000001e-9, 1e-8];
    let run = Home::with(&every_step(&close)).run("run", &[]);
    let message: Vec<f64> = run.summary["profiles"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| p["time"].as_f64().unwrap())
        .collect();
    assert_eq!(message, close);
    let mut files: Vec<_> =
        (0..4).map(|k| run.summary["profiles"][k]["file"].to_string()).collect();
    files.dedup();
    assert_eq!(files.len(), 4, "{files:?}");
    // no output times: only the end
    let run = Home::with(&every_step(&[])).run("run", &[]);
    assert_eq!(run.summary["profiles"][0]["time"], json!(1e-8));
    assert_eq!(run.summary["profiles"].as_array().unwrap().len(), 1);
}
