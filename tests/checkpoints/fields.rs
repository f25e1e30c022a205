//! Fields as the run goes: the same data on any ranks, after a stop and after a restart.

use std::path::Path;

use serde_json::{Value, json};

use crate::home::{Home, Results, names};
use crate::restarts::recorded;
use crate::scenes::with;

/// A small scene with frames in both formats, gauges, and checkpoints every so many steps.
fn framed(every: u64) -> Value {
    let edit = json!({"output": {
        "profiles": {"times": [5e-8]},
        "fields": {"every": 2e-9, "format": "both", "quantities": ["velocity", "strain", "mass", "pressure"]},
        "histories": {
            "interval": 1e-9,
            "stations": [{"name": "fixed", "at": [0.0002]}],
            "velocimeters": [{"name": "visar", "body": "target", "at": [0.0007], "fringe": 100.0}],
            "planes": [{"name": "middle", "at": 0.0001}]
        },
        "hdf5": false
    }});
    with(&recorded(every), &edit)
}

/// Values of a column of a frame as CSV.
fn values(run: &Results, frame: usize, name: &str) -> Vec<f64> {
    crate::home::column(run.text(&format!("fields/frame_{frame:06}.csv")), name)
}

#[test]
fn frames_stand_from_the_start_in_order_of_particles() {
    let home = Home::with(&framed(1000));
    let run = home.run("run", &[]);
    let frames =
        run.names().iter().filter(|name| name.ends_with(".csv") && name.contains("frame_")).count();
    assert_eq!(frames, 26, "{:?}", run.names());
    // the initial state, particle after particle of the flyer and of the target
    let (velocity, mass) = (values(&run, 0, "velocity"), values(&run, 0, "mass"));
    let flyer = velocity.iter().take_while(|&&u| u == 1000.0).count();
    assert!(flyer > 10 && velocity[flyer..].iter().all(|&u| u == 0.0), "{velocity:?}");
    assert!(values(&run, 0, "strain_xx").iter().all(|&e| e.abs() < 1e-12));
    assert!(values(&run, 25, "strain_xx").iter().any(|&e| e < -0.05));
    assert_eq!(values(&run, 25, "mass"), mass);
    let data = hdf5_values(&home.at("run"), "PointData/velocity");
    assert_eq!(data.len(), 26 * 3 * mass.len());
    let last = &data[25 * 3 * mass.len()..];
    assert!(last.chunks(3).map(|v| v[0]).eq(values(&run, 25, "velocity")));
    assert!(last.chunks(3).all(|v| v[1..] == [0.0, 0.0]));
    let tensors = hdf5_values(&home.at("run"), "PointData/strain");
    assert!(tensors[25 * 6 * mass.len()..].chunks(6).map(|e| e[0]).eq(values(
        &run,
        25,
        "strain_xx"
    )));
    let times = hdf5_values(&home.at("run"), "Steps/Values");
    assert!(times.len() == 26 && times[0] == 0.0 && times[25] == 5e-8, "{times:?}");
    let late = times.iter().enumerate().all(|(k, t)| *t >= 2e-9 * k as f64 * (1.0 - 1e-12));
    assert!(late, "{times:?}");
    // frames change no bit of the results
    let plain = home.run("plain", &["--set", "output.fields=null"]);
    assert_eq!(plain.profile(0), run.profile(0));
    assert_eq!(plain.count("steps"), run.count("steps"));
}

/// All numbers of a dataset of `fields.vtkhdf`.
fn hdf5_values(results: &Path, name: &str) -> Vec<f64> {
    let file = hdf5::File::open(results.join("fields.vtkhdf")).unwrap();
    file.dataset(&format!("VTKHDF/{name}")).unwrap().read_raw().unwrap()
}

/// What is in a folder of results beside the index, whose bytes name the layout of the run.
#[track_caller]
fn same_frames(home: &Home, a: &Results, b: &Results, folders: [&str; 2]) {
    for name in a.names().iter().filter(|name| name.starts_with("fields/")) {
        assert!(a.bytes(name) == b.bytes(name), "{name}");
    }
    for name in ["Points", "PointData/velocity", "PointData/strain", "Steps/Values"] {
        let [a, b] = folders.map(|folder| hdf5_values(&home.at(folder), name));
        assert!(a == b, "{name}");
    }
}

/// A run that is stopped leaves its frames, profiles and a picture; it goes on as if it had not been.
#[test]
fn a_stopped_run_leaves_what_it_has_and_goes_on_without_a_seam() {
    let mut scene = framed(1000);
    scene["output"]["pictures"] = json!(true);
    let home = Home::with(&scene);
    let whole = home.run("whole", &[]);
    let args = ["scene.json", "--output", "run", "--set", "time.wall_limit=1e-9"];
    let out = home.call(args).end();
    assert_eq!(out.status.code(), Some(4));
    assert!(out.stderr.contains("run.unfinished"), "{}", out.stderr);
    assert!(!home.at("run").exists());
    let left = names(&home.at("run.unfinished"));
    for name in ["fields.vtkhdf", "histories.csv", "origin.json"] {
        assert!(left.contains(&name.to_string()), "{left:?}");
    }
    let begins =
        |head: &str, end: &str| left.iter().any(|f| f.starts_with(head) && f.ends_with(end));
    assert!(begins("profile_", ".csv") && begins("pressure_", ".png"), "{left:?}");
    assert_eq!(hdf5_values(&home.at("run.unfinished"), "Steps/Values"), [0.0]);
    // many stops, each a step or a few later
    for _ in 0..3 {
        let args = ["--restart", "run", "--quiet", "--set", "time.wall_limit=0.05"];
        let code = home.call(args).end().status.code();
        assert!(matches!(code, Some(0 | 4)), "{code:?}");
        // a run that has ended would be continued from its last checkpoint
        if code == Some(0) {
            break;
        }
    }
    if !home.at("run").exists() {
        let args = ["--restart", "run", "--quiet", "--set", "time.wall_limit=null"];
        home.call(args).end().succeeded();
    }
    let run = home.results("run");
    same_frames(&home, &run, &whole, ["run", "whole"]);
    for name in ["histories.csv", "profile_50.000ns.csv"] {
        if let Some(name) = whole.names().iter().find(|n| n.ends_with(name)) {
            assert!(run.bytes(name) == whole.bytes(name), "{name}");
        }
    }
    assert_eq!(run.summary["gauges"], whole.summary["gauges"]);
    assert!(run.summary["gauges"].as_array().unwrap().len() > 3);
    assert!(!home.at("run.unfinished").exists());
}

#[cfg(feature = "mpi")]
#[test]
fn ranks_write_the_same_frames() {
    let home = Home::with(&framed(60));
    let whole = home.run("whole", &[]);
    home.call(["scene.json", "--quiet", "--output", "ranks"]).ranks(3).end().succeeded();
    let ranks = home.results("ranks");
    same_frames(&home, &ranks, &whole, ["ranks", "whole"]);
    assert_eq!(ranks.bytes("histories.csv"), whole.bytes("histories.csv"));
    // from a checkpoint of three ranks on two
    let first = "ranks.checkpoints/checkpoint-000001.hdf5";
    home.call(["--restart", first, "--quiet", "--output", "again"]).ranks(2).end().succeeded();
    let mut again = home.results("again");
    again.files.retain(|name, _| !name.starts_with("fields") && name != Path::new("fields.vtkhdf"));
    let mut whole = whole;
    whole.files.retain(|name, _| !name.starts_with("fields") && name != Path::new("fields.vtkhdf"));
    crate::restarts::same(&again, &whole);
}

/// Frames of another scene are not replaced.
#[test]
fn the_frames_of_another_scene_stay() {
    let home = Home::with(&framed(1000));
    let stop = ["--quiet", "--output", "run", "--set", "time.wall_limit=1e-9"];
    home.write("other.json", &framed(1000).to_string());
    let call = |scene: &'static str| home.call([scene].into_iter().chain(stop)).end();
    assert_eq!(call("scene.json").status.code(), Some(4));
    std::fs::remove_dir_all(home.at("run.checkpoints")).unwrap();
    let before = crate::home::contents(&home.at("run.unfinished"));
    call("other.json").failed(&["run.unfinished", "scene.json"]);
    assert_eq!(crate::home::contents(&home.at("run.unfinished")), before);
    // the scene itself begins again
    assert_eq!(call("scene.json").status.code(), Some(4));
}
