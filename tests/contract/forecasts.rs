//! The commands `calibrate` and `predict`: tables, files, and rejected input.

use std::sync::OnceLock;

use serde_json::{Value, json};

use crate::home::{Home, names};
#[cfg(feature = "mpi")]
use crate::program::Turn;
use crate::scenes::{FLYER, short};

/// A folder with the shipped scene and the constants of a short calibration, which is made once.
fn calibrated() -> Home {
    static CONSTANTS: OnceLock<String> = OnceLock::new();
    let constants = CONSTANTS.get_or_init(|| {
        let home = Home::new();
        home.write("flyer.json", FLYER);
        let args = ["perf", "calibrate", "flyer.json", "--seconds", "0.05", "--output", "m.json"];
        let text = home.call(args.into_iter().chain(["--samples"])).end().succeeded();
        for word in ["compute row", "exchange ghost row", "latency L (assumed)", "fit of steps"] {
            assert!(text.contains(word), "no {word} in: {text}");
        }
        assert_eq!(names(home.path()), ["flyer.json", "m.json"]);
        std::fs::read_to_string(home.at("m.json")).unwrap()
    });
    let home = Home::new();
    home.write("flyer.json", FLYER);
    home.write("m.json", constants);
    home
}

/// A study of one configuration, which takes `wall` seconds for 100 steps.
fn study(ranks: usize, wall: f64) -> Value {
    let row = |skip_quiescent| {
        json!({
            "ranks": ranks, "threads": 1, "skip_quiescent": skip_quiescent, "oversubscribed": false,
            "patches": 7, "particles": 1700, "steps": 100, "wall_seconds": wall,
        })
    };
    json!({"kind": "strong", "scene": "flyer.json", "sets": ["domain.patches=[7]"],
           "rows": [row(false), row(true)]})
}

#[test]
fn constants_are_measured_and_a_scene_is_predicted() {
    let home = calibrated();
    let constants: Value =
        serde_json::from_str(&std::fs::read_to_string(home.at("m.json")).unwrap()).unwrap();
    assert_eq!(constants["format"], 1);
    assert_eq!(constants["network"]["measured"], false);
    assert!(constants["coefficients"]["compute"][0].as_f64().unwrap() > 0.0);

    let before = home.contents();
    let predict = ["perf", "predict", "flyer.json", "--machine", "m.json"];
    let message = |more: &[&str]| {
        let all = predict.into_iter().chain(more.to_vec());
        home.call(all).end().succeeded()
    };
    let text = message(&["--ranks", "1,3", "--network", "slingshot11"]);
    for word in ["1700 particles", "speed-up", "slingshot11 (2.00 us", "patches run out at 62"] {
        assert!(text.contains(word), "no {word} in: {text}");
    }
    let rows: Vec<Vec<&str>> = text.lines().map(|l| l.split_whitespace().collect()).collect();
    let row = |ranks: &str| rows.iter().find(|r| r.first() == Some(&ranks)).unwrap();
    assert_eq!((row("1")[5], row("1")[6]), ("1.00", "100.0"));
    // numbers of ranks that were not measured are marked, and the table continues
    assert_eq!((row("*3")[1], row("*100000")[2]), ("1", "62"));

    home.write("scaling.json", &study(1, 1.0).to_string());
    let text =
        home.call(predict.into_iter().chain(["--against", "scaling.json"])).end().succeeded();
    let rows: Vec<Vec<&str>> = text.lines().map(|l| l.split_whitespace().collect()).collect();
    // rows with skipped patches are not part of the table
    assert_eq!(rows.len(), 3, "{text}");
    assert_eq!((rows[1][0], rows[1][3], rows[1][6]), ("1700", "7", "10000"));
    assert!(rows[2].starts_with(&["largest", "deviation:"]), "{text}");
    std::fs::remove_file(home.at("scaling.json")).unwrap();
    assert_eq!(home.contents(), before);
}

#[test]
fn what_cannot_be_predicted_is_refused() {
    let home = calibrated();
    home.write("scene.json", &short().to_string());
    home.write("weak.json", &study(1, 1.0).to_string().replace("strong", "weak"));
    home.write("none.json", &study(0, 1.0).to_string());
    home.write("other.json", &study(1, 1.0).to_string());
    home.write("text.json", "{\"format\": 1");
    let refused = |args: &[&str], fragments: &[&str]| {
        let out = home.call(["perf", "predict"].into_iter().chain(args.to_vec())).end();
        out.failed(fragments);
        assert_eq!(out.status.code(), Some(2), "{args:?}");
    };
    let with = |more: &[&'static str]| [&["flyer.json", "--machine", "m.json"], more].concat();
    refused(&["flyer.json"], &["output/machine.json", "flyer-mpm perf calibrate"]);
    refused(&["flyer.json", "--machine", "text.json"], &["text.json", "no machine file"]);
    refused(&["flyer.json", "--machine", "flyer.json"], &["flyer.json", "no machine file"]);
    refused(&with(&["--set", "method.shape=cpdi"]), &["m.json", "cpdi, fmpm 8", "calibrate"]);
    refused(&with(&["--set", "time.end=0"]), &["time.end = 0"]);
    refused(&with(&["--ranks", "1,0"]), &["--ranks", "1 to 1000000"]);
    refused(&with(&["--threads", "0"]), &["--threads"]);
    refused(&with(&["--network", "tokenring"]), &["--network", "tokenring", "slingshot11"]);
    refused(&with(&["--network", "1e-6,0"]), &["--network", "above 0"]);
    refused(&with(&["--against", "none"]), &["none", "cannot be read"]);
    refused(&with(&["--against", "m.json"]), &["m.json", "no scaling study"]);
    refused(&with(&["--against", "weak.json"]), &["weak.json", "kind = \"weak\"", "strong"]);
    refused(&with(&["--against", "none.json"]), &["none.json", "row 0", "above 0"]);
    let other = ["scene.json", "--machine", "m.json", "--against", "other.json"];
    refused(&other, &["other.json", "1700 particles", "400"]);
    let both = ["--against", "other.json", "--ranks", "2"];
    refused(&with(&both), &["--against", "--ranks"]);

    let out = home.call(["perf", "calibrate", "nowhere.json"]).end();
    out.failed(&["nowhere.json"]);
    assert_eq!(out.status.code(), Some(2));
    home.call(["perf", "calibrate", "flyer.json", "--seconds", "no"]).end().failed(&["--seconds"]);
    let out = home.call(["perf", "calibrate", "flyer.json", "--output", "."]).end();
    out.failed(&["a directory"]);
}

#[cfg(feature = "mpi")]
#[test]
fn ranks_measure_messages() {
    let home = Home::new();
    let args = ["perf", "calibrate", "--seconds", "0.05", "--output", "m.json"];
    let turn = Turn::alone();
    let run = home.call(args).ranks(3).within(&turn).start();
    let refused = home.call(["perf", "calibrate", "nowhere.json"]).ranks(2).within(&turn).start();
    refused.end().failed(&["nowhere.json"]);
    let text = run.end().succeeded();
    assert_eq!(text.matches("constants in m.json").count(), 1);
    let constants: Value =
        serde_json::from_str(&std::fs::read_to_string(home.at("m.json")).unwrap()).unwrap();
    assert_eq!((&constants["ranks"], &constants["network"]["measured"]), (&json!(3), &json!(true)));
    assert!(constants["network"]["reduction_level"].as_f64().unwrap() > 0.0);
}
