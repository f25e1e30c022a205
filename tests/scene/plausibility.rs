//! Warnings about values that are allowed but rarely meant: each with a scene that sets it off, and
//! one beside it that does not.

use crate::with;

#[track_caller]
fn warned(name: &str, wrong: &[&str], right: &[&str], fragment: &str) {
    let warnings = |sets: &[&str]| with(name, sets).unwrap().warnings;
    let all = warnings(wrong);
    assert!(all.iter().any(|w| w.contains(fragment)), "no `{fragment}` in {all:?}");
    let all = warnings(right);
    assert!(!all.iter().any(|w| w.contains(fragment)), "{all:?}");
}

#[test]
fn densities_in_other_units() {
    let set = |density: &str| format!("materials.copper.density={density}");
    warned(
        "flyer.json",
        &[&set("8.93")],
        &[&set("20")],
        "materials.copper.density = 8.93: no solid",
    );
    warned("flyer.json", &[&set("3.1e4")], &[&set("2.9e4")], "the unit is kg/m3");
    // a gas may be thin: air at room temperature
    let air = ["materials.gas_left.density=1.2", "bodies.left.pressure=1e5", "time.end=5e-4"];
    let warnings =
        with("sod.json", &[&air[..], &["output.profiles.times=[5e-4]"]].concat()).unwrap();
    assert!(!warnings.warnings.iter().any(|w| w.contains("kg/m3")), "{:?}", warnings.warnings);
}

#[test]
fn bodies_of_few_cells() {
    let cells = |size: &str| format!("domain.cell_size={size}");
    warned("flyer.json", &[&cells("1e-4")], &[&cells("5e-5")], "bodies.flyer: 5.0 cells across");
    let plan = r#"output.plan={"quantity":"l1","wanted":0.1,"error":0.1,"cpu_seconds":1,
                  "wall_seconds":1,"guess":false}"#;
    let planned = [&cells("1e-4"), plan];
    warned("flyer.json", &[&cells("1e-4")], &planned, "bodies.flyer: 5.0 cells across");
}

#[test]
fn shocks_without_viscosity() {
    let off = "artificial_viscosity=null";
    let speed = |v: &str| format!("bodies.flyer.velocity=[{v}]");
    warned("flyer.json", &[off], &[off, &speed("50")], "bodies meet at 1000 m/s");
    warned("flyer.json", &[off], &[], "shock will oscillate");
    // bodies that leave each other
    let parting = [off, "reference=null", &speed("-500")];
    warned("flyer.json", &[off], &parting, "shock will oscillate");
    // elastic solids
    assert!(with("disks.json", &[]).unwrap().warnings.is_empty());
}

#[test]
fn runs_that_end_too_early_or_too_late() {
    let end = |t: &str| vec![format!("time.end={t}"), "output.profiles.times=[1e-10]".to_string()];
    let [short, long, right] = [end("1e-9"), end("1.0"), end("1e-7")];
    let sets = |all: &Vec<String>| all.clone();
    let warnings = |all: &Vec<String>| {
        let all = sets(all);
        with("flyer.json", &all.iter().map(String::as_str).collect::<Vec<_>>()).unwrap().warnings
    };
    assert!(warnings(&short).iter().any(|w| w.contains("crosses only 0.07 % of the longest")));
    let message = warnings(&long);
    assert!(message.iter().any(|w| w.contains("steps") && w.contains("hours")), "{message:?}");
    assert!(warnings(&right).is_empty(), "{:?}", warnings(&right));
}

#[test]
fn speeds_in_other_units() {
    let slow = ["bodies.flyer.velocity=[1.0]"];
    warned("flyer.json", &slow, &["bodies.flyer.velocity=[6.0]"], "bodies: they meet at 1 m/s");
    let fast = ["bodies.flyer.velocity=[76000]"];
    warned("flyer.json", &fast, &["bodies.flyer.velocity=[20000]"], "bodies: a speed of 7.6e4 m/s");
}

#[test]
fn lengths_in_other_units() {
    let sizes = |lower: &str, upper: &str, cell: &str| {
        let flyer = format!("bodies.flyer.box={{\"lower\": [{lower}], \"upper\": [0]}}");
        let target = format!("bodies.target.box={{\"lower\": [0], \"upper\": [{upper}]}}");
        let domain =
            format!("domain={{\"lower\":[{lower}],\"upper\":[{upper}],\"cell_size\":{cell}}}");
        vec![flyer, target, domain]
    };
    let message = |sets: Vec<String>| {
        let sets: Vec<&str> = sets.iter().map(String::as_str).chain(["reference=null"]).collect();
        with("flyer.json", &sets).unwrap().warnings.join("; ")
    };
    assert!(message(sizes("-1e-9", "1e-9", "2e-11")).contains("smaller than an atom"));
    assert!(!message(sizes("-1e-7", "1e-7", "2e-9")).contains("the unit is m"));
    assert!(message(sizes("-1e7", "1e7", "1e5")).contains("domain is 2e7 m long"));
    assert!(!message(sizes("-1e6", "1e6", "1e4")).contains("the unit is m"));
}

/// Rarefactions meet after (0.5 + 8) mm over the sound speeds, 1.6 us.
#[test]
fn tension_that_no_material_bears() {
    let plates = |end: &str, speed: &str, more: &str| {
        let sets = [
            format!("time.end={end}"),
            format!("bodies.flyer.velocity=[{speed}]"),
            "domain.upper=[0.02]".into(),
            "output.profiles.times=[1e-8]".into(),
            "reference=null".into(),
            more.into(),
        ];
        let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
        with("flyer.json", &sets).unwrap().warnings.join("; ")
    };
    // P = v Z Z'/(Z + Z') with Z = 2785*5386 and Z' = 8930*3940 kg/(m2 s), less what copper keeps up:
    // 2 P Z/(Z + Z')
    let message = plates("3e-6", "1000", "title=plates");
    assert!(
        message.contains("bodies.target: aluminium would reach a tension of about 6.3 GPa"),
        "{message}"
    );
    for (end, speed, more) in [
        ("1e-6", "1000", "title=too short for the waves to meet"),
        ("3e-6", "300", "title=slow"),
        ("3e-6", "1000", "materials.aluminium.eos.tension_cutoff=1e9"),
        ("3e-6", "1000", "boundary={\"x_upper\": \"wall\"}"),
        (
            "3e-6",
            "1000",
            "materials.aluminium.failure={\"type\": \"tension_limit\", \"stress\": 1e9}",
        ),
    ] {
        let message = plates(end, speed, more);
        assert!(!message.contains("would reach a tension"), "{more}: {message}");
    }
}

/// P (Z' - Z)/(Z' + Z) with P, Z and Z' as above; the rarefaction is there after two crossings.
#[test]
fn plates_that_would_part() {
    let swapped = ["bodies.flyer.material=aluminium", "bodies.target.material=copper"];
    let with = |more: &'static str| [&["reference=null", more][..], &swapped[..]].concat();
    let sets = with("title=plates");
    for other in [
        with("contact={\"type\": \"frictionless\"}"),
        with("time.end=1.8e-7"),
        with("boundary={\"x_lower\": \"wall\"}"),
        vec!["title=copper on aluminium"],
    ] {
        let other = [&other[..], &["output.profiles.times=[1e-8]"]].concat();
        warned(
            "flyer.json",
            &sets,
            &other,
            "bodies.flyer: the rarefaction from its rear reaches target after about 0.186 us",
        );
    }
    warned("flyer.json", &sets, &[], "under a tension of about 4.2 GPa");
}

#[test]
fn limits_beyond_the_cutoff_never_act() {
    let law = |text: &str| format!("materials.aluminium.failure={{{text}}}");
    let cut = |gpa: &str| format!("materials.aluminium.eos.tension_cutoff={gpa}e9");
    for text in [
        "\"type\": \"tension_limit\", \"stress\": 2e9",
        "\"type\": \"cochran_banner\", \"stress\": 2e9, \"opening\": 1e-5",
        "\"type\": \"tuler_butcher\", \"threshold\": 2e9, \"exponent\": 2, \"impulse\": 1e12",
    ] {
        let law = law(text);
        warned("spall.json", &[&law, &cut("1.9")], &[&law, &cut("2.1")], "= 2e9: never acts");
        warned("spall.json", &[&law, &cut("1.9")], &[&law], "never acts");
    }
    // a principal stress has a part that the cutoff does not limit
    let strong = "materials.aluminium.strength={\"type\": \"von_mises\", \"shear_modulus\": 26e9, \"yield_stress\": 3e8}";
    let law = law("\"type\": \"tension_limit\", \"stress\": 2e9");
    warned("spall.json", &[&law, &cut("1.9")], &[&law, &cut("1.9"), strong], "never acts");
}

#[test]
fn bodies_that_nothing_moves() {
    let reference = "reference=null";
    let still = ["bodies.flyer.velocity=[0]", reference];
    let together =
        ["bodies.flyer.velocity=[100]", "bodies.target.velocity=[100]", "domain.upper=[0.02]"];
    let text = "none moves relative to another, and nothing drives them";
    for sets in [&still[..], &[&together[..], &[reference]].concat()] {
        warned("flyer.json", sets, &[], text);
        for driven in ["body_force={\"gravity\": [-10]}", "bodies.target.pressure=1e9"] {
            warned("flyer.json", sets, &[sets, &[driven]].concat(), text);
        }
    }
    // together they strike a wall
    let wall = "boundary={\"x_upper\": \"wall\"}";
    warned(
        "flyer.json",
        &[&still[..], &[wall]].concat(),
        &[&together[..], &[reference, wall]].concat(),
        text,
    );
    let apart = ["bodies.flyer.velocity=[-10]", reference];
    warned("flyer.json", &apart, &[], "none moves towards another");
    warned(
        "flyer.json",
        &apart,
        &[&apart[..], &["boundary={\"x_lower\": \"wall\"}"]].concat(),
        "none moves towards another",
    );
}
