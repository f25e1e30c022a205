//! All faults of a scene in one reply, in the order of its file, and no consequences of one another.

use flyer_mpm::input::parse;
use serde_json::{Value, json};

use super::{refused_edit, shipped};

/// The lines of the reply to `flyer.json` with some edits.
#[track_caller]
fn reply(edit: impl FnOnce(&mut Value)) -> Vec<String> {
    let mut value: Value = serde_json::from_slice(&shipped("flyer.json")).unwrap();
    edit(&mut value);
    lines(&value.to_string())
}

#[track_caller]
fn lines(text: &str) -> Vec<String> {
    let error = parse(text.as_bytes(), "bad.json", &[]).expect_err("the scene passed");
    error.to_string().lines().map(str::to_string).collect()
}

fn remove(scene: &mut Value, parent: &str, key: &str) {
    let object = scene.pointer_mut(parent).unwrap().as_object_mut().unwrap();
    object.remove(key).unwrap();
}

/// Each line names its path, in this order.
#[track_caller]
fn holds(lines: &[String], paths: &[&str]) {
    assert_eq!(lines[0], format!("bad.json: {} faults", paths.len()), "{lines:#?}");
    assert_eq!(lines.len(), paths.len() + 1, "{lines:#?}");
    for (line, path) in lines[1..].iter().zip(paths) {
        assert!(line.starts_with(&format!("  {path}")), "{path}: {lines:#?}");
        assert!(line.contains("; allowed: ") || line.contains("did you mean"), "{line}");
    }
}

#[test]
fn six_missing_keys_are_reported_at_once() {
    let lines = reply(|scene| {
        remove(scene, "", "title");
        remove(scene, "/domain", "upper");
        remove(scene, "/time", "end");
        remove(scene, "/materials/copper/eos", "c0");
        remove(scene, "/bodies/0", "material");
        remove(scene, "/bodies/1/box", "upper");
    });
    holds(
        &lines,
        &[
            "bodies.flyer.material: missing key",
            "bodies.target.box.upper: missing key",
            "domain.upper: missing key",
            "materials.copper.eos.c0: missing key",
            "time.end: missing key",
            "title: missing key",
        ],
    );
}

#[test]
fn units_and_names_are_reported_with_them() {
    let lines = reply(|scene| {
        scene["materials"]["copper"]["density"] = json!("8.93 GPa");
        scene["time"]["end"] = json!("3 parsec");
        scene["bodies"][1]["material"] = json!("coper");
        scene["materials"]["copper"]["eos"]["type"] = json!("mie_grueneisen");
    });
    holds(
        &lines,
        &[
            "bodies.target.material = \"coper\": no such material; did you mean copper?",
            "materials.copper.density = \"8.93 GPa\": has another dimension",
            "materials.copper.eos.type = \"mie_grueneisen\": unknown type",
            "time.end = \"3 parsec\": unknown unit",
        ],
    );
}

#[test]
fn text_that_is_no_quantity_is_told_so() {
    let end = |text: &str, fragments: &[&str]| {
        refused_edit(|scene| scene["time"]["end"] = json!(text), fragments);
    };
    end("0,2 us", &["time.end = \"0,2 us\"", "a decimal comma; allowed: a decimal point"]);
    end("us", &["a number above 0, or text of a number and a unit"]);
    // no bound that every number has
    let density = |scene: &mut Value| scene["materials"]["copper"]["density"] = json!(-1.0);
    refused_edit(density, &["allowed: a number above 0"]);
    let mut scene: Value = serde_json::from_slice(&shipped("flyer.json")).unwrap();
    density(&mut scene);
    assert!(!lines(&scene.to_string())[0].contains("at most"));
}

#[test]
fn the_order_is_that_of_the_file_and_not_of_the_alphabet() {
    let text = r#"{
        // the last letter first
        "title": 3,
        "materials": {"zinc": {"library": "zinc"}, "gas": {"density": "1 m"}},
        "domain": {"lower": [0.0], "uper": [1.0], "cell_size": "x"},
        "bodies": [],
        "time": {"courant": 0.3}
    }"#;
    holds(
        &lines(text),
        &[
            "title = 3",
            "materials.zinc.library = \"zinc\": no such material",
            "materials.gas.density = \"1 m\"",
            "materials.gas.eos: missing key",
            "domain.uper = [1.0]: unknown key; did you mean upper?",
            "domain.cell_size = \"x\"",
            "bodies = []",
            "time.end: missing key",
        ],
    );
}

#[test]
fn a_consequence_of_a_fault_is_not_reported() {
    // a misspelt key is not missing as well
    refused_edit(
        |scene| {
            let end = scene["time"]["end"].take();
            scene["time"] = json!({"ende": end, "courant": 0.3});
        },
        &["time.ende", "did you mean end?"],
    );
    // nor are the keys of an unknown library material, or of an unknown preset
    refused_edit(
        |s| s["materials"]["copper"] = json!({"library": "coper"}),
        &["did you mean copper"],
    );
    refused_edit(|s| s["method"] = json!({"preset": "defalt"}), &["method.preset", "default"]);
    // a body cannot be judged with a material that has a fault of its own
    refused_edit(
        |scene| {
            scene["materials"]["copper"]["eos"]["c0"] = json!(1e-100);
            scene["materials"]["copper"]["eos"]["tension_cutoff"] = json!(1e3);
            scene["bodies"][0]["pressure"] = json!(-1e9);
        },
        &["materials.copper.density", "no finite stiffness"],
    );
}

#[test]
fn checks_that_do_not_depend_on_each_other_are_all_reported() {
    let lines = reply(|scene| {
        scene["bodies"][0]["velocity"] = json!([1.0, 2.0]);
        scene["bodies"][1]["box"]["upper"] = json!([1.0]);
        scene["boundary"] = json!({"y_lower": "wall"});
        scene["output"]["profiles"]["times"] = json!([1.0]);
    });
    holds(
        &lines,
        &[
            "bodies.flyer.velocity = [1.0,2.0]",
            "bodies.target.box.upper = [1.0]: outside of the domain",
            "boundary.y_lower = \"wall\": a side along y",
            "output.profiles.times[0] = 1.0: beyond time.end",
        ],
    );
}

#[test]
fn faults_of_keys_and_of_physics_are_reported_together() {
    let lines = reply(|scene| {
        remove(scene, "/domain", "cell_size");
        remove(scene, "/time", "end");
        scene["materials"]["copper"]["eos"]["c0"] = json!("fast");
        scene["materials"]["aluminium"]["density"] = json!(-2700.0);
        scene["bodies"][0]["velocty"] = json!([1000.0]);
        scene["bodies"][0]["colour"] = json!("red");
        scene["bodies"][0]["box"]["lower"] = json!([-1.0]);
        scene["bodies"][1]["velocity"] = json!([1.0, 2.0]);
        scene["reference"]["flyer_impact"]["target"] = json!("targt");
        scene["boundary"] = json!({"y_lower": "wall"});
        scene["output"]["checkpoint"] = json!({"at_times": [2.0, 1.0]});
        scene["artificial_viscosity"] =
            json!({"linear": 0.1, "quadratic": 2.0, "growth": {"rate": 1.0, "max": 1.0}});
    });
    holds(
        &lines,
        &[
            "artificial_viscosity.growth.max = 1.0: leaves no room",
            "bodies.flyer.box.lower = [-1.0]: outside of the domain",
            "bodies.flyer.colour = \"red\": unknown key",
            "bodies.flyer.velocty = [1000.0]: unknown key; did you mean velocity?",
            "bodies.target.velocity = [1.0,2.0]: 2 numbers",
            "boundary.y_lower = \"wall\": a side along y",
            "domain.cell_size: missing key",
            "materials.aluminium.density = -2700.0: not allowed",
            "materials.copper.eos.c0 = \"fast\": not allowed",
            "reference.flyer_impact.target = \"targt\": no such body; did you mean target?",
            "time.end: missing key",
        ],
    );
}

#[test]
fn parts_that_are_known_are_checked_against_each_other() {
    // bodies that cannot approach each other, beside a key that says nothing about them
    let lines = reply(|scene| {
        scene["title"] = json!(3);
        scene["bodies"][0]["velocity"] = json!([-1000.0]);
        scene["output"]["histories"] = json!({"tracers": [
            {"name": "a", "body": "flyer", "at": [1.0]}, {"name": "b", "body": "target", "at": [-1.0]}]});
    });
    holds(
        &lines,
        &[
            "bodies.flyer.velocity = [-1000.0]: does not approach",
            "output.histories.tracers.a.at = [1.0]: outside of its body",
            "output.histories.tracers.b.at = [-1.0]: outside of its body",
            "title = 3",
        ],
    );
    // each body that overlaps another one, and each impact beyond the limit
    let lines = reply(|scene| {
        scene["bodies"][0]["box"]["upper"] = json!([1e-4]);
        let mut third = scene["bodies"][1].clone();
        third["name"] = json!("third");
        scene["bodies"].as_array_mut().unwrap().push(third);
    });
    assert_eq!(lines.len(), 3, "{lines:#?}");
    assert!(lines[1..].iter().all(|line| line.contains("overlaps")), "{lines:#?}");
    // the place of a body without a material
    let lines = reply(|scene| {
        remove(scene, "/bodies/0", "material");
        scene["bodies"][0]["box"]["lower"] = json!([-1.0]);
    });
    holds(&lines, &["bodies.flyer.box.lower = [-1.0]: outside", "bodies.flyer.material: missing"]);
}

#[test]
fn the_rest_of_a_broken_scene_gives_no_faults_of_its_own() {
    // the region of the flyer, its material and the reference depend on what cannot be read
    for (edit, path) in [
        ("/bodies/0/box/upper", "bodies.flyer.box.upper: missing key"),
        ("/bodies/0/material", "bodies.flyer.material: missing key"),
        ("/materials/copper/eos/type", "materials.copper.eos.type: missing key"),
        ("/domain/lower", "domain.lower: missing key"),
        ("/bodies", "bodies: missing key"),
        ("/materials", "materials: missing key"),
        ("/time", "time: missing key"),
    ] {
        let (parent, key) = edit.rsplit_once('/').unwrap();
        let lines = reply(|scene| remove(scene, parent, key));
        assert_eq!(lines.len(), 1, "{lines:#?}");
        assert!(lines[0].contains(path), "{lines:#?}");
    }
}

#[test]
fn of_many_faults_the_first_twenty_are_reported() {
    let lines = reply(|scene| {
        let keys = (0..23).map(|k| (format!("zz{k:02}"), json!(1)));
        scene.as_object_mut().unwrap().extend(keys);
    });
    assert_eq!((lines.len(), &lines[0][..]), (22, "bad.json: 23 faults"));
    assert!(lines[20].contains("zz19") && lines[21] == "  ... and 3 more", "{lines:#?}");
}
