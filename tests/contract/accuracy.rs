//! Studies, error estimates of a run, and plans.

use std::time::SystemTime;

use serde_json::{Value, json};

use crate::home::{Home, names};
use crate::scenes::whole;

/// A study of the small scene: two cell sizes, and a scheme that is rejected.
fn study() -> Value {
    json!({
        "title": "small", "scene": "scene.json", "repeats": 2,
        "set": {"output.pictures": false, "output.hdf5": false},
        "sweep": [
            {"name": "scheme", "cases": [
                {"name": "as it is", "set": {}},
                {"name": "none", "set": {"method.shape": "octic"}},
            ]},
            {"key": "domain.cell_size", "values": [2e-5, 1e-5]},
        ],
        "leave_out": [{"scheme": "none", "domain.cell_size": 2e-5}],
        "choices": {"error": "l1", "time": 1e-7, "wanted": [0.9, 1e-9]},
        "pictures": [
            {"type": "curves", "name": "cost", "title": "cost", "x": "loop_cpu_seconds",
             "y": ["l1", "waves.shock"], "time": 1e-7, "series": ["scheme"], "front": true},
            {"type": "map", "name": "map", "title": "map", "x": "domain.cell_size",
             "y": "domain.cell_size", "value": "l1", "time": 1e-7},
        ],
    })
}

fn home(study: &Value) -> Home {
    let home = Home::with(&whole());
    home.write("study.json", &study.to_string());
    home
}

fn records(home: &Home) -> Vec<(String, SystemTime)> {
    let folder = home.at("out/runs");
    let time = |name: &String| folder.join(name).metadata().unwrap().modified().unwrap();
    names(&folder).into_iter().map(|name| (name.clone(), time(&name))).collect()
}

#[test]
fn a_study_runs_each_case_once_and_tells_of_those_that_fail() {
    let home = home(&study());
    let call = || home.call(["study", "study.json", "--output", "out"]).end().succeeded();
    let text = call();
    for word in ["3 cases, 1 failed", "method.shape", "none of these", "out/study.csv"] {
        assert!(text.contains(word), "no {word} in: {text}");
    }
    let table = std::fs::read_to_string(home.at("out/study.csv")).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(lines.len(), 4, "{table}");
    assert!(
        lines[0].starts_with("scheme,domain.cell_size,status,") && lines[0].contains("l1@0.1us")
    );
    assert!(lines[1].starts_with("as it is,0.00002,done,1,1,2,"), "{}", lines[1]);
    assert!(lines[3].contains("refused: "), "{}", lines[3]);
    let left = [
        "choices.md",
        "cost.png",
        "cost.svg",
        "map.png",
        "map.svg",
        "origin.json",
        "runs",
        "study.csv",
    ];
    assert_eq!(names(&home.at("out")), left);
    // no run is repeated; only a lost one is run again
    let before = records(&home);
    assert_eq!(before.len(), 2);
    call();
    assert_eq!(records(&home), before);
    std::fs::remove_file(home.at("out/runs").join(&before[0].0)).unwrap();
    call();
    let after = records(&home);
    assert_eq!(after[1], before[1]);
    assert_ne!(after[0].1, before[0].1);
}

#[test]
fn a_study_that_makes_no_sense_is_refused() {
    for (key, value, word) in [
        ("repeats", json!(0), "repeats = 0"),
        ("sweep", json!([{"key": "a"}]), "sweep"),
        ("sweep", json!([{"key": "a", "values": []}]), "`a` has no cases"),
        ("sweep", json!([{"key": "a", "values": [1, 2, 1]}]), "`a` has 1 twice"),
        ("leave_out", json!([{"speed": 1}]), "no label `speed`; allowed: scheme, domain.cell_size"),
        ("limits", json!(1), "unknown field"),
        ("scene", json!("missing.json"), "missing.json"),
    ] {
        let mut study = study();
        study[key] = value;
        let home = home(&study);
        home.call(["study", "study.json", "--output", "out"]).end().failed(&["error: ", word]);
    }
}

/// The small scene with an error estimate at one position.
fn estimating() -> Value {
    let mut scene = whole();
    scene["error_estimate"] = json!({"arrivals": [2e-4]});
    scene["output"] = json!({"pictures": false, "hdf5": false});
    scene
}

#[test]
fn a_run_tells_its_errors_and_changes_no_bit() {
    let plain = {
        let mut scene = estimating();
        scene.as_object_mut().unwrap().remove("error_estimate");
        Home::with(&scene).run("run", &[]).summary
    };
    assert!(plain.get("error_estimate").is_none() && plain.get("plan").is_none());
    let summary = Home::with(&estimating()).run("run", &[]).summary;
    assert_eq!(summary["profiles"], plain["profiles"]);
    let message = &summary["error_estimate"];
    let size = summary["scene"]["domain"]["cell_size"].as_f64().unwrap();
    assert_eq!(message["companions"], json!([4.0 * size, 2.0 * size]));
    let l1 = &message["profiles"][0]["l1"];
    assert_eq!(l1["exact"], summary["profiles"][0]["errors"]["l1"]);
    assert!(l1["half_width"].as_f64().unwrap() > 0.0);
    let arrival = &message["arrivals"][0]["time"];
    let [value, width, exact] =
        ["value", "half_width", "exact"].map(|key| arrival[key].as_f64().unwrap());
    // within the transit time of a cell, and reported with that width
    assert!((value - exact).abs() < size / 6000.0 && width < 5.0 * size / 6000.0, "{arrival}");
}

#[test]
fn a_statement_that_cannot_be_made_is_refused() {
    for (value, words) in [
        (json!({"body": "anvil"}), ["error_estimate.body", "no such body"]),
        (json!({"arrivals": [1.0]}), ["error_estimate.arrivals[0]", "outside of its body"]),
        (json!({"places": []}), ["error_estimate.places", "unknown key"]),
    ] {
        let mut scene = estimating();
        scene["error_estimate"] = value;
        Home::with(&scene).call(["check", "scene.json"]).end().failed(&words);
    }
}

#[test]
fn a_plan_chooses_and_its_run_compares_predicted_and_actual() {
    let home = Home::with(&estimating());
    let ask = |error: &str, more: &[&str]| {
        let all =
            ["plan", "scene.json", "--quantity", "l1", "--error", error, "--output", "p.json"];
        home.call(all.into_iter().chain(more.to_vec())).end()
    };
    let text = ask("10%", &[]).succeeded();
    assert!(text.contains("scheme") && text.contains("p.json"), "{text}");
    let end = home.call(["p.json", "--quiet", "--output", "run"]).end();
    assert_eq!(end.succeeded(), "");
    let plan = home.results("run").summary["plan"].clone();
    assert_eq!((&plan["wanted"], &plan["is_true"]), (&json!(0.1), &json!(true)));
    assert!(plan["actual"].as_f64().unwrap() < 0.1, "{plan}");
    // a smaller target error requires smaller cells
    let cells = |home: &Home| -> f64 {
        let text = std::fs::read_to_string(home.at("p.json")).unwrap();
        let scene: Value = serde_json::from_str(&text).unwrap();
        scene["domain"]["cell_size"].as_f64().unwrap()
    };
    let coarse = cells(&home);
    ask("3%", &[]).succeeded();
    assert!(cells(&home) < 0.6 * coarse);
    ask("0.0001%", &["--budget", "0.5"]).failed(&["cannot be had within 0.500 s", "the best is"]);
    let wrong = ["plan", "scene.json", "--quantity", "joy", "--error", "1%"];
    home.call(wrong).end().failed(&["plateau_pressure, l1 or arrival_time"]);
    let wrong = ["plan", "scene.json", "--quantity", "l1", "--error", "200%"];
    home.call(wrong).end().failed(&["0.5%"]);
}
