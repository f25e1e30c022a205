//! Scaling studies: `perf study`.

use serde_json::{Value, json};

use crate::home::{Home, names};
use crate::scenes::short;

/// Every configuration is run without and with skipping; the files hold the rows.
#[test]
fn a_study_runs_its_configurations_and_writes_its_files() {
    let home = Home::with(&short());
    let args = ["perf", "study", "strong", "scene.json", "--ranks", "2", "--repeats", "1"];
    let text = home.call(args.into_iter().chain(["--cores", "1"])).end().succeeded();
    let rows = |name: &str| text.lines().filter(|line| line.contains(name)).count();
    assert_eq!((rows("1 x 1"), rows("2 x 1"), rows("oversubscribed")), (2, 2, 2), "{text}");
    assert!(text.contains("results in output/strong_scaling_scene"), "{text}");
    let folder = home.at("output/strong_scaling_scene");
    let files = ["origin.json", "scaling.json", "scaling.png", "scaling.svg", "strong_scaling.csv"];
    assert_eq!(names(&folder), files);
    let study: Value =
        serde_json::from_slice(&std::fs::read(folder.join("scaling.json")).unwrap()).unwrap();
    let found: Vec<[&Value; 2]> = study["rows"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| {
            assert_eq!(row["particles"], 400);
            [&row["ranks"], &row["skip_quiescent"]]
        })
        .collect();
    let expected = json!([[1, false], [1, true], [2, false], [2, true]]);
    assert_eq!(serde_json::to_value(found).unwrap(), expected);
    let kind = json!("strong");
    assert_eq!(
        (&study["kind"], study["rows"][0]["oversubscribed"].as_bool()),
        (&kind, Some(false))
    );
}

#[test]
fn a_study_that_cannot_be_run_is_refused_before_its_first_run() {
    let home = Home::with(&short());
    let before = home.contents();
    for (args, fragment) in [
        (["strong", "none.json", "--ranks", "1"], "none.json"),
        (["strong", "scene.json", "--ranks", "0"], "a whole number from 1 to 1024"),
    ] {
        let out = home.call(["perf", "study"].into_iter().chain(args)).end();
        out.failed(&[fragment]);
        assert_eq!(out.status.code(), Some(2));
    }
    let mut bad = short();
    bad["time"]["end"] = json!(-1.0);
    home.write("bad.json", &bad.to_string());
    let out = home.call(["perf", "study", "weak", "bad.json", "--ranks", "2"]).end();
    out.failed(&["bad.json", "time.end"]);
    let nested = ["perf", "study", "strong", "scene.json", "--ranks", "1"];
    home.call(nested).ranks(1).end().failed(&["start it without mpirun"]);
    std::fs::remove_file(home.at("bad.json")).unwrap();
    assert_eq!(home.contents(), before);
}
