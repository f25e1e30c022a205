//! Other commands: schema, check, hugoniot, compare.

use std::fs;

use serde_json::{Value, json};

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
    // a scene that a run would reject
    let bad = home.call(["check", "scene.json", "--set", "time.end=0"]).end();
    bad.failed(&["scene.json", "time.end = 0"]);
    let large = "bodies.flyer.particles_per_cell=[1000000000]";
    let text = home.call(["check", "scene.json", "--set", large]).end().succeeded();
    assert!(text.contains("MB that this machine has left"), "{text}");
    home.call(["scene.json", "--set", large]).end().failed(&["particles", "memory"]);
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
    // the states as printed by Burghardt (2010); speeds, times and positions of the waves
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
    // its default folder differs from that of a run
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

/// The flyer scene with other materials (density, c0, s, gamma0), speed [m/s] and thicknesses [m].
fn plates(materials: [[f64; 4]; 2], speed: f64, thickness: [f64; 2]) -> Value {
    let mut scene = whole();
    let material = |[density, c0, s, gamma0]: [f64; 4]| {
        json!({"density": density,
            "eos": {"type": "mie_gruneisen", "c0": c0, "s": s, "gamma0": gamma0}})
    };
    scene["materials"] = json!({"a": material(materials[0]), "b": material(materials[1])});
    scene["domain"] = json!({"lower": [-4e-3], "upper": [1e-2], "cell_size": 1e-5});
    let boxes = [[-thickness[0], 0.0], [0.0, thickness[1]]];
    for (k, (name, [lower, upper])) in ["a", "b"].into_iter().zip(boxes).enumerate() {
        scene["bodies"][k]["material"] = json!(name);
        scene["bodies"][k]["box"] = json!({"lower": [lower], "upper": [upper]});
    }
    scene["bodies"][0]["velocity"] = json!([speed]);
    scene["time"]["end"] = json!(1.5e-6);
    scene["output"] = json!({"profiles": {"times": [1e-7]}, "pictures": false, "hdf5": false});
    scene
}

const LEAD: [f64; 4] = [11350.0, 2051.0, 1.46, 2.77];
const MERCURY: [f64; 4] = [13540.0, 1490.0, 2.047, 1.96];
const PMMA: [f64; 4] = [1186.0, 2598.0, 1.516, 0.97];
const STEEL: [f64; 4] = [7896.0, 4569.0, 1.49, 2.17];
const TUNGSTEN: [f64; 4] = [19224.0, 4029.0, 1.237, 1.54];
const TANTALUM: [f64; 4] = [16654.0, 3414.0, 1.201, 1.6];

#[test]
fn fast_impacts_that_part_have_their_chain() {
    for (materials, speed) in
        [([LEAD, MERCURY], 3552.4), ([PMMA, STEEL], 3896.7), ([STEEL, TUNGSTEN], 6100.0)]
    {
        let home = Home::with(&plates(materials, speed, [0.35e-3, 4e-3]));
        let text = home.call(["hugoniot", "scene.json", "--output", "chain"]).end().succeeded();
        assert!(text.contains("separate"), "{text}");
    }
}

/// The text of the x-t diagram of a scene, and the output of the command.
fn waves(scene: &Value) -> [String; 2] {
    let home = Home::with(scene);
    let text = home.call(["hugoniot", "scene.json", "--output", "chain"]).end().succeeded();
    [fs::read_to_string(home.at("chain/x_t_diagram.svg")).unwrap(), text]
}

#[test]
fn the_x_t_diagram_goes_on_past_the_targets_rear() {
    let mut scene = plates([TUNGSTEN, TANTALUM], 1000.0, [1e-3, 3e-3]);
    let [svg, text] = waves(&scene);
    assert!(text.contains("reaches the target's rear at 0.733421 us"), "{text}");
    assert!(!text.contains("exact lines end") && !svg.contains("exact lines end"));
    assert!(svg.lines().any(|line| line.trim() == "1.4"), "the axis ends with the scene");
    // with a third plate behind it the rear is not a free surface
    scene["bodies"].as_array_mut().unwrap().push(json!({
        "name": "third", "material": "a", "box": {"lower": [3e-3], "upper": [4e-3]},
        "velocity": [0.0], "particles_per_cell": [2]
    }));
    let [svg, text] = waves(&scene);
    assert!(text.contains("exact lines end at 0.733421 us"), "{text}");
    assert!(text.contains("not a free surface"), "{text}");
    assert!(svg.contains("exact lines end at 0.7334 µs"));
    assert!(svg.lines().any(|line| line.trim() == "1.4"), "the axis ends with the scene");
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
