//! Invalid files, for every file that a scene or the command line may name: a message of one line
//! and exit code 2, at once.

use std::fs;
use std::os::unix::net::UnixListener;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::home::Home;
use crate::program::signal;
use crate::scenes::short;

/// Invalid files, and the words of their message.
const BAD: [(&str, &[&str]); 10] = [
    ("fifo", &["no regular file", "FIFO"]),
    ("/dev/zero", &["no regular file", "device"]),
    ("/dev/null", &["no regular file", "device"]),
    ("/dev/random", &["no regular file", "device"]),
    ("folder", &["is a directory"]),
    ("socket", &["no regular file", "socket"]),
    ("huge", &["1099511627776 bytes", "at most"]),
    ("empty", &[]),
    ("scene.json/inside", &["Not a directory"]),
    ("missing", &["No such file"]),
];

/// A folder with every kind of invalid file.
fn home() -> Home {
    let home = Home::with(&short());
    let made = std::process::Command::new("mkfifo").arg(home.at("fifo")).status().unwrap();
    assert!(made.success());
    fs::create_dir(home.at("folder")).unwrap();
    drop(UnixListener::bind(home.at("socket")).unwrap());
    fs::File::create(home.at("huge")).unwrap().set_len(1 << 40).unwrap();
    fs::write(home.at("empty"), "").unwrap();
    // HDF5 is recognised by its name
    for name in ["fifo", "huge", "empty"] {
        std::os::unix::fs::symlink(name, home.at(&format!("{name}.h5"))).unwrap();
    }
    home
}

/// The scene with the key at a pointer set to a file name.
fn naming(pointer: &str, name: &str) -> Value {
    let mut scene = short();
    match pointer {
        "positions" => {
            let body = scene["bodies"][0].as_object_mut().unwrap();
            body.remove("particles_per_cell");
            body.insert(pointer.into(), json!(name));
        }
        "table" => {
            scene["materials"]["copper"]["eos"] = json!({"type": "tabular", "table": name});
        }
        "solid table" => {
            scene["materials"]["copper"]["eos"] = json!({
                "type": "p_alpha",
                "solid": {"type": "tabular", "table": name},
                "solid_density": 9000.0,
                "elastic_pressure": 1e8,
                "full_compaction_pressure": 1e9,
            });
        }
        "material" => scene["materials"]["copper"] = json!({"file": name}),
        "velocity" => scene["boundary"] = json!({"x_lower": {"velocity": name}}),
        "pressure" => scene["boundary"] = json!({"x_upper": {"pressure": name}}),
        _ => panic!("{pointer}"),
    }
    scene
}

/// Asserts one line, exit code 2, within a second and some tolerance for a busy machine.
#[track_caller]
fn refused(home: &Home, args: &[&str], words: &[&str]) {
    let since = Instant::now();
    let out = home.call(args.iter().copied()).end();
    assert!(since.elapsed() < Duration::from_secs(8), "{args:?}: {:?}", since.elapsed());
    assert_eq!(out.status.code(), Some(2), "{args:?}: {}", out.stderr);
    out.failed(words);
    assert_eq!(out.stderr.lines().count(), 1, "{args:?}: {}", out.stderr);
}

#[test]
fn files_that_a_scene_names() {
    let home = home();
    for key in ["positions", "table", "solid table", "material", "velocity", "pressure"] {
        for (name, words) in BAD {
            home.write("naming.json", &naming(key, name).to_string());
            refused(&home, &["check", "naming.json"], words);
        }
        home.write("naming.json", &naming(key, "fifo").to_string());
        for command in [&["naming.json"][..], &["hugoniot", "naming.json"]] {
            refused(&home, command, &["fifo: is no regular file"]);
        }
    }
    for name in ["fifo.h5", "huge.h5", "empty.h5"] {
        home.write("naming.json", &naming("table", name).to_string());
        refused(&home, &["naming.json"], &[name]);
    }
}

#[test]
fn files_that_the_command_line_names() {
    let home = home();
    home.run("run", &[]);
    for (name, words) in BAD {
        for args in [
            &[name][..],
            &["check", name],
            &["hugoniot", name],
            &["material", name, "copper"],
            &["perf", "predict", name],
            &["perf", "calibrate", name],
            &["plan", name, "--quantity", "l1", "--error", "1%"],
        ] {
            let words = if name == "folder" { &["is a directory"][..] } else { words };
            refused(&home, args, words);
        }
        refused(&home, &["study", name], words);
        refused(&home, &["perf", "predict", "scene.json", "--machine", name], words);
        // a folder may contain checkpoints
        let words = match name {
            "folder" => &["has no checkpoint"][..],
            "huge" => &["does not begin as a checkpoint"],
            _ => words,
        };
        refused(&home, &["--restart", name], words);
    }
    for name in ["fifo", "/dev/zero", "/dev/null", "huge", "empty"] {
        refused(&home, &["compare", "run", name], &[name]);
        refused(&home, &["scene.json", "--output", name], &["is not a folder"]);
    }
    let study = json!({
        "title": "t", "scene": "fifo",
        "sweep": [{"key": "time.courant", "values": [0.4]}], "repeats": 1,
    });
    home.write("study.json", &study.to_string());
    refused(&home, &["study", "study.json"], &["fifo", "no regular file"]);
    for name in ["fifo", "/dev/full", "folder"] {
        let plan = ["plan", "scene.json", "--quantity", "l1", "--error", "1%", "--output", name];
        refused(&home, &plan, &[name, "allowed: a regular file"]);
        refused(
            &home,
            &["perf", "calibrate", "--output", name],
            &[name, "allowed: a regular file"],
        );
        let trace = ["scene.json", "--quiet", "--trace", name];
        refused(&home, &trace, &[name, "allowed: a regular file"]);
    }
    home.write("study.json", &study.to_string().replace("fifo", "scene.json"));
    for name in ["fifo", "/dev/full"] {
        refused(&home, &["study", "study.json", "--output", name], &[name]);
        refused(&home, &["hugoniot", "scene.json", "--output", name], &[name]);
        refused(&home, &["material", "scene.json", "copper", "--output", name], &[name]);
    }
    let below = ["perf", "calibrate", "--output", "scene.json/x"];
    refused(&home, &below, &["scene.json/x: cannot be written", "not a directory"]);
}

/// A run whose summary or profile is not a file cannot be compared.
#[test]
fn files_of_results() {
    let home = home();
    let run = home.run("run", &[]);
    let profile = run.summary["profiles"][0]["file"].as_str().unwrap().to_string();
    for file in ["summary.json", &profile] {
        let path = home.at(&format!("run/{file}"));
        let good = fs::read(&path).unwrap();
        for (name, words) in BAD.iter().filter(|(name, _)| name.len() < 8 && *name != "missing") {
            fs::remove_file(&path).unwrap();
            std::os::unix::fs::symlink(home.path().join(name), &path).unwrap();
            refused(&home, &["compare", "run", "run"], words);
        }
        fs::remove_file(&path).unwrap();
        fs::write(&path, good).unwrap();
    }
    assert!(home.call(["compare", "run", "run"]).end().status.success());
}

/// A table whose declared size exceeds its contents is rejected before memory is allocated for it.
#[test]
fn a_table_that_claims_too_much() {
    let home = home();
    for large in ["density", "specific_internal_energy", "pressure"] {
        let file = hdf5::File::create(home.at("t.h5")).unwrap();
        for name in ["density", "specific_internal_energy"] {
            let long = if name == large { 1 << 40 } else { 2 };
            file.new_dataset::<f64>().chunk(2).shape(long).create(name).unwrap();
        }
        let long = if large == "pressure" { 1 << 40 } else { 2 };
        file.new_dataset::<f64>().chunk((2, 2)).shape((long, long)).create("pressure").unwrap();
        drop(file);
        home.write("naming.json", &naming("table", "t.h5").to_string());
        refused(&home, &["check", "naming.json"], &["t.h5", large, "allowed: at most 4194304"]);
        fs::remove_file(home.at("t.h5")).unwrap();
    }
}

/// A signal ends a program that reads files: here a study with long runs.
#[test]
fn a_signal_ends_a_study() {
    let home = home();
    let mut scene = short();
    scene["domain"]["cell_size"] = json!(2e-7);
    scene["time"]["end"] = json!(1e-6);
    home.write("long.json", &scene.to_string());
    let study = json!({
        "title": "t", "scene": "long.json",
        "sweep": [{"key": "time.courant", "values": [0.4]}], "repeats": 1,
    });
    home.write("study.json", &study.to_string());
    let run = home.call(["study", "study.json", "--quiet"]).start();
    std::thread::sleep(Duration::from_millis(300));
    signal("-TERM", run.id());
    let since = Instant::now();
    assert!(!run.end().status.success());
    assert!(since.elapsed() < Duration::from_secs(5));
    // its run does not go on alone
    let works_here = |process: &fs::DirEntry| {
        fs::read_link(process.path().join("cwd")).is_ok_and(|folder| home.at(".") == folder)
    };
    assert!(!fs::read_dir("/proc").unwrap().flatten().any(|process| works_here(&process)));
}

/// A file of the wrong kind is identified in the message.
#[test]
fn files_of_another_kind() {
    let home = home();
    home.run("run", &["--set", "output.checkpoint={\"every_steps\":1,\"keep\":1}"]);
    refused(
        &home,
        &["--restart", "scene.json"],
        &["scene.json: is JSON text such as a scene", "flyer-mpm scene.json without --restart"],
    );
    let checkpoints = crate::home::checkpoints(&home.at("run.checkpoints"));
    let file = format!("run.checkpoints/{}", checkpoints[0]);
    for args in [&[&file[..]][..], &["check", &file], &["hugoniot", &file]] {
        refused(&home, args, &["is a checkpoint", "--restart"]);
    }
}

#[test]
fn a_mistyped_command_is_reported_the_nearest() {
    let home = home();
    for (typed, meant) in [
        ("hugonoit", "hugoniot"),
        ("Chekc", "check"),
        ("stduy", "study"),
        ("predcit", "perf predict"),
        ("compar", "compare"),
        ("plna", "plan"),
        ("calibrat", "perf calibrate"),
        ("shema", "schema"),
        ("materail", "material"),
    ] {
        let meant = format!("{typed}: no such scene or command; did you mean {meant}?");
        refused(&home, &[typed, "scene.json"], &[&meant]);
        refused(&home, &[typed], &[&meant]);
    }
    // an argument with the name of an existing file is a scene
    fs::write(home.at("plna"), short().to_string()).unwrap();
    assert_eq!(home.call(["plna", "--quiet", "--output", "o"]).end().succeeded(), "");
}
