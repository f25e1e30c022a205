//! A scene without `method`: the printed choice of the program, and its accuracy.

use serde_json::json;

use crate::home::Home;
use crate::scenes::short;

/// Tungsten on tantalum at 800 m/s. The exact pressure between them is 29.807 GPa.
#[test]
fn an_impact_without_a_method_is_accurate() {
    let plate = |name: &str, ends: [f64; 2], speed: f64| {
        json!({"name": name, "material": name, "velocity": [speed], "particles_per_cell": [2],
               "box": {"lower": [ends[0]], "upper": [ends[1]]}})
    };
    let gauge = |name: &str, x: f64| json!({"name": name, "body": "tantalum", "at": [x]});
    let gauges = [gauge("gauge_1", 0.0005), gauge("gauge_2", 0.0015), gauge("gauge_3", 0.0025)];
    let scene = json!({
        "title": "Tungsten on tantalum",
        "domain": {"lower": [-0.002], "upper": [0.008], "cell_size": 1e-5},
        "time": {"end": 1e-6},
        "materials": {"tungsten": {"library": "tungsten"}, "tantalum": {"library": "tantalum"}},
        "bodies": [plate("tungsten", [-0.001, 0.0], 800.0), plate("tantalum", [0.0, 0.006], 0.0)],
        "output": {
            "profiles": {"times": [3e-7, 6e-7, 1e-6]},
            "histories": {"interval": 1e-9, "tracers": gauges},
        },
        "reference": {"flyer_impact": {"flyer": "tungsten", "target": "tantalum"}},
    });
    let home = Home::with(&scene);
    let message = home.call(["check", "scene.json"]).end().succeeded();
    assert!(message.contains("preset default") && message.contains("FMPM(14)"), "{message}");
    let said = home.call(["scene.json"]).end();
    assert!(said.stderr.contains("method default: FMPM(14)"), "{}", said.stderr);
    said.succeeded();
    let results = home.results("output/scene");
    let summary = &results.summary;
    assert_eq!(summary["method_choice"]["preset"], "default");
    for profile in summary["profiles"].as_array().unwrap() {
        let l1 = profile["errors_cell_averaged"]["l1"].as_f64().unwrap();
        assert!(l1 < 0.01, "L1 {l1}");
    }
    let mut reader =
        csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(results.bytes("histories.csv"));
    let is_gauge = |name: &str| name.starts_with("gauge") && name.ends_with("pressure");
    let gauges: Vec<usize> = reader
        .headers()
        .unwrap()
        .iter()
        .enumerate()
        .filter(|(_, name)| is_gauge(name))
        .map(|(k, _)| k)
        .collect();
    assert_eq!(gauges.len(), 3);
    let mut peaks = [0.0_f64; 3];
    for row in reader.records().map(Result::unwrap) {
        for (peak, k) in peaks.iter_mut().zip(&gauges) {
            *peak = peak.max(row[*k].parse().unwrap());
        }
    }
    for peak in peaks {
        assert!((peak / 29.806946e9 - 1.0).abs() < 0.005, "peak {peak:e} Pa");
    }
}

/// The checkpoint holds the method in full; the restarted run still says how it was chosen.
#[test]
fn a_restarted_run_tells_of_the_same_choice() {
    let mut scene = short();
    for key in ["method", "artificial_viscosity"] {
        scene.as_object_mut().unwrap().remove(key);
    }
    scene["output"]["checkpoint"] = json!({"every_steps": 5, "keep": 9});
    let home = Home::with(&scene);
    let method = |stderr: &str| {
        let lines = stderr.lines().skip_while(|line| !line.starts_with("method "));
        let end = |line: &&str| line.starts_with("method ") || line.starts_with("  ");
        lines.take_while(end).map(String::from).collect::<Vec<_>>()
    };
    let whole = home.call(["scene.json", "--output", "run"]).end();
    let choice = home.results("run").summary["method_choice"].clone();
    assert!(choice["reasons"].as_array().is_some_and(|reasons| !reasons.is_empty()), "{choice}");
    let said = method(&whole.stderr);
    assert!(said[0].starts_with("method default: "), "{}", whole.stderr);
    for _ in 0..2 {
        let file = "run.checkpoints/checkpoint-000001.hdf5";
        let again = home.call(["--restart", file, "--output", "run"]).end();
        assert_eq!(method(&again.stderr), said);
        again.succeeded();
        assert_eq!(home.results("run").summary["method_choice"], choice);
    }
}
