//! The commands beside a run: schema, check, hugoniot, compare.

use std::fs;

use serde_json::Value;

use crate::home::{Home, contents, names};
use crate::pictures::has_pictures;
use crate::scenes::{FLYER, short, whole};

#[test]
fn the_schema_is_json_that_the_scene_fits() {
    let home = Home::new();
    let text = home.call(["schema"]).end().succeeded();
    let schema: Value = serde_json::from_str(&text).unwrap();
    let known = schema["properties"].as_object().unwrap();
    for key in ["domain", "time", "method", "materials", "bodies", "output", "reference"] {
        assert!(known.contains_key(key), "{key}");
    }
    let validator = jsonschema::validator_for(&schema).unwrap();
    assert!(validator.is_valid(&whole()));
    let mut wrong = whole();
    wrong["time"]["courant"] = 1.5.into();
    assert!(!validator.is_valid(&wrong));
    assert!(names(home.path()).is_empty());
}

#[test]
fn check_tells_what_a_run_takes_and_makes_no_file() {
    let home = Home::with(&whole());
    let before = home.contents();
    let text = home.call(["check", "scene.json", "--set", "time.end=2e-7"]).end().succeeded();
    let value = |name: &str| {
        let line = text.lines().find(|l| l.trim_start().starts_with(name));
        let line = line.unwrap_or_else(|| panic!("no {name} in: {text}"));
        line.trim_start()[name.len()..].trim().to_string()
    };
    assert_eq!((value("particles").as_str(), value("cells").as_str()), ("400", "300"));
    assert!(value("memory").contains('B'), "{text}");
    let dt: f64 = value("first time step").strip_suffix(" s").unwrap().parse().unwrap();
    assert!((4e-10..6e-10).contains(&dt), "{dt}");
    let steps: f64 = value("steps").strip_prefix("about ").unwrap().parse().unwrap();
    assert!((steps * dt / 2e-7 - 1.0).abs() < 0.01, "{steps} steps of {dt} s");
    for effect in ["shape", "transfer", "artificial viscosity", "boundary", "reference"] {
        assert!(!value(effect).is_empty());
    }
    assert_eq!(home.contents(), before);
    // a scene that a run would refuse
    let bad = home.call(["check", "scene.json", "--set", "time.end=0"]).end();
    bad.failed(&["scene.json", "time.end = 0"]);
    let large = "bodies.flyer.particles_per_cell=[1000000000]";
    home.call(["check", "scene.json", "--set", large]).end().failed(&["particles", "memory"]);
}

#[test]
fn material_prints_and_draws_an_equation_of_state() {
    let home = Home::new();
    home.write("flyer.json", FLYER);
    let text =
        home.call(["material", "flyer.json", "copper", "--output", "sheet"]).end().succeeded();
    // Us = c0 + s up at 1 km/s, and the limit of compression
    for word in ["mie_gruneisen", "5429.00", "48.48", "isentrope from rest", "limit 1/s", "tension"]
    {
        assert!(text.contains(word), "no {word} in {text}");
    }
    has_pictures(&contents(&home.at("sheet")), &["hugoniot", "isentropes"]);
    let unknown = home.call(["material", "flyer.json", "iron"]).end();
    unknown.failed(&["no material iron", "allowed: aluminium, copper"]);
}

#[test]
fn hugoniot_prints_the_chain_and_draws_it() {
    let home = Home::new();
    home.write("flyer.json", FLYER);
    let text = home.call(["hugoniot", "flyer.json", "--output", "chain"]).end().succeeded();
    // the document's states as far as it prints them, speeds, times and places of its waves
    for digits in [
        "690.93", "12.144", "381.87", "266.027", "4.254", "150.18", "105.01", "1.616", "6311.16",
        "4400.19", "0.113631", "0.227263",
    ] {
        assert!(text.split_whitespace().any(|w| w.starts_with(digits)), "no {digits} in: {text}");
    }
    has_pictures(
        &contents(&home.at("chain")),
        &["figure_1", "figure_2", "figure_3", "x_t_diagram"],
    );
    assert_eq!(names(home.path()), ["chain", "flyer.json"]);
    // its default folder is not that of a run
    home.call(["hugoniot", "flyer.json"]).end().succeeded();
    assert!(!home.at("output/flyer").exists());
    let no_impact = ["hugoniot", "flyer.json", "--set", "reference=null"];
    home.call(no_impact).end().failed(&["flyer_impact"]);
}

#[test]
fn a_softer_flyer_separates() {
    let home = Home::new();
    home.write("flyer.json", FLYER);
    let sets = ["bodies.flyer.material=aluminium", "bodies.target.material=copper"];
    let args = ["hugoniot", "flyer.json", "--set", sets[0], "--set", sets[1]];
    assert!(home.call(args).end().succeeded().contains("separate"));
}

#[test]
fn compare_tells_same_from_different() {
    let home = Home::with(&short());
    home.run("a", &[]);
    home.run("b", &["--threads", "2", "--set", "domain.patches=[7]"]);
    let same = home.call(["compare", "a", "b"]).end();
    assert!(same.succeeded().contains("same"));

    home.run("c", &["--set", "bodies.flyer.velocity=[1001]"]);
    let before = home.contents();
    let out = home.call(["compare", "a", "c"]).end();
    assert_eq!(out.status.code(), Some(1), "{}", out.stderr);
    for word in ["L1", "L2", "velocity", "particle 1 from the left", "different"] {
        assert!(out.stdout.contains(word), "no {word} in: {}", out.stdout);
    }
    assert_eq!(home.contents(), before);
    home.call(["compare", "a", "nowhere"]).end().failed(&["nowhere"]);
}

#[test]
fn compare_finds_one_changed_bit() {
    let home = Home::with(&short());
    let run = home.run("a", &[]);
    home.run("b", &[]);
    let file = run.summary["profiles"][0]["file"].as_str().unwrap();
    let text = run.profile(0);
    let row: Vec<&str> = text.lines().nth(150).unwrap().split(',').collect();
    let density: f64 = row[3].parse().unwrap();
    let changed = format!("{:?}", density.next_up());
    let edited: Vec<String> = text
        .lines()
        .enumerate()
        .map(|(i, line)| if i == 150 { line.replacen(row[3], &changed, 1) } else { line.into() })
        .collect();
    fs::write(home.at("b").join(file), edited.join("\n") + "\n").unwrap();
    let out = home.call(["compare", "a", "b"]).end();
    assert_eq!(out.status.code(), Some(1));
    assert!(out.stdout.contains("particle 150 from the left"), "{}", out.stdout);
    assert!(out.stdout.contains(&format!("density: {}, {changed}", row[3])), "{}", out.stdout);
}
