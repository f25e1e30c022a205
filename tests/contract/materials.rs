//! The library of materials on the command line.

use crate::home::Home;

#[test]
fn the_library_is_listed() {
    let home = Home::new();
    let text = home.call(["materials"]).end().succeeded();
    for (name, _) in flyer_mpm::input::LIBRARY {
        let line = text.lines().find(|line| line.split(' ').next() == Some(name));
        let line = line.unwrap_or_else(|| panic!("no {name} in {text}"));
        assert!(line.contains("kg/m3"), "{line}");
    }
    let copper = text.lines().find(|line| line.starts_with("copper_johnson_cook")).unwrap();
    assert!(copper.contains("mie_gruneisen, johnson_cook, thermal") && copper.contains("8930"));
    assert!(copper.ends_with("failure: johnson_cook"), "{copper}");
    let gold = text.lines().find(|line| line.starts_with("gold")).unwrap();
    assert!(!gold.contains("failure"), "{gold}");
    let tantalum = home.call(["material", "tantalum"]).end().succeeded();
    assert!(
        tantalum.contains("failure spall: ")
            && tantalum.contains("5100000000.0")
            && tantalum.contains("Jones et al. (2018)"),
        "{tantalum}"
    );
}

/// A material by its name alone is the same as in a scene.
#[test]
fn a_material_needs_no_scene() {
    let mut scene = crate::scenes::short();
    scene["materials"]["copper"] = serde_json::json!({"library": "copper"});
    let home = Home::with(&scene);
    let from_scene = home.call(["material", "scene.json", "copper"]).end().succeeded();
    let by_name = home.call(["material", "copper"]).end().succeeded();
    let numbers = |text: &str| {
        text.lines()
            .filter(|l| !l.starts_with("pictures") && !l.starts_with("failure "))
            .collect::<String>()
    };
    assert_eq!(numbers(&from_scene), numbers(&by_name));
    assert!(home.at("output/material.copper/summary.json").is_file());
    // an explosive is described by its products
    assert!(home.call(["material", "tnt"]).end().succeeded().contains("tnt"));
    home.call(["material", "coper"]).end().failed(&["no such material", "did you mean copper"]);
    home.call(["material", "scene.json"]).end().failed(&["scene.json: the name of a material"]);
}
