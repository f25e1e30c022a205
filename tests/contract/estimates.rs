//! Error estimate of a run, and a plan, without an exact solution.

use serde_json::{Value, json};

use crate::home::Home;
use crate::scenes::whole;

/// The small scene without its reference, with an error estimate.
fn scene(estimate: Value) -> Value {
    let mut scene = whole();
    scene.as_object_mut().unwrap().remove("reference");
    scene["error_estimate"] = estimate;
    scene["output"] = json!({"pictures": false, "hdf5": false});
    scene["time"]["end"] = json!(1.5e-7);
    scene
}

#[test]
fn an_estimate_needs_no_reference_and_is_the_same_with_one() {
    let asked = json!({"arrivals": [5e-4]});
    let estimate =
        |scene: &Value| Home::with(scene).run("run", &[]).summary["error_estimate"].clone();
    let without = estimate(&scene(asked.clone()));
    let mut with = scene(asked);
    with["reference"] = whole()["reference"].clone();
    // the default number of particles per cell is the same as the number in this scene
    for body in with["bodies"].as_array_mut().unwrap() {
        assert_eq!(body["particles_per_cell"], json!([2]));
        body.as_object_mut().unwrap().remove("particles_per_cell");
    }
    let with = estimate(&with);
    assert_eq!(with["basis"], "calibrated", "{with}");
    let quantities = ["/profiles/0/l1", "/profiles/0/plateau_pressure", "/arrivals/0/time"];
    for path in quantities {
        for key in ["value", "half_width", "evidence"] {
            let path = format!("{path}/{key}");
            assert!(without.pointer(&path).is_some_and(|v| !v.is_null()), "{path}: {without}");
            assert_eq!(without.pointer(&path), with.pointer(&path), "{path}");
        }
    }
    // an impact within the range for which the error model was fitted
    assert_eq!((&without["body"], &without["basis"]), (&json!("target"), &json!("calibrated")));
    assert_eq!(without["outside"], json!([]));
}

/// Coarse runs on one worker have wider patches than on several.
#[test]
fn an_estimate_is_the_same_on_two_threads() {
    let mut scene = scene(json!({"arrivals": [5e-4]}));
    scene["domain"]["cell_size"] = json!(2.5e-6);
    let home = Home::with(&scene);
    let [one, two] = ["1", "2"].map(|threads| {
        home.run(threads, &["--threads", threads]).summary["error_estimate"].clone()
    });
    for key in ["profiles", "arrivals", "companions"] {
        assert_eq!(one[key], two[key], "{key}");
    }
    assert!(one["arrivals"][0]["time"]["half_width"].as_f64().unwrap() > 0.0, "{one}");
}

#[test]
fn what_was_not_fitted_is_named_and_makes_a_guess() {
    let mut plain = scene(json!({"arrivals": [5e-4], "body": "target"}));
    let strength = json!({"type": "von_mises", "shear_modulus": 2.76e10, "yield_stress": 2.9e8});
    let third = json!({"name": "third", "material": "copper", "particles_per_cell": [2],
                       "box": {"lower": [1.5e-3], "upper": [1.7e-3]}});
    let mut bodies = plain["bodies"].clone();
    bodies.as_array_mut().unwrap().push(third);
    plain["output"]["profiles"] = json!({"times": [1e-7, 1.5e-7]});
    for (path, value, word) in [
        ("/bodies", bodies, "bodies: 3"),
        ("/bodies/0/velocity", json!([7000.0]), "bodies.flyer.velocity = 7000"),
        ("/bodies/0/box/lower", json!([-4e-5]), "cells in body flyer = 4"),
        ("/bodies/0/box", json!({"lower": [-6e-4], "upper": [-1e-4]}), "a gap"),
        ("/materials/aluminium/strength", strength, "materials.aluminium.strength"),
        ("/materials/aluminium/density", json!(800.0), "materials.aluminium.density = 800"),
        ("/artificial_viscosity/linear", json!(0.3), "artificial_viscosity.linear = 0.3"),
        ("/boundary", json!({"x_upper": "wall"}), "boundary.x_upper"),
        ("/error_estimate/arrivals", json!([1e-6]), "error_estimate.arrivals[0]"),
        // half of the time in which the release returns to the interface
        ("/title", json!("as it is"), "output.profiles.times[0] over 2.16"),
    ] {
        let mut scene = plain.clone();
        let (parent, key) = path.rsplit_once('/').unwrap();
        scene.pointer_mut(parent).unwrap()[key] = value;
        let home = Home::with(&scene);
        let text = one_line(&home.call(["scene.json"]).end().succeeded());
        let estimate = home.results("output/scene").summary["error_estimate"].clone();
        assert_eq!(estimate["basis"], "guess", "{word}: {estimate}");
        let outside = estimate["outside"].to_string();
        assert!(outside.contains(word), "no {word} in {outside}");
        assert!(text.contains("are guesses") && text.contains(word), "{text}");
        // the later profile of the last case is within the fitted range
        let late = if path == "/title" { "calibrated" } else { "guess" };
        let late = if path == "/error_estimate/arrivals" { "calibrated" } else { late };
        assert_eq!(estimate["profiles"][1]["basis"], late, "{word}");
    }
}

#[test]
fn no_plateau_is_reported_where_none_is_left() {
    for (thickness, reason) in
        [(6e-5, "the plateau is 4 cells long"), (4e-5, "has caught the shock at 0.1394 us")]
    {
        let mut thin = scene(json!({"body": "target"}));
        thin["bodies"][0]["box"]["lower"] = json!([-thickness]);
        let home = Home::with(&thin);
        let text = one_line(&home.call(["scene.json"]).end().succeeded());
        assert!(text.contains("no plateau;") && text.contains(reason), "{text}");
        let estimate = home.results("output/scene").summary["error_estimate"].clone();
        assert_eq!(estimate["profiles"][0]["plateau_pressure"], Value::Null, "{estimate}");
        assert!(estimate["notes"].to_string().contains(reason), "{estimate}");
        let plan = ["plan", "scene.json", "--quantity", "plateau_pressure", "--error", "1%"];
        if thickness < 5e-5 {
            home.call(plan).end().failed(&["no plateau pressure at 0.1500 us", reason]);
        }
    }
}

#[test]
fn a_body_has_to_be_named_where_none_stands_out() {
    let mut moving = scene(json!({}));
    moving["bodies"][1]["velocity"] = json!([-100.0]);
    let home = Home::with(&moving);
    let words = ["error_estimate.body: missing key", "allowed: flyer, target"];
    home.call(["scene.json"]).end().failed(&words);
    let plan = ["plan", "scene.json", "--quantity", "l1", "--error", "20%"];
    home.call(plan).end().failed(&words);
    for body in ["flyer", "target"] {
        let set = format!("error_estimate.body={body}");
        let estimate = home.run("run", &["--set", &set]).summary["error_estimate"].clone();
        assert_eq!(estimate["body"], body);
        assert!(estimate["profiles"][0]["l1"]["half_width"].as_f64().unwrap() > 0.0, "{estimate}");
    }
}

#[test]
fn nothing_is_estimated_that_is_not_there() {
    // gas at rest under pressure: no shock, no wave
    let gas = json!({
        "title": "gas at rest",
        "domain": {"lower": [0.0], "upper": [1e-3], "cell_size": 1e-5},
        "time": {"end": 2e-7},
        "method": {"shape": "cpdi", "transfer": "flip"},
        "materials": {"gas": {"density": 1.0, "eos": {"type": "ideal_gas", "gamma": 1.4}}},
        "bodies": [{"name": "gas", "material": "gas", "pressure": 1e5, "particles_per_cell": [2],
                    "box": {"lower": [0.0], "upper": [1e-3]}}],
        "boundary": {"x_lower": "wall", "x_upper": "wall"},
        "error_estimate": {"arrivals": [5e-4]},
        "output": {"pictures": false, "hdf5": false},
    });
    let home = Home::with(&gas);
    let text = one_line(&home.call(["scene.json"]).end().succeeded());
    assert!(text.contains("no plateau") && text.contains("nothing has arrived"), "{text}");
    // a plate at rest has no pressure and hence no error of it
    let mut plate = scene(json!({"arrivals": [5e-4]}));
    plate["bodies"][0]["velocity"] = json!([0.0]);
    plate["error_estimate"]["body"] = json!("target");
    let estimate = Home::with(&plate).run("run", &[]).summary["error_estimate"].clone();
    assert_eq!(estimate["profiles"][0]["plateau_pressure"], Value::Null, "{estimate}");
    assert_eq!(estimate["profiles"][0]["l1"]["half_width"], Value::Null, "{estimate}");
    assert_eq!(estimate["arrivals"][0]["time"], Value::Null, "{estimate}");
}

#[test]
fn a_pressure_at_the_start_is_no_arrival() {
    // the wave adds a tenth of the initial pressure
    let mut scene = scene(json!({"arrivals": [3e-4], "body": "target"}));
    scene["materials"]["gas"] =
        json!({"density": 50.0, "eos": {"type": "ideal_gas", "gamma": 1.4}});
    for (body, velocity) in [(0, 200.0), (1, 0.0)] {
        scene["bodies"][body]["material"] = json!("gas");
        scene["bodies"][body]["pressure"] = json!(1e8);
        scene["bodies"][body]["velocity"] = json!([velocity]);
    }
    scene["time"]["end"] = json!(3.0e-7);
    // walls confine the gas
    scene["domain"]["lower"] = json!([-5e-4]);
    scene["bodies"][1]["box"]["upper"] = json!([2e-3]);
    scene["boundary"] = json!({"x_lower": "wall", "x_upper": "wall"});
    let estimate = Home::with(&scene).run("run", &[]).summary["error_estimate"].clone();
    let time = estimate["arrivals"][0]["time"]["value"].as_f64().unwrap();
    // a sound wave takes 0.18 us
    assert!((1.4e-7..2e-7).contains(&time), "{estimate}");
    let plateau = estimate["profiles"][0]["plateau_pressure"]["value"].as_f64().unwrap();
    assert!((1.05e8..1.3e8).contains(&plateau), "{estimate}");
}

#[test]
fn a_plan_needs_no_reference_and_marks_a_guess() {
    let home = Home::with(&scene(json!({})));
    let plan = |more: &[&str]| {
        let all =
            ["plan", "scene.json", "--quantity", "l1", "--error", "10%", "--output", "p.json"];
        home.call(all.into_iter().chain(more.to_vec())).end().succeeded()
    };
    let planned = || -> Value {
        let text = std::fs::read_to_string(home.at("p.json")).unwrap();
        serde_json::from_str::<Value>(&text).unwrap()["output"]["plan"].clone()
    };
    assert!(!plan(&[]).contains("guess"));
    assert_eq!(planned()["guess"], false);
    let text = plan(&["--set", "boundary={\"x_upper\": \"wall\"}"]);
    assert!(text.contains("guess ") && text.contains("boundary.x_upper"), "{text}");
    assert_eq!(planned()["guess"], true);
    let text = one_line(&home.call(["p.json"]).end().succeeded());
    let line = text.split(" plan ").nth(1).unwrap();
    assert!(line.contains("(guess)") && line.contains("by its own bound"), "{line}");
}

/// CoarseRun runs keep a wall in its place, at either end.
#[test]
fn a_mirrored_scene_has_the_mirrored_estimate() {
    // a number of cells that neither two nor four divide
    let estimate = |upper: bool| {
        let mut scene = scene(json!({"arrivals": [if upper { 7.3e-4 } else { 3e-4 }]}));
        let aluminium = scene["materials"]["aluminium"].clone();
        scene["materials"] = json!({"aluminium": aluminium});
        scene["domain"] = json!({"lower": [0.0], "upper": [1.03e-3], "cell_size": 1e-5});
        scene["time"]["end"] = json!(1e-7);
        let [lower, velocity] = if upper { [2e-4, 500.0] } else { [0.0, -500.0] };
        scene["bodies"] = json!([{
            "name": "plate", "material": "aluminium", "particles_per_cell": [2],
            "box": {"lower": [lower], "upper": [lower + 8.3e-4]}, "velocity": [velocity],
        }]);
        let side = if upper { "x_upper" } else { "x_lower" };
        scene["boundary"] = json!({side: "wall"});
        Home::with(&scene).run("run", &[]).summary["error_estimate"].clone()
    };
    let both = [estimate(false), estimate(true)];
    for path in ["/arrivals/0/time", "/profiles/0/l1", "/profiles/0/plateau_pressure"] {
        let [a, b] =
            both.each_ref().map(|estimate| estimate.pointer(path).unwrap()["half_width"].as_f64());
        let (a, b) = (a.unwrap(), b.unwrap());
        assert!((a / b - 1.0).abs() < 1e-3, "{path}: {a:e} {b:e}");
    }
}

#[test]
fn a_body_with_positions_of_its_own_has_companions() {
    let mut scene = scene(json!({"arrivals": [5e-4], "body": "target"}));
    let target = &mut scene["bodies"][1];
    target.as_object_mut().unwrap().remove("particles_per_cell");
    let at = |k: usize| 5e-6 * (k as f64 + 0.4 + 0.2 * (k % 2) as f64);
    target["positions"] = json!((0..300).map(|k| [at(k)]).collect::<Vec<_>>());
    let estimate = Home::with(&scene).run("run", &[]).summary["error_estimate"].clone();
    assert_eq!(estimate["companions"].as_array().unwrap().len(), 2, "{estimate}");
    assert!(estimate["arrivals"][0]["time"]["half_width"].as_f64().unwrap() < 5e-9, "{estimate}");
}

/// A report without the ends of its lines, which may be within a fact.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A small copper plate that strikes an aluminium plate in a plane, with gauges of all kinds.
fn in_a_plane(estimate: Value) -> Value {
    let mut scene = whole();
    scene.as_object_mut().unwrap().remove("reference");
    scene["domain"] = json!({"lower": [-4e-4, 0.0], "upper": [6e-4, 4e-4], "cell_size": 2e-5});
    scene["boundary"] = json!({"y_lower": "symmetry"});
    scene["time"]["end"] = json!(8e-8);
    for (body, lower, upper) in [(0, [-3e-4, 0.0], [0.0, 2e-4]), (1, [0.0, 0.0], [4e-4, 3e-4])] {
        scene["bodies"][body]["box"] = json!({"lower": lower, "upper": upper});
        scene["bodies"][body]["particles_per_cell"] = json!([2, 2]);
        scene["bodies"][body]["velocity"] = json!([if body == 0 { 1000.0 } else { 0.0 }, 0.0]);
    }
    scene["output"] = json!({
        "profiles": {"times": [4e-8, 8e-8]}, "pictures": false, "hdf5": false,
        "histories": {
            "interval": 1e-9,
            "stations": [{"name": "station", "at": [1e-4, 5e-5]}],
            "tracers": [{"name": "tracer", "body": "target", "at": [2e-4, 5e-5]}],
            "planes": [{"name": "section", "at": 1.5e-4}],
        },
    });
    scene["error_estimate"] = estimate;
    scene
}

/// Half-widths of a list of estimates, by the names of their keys.
fn half_widths(list: &Value, keys: [&str; 2], value: &str) -> Vec<(String, f64)> {
    let all = list.as_array().unwrap_or_else(|| panic!("{list}"));
    let one = |entry: &Value| {
        assert_eq!(entry["basis"], "guess", "{entry}");
        let name = keys.map(|key| entry[key].to_string()).join(" ");
        (name, entry[value]["half_width"].as_f64().unwrap_or_else(|| panic!("{entry}")))
    };
    all.iter().map(one).collect()
}

#[test]
fn fields_and_gauges_are_estimated_in_a_plane() {
    let scene = in_a_plane(json!({"fields": ["pressure", "velocity"]}));
    let home = Home::with(&scene);
    let run = home.run("one", &[]);
    let estimate = run.summary["error_estimate"].clone();
    assert_eq!(estimate["companions"], json!([8e-5, 4e-5]), "{estimate}");
    let fields = half_widths(&estimate["fields"], ["quantity", "time"], "l1");
    assert_eq!(fields.len(), 4, "{fields:?}");
    let histories = half_widths(&estimate["histories"], ["gauge", "quantity"], "l1");
    let names: Vec<&str> = histories.iter().map(|(name, _)| name.as_str()).collect();
    let expected = [
        r#""tracer" "velocity""#,
        r#""tracer" "pressure""#,
        r#""station" "velocity""#,
        r#""station" "pressure""#,
        r#""section" "momentum""#,
    ];
    assert_eq!(names, expected);
    let readings = half_widths(&estimate["readings"], ["gauge", "quantity"], "value");
    for name in [r#""tracer" "arrival""#, r#""station" "peak velocity""#, r#""section" "impulse""#]
    {
        assert!(readings.iter().any(|reading| reading.0 == name), "{name}: {readings:?}");
    }
    for (name, half_width) in fields.iter().chain(&histories) {
        assert!((0.005..1.0).contains(half_width), "{name}: {half_width}");
    }
    // the same on two threads
    let two = home.run("two", &["--threads", "2"]).summary["error_estimate"].clone();
    assert_same(&estimate, &two);
}

fn assert_same(estimate: &Value, other: &Value) {
    for key in ["fields", "histories", "readings"] {
        assert!(!estimate[key].as_array().unwrap().is_empty(), "{key}: {estimate}");
        assert_eq!(estimate[key], other[key], "{key}");
    }
}

#[test]
fn estimates_about_an_axis_are_the_same_on_two_ranks_and_after_a_restart() {
    let mut scene = in_a_plane(json!({"fields": ["pressure", "velocity"]}));
    // the bodies stand on the axis and strike each other along it
    scene["domain"] = json!({"lower": [0.0, -4e-4], "upper": [4e-4, 6e-4], "cell_size": 2e-5,
                             "geometry": "axisymmetric"});
    scene["boundary"] = json!({"x_lower": "symmetry"});
    for (body, lower, upper) in [(0, [0.0, -3e-4], [2e-4, 0.0]), (1, [0.0, 0.0], [3e-4, 4e-4])] {
        scene["bodies"][body]["box"] = json!({"lower": lower, "upper": upper});
        scene["bodies"][body]["velocity"] = json!([0.0, if body == 0 { 1000.0 } else { 0.0 }]);
    }
    scene["output"]["histories"] = json!({"stations": [{"name": "station", "at": [5e-5, 1e-4]}]});
    scene["output"]["checkpoint"] = json!({"at_times": [5e-8]});
    let home = Home::with(&scene);
    let alone = home.run("alone", &[]).summary["error_estimate"].clone();
    let on_two = ["scene.json", "--quiet", "--output", "two"];
    home.call(on_two).ranks(2).end().succeeded();
    assert_same(&alone, &home.results("two").summary["error_estimate"]);
    let restart = ["--restart", "alone.checkpoints", "--quiet", "--output", "again"];
    home.call(restart).ranks(2).end().succeeded();
    assert_same(&alone, &home.results("again").summary["error_estimate"]);
}

#[test]
fn profiles_have_the_differences_of_estimated_fields_and_nothing_else_changes() {
    let (plain, estimated) = (in_a_plane(Value::Null), in_a_plane(json!({"fields": ["velocity"]})));
    let [plain, estimated] = [plain, estimated].map(|scene| {
        let results = Home::with(&scene).run("run", &[]);
        (results.summary.clone(), results.profile(1).to_string())
    });
    assert!(plain.0.get("error_estimate").is_none());
    let digests = |summary: &Value| summary["profiles"].clone();
    assert_eq!(digests(&plain.0), digests(&estimated.0));
    assert_eq!(plain.1.lines().count(), estimated.1.lines().count());
    let added = ",velocity_difference_x,velocity_difference_y";
    let mut largest: f64 = 0.0;
    for (a, b) in plain.1.lines().zip(estimated.1.lines()) {
        let (own, differences) = match a.starts_with("x,") {
            true => (b.strip_suffix(added).unwrap(), ""),
            false => {
                let (rest, last) = b.rsplit_once(',').unwrap();
                let (rest, first) = rest.rsplit_once(',').unwrap();
                largest = largest.max(first.parse::<f64>().unwrap().abs());
                (rest, last)
            }
        };
        assert_eq!(a, own);
        assert!(differences.is_empty() || differences.parse::<f64>().is_ok(), "{b}");
    }
    assert!((10.0..1000.0).contains(&largest), "{largest}");
}

#[test]
fn an_estimate_in_a_plane_has_no_body() {
    for (estimate, word) in [
        (json!({"body": "target"}), "error_estimate.body"),
        (json!({"arrivals": [1e-4]}), "error_estimate.arrivals"),
        (json!({"fields": ["presure"]}), "error_estimate.fields[0]"),
        // profiles have no such column; the values depend on the size of the particles
        (json!({"fields": ["strain"]}), "error_estimate.fields[0]"),
        (json!({"fields": ["volume"]}), "error_estimate.fields[0]"),
        (json!({"fields": ["pressure", "pressure"]}), "error_estimate.fields[1]"),
    ] {
        let home = Home::with(&in_a_plane(estimate));
        home.call(["check", "scene.json"]).end().failed(&[word, "allowed"]);
    }
}

#[test]
fn a_line_has_fields_and_gauges_beside_its_body() {
    let mut line = scene(json!({"fields": ["pressure"]}));
    line["output"]["histories"] = json!({"velocimeters": [
        {"name": "rear", "body": "target", "at": [1.5e-3]},
    ]});
    // until after the shock has reached the rear
    line["time"]["end"] = json!(3e-7);
    let estimate = Home::with(&line).run("run", &[]).summary["error_estimate"].clone();
    assert_eq!(estimate["body"], "target");
    assert_eq!(estimate["profiles"].as_array().unwrap().len(), 1, "{estimate}");
    assert_eq!(half_widths(&estimate["fields"], ["quantity", "time"], "l1").len(), 1);
    let readings = half_widths(&estimate["readings"], ["gauge", "quantity"], "value");
    let free_surface = readings.iter().find(|r| r.0 == r#""rear" "plateau velocity""#);
    assert!(free_surface.is_some_and(|r| (1e-3..50.0).contains(&r.1)), "{readings:?}");
    // a face that meets another body has no estimate of its peak pressure
    assert!(readings.iter().all(|r| r.0 != r#""target_lower" "peak pressure""#), "{readings:?}");
    assert!(readings.iter().any(|r| r.0 == r#""target_lower" "peak velocity""#), "{readings:?}");
}

#[test]
fn the_gauges_of_a_reference_are_estimated() {
    let mut flyer = whole();
    flyer["domain"]["cell_size"] = json!(5e-6);
    flyer["error_estimate"] = json!({});
    flyer["output"] = json!({"pictures": false, "hdf5": false, "histories": {}});
    // until after the shock has reached the rear
    flyer["time"]["end"] = json!(3e-7);
    let summary = Home::with(&flyer).run("run", &[]).summary;
    let estimate = &summary["error_estimate"];
    let readings = half_widths(&estimate["readings"], ["gauge", "quantity"], "value");
    let named = r#""free_surface" "plateau velocity""#;
    let (_, half_width) = readings.iter().find(|r| r.0 == named).unwrap_or_else(|| {
        panic!("{readings:?}");
    });
    // within the interval of the estimate
    let measured = summary["measured"].as_array().unwrap();
    let exact = measured
        .iter()
        .find_map(|m| (m["name"] == "free-surface velocity").then(|| m["exact"].as_f64()));
    let value = summary["gauges"].as_array().unwrap().iter().find_map(|g| {
        let is = g["gauge"] == "free_surface" && g["quantity"] == "plateau velocity";
        is.then(|| g["value"].as_f64().unwrap())
    });
    let (exact, value) = (exact.flatten().unwrap(), value.unwrap());
    assert!((value - exact).abs() <= *half_width && *half_width < 0.002 * exact, "{value} {exact}");
}

#[test]
fn gauges_and_fields_need_no_body() {
    let mut both = scene(json!({}));
    // two bodies at rest: none is struck
    both["bodies"][0]["velocity"] = json!([0.0]);
    both["bodies"][1]["velocity"] = json!([0.0]);
    let home = Home::with(&both);
    home.call(["check", "scene.json"]).end().failed(&["error_estimate.body: missing key"]);
    both["error_estimate"] = json!({"fields": ["velocity"]});
    let home = Home::with(&both);
    home.call(["check", "scene.json"]).end().succeeded();
    let plan = ["plan", "scene.json", "--quantity", "l1", "--error", "1%"];
    home.call(plan).end().failed(&["error_estimate.body: missing key", "flyer, target"]);
}

#[test]
fn failed_material_widens_the_estimates() {
    let mut scene = in_a_plane(json!({"fields": ["velocity"]}));
    scene["output"]["profiles"]["times"] = json!([8e-8]);
    let l1 = |scene: &Value| {
        let estimate = Home::with(scene).run("run", &[]).summary["error_estimate"].clone();
        let l1 = &estimate["fields"][0]["l1"];
        l1["half_width"].as_f64().unwrap() / l1["evidence"]["difference_2"].as_f64().unwrap()
    };
    let whole = l1(&scene);
    for material in ["aluminium", "copper"] {
        scene["materials"][material]["failure"] = json!({"type": "tension_limit", "stress": 1e6});
    }
    assert!(l1(&scene) > 4.0 * whole, "{} {whole}", l1(&scene));
}
