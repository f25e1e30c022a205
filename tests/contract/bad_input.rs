//! Scenes that cannot run: a message of one line with the key, nothing written, an earlier result
//! unchanged; the same on several ranks.

use std::fs;

use serde_json::{Value, json};

use crate::home::{Contents, Home};
use crate::program::Ended;
#[cfg(feature = "mpi")]
use crate::program::Turn;
use crate::scenes::short;

/// An edit of the scene.
enum Edit {
    /// Sets a value at a JSON pointer; the key is created if its parent exists.
    Put(&'static str, Value),
    /// Removes a key.
    Remove(&'static str),
    /// Replaces some text of the file.
    Swap(&'static str, &'static str),
    /// Replaces the whole file.
    Text(String),
}

use Edit::{Put, Remove, Swap, Text};

impl Edit {
    fn apply(&self) -> String {
        let mut scene = short();
        let parent = |path: &'static str| path.rsplit_once('/').unwrap();
        match self {
            Text(text) => return text.clone(),
            Swap(from, to) => {
                let text = scene.to_string();
                assert!(text.contains(from), "{from} is not in {text}");
                return text.replacen(from, to, 1);
            }
            Put(path, value) => {
                let (parent, key) = parent(path);
                match scene.pointer_mut(parent).unwrap() {
                    Value::Array(entries) => entries[key.parse::<usize>().unwrap()] = value.clone(),
                    object => object[key] = value.clone(),
                }
            }
            Remove(path) => {
                let (parent, key) = parent(path);
                let object = scene.pointer_mut(parent).unwrap().as_object_mut().unwrap();
                assert!(object.remove(key).is_some(), "{path}");
            }
        }
        scene.to_string()
    }
}

/// Invalid scenes and the words of their message: path of the key, value, what is allowed.
fn bad() -> Vec<(Edit, &'static [&'static str])> {
    vec![
        (Put("/domain/cel_size", json!(1e-5)), &["domain.cel_size", "did you mean cell_size?"]),
        (Put("/metod", json!({})), &["metod", "did you mean method?"]),
        (Put("/bodies/0/colour", json!("red")), &["bodies.flyer.colour", "allowed"]),
        (Put("/materials/copper/eos/c_0", json!(1)), &["materials.copper.eos.c_0", "c0"]),
        (Put("/time/end", json!("soon")), &["time.end = \"soon\"", "a number"]),
        (Put("/time", json!([1])), &["time = [1]", "object"]),
        (Put("/bodies/0/velocity", json!(1000)), &["bodies.flyer.velocity = 1000", "array"]),
        (Put("/method/filter_heat", json!(1)), &["method.filter_heat = 1", "true or false"]),
        (Put("/method/shape", json!("cpdi_bspline")), &["method.shape", "cpdi_bspline_quadratic"]),
        (Put("/method/transfer", json!({"fmpm": 0})), &["method.transfer.fmpm = 0", "at least 1"]),
        (Put("/method/transfer", json!("flap")), &["method.transfer = \"flap\"", "flip"]),
        (Put("/materials/copper/eos/type", json!("mie")), &["materials.copper.eos.type", "mie_"]),
        (Remove("/time"), &["time", "missing"]),
        (Remove("/materials/copper/density"), &["materials.copper.density", "missing"]),
        (Remove("/bodies/1/box"), &["bodies.target.box", "missing"]),
        (Put("/materials/copper/density", json!(-1)), &["materials.copper.density = -1", "above"]),
        (Put("/domain/cell_size", json!(-1e-5)), &["domain.cell_size = -0.00001", "above 0"]),
        (Put("/time/end", json!(-1)), &["time.end = -1", "above 0"]),
        (Put("/artificial_viscosity/linear", json!(-0.1)), &["artificial_viscosity.linear = -0.1"]),
        (Swap("\"courant\":0.4", "\"courant\":NaN"), &["time.courant", "NaN", "finite number"]),
        (Swap("\"courant\":0.4", "\"courant\":1e999"), &["time.courant", "1e999", "1.7e308"]),
        (Swap("\"courant\":0.4", "\"courant\":null"), &["time.courant = null", "a number"]),
        (Swap("\"courant\":0.4", "\"courant\":0.4,\"courant\":1"), &["time", "courant", "twice"]),
        (Put("/materials/copper/eos/s", json!(0)), &["materials.copper.eos.s = 0", "above 0"]),
        (Put("/materials/copper/eos/s", json!(-1)), &["materials.copper.eos.s = -1", "above 0"]),
        (Put("/bodies/0/velocity/0", json!(2e5)), &["bodies.flyer.velocity", "0.95"]),
        (Put("/bodies/0/box/lower/0", json!(-0.1)), &["bodies.flyer.box.lower = [-0.1]", "-0.001"]),
        (Put("/bodies/1/box/upper/0", json!(0.1)), &["bodies.target.box.upper = [0.1]", "0.002"]),
        (Put("/bodies/0/box/upper/0", json!(1e-4)), &["bodies.target.box", "overlaps bodies.fly"]),
        (Put("/bodies", json!([])), &["bodies = []", "not empty"]),
        (Put("/bodies/0/box/lower/0", json!(-1e-6)), &["bodies.flyer.box", "no particle"]),
        (Put("/bodies/0/particles_per_cell/0", json!(0)), &["bodies.flyer.particles_per_cell[0]"]),
        (Put("/bodies/0/material", json!("coper")), &["bodies.flyer.material", "copper?"]),
        (Put("/time/courant", json!(1.01)), &["time.courant = 1.01", "at most 1"]),
        (Put("/time/courant", json!(0)), &["time.courant = 0", "above 0"]),
        (Put("/time/end", json!(0)), &["time.end = 0", "above 0"]),
        (
            Put("/output/profiles/times/0", json!(2e-8)),
            &["output.profiles.times[0] = 2e-8", "time.end = 1e-8"],
        ),
        (
            Put("/reference/flyer_impact/target", json!("tarjet")),
            &["reference.flyer_impact.target = \"tarjet\"", "did you mean target?"],
        ),
        (Put("/domain/lower", json!([-1e-3, 0])), &["domain.upper = [0.002]", "2"]),
        (Put("/bodies/0/velocity", json!([1, 2])), &["bodies.flyer.velocity = [1.0,2.0]", "1 num"]),
        (Put("/domain/patches", json!([2, 2])), &["domain.patches = [2,2]", "1 number"]),
        (Put("/domain/patches", json!([301])), &["domain.patches = [301]", "1 to 300"]),
        (
            Put("/bodies/0/particles_per_cell/0", json!(1_000_000_000)),
            &["50000000300 particles", "allowed", "particles_per_cell"],
        ),
        (Put("/domain/cell_size", json!(1e-12)), &["3000000000 cells", "allowed", "cell_size"]),
        (Text("[".repeat(100_000)), &["nested too deep"]),
        (Text("{\"a\":".repeat(100_000)), &["nested too deep"]),
        (Text(String::new()), &["scene.json: is empty"]),
        (Text(" \n".into()), &["scene.json: is empty"]),
        (Text("domain:\n  lower: 0\n".into()), &["scene.json", "line 1", "not JSON"]),
        (Text("{\"title\": \"a\"".into()), &["scene.json", "too early"]),
        (Text("[1, 2]".into()), &["scene.json", "[1,2]", "object"]),
        (Text(format!("{} trailing", short())), &["scene.json", "trailing"]),
    ]
}

/// A folder with an earlier result where the invalid scene would write its own.
fn home_with_result() -> Home {
    let home = Home::with(&short());
    home.run("output/scene", &[]);
    home
}

/// Asserts that a call has changed no file and has refused the scene.
#[track_caller]
fn refused(home: &Home, before: &Contents, out: &Ended, fragments: &[&str]) {
    out.failed(fragments);
    assert!(out.stderr.contains("scene.json"), "{}", out.stderr);
    assert_eq!(home.contents(), *before);
}

#[test]
fn a_bad_scene_is_refused() {
    let home = home_with_result();
    for (edit, fragments) in bad() {
        home.write("scene.json", &edit.apply());
        let before = home.contents();
        let out = home.call(["scene.json"]).end();
        refused(&home, &before, &out, fragments);
        assert_eq!(out.stderr.lines().count(), 1, "{}", out.stderr);
    }
}

#[test]
#[cfg(feature = "mpi")]
fn a_bad_scene_is_refused_by_two_ranks() {
    let all = bad();
    let cases = [
        "did you mean cell_size?",
        "time.courant = 1.01",
        "overlaps bodies.fly",
        "particles_per_cell",
        "nested too deep",
        "scene.json: is empty",
    ];
    let cases = cases.map(|wanted| {
        let (edit, fragments) = all.iter().find(|b| b.1.contains(&wanted)).unwrap();
        let home = home_with_result();
        home.write("scene.json", &edit.apply());
        (home.contents(), home, fragments)
    });
    // no rank computes, so all the calls are made at once
    let turn = Turn::of(2);
    let start = |home: &Home| home.call(["scene.json"]).ranks(2).within(&turn).start();
    let runs = cases.each_ref().map(|(_, home, _)| start(home));
    for (run, (before, home, fragments)) in runs.into_iter().zip(&cases) {
        refused(home, before, &run.end(), fragments);
    }
}

#[test]
fn paths_that_cannot_be_read_or_written() {
    let home = home_with_result();
    fs::create_dir(home.at("folder.json")).unwrap();
    fs::write(home.at("binary.json"), [0xff, 0xfe, 0, 1]).unwrap();
    std::os::unix::fs::symlink("loop.json", home.at("loop.json")).unwrap();
    let before = fs::read(home.at("output/scene/summary.json")).unwrap();
    for (args, fragments) in [
        (vec!["missing.json"], ["missing.json", "No such file"]),
        (vec!["scene.json/inside.json"], ["scene.json/inside.json", "Not a directory"]),
        (vec!["folder.json"], ["folder.json", "is a directory"]),
        (vec!["loop.json"], ["loop.json", "cannot be read"]),
        (vec!["binary.json"], ["binary.json", "not UTF-8"]),
        (vec!["/dev/zero"], ["/dev/zero", "no regular file"]),
        (vec!["scene.json", "--output", "scene.json/x"], ["scene.json", "not a folder"]),
        (vec!["scene.json", "--output", "/proc/1/x"], ["/proc", "cannot"]),
        (vec!["check", "missing.json"], ["missing.json", "No such file"]),
        (vec!["hugoniot", "missing.json"], ["missing.json", "No such file"]),
    ] {
        let out = home.call(args).end();
        out.failed(&fragments);
        assert_eq!(out.stderr.lines().count(), 1, "{}", out.stderr);
    }
    assert_eq!(fs::read(home.at("output/scene/summary.json")).unwrap(), before);
    assert_eq!(crate::home::names(&home.at("output")), ["scene"]);
}

#[test]
fn values_from_the_command_line_are_checked_alike() {
    let home = home_with_result();
    let before = home.contents();
    for (set, fragment) in [
        ("time.end=NaN", "time.end = \"NaN\""),
        ("time.end=-inf", "time.end = \"-inf\""),
        ("time.courant=1.5", "time.courant = 1.5"),
        ("output.profiles.times=[1]", "output.profiles.times[0] = 1"),
        ("reference.flyer_impact.flyer=nobody", "reference.flyer_impact.flyer = \"nobody\""),
    ] {
        home.call(["scene.json", "--set", set]).end().failed(&[fragment, "allowed"]);
        assert_eq!(home.contents(), before);
    }
}
