//! Files, text, keys and single numbers that are refused on reading.

use std::collections::BTreeSet;
use std::path::Path;

use flyer_mpm::input;
use flyer_mpm::input::parse;
use serde_json::{Value, json};

use super::{inputs, mentions, mentions_all, refused, refused_edit, refused_text, shipped, with};

#[test]
fn files_that_are_no_scene() {
    let folder = tempfile::tempdir().unwrap();
    let message = |path: &Path| input::read(path).unwrap_err().to_string();
    let missing = folder.path().join("missing.json");
    mentions(&message(&missing), &["missing.json", "cannot be read", "No such file"]);
    mentions(&message(folder.path()), &["is a directory"]);
    mentions(&message(&folder.path().join("a\nb.json")), &["a\\nb.json", "cannot be read"]);
    let long = folder.path().join("long.json");
    std::fs::File::create(&long).unwrap().set_len(input::LARGEST_FILE + 1).unwrap();
    mentions(&message(&long), &["long.json", "16777217 bytes", "at most 16777216 bytes"]);

    refused_text("", &["bad.json: is empty", "allowed"]);
    refused_text(" \n\t", &["is empty"]);
    refused_text("[1, 2]", &["the scene = [1,2]", "an object with the keys", "title"]);
    refused_text("42", &["the scene = 42"]);
    refused_text("{\"title\": ", &["line 1 column", "ends too early"]);
    refused_text("title: flyer", &["line 1 column", "title"]);
    refused_text("{} {}", &["trailing characters"]);
    refused_text(&"[".repeat(1_000_000), &["nested too deep", "127 levels"]);
    refused_text(&"{\"a\":".repeat(1_000_000), &["nested too deep"]);
    let error = parse(b"{\"title\": \"\xff\"}", "bad.json", &[]).unwrap_err().to_string();
    mentions(&error, &["bad.json", "not UTF-8 from byte 11"]);
}

/// Comments, trailing commas and the name of a schema change nothing, and faults keep their place.
#[test]
fn comments_trailing_commas_and_a_schema() {
    let shipped = std::fs::read_to_string(
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs/flyer.json"),
    )
    .unwrap();
    let plain = shipped.replacen("\"$schema\": \"schema/scene.schema.json\",", "", 1);
    assert!(!plain.contains("$schema"));
    let read = |text: &str| parse(text.as_bytes(), "flyer.json", &[]);
    let noted = plain.replacen('{', "{ // µ: the first\n \"$schema\": \"s.json\", /* and */", 1);
    let end = noted.rfind('}').unwrap();
    let noted = format!("{},\n}}", &noted[..end].trim_end());
    let value = |text: &str| serde_json::to_value(read(text).unwrap().scene).unwrap();
    assert_eq!(value(&noted), value(&plain));
    let error = read("{\n /* two\n lines */ \"title\" 1,\n}").unwrap_err().to_string();
    mentions(&error, &["line 3 column", "expected `:`"]);
    refused_text("{/* open", &["line 1 column"]);
}

/// A scene in other units is the same scene to the bit: a key with a dimension takes text with a unit.
#[test]
fn units_give_the_same_doubles() {
    let read = |text: &str| {
        let scene = parse(text.as_bytes(), "units.json", &[]).unwrap_or_else(|e| panic!("{e}"));
        serde_json::to_value(scene.scene).unwrap()
    };
    let si = r#"{
        "title": "plates", "domain": {"lower": [-0.001], "upper": [0.008], "cell_size": 1e-5},
        "time": {"end": 1e-6},
        "materials": {
            "copper": {"density": 8930.0, "eos": {"type": "mie_gruneisen", "c0": 3940.0, "s": 1.489,
                "gamma0": 1.96, "tension_cutoff": 1.2e9}},
            "aluminium": {"library": "aluminium_6061"}
        },
        "bodies": [
            {"name": "flyer", "material": "copper", "box": {"lower": [-0.0005], "upper": [0.0]},
                "velocity": [1000.0], "particles_per_cell": [2]},
            {"name": "target", "material": "aluminium", "box": {"lower": [0.0], "upper": [0.008]},
                "particles_per_cell": [2]}
        ],
        "boundary": {"x_upper": {"pressure": 1e5}},
        "output": {"profiles": {"times": [2e-7, 1e-6]}}
    }"#;
    let mut other = si.to_string();
    for (number, text) in [
        ("[-0.001]", r#"["-1 mm"]"#),
        ("[0.008]", r#"["8mm"]"#),
        ("\"cell_size\": 1e-5", r#""cell_size": "10 um""#),
        ("\"end\": 1e-6", r#""end": "1 us""#),
        ("8930.0", r#""8.93 g/cm3""#),
        ("3940.0", r#""3.94 km/s""#),
        ("1.2e9", r#""12 kbar""#),
        ("[-0.0005]", r#"["-0.5 mm"]"#),
        ("[1000.0]", r#"["1 km/s"]"#),
        ("\"pressure\": 1e5", r#""pressure": "0.1 MPa""#),
        ("[2e-7, 1e-6]", r#"["0.2 us", 1e-6]"#),
    ] {
        assert!(other.contains(number), "{number}");
        other = other.replacen(number, text, 1);
    }
    assert_eq!(read(&other), read(si));
    let refuse = |from: &str, to: &str| {
        let text = si.replacen(from, to, 1);
        parse(text.as_bytes(), "units.json", &[]).unwrap_err().to_string()
    };
    let error = refuse("\"end\": 1e-6", r#""end": "1 mm""#);
    mentions(&error, &["units.json: time.end = \"1 mm\"", "another dimension", "s"]);
    let error = refuse("8930.0", r#""8.93 lb/ft3""#);
    mentions(&error, &["materials.copper.density = \"8.93 lb/ft3\"", "unknown unit"]);
    let error = refuse("1.489", r#""1.489 m""#);
    mentions(&error, &["materials.copper.eos.s = \"1.489 m\"", "a number"]);
}

#[test]
fn numbers_that_are_none() {
    let bad = |end: &str| format!("{{\n  \"time\": {{\n    \"end\": {end}\n  }}\n}}");
    for (end, found) in [
        ("NaN", "NaN is not JSON; allowed: a finite number"),
        ("nan", "nan is not JSON"),
        ("-NaN", "-NaN is not JSON"),
        ("Infinity", "Infinity is not JSON"),
        ("-Infinity", "-Infinity is not JSON"),
        ("1e999", "1e999 is too large for a number; allowed: finite numbers"),
        ("-1e999", "-1e999 is too large"),
        (".5", ".5"),
    ] {
        refused_text(&bad(end), &["bad.json: line 3 column ", "at time.end", found]);
    }
    refused_text(&bad("0x10"), &["bad.json: line 3 column ", "at time: not JSON", "0x10"]);
    let mut checked = with("flyer.json", &[]).unwrap().scene;
    checked.bodies[0].velocity = Some(vec![f64::NAN]);
    let error = input::check(checked, "made").unwrap_err().to_string();
    mentions(&error, &["made: bodies.flyer.velocity[0] = null", "a number"]);
}

#[test]
fn a_key_that_stands_twice() {
    let text = "{\"time\": {\"end\": 1, \"end\": 2}}";
    refused_text(text, &["at time", "\"end\" stands twice", "allowed: once"]);
}

#[test]
fn unknown_keys_and_names() {
    let edit = |set: &str, fragments: &[&str]| refused("flyer.json", &[set], fragments);
    edit(
        "domain.cel_size=1",
        &["domain.cel_size = 1", "unknown key", "did you mean cell_size?", "lower, patches, upper"],
    );
    edit("comment=hello", &["flyer.json: comment = \"hello\"", "unknown key", "allowed: "]);
    edit("materials.copper.rho=1", &["materials.copper.rho = 1", "allowed: density, eos"]);
    edit("materials.copper.eos.c_0=1", &["materials.copper.eos.c_0", "did you mean c0?"]);
    edit(
        "materials.copper.eos.type=mie_gruneissen",
        &["materials.copper.eos.type = \"mie_gruneissen\"", "did you mean mie_gruneisen?"],
    );
    edit("materials.copper.eos.type=3", &["materials.copper.eos.type = 3", "ideal_gas"]);
    let printed = with("flyer.json", &["materials.copper.eos.type=ideal_gas"]).unwrap_err();
    mentions_all(
        &printed,
        &["materials.copper.eos.c0", "materials.copper.eos.s", "allowed: gamma"],
    );
    edit("materials.copper.eos={}", &["materials.copper.eos.type", "missing", "mie_gruneisen"]);
    edit(
        "method.shape=bspline_quadratik",
        &[
            "method.shape = \"bspline_quadratik\"",
            "did you mean \"bspline_quadratic\"?",
            "\"gimp\"",
        ],
    );
    edit(
        "method.transfer=fmpm",
        &["method.transfer = \"fmpm\"", "did you mean {\"fmpm\": a whole number"],
    );
    edit("method.transfer={\"fmpn\": 4}", &["method.transfer.fmpn = 4", "did you mean fmpm?"]);
    edit("method.transfer.xpic=2", &["method.transfer = {", "\"flip\""]);
    edit("method.transfer={}", &["method.transfer = {}", "\"flip\""]);
    edit("boundary.x_lower=open", &["boundary.x_lower = \"open\"", "\"outflow\""]);
    edit("boundary.z_lower=free", &["boundary.z_lower", "x_lower, x_upper, y_lower, y_upper"]);
    edit("reference={\"flyer\": 1}", &["reference.flyer", "flyer_impact", "riemann"]);
    edit(
        "reference.flyer_impact.speed=1",
        &["reference.flyer_impact.speed", "flyer, front, target"],
    );
    edit(
        "bodies.flyer.material=cooper",
        &["bodies.flyer.material = \"cooper\"", "did you mean copper?", "aluminium, copper"],
    );
    edit(
        "reference.flyer_impact.target=targer",
        &["reference.flyer_impact.target = \"targer\"", "did you mean target?", "flyer, target"],
    );
}

#[test]
fn wrong_types() {
    let edit = |set: &str, fragments: &[&str]| refused("flyer.json", &[set], fragments);
    edit("time.end=soon", &["time.end = \"soon\"", "a number above 0"]);
    edit("time=[]", &["time = []", "an object with the keys courant, end"]);
    edit("bodies={}", &["bodies = {}", "an array"]);
    edit("bodies=[]", &["bodies = []", "an array"]);
    edit("bodies=[1]", &["bodies[0] = 1", "an object with the keys"]);
    edit("domain.cell_size=true", &["domain.cell_size = true", "a number above 0, or an array"]);
    edit("domain.patches=[2.0]", &["domain.patches[0] = 2.0", "a whole number at least 1"]);
    edit("bodies.flyer.particles_per_cell=2", &["bodies.flyer.particles_per_cell = 2", "an array"]);
    edit("bodies.flyer.velocity=1000", &["bodies.flyer.velocity = 1000", "an array"]);
    edit("method.filter_heat=1", &["method.filter_heat = 1", "true or false"]);
    edit("method.transfer={\"fmpm\": 2.5}", &["method.transfer.fmpm = 2.5", "a whole number"]);
    edit("materials=[]", &["materials = []", "an object of names"]);
    edit("title=7", &["title = 7", "a string"]);
}

#[test]
fn missing_keys() {
    for (path, fragments) in [
        ("/title", ["title: missing key", "a string"]),
        ("/time/end", ["time.end: missing key", "a number above 0"]),
        ("/domain/cell_size", ["domain.cell_size: missing key", "a number above 0, or an array"]),
        ("/method/shape", ["method.shape: missing key", "\"cpdi\""]),
        ("/materials/copper/density", ["materials.copper.density: missing", "a number above 0"]),
        ("/materials/copper/eos/c0", ["materials.copper.eos.c0: missing", "a number above 0"]),
        ("/bodies/0/box", ["bodies.flyer.box: missing", "\"box\""]),
        ("/bodies/0/name", ["bodies[0].name: missing", "a string"]),
        ("/reference/flyer_impact/target", ["reference.flyer_impact.target: missing", "a string"]),
    ] {
        let (parent, key) = path.rsplit_once('/').unwrap();
        let remove = |scene: &mut Value| {
            scene.pointer_mut(parent).unwrap().as_object_mut().unwrap().remove(key).unwrap();
        };
        refused_edit(remove, &fragments);
    }
}

#[test]
fn numbers_out_of_bounds() {
    for (path, value, allowed) in [
        ("time.end", "0", "a number above 0"),
        ("time.end", "-1e-6", "a number above 0"),
        ("time.courant", "1.5", "a number above 0 and at most 1"),
        ("time.courant", "0", "a number above 0 and at most 1"),
        ("domain.cell_size", "-1e-5", "a number above 0"),
        ("domain.cell_size", "0", "a number above 0"),
        ("materials.copper.density", "-8930", "a number above 0"),
        ("materials.copper.eos.c0", "0", "a number above 0"),
        ("materials.copper.eos.s", "0", "a number above 0"),
        ("materials.copper.eos.s", "-1.489", "a number above 0"),
        ("materials.copper.eos.gamma0", "-1", "a number above 0"),
        ("artificial_viscosity.linear", "-0.1", "a number at least 0"),
        ("artificial_viscosity.quadratic", "-0.1", "a number at least 0"),
        ("method.transfer.fmpm", "0", "a whole number at least 1 and at most 50"),
        ("method.transfer.fmpm", "51", "at most 50"),
        ("method.transfer.fmpm", "-3", "at least 1"),
        ("method.pressure_relaxation.rate", "1.5", "above 0 and at most 1"),
        ("method.pressure_relaxation.interval", "0", "at least 1"),
        ("method.pressure_relaxation.interval", "5000000000", "a whole number"),
        ("method.edge_mask", "1.0", "at least 0 and below 1"),
        ("method.mass_lumping", "0", "above 0 and at most 0.5"),
        ("output.histories.interval", "0", "a number above 0"),
    ] {
        let set = format!("{path}={value}");
        let shown: Value = serde_json::from_str(value).unwrap();
        refused("flyer.json", &[&set], &[&format!("{path} = {shown}"), "allowed: ", allowed]);
    }
    let sets = ["method.transfer={\"flip_pic\": 1.1}"];
    refused("flyer.json", &sets, &["method.transfer.flip_pic = 1.1", "at least 0 and at most 1"]);
    let sets = ["materials.gas_left.eos.gamma=1"];
    refused("sod.json", &sets, &["materials.gas_left.eos.gamma = 1", "a number above 1"]);
    let sets = ["bodies.flyer.particles_per_cell=[0]"];
    refused(
        "flyer.json",
        &sets,
        &["bodies.flyer.particles_per_cell[0] = 0", "a whole number at least 1"],
    );
    let sets = ["materials.copper.density=1e307"];
    refused("flyer.json", &sets, &["materials.copper.density = 1e+307", "no finite stiffness"]);
}

#[test]
fn huge_files_get_a_short_verdict_soon() {
    let name = "n".repeat(5_000_000);
    refused_edit(|scene| scene[&name] = 1.into(), &["unknown key", "allowed: artificial"]);
    refused_edit(|scene| scene["bodies"][0]["material"] = name.clone().into(), &["no such"]);
    refused_edit(|scene| scene["bodies"][0]["name"] = name.clone().into(), &["at most 200"]);
    let bodies = |scene: &mut Value| {
        let body = scene["bodies"][0].clone();
        let many = (0..50_000).map(|i| {
            let mut body = body.clone();
            body["name"] = i.to_string().into();
            body
        });
        scene["bodies"] = many.collect();
    };
    let several = |edit: &dyn Fn(&mut Value), fragments: &[&str]| {
        let mut value: Value = serde_json::from_slice(&shipped("flyer.json")).unwrap();
        edit(&mut value);
        let error = parse(value.to_string().as_bytes(), "bad.json", &[]).unwrap_err();
        mentions_all(&error.to_string(), fragments);
    };
    several(&bodies, &["12 faults", "bodies.1.box", "overlaps bodies.0.box"]);
    let unknown = |scene: &mut Value| {
        bodies(scene);
        scene["bodies"][49_999]["colour"] = "red".into();
    };
    several(&unknown, &["13 faults", "bodies.49999.colour = \"red\"", "unknown key"]);
    let nobody = |scene: &mut Value| {
        bodies(scene);
        for i in 0..50_000 {
            let lower = f64::from(i) * 1.6e-7;
            scene["bodies"][i as usize]["box"] =
                json!({"lower": [lower], "upper": [lower + 1.5e-7]});
            scene["bodies"][i as usize]["particles_per_cell"] = json!([100]);
        }
    };
    several(
        &nobody,
        &["2 faults", "reference.flyer_impact.flyer", "no such body", "and 49980 more"],
    );
}

/// Pairs and ramps of pressures and velocities take units, and give the same doubles.
#[test]
fn units_of_time_functions_give_the_same_doubles() {
    let side = |text: &str| {
        let sets = [
            "reference=null".to_string(),
            "domain.lower=[-0.0005]".into(),
            format!("boundary={{\"x_lower\": {text}}}"),
        ];
        let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
        with("flyer.json", &sets)
            .map(|checked| serde_json::to_value(checked.scene.boundary).unwrap())
    };
    for (text, number) in [
        (
            r#"{"pressure": [["0 us", "0 GPa"], [1e-7, "12 GPa"], ["0.3 us", 1e5]]}"#,
            r#"{"pressure": [[0, 0], [1e-7, 12e9], [0.3e-6, 1e5]]}"#,
        ),
        (
            r#"{"pressure": {"from": "1 bar", "to": "0.1 Mbar", "start": "1 ns", "duration": "0.2 us"}}"#,
            r#"{"pressure": {"from": 1e5, "to": 1e10, "start": 1e-9, "duration": 0.2e-6}}"#,
        ),
        (
            r#"{"velocity": [["0 us", "1 km/s"], ["0.3 us", "0.5 mm/us"]]}"#,
            r#"{"velocity": [[0, 1000], [0.3e-6, 500]]}"#,
        ),
        (
            r#"{"velocity": {"to": "0.7 km/s", "duration": "1 ms"}}"#,
            r#"{"velocity": {"to": 700, "duration": 1e-3}}"#,
        ),
    ] {
        assert_eq!(side(text).unwrap(), side(number).unwrap(), "{text}");
    }
    for (text, fragments) in [
        (
            r#"{"pressure": [["0 us", "0 GPa"], ["1 Pa", "12 km/s"]]}"#,
            [
                "boundary.x_lower.pressure[1][0] = \"1 Pa\": has another dimension",
                "boundary.x_lower.pressure[1][1] = \"12 km/s\": has another dimension",
            ],
        ),
        (
            r#"{"velocity": {"to": "1 GPa", "duration": "3 mm"}}"#,
            [
                "boundary.x_lower.velocity.to = \"1 GPa\": has another dimension",
                "boundary.x_lower.velocity.duration = \"3 mm\": has another dimension",
            ],
        ),
    ] {
        mentions_all(&side(text).unwrap_err(), &fragments);
    }
    // the published schema takes them too
    let validator = jsonschema::validator_for(&input::schema()).unwrap();
    let mut scene: Value = serde_json::from_slice(&super::shipped("flyer.json")).unwrap();
    for (text, valid) in [
        (r#"{"pressure": [["0 us", "0 GPa"], [1e-7, "12 GPa"]]}"#, true),
        (r#"{"velocity": {"from": "1 m/s", "to": "0.7 km/s", "duration": "1 ms"}}"#, true),
        (r#"{"velocity": {"to": "fast", "duration": "1 ms"}}"#, false),
    ] {
        scene["boundary"] = json!({"x_lower": serde_json::from_str::<Value>(text).unwrap()});
        assert_eq!(validator.is_valid(&scene), valid, "{text}");
    }
}

/// Vertices of a polygon are no pairs of a time function.
#[test]
fn units_of_vertices_are_lengths() {
    let polygon = |vertices: &str| {
        let text = format!(
            r#"{{"title": "a", "domain": {{"lower": [0.0, 0.0], "upper": [0.01, 0.01], "cell_size": 1e-3}},
            "time": {{"end": 1e-6}}, "materials": {{"copper": {{"library": "copper"}}}},
            "bodies": [{{"name": "b", "material": "copper", "particles_per_cell": [2, 2],
                         "polygon": {{"vertices": {vertices}}}}}]}}"#
        );
        parse(text.as_bytes(), "a.json", &[]).unwrap().bodies[0].upper.clone()
    };
    let text = r#"[["0 mm", "0 mm"], ["8 mm", 0], [0, "6 mm"]]"#;
    assert_eq!(polygon(text), polygon("[[0, 0], [8e-3, 0], [0, 6e-3]]"));
}

/// Units of the keys of scenes.
const UNITS: [&str; 17] = [
    "m", "s", "m/s", "Pa", "kg/m3", "K", "J/kg", "J/(kg K)", "W/(m K)", "1/s", "m/s2", "1/Pa",
    "Pa s", "J/m3", "Pa/K", "1/m", "m3/kg",
];

/// Numbers of a scene with the paths of their keys, without the names and numbers of members.
fn numbers(value: &Value, pointer: &str, key: &str, found: &mut Vec<(String, String)>) {
    match value {
        Value::Number(_) => found.push((pointer.to_string(), key.to_string())),
        Value::Array(all) => all.iter().enumerate().for_each(|(k, entry)| {
            numbers(entry, &format!("{pointer}/{k}"), key, found);
        }),
        Value::Object(all) => all.iter().for_each(|(name, entry)| {
            let key = match key {
                "materials" => format!("{key}.NAME"),
                "" => name.clone(),
                _ => format!("{key}.{name}"),
            };
            numbers(entry, &format!("{pointer}/{name}"), &key, found);
        }),
        _ => {}
    }
}

/// Every number of the shipped scenes takes a unit, and then the scene is the same; the keys that
/// take none have no dimension.
#[test]
fn every_key_with_a_dimension_takes_units() {
    let mut seen = BTreeSet::new();
    let mut plain = BTreeSet::new();
    for file in inputs() {
        let scene: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
        let read = |scene: &Value| {
            let checked = parse(scene.to_string().as_bytes(), "units.json", &[]).ok()?;
            Some(serde_json::to_value(checked.scene).unwrap())
        };
        let Some(same) = read(&scene) else { continue };
        let mut found = Vec::new();
        numbers(&scene, "", "", &mut found);
        for (pointer, key) in found {
            if !seen.insert(key.clone()) {
                continue;
            }
            let takes = |unit: &&str| {
                let mut scene = scene.clone();
                let number = scene.pointer_mut(&pointer).unwrap();
                *number = json!(format!("{number} {unit}"));
                read(&scene).is_some_and(|read| {
                    assert_eq!(read, same, "{pointer}");
                    true
                })
            };
            if !UNITS.iter().any(takes) {
                plain.insert(key);
            }
        }
    }
    assert!(seen.len() > 90, "{seen:?}");
    let listed: BTreeSet<String> = PLAIN.iter().map(|key| key.to_string()).collect();
    assert_eq!(plain, listed);
}

/// Keys of the shipped scenes without a dimension.
const PLAIN: [&str; 36] = [
    "artificial_viscosity.expansion",
    "artificial_viscosity.growth.max",
    "artificial_viscosity.growth.rate",
    "artificial_viscosity.linear",
    "artificial_viscosity.quadratic",
    "bodies.intersection.half_plane.normal",
    "bodies.particles_per_cell",
    "bodies.rotation.angle",
    "bodies.velocity_field.vortex.amplitude",
    "body_force.vortex.amplitude",
    "boundary.y_lower.friction",
    "domain.patches",
    "format",
    "heat_mixing.coefficient",
    "materials.NAME.eos.burn.plane.normal",
    "materials.NAME.eos.exponent",
    "materials.NAME.eos.gamma",
    "materials.NAME.eos.gamma0",
    "materials.NAME.eos.poissons_ratio",
    "materials.NAME.eos.s",
    "materials.NAME.eos.solid.gamma0",
    "materials.NAME.eos.solid.s",
    "materials.NAME.strength.c",
    "materials.NAME.strength.n",
    "materials.NAME.strength.softening.m",
    "materials.NAME.thermal.taylor_quinney",
    "method.domain_limit",
    "method.edge_mask",
    "method.mass_lumping",
    "method.pressure_relaxation.interval",
    "method.pressure_relaxation.rate",
    "method.transfer.fmpm",
    "method.volume_relaxation",
    "reference.flyer_impact.front.angle",
    "reference.riemann.front.angle",
    "time.courant",
];
