//! Every command on every shipped scene: it succeeds or is rejected with a message of one line.
//!
//! Commands that measure or time something take seconds, so they are tested with a few
//! representative scenes; `EVERY_SCENE=all cargo test --release --test contract every_scene` uses
//! all of them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use flyer_mpm::input;
use flyer_mpm::scene::CheckedScene;
use serde_json::Value;

use crate::home::Home;

/// All shipped scenes.
fn scenes() -> Vec<PathBuf> {
    scenes_of(&["", "hard"])
}

/// The scenes in folders of `inputs`.
fn scenes_of(folders: &[&str]) -> Vec<PathBuf> {
    let inputs = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs");
    let entries = folders.iter().flat_map(|f| std::fs::read_dir(inputs.join(f)).unwrap());
    let mut all: Vec<PathBuf> = entries.map(|e| e.unwrap().path()).collect();
    all.retain(|path| path.extension().is_some_and(|end| end == "json"));
    all.sort();
    assert!(all.len() > 35);
    all
}

fn read(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn checked(path: &Path) -> CheckedScene {
    let bytes = input::read(path).unwrap();
    input::parse(&bytes, path.to_str().unwrap(), &[]).unwrap()
}

fn is_plane(scene: &Value) -> bool {
    scene["domain"]["lower"].as_array().unwrap().len() > 1
}

/// Representative scenes for slow commands: all in a plane, which `plan` refuses at once, and some in
/// one dimension.
fn some(on_a_line: &[&str]) -> Vec<PathBuf> {
    let all = std::env::var("EVERY_SCENE").is_ok_and(|v| v == "all");
    let name = |path: &PathBuf| path.file_name().unwrap().to_str().unwrap().to_string();
    let taken = |p: &PathBuf| all || is_plane(&read(p)) || on_a_line.contains(&name(p).as_str());
    scenes().into_iter().filter(taken).collect()
}

/// Runs a command, asserts success or a message of one line, and returns the exit code.
#[track_caller]
fn call(home: &Home, args: &[&str]) -> i32 {
    let end = home.call(args.iter().copied()).end();
    let code = end.status.code();
    assert!(!end.stderr.contains("panicked"), "{args:?}: {}", end.stderr);
    let errors = end.stderr.lines().filter(|l| l.starts_with("error:")).count();
    let text = if code == Some(0) { 0 } else { 1 };
    assert_eq!(errors, text, "{args:?}: {code:?} {}", end.stderr);
    assert!(matches!(code, Some(0 | 2 | 3)), "{args:?}: {code:?} {}", end.stderr);
    code.unwrap()
}

#[test]
fn check_hugoniot_and_material_of_every_scene() {
    let home = Home::new();
    let mut seen = BTreeSet::new();
    for path in scenes() {
        let (file, scene) = (path.to_str().unwrap(), read(&path));
        assert_eq!(call(&home, &["check", file]), 0, "{file}");
        let impact = scene.pointer("/reference/flyer_impact").is_some();
        let code = call(&home, &["hugoniot", file]);
        assert_eq!(code == 0, impact, "{file}: {code}");
        for (name, material) in scene["materials"].as_object().unwrap() {
            if seen.insert(material.to_string()) {
                call(&home, &["material", file, name]);
            }
        }
    }
}

#[test]
fn calibrate_and_predict_of_every_scene() {
    let home = Home::new();
    // a prediction counts all patches and their particles, which takes longest in large planes
    for path in some(&["sod.json"]).into_iter().filter(|path| checked(path).particles < 15_000) {
        let file = path.to_str().unwrap();
        let code =
            call(&home, &["perf", "calibrate", file, "--seconds", "0.01", "--output", "m.json"]);
        assert_eq!(code, 0, "{file}: calibrate");
        let code = call(&home, &["perf", "predict", file, "--machine", "m.json", "--ranks", "2"]);
        assert_eq!(code, 0, "{file}: predict");
    }
}

#[test]
fn plan_of_every_scene() {
    let home = Home::new();
    for path in some(&["flyer_strength.json", "gap.json", "piston.json", "sod.json"]) {
        let (file, scene) = (path.to_str().unwrap(), read(&path));
        let end = checked(&path).scene.time.end;
        let end = format!("time.end={}", if is_plane(&scene) { end } else { 0.1 * end });
        let sets = ["--set", &end, "--set", "output={}", "--set", "error_estimate=null"];
        let plan = ["plan", file, "--quantity", "l1", "--error", "30%", "--output", "p.json"];
        let args = [&plan[..], &sets].concat();
        let code = call(&home, &args);
        assert!(!is_plane(&scene) || code == 2, "{file}: {code}");
        let _ = std::fs::remove_file(home.at("p.json"));
    }
}

/// Whatever a scene contains, the lines of its run are at most 100 characters long, and the report
/// has at most ten of them and the warnings. The title stands once.
#[test]
fn the_report_of_every_scene_is_short() {
    let home = Home::new();
    for path in scenes_of(&["", "hard", "templates"]) {
        let (file, scene) = (path.to_str().unwrap(), checked(&path));
        let end = scene.scene.time.end / 500.0;
        let output = format!(
            "output={{\"profiles\": {{\"times\": [{end:e}]}}, \"pictures\": false, \"hdf5\": false}}"
        );
        let sets = ["--set", &format!("time.end={end:e}"), "--set", &output];
        let run = home.call([&[file, "--progress", "never"][..], &sets].concat()).end();
        let all = format!("{}{}", run.stderr, run.stdout);
        let report = run.succeeded();
        assert!(all.lines().all(|line| line.chars().count() <= 100), "{file}: {all}");
        let is_warning =
            |line: &&str| line.starts_with("warning: ") || line.starts_with("         ");
        let is_quantity = |line: &&str| line.contains("computed");
        let lines = report.lines().filter(|line| !is_warning(line) || is_quantity(line)).count();
        assert!((4..=10).contains(&lines), "{file}: {report}");
        let title = scene.scene.title.as_str();
        assert_eq!(all.lines().filter(|line| line.starts_with(title)).count(), 1, "{file}: {all}");
    }
}
