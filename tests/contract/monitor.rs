//! Runs that the monitor ends: their messages, and the last good state that they write.

use serde_json::{Value, json};

use crate::home::{Home, checkpoints};
use crate::scenes::short;

/// A scene in which both plates keep flying and the target leaves the domain after about a hundred
/// steps.
fn leaving() -> Value {
    let mut scene = short();
    scene.as_object_mut().unwrap().remove("reference");
    scene["domain"]["upper"] = json!([1.6e-3]);
    scene["bodies"][0]["velocity"] = json!([2500.0]);
    scene["bodies"][1]["velocity"] = json!([1500.0]);
    scene["time"]["end"] = json!(1e-7);
    scene["output"]["profiles"]["times"] = json!([2e-9, 1e-7]);
    scene["output"]["histories"] = json!({"interval": 1e-9});
    scene
}

const FRAGMENTS: [&str; 6] = [
    "leaves the domain",
    "cell [",
    "likely cause",
    "the last good state, time ",
    ", step ",
    "--restart",
];

/// Overrides with which it ends well before that.
const EARLIER: [&str; 4] =
    ["--set", "time.end=6.5e-8", "--set", "output.profiles.times=[2e-9,6.5e-8]"];

fn goes_on(ranks: Option<usize>) {
    let home = Home::with(&leaving());
    let call = |args: &[&str]| {
        let call = home.call(args.to_vec());
        ranks.map_or(call, |_| home.call(args.to_vec()).ranks(ranks.unwrap_or(1))).end()
    };
    let ended = call(&["scene.json", "--quiet", "--output", "run"]);
    ended.failed(&FRAGMENTS);
    assert!(ended.status.code().is_some_and(|code| code == 3));
    assert_eq!(checkpoints(&home.at("run.checkpoints")), ["checkpoint-000001.hdf5"]);
    let restart = ["--restart", "run.checkpoints", "--quiet", "--output", "on"];
    assert_eq!(call(&[&restart[..], &EARLIER].concat()).succeeded(), "");
    let plain = ["scene.json", "--quiet", "--output", "plain"];
    assert_eq!(call(&[&plain[..], &EARLIER].concat()).succeeded(), "");
    let (on, plain) = (home.results("on"), home.results("plain"));
    assert_eq!(on.states(), plain.states());
    assert_eq!(on.text("histories.csv"), plain.text("histories.csv"));
}

#[test]
fn the_last_good_state_is_written_and_goes_on() {
    goes_on(None);
}

#[cfg(feature = "mpi")]
#[test]
fn all_ranks_end_and_go_on() {
    goes_on(Some(3));
}

#[test]
fn nothing_is_written_where_nobody_wants_it() {
    let mut scene = leaving();
    scene["output"]["checkpoint"] = json!({"keep": 0});
    let home = Home::with(&scene);
    home.call(["scene.json", "--quiet"]).end().failed(&["no state was written"]);
    assert!(!home.at("output/scene.checkpoints").exists());
}

/// If the state cannot be written, the message still contains the cause of the end.
#[test]
fn a_state_that_cannot_be_written_is_reported_beside_the_cause() {
    let home = Home::with(&leaving());
    home.write("run.checkpoints", "a file in its place");
    let ended = home.call(["scene.json", "--quiet", "--output", "run"]).end();
    ended.failed(&["leaves the domain", "the last good state could not be written"]);
}

/// A run that is inaccurate but within the bounds continues with a warning.
#[test]
fn energy_that_drifts_is_reported() {
    let mut scene = short();
    scene["method"] = json!({"shape": "cpdi", "transfer": "pic"});
    scene["time"]["end"] = json!(3e-8);
    scene["output"]["profiles"]["times"] = json!([3e-8]);
    let home = Home::with(&scene);
    let run = home.run("run", &[]);
    let drift = run.summary["energy"]["drift"].as_f64().unwrap();
    assert!(drift < -0.01, "{drift}");
    let warnings = run.summary["warnings"].to_string();
    assert!(warnings.contains("energy has drifted by -"), "{warnings}");
    let exact = Home::with(&short()).run("run", &[]);
    assert!(!exact.summary["warnings"].to_string().contains("drifted"));
}

/// Repeated steps are counted.
#[test]
fn redone_steps_are_reported() {
    let mut scene = short();
    scene["monitor"] = json!({"courant": 0.401, "on_alarm": "redo"});
    scene["time"]["end"] = json!(3e-8);
    scene["output"]["profiles"]["times"] = json!([3e-8]);
    let home = Home::with(&scene);
    let warnings = home.run("run", &[]).summary["warnings"].to_string();
    assert!(warnings.contains("times a step was redone half as long"), "{warnings}");
}

/// The command `check` shows the bounds of the monitor.
#[test]
fn the_check_tells_what_is_held() {
    let home = Home::with(&short());
    let text = home.call(["check", "scene.json"]).end().succeeded();
    assert!(text.contains("last good state") && text.contains("this method's limit"), "{text}");
}
