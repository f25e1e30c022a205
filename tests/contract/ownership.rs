//! Only a run of the same scene replaces a result: comparison of the files before and after each
//! command.

use std::fs;
use std::path::Path;

use flyer_mpm::driver::output::lock::Lock;
use flyer_mpm::driver::output::origin::{Origin, RUN};
use serde_json::{Value, json};

use crate::home::Home;
use crate::program::Ended;
use crate::scenes::{FLYER, short, whole};

/// A folder with two scenes of the same file name, `a/plate.json` and `b/plate.json`, and the
/// result of the first.
fn home() -> Home {
    let home = Home::new();
    home.write("a/plate.json", &short().to_string());
    let mut other = short();
    other["bodies"][0]["velocity"] = json!([700.0]);
    home.write("b/plate.json", &other.to_string());
    home.call(["a/plate.json", "--quiet"]).end().succeeded();
    home
}

/// Asserts a message of one line, exit code 2, and no change of files.
#[track_caller]
fn refused(home: &Home, args: &[&str], fragments: &[&str]) {
    let before = home.contents();
    let out = home.call(args.iter().copied()).end();
    out.failed(fragments);
    assert_eq!(out.status.code(), Some(2), "{}", out.stderr);
    assert!(home.contents() == before, "{args:?} has changed files");
}

/// Asserts that existing files are unchanged, whatever the exit code.
#[track_caller]
fn harmless(home: &Home, args: &[&str]) -> Ended {
    let before = home.contents();
    let end = home.call(args.iter().copied()).end();
    assert!(!end.stderr.contains("panicked"), "{args:?}: {}", end.stderr);
    let after = home.contents();
    for (path, bytes) in &before {
        assert!(after.get(path) == Some(bytes), "{args:?} has changed {path:?}");
    }
    end
}

#[test]
fn two_scenes_of_one_name_do_not_share_a_result() {
    let home = home();
    let words = ["output/plate", "a/plate.json", "b/plate.json", "--output DIR"];
    refused(&home, &["b/plate.json", "--output", "output/plate"], &words);
    harmless(&home, &["b/plate.json", "--quiet", "--output", "output/b"]).succeeded();
    refused(&home, &["a/plate.json", "--output", "output/b"], &words[1..]);
    // without --output, each scene has its own folder, also when it is run again
    for _ in 0..2 {
        let out = home.call(["b/plate.json"]).end();
        // lines are broken between words
        let text = out.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(text.matches("results go").count(), 1, "{text}");
        for word in ["output/plate-2", "instead of output/plate", "it holds", "a/plate.json"] {
            assert!(text.contains(word), "no {word} in: {text}");
        }
        assert!(out.succeeded().contains("output/plate-2"));
    }
    let out = home.call(["a/plate.json"]).end();
    assert!(!out.stderr.contains("results go"), "{}", out.stderr);
    out.succeeded();
    assert_eq!(home.results("output/plate").summary["scene"]["bodies"][0]["velocity"][0], 1000.0);
    assert_eq!(home.results("output/plate-2").summary["scene"]["bodies"][0]["velocity"][0], 700.0);
    assert!(!home.at("output/plate-3").exists());
}

/// A run of another scene that has not ended yet is passed over; the same scene is refused.
#[test]
fn two_scenes_of_one_name_may_run_at_once() {
    let home = home();
    fs::remove_dir_all(home.at("output")).unwrap();
    let running = Origin::new(RUN, &home.at("a/plate.json"));
    let lock = Lock::take_for(&home.at("output/plate"), &running).unwrap();
    let out = home.call(["b/plate.json"]).end();
    for word in ["output/plate-2 instead of output/plate", "a/plate.json is writing there"] {
        let text = out.stderr.replace("\n  ", " ");
        assert!(text.contains(word), "no {word} in: {text}");
    }
    assert!(out.succeeded().contains("output/plate-2"));
    let words = ["output/plate", "another --output"];
    home.call(["a/plate.json", "--quiet"]).end().failed(&words);
    drop(lock);
    home.call(["a/plate.json", "--quiet"]).end().succeeded();
    assert!(home.at("output/plate/summary.json").exists());
}

/// A run that was killed before its first result has checkpoints only.
#[test]
fn a_scene_with_checkpoints_alone_keeps_its_folder() {
    let home = home();
    let checkpoints = "output.checkpoint={\"every_steps\": 3}";
    home.call(["a/plate.json", "--quiet", "--set", checkpoints]).end().succeeded();
    fs::remove_dir_all(home.at("output/plate")).unwrap();
    harmless(&home, &["b/plate.json", "--quiet"]).succeeded();
    assert!(home.at("output/plate-2/summary.json").exists());
    home.call(["--restart", "output/plate.checkpoints", "--quiet"]).end().succeeded();
    assert!(home.at("output/plate/summary.json").exists());
}

#[test]
fn an_edited_a_copied_and_a_moved_scene() {
    let home = home();
    let first = home.results("output/plate");
    // an edited scene, or another value by --set, is the same scene
    home.call(["a/plate.json", "--quiet", "--set", "time.end=2e-8"]).end().succeeded();
    let mut edited = short();
    edited["title"] = json!("edited");
    edited["bodies"][0]["velocity"] = json!([900.0]);
    home.write("a/plate.json", &edited.to_string());
    home.call(["a/plate.json", "--quiet"]).end().succeeded();
    assert_ne!(home.results("output/plate").states(), first.states());
    // a copy is another scene
    fs::copy(home.at("a/plate.json"), home.at("b/plate.json")).unwrap();
    harmless(&home, &["b/plate.json", "--quiet"]).succeeded();
    let states = home.results("output/plate-2");
    assert_eq!(states.states(), home.results("output/plate").states());
    // scenes and results moved together
    fs::create_dir(home.at("old")).unwrap();
    for name in ["a", "b", "output"] {
        fs::rename(home.at(name), home.at("old").join(name)).unwrap();
    }
    fs::rename(home.at("old"), home.at("new")).unwrap();
    edited["time"]["end"] = json!(2e-8);
    home.write("new/a/plate.json", &edited.to_string());
    let args = ["new/a/plate.json", "--quiet", "--output", "new/output/plate"];
    home.call(args).end().succeeded();
    edited["time"]["end"] = json!(1.5e-8);
    home.write("new/b/plate.json", &edited.to_string());
    refused(&home, &["new/b/plate.json", "--output", "new/output/plate"], &["new/output/plate"]);
}

#[test]
fn a_result_without_a_record_is_replaced_by_the_same_values_alone() {
    let home = home();
    let file = home.at("output/plate/summary.json");
    let mut summary: Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    assert!(summary.as_object_mut().unwrap().remove("origin").is_some());
    home.write("output/plate/summary.json", &summary.to_string());
    let other = ["b/plate.json", "--output", "output/plate"];
    refused(&home, &other, &["an unknown file", "b/plate.json"]);
    home.call(["a/plate.json", "--quiet"]).end().succeeded();
    assert!(home.results("output/plate").summary["origin"]["file"].is_string());
}

#[test]
fn results_are_not_put_into_results_nor_replaced_around_others() {
    let home = home();
    let inside = ["b/plate.json", "--output", "output/plate/b"];
    refused(&home, &inside, &["output/plate/b", "inside of the result"]);
    refused(&home, &["hugoniot", "b/plate.json", "--output", "output/plate/x/y"], &["inside"]);
    home.call(["b/plate.json", "--quiet", "--output", "b/result"]).end().succeeded();
    fs::rename(home.at("b/result"), home.at("output/plate/moved")).unwrap();
    refused(&home, &["a/plate.json"], &["has another result inside", "moved"]);
}

#[test]
fn checkpoints_of_another_scene_stay() {
    let home = home();
    let checkpoints = "output.checkpoint={\"every_steps\": 3, \"keep\": 9}";
    let args = ["a/plate.json", "--quiet", "--output", "kept", "--set", checkpoints];
    home.call(args).end().succeeded();
    assert!(home.at("kept.checkpoints/checkpoint-000001.hdf5").exists());
    // a killed run leaves no result, but checkpoints
    fs::remove_dir_all(home.at("kept")).unwrap();
    refused(&home, &["b/plate.json", "--output", "kept"], &["kept.checkpoints", "a/plate.json"]);
    // a restart belongs to the scene with which the run began
    let restart = ["--restart", "kept.checkpoints", "--quiet"];
    home.call(restart.into_iter().chain(["--output", "output/plate"])).end().succeeded();
    home.call(restart).end().succeeded();
    home.call(["b/plate.json", "--quiet", "--output", "other"]).end().succeeded();
    let other = ["--restart", "kept.checkpoints", "--output", "other"];
    refused(&home, &other, &["other", "b/plate.json", "a/plate.json"]);
    home.call(["a/plate.json", "--quiet", "--output", "kept"]).end().succeeded();
    // the file name of a single checkpoint determines its output folder
    fs::create_dir(home.at("alone")).unwrap();
    let newest = "kept.checkpoints/checkpoint-000002.hdf5";
    for (folder, scene) in [("alone", "a/plate.json"), ("more", "b/plate.json")] {
        home.call([scene, "--quiet", "--output", folder, "--set", checkpoints]).end();
        fs::create_dir_all(home.at(&format!("{folder}.files"))).unwrap();
        let from = home.at(newest.replace("kept", folder).as_str());
        fs::copy(from, home.at(&format!("{folder}.files/checkpoint-000002.hdf5"))).unwrap();
    }
    home.call(["--restart", "alone.files/checkpoint-000002.hdf5", "--quiet"]).end().succeeded();
    refused(
        &home,
        &["--restart", "more.files/checkpoint-000002.hdf5"],
        &["output/checkpoint-000002"],
    );
}

#[test]
fn no_other_command_changes_a_result() {
    let home = home();
    home.write("a/flyer.json", FLYER);
    let quick = ["--quiet", "--set", "time.end=2e-8", "--set", "output={}"];
    home.call(["a/flyer.json"].into_iter().chain(quick)).end().succeeded();
    home.write(
        "sweep.json",
        &json!({
            "title": "small", "scene": "a/plate.json",
            "sweep": [{"key": "domain.cell_size", "values": [2e-5]}],
        })
        .to_string(),
    );
    harmless(&home, &["check", "a/plate.json"]).succeeded();
    harmless(&home, &["schema"]).succeeded();
    harmless(&home, &["hugoniot", "a/flyer.json"]).succeeded();
    harmless(&home, &["material", "a/flyer.json", "copper"]).succeeded();
    harmless(&home, &["compare", "output/plate", "output/flyer"]);
    harmless(&home, &["study", "sweep.json", "--quiet"]).succeeded();
    let calibrate = ["perf", "calibrate", "a/plate.json", "--seconds", "0.01"];
    harmless(&home, &calibrate).succeeded();
    harmless(&home, &["perf", "predict", "a/plate.json"]).succeeded();
    let plan = ["plan", "a/plate.json", "--quantity", "l1", "--error", "20%"];
    harmless(&home, &plan).succeeded();
    // the scene of a plan has its own folder
    harmless(&home, &["output/plans/plate.plan.json", "--quiet"]).succeeded();
    assert!(home.at("output/plate.plan/summary.json").exists());
    // each of them into the folder of a run
    for args in [
        &["hugoniot", "a/flyer.json", "--output", "output/flyer"][..],
        &["material", "a/flyer.json", "copper", "--output", "output/flyer"],
        &["study", "sweep.json", "--output", "output/flyer"],
        &["plan", "a/plate.json", "--quantity", "l1", "--error", "20%", "--output", "b/plate.json"],
        &["perf", "calibrate", "a/plate.json", "--seconds", "0.01", "--output", "b/plate.json"],
        &["perf", "calibrate", "--seconds", "0.01", "--output", "output/plate/machine.json"],
        &["a/plate.json", "--trace", "b/plate.json"],
        &["a/plate.json", "--trace", "output/flyer/line.json"],
    ] {
        refused(&home, args, &["error: "]);
    }
    // results of other scenes and studies with the same name
    let mut other: Value = serde_json::from_str(FLYER).unwrap();
    other["bodies"][0]["velocity"] = json!([700.0]);
    home.write("b/flyer.json", &other.to_string());
    home.write(
        "b/sweep.json",
        &fs::read_to_string(home.at("sweep.json")).unwrap().replace("a/", ""),
    );
    refused(&home, &["hugoniot", "b/flyer.json"], &["a/flyer.json", "b/flyer.json"]);
    refused(&home, &["material", "b/flyer.json", "copper"], &["a/flyer.json", "b/flyer.json"]);
    refused(&home, &["study", "b/sweep.json"], &["sweep.json", "b/sweep.json"]);
    let plan = ["plan", "b/plate.json", "--quantity", "l1", "--error", "20%"];
    refused(&home, &plan, &["output/plans/plate.plan.json", "b/plate.json"]);
    // the same commands again
    for args in [
        &["hugoniot", "a/flyer.json"][..],
        &["material", "a/flyer.json", "copper"],
        &["study", "sweep.json", "--quiet"],
    ] {
        home.call(args.iter().copied()).end().succeeded();
    }
}

#[test]
fn a_run_records_its_origin() {
    let home = Home::with(&whole());
    let run = home.run("run", &["--set", "output.pictures=false"]);
    let origin = &run.summary["origin"];
    assert_eq!((&origin["command"], &origin["relative"]), (&json!("run"), &json!("../scene.json")));
    let file = Path::new(origin["file"].as_str().unwrap());
    assert!(file.is_absolute() && file.is_file());
}
