//! Scenes to start from.

use crate::home::Home;

/// Every template is written, runs as it is, and leaves its profiles and pictures.
#[test]
fn every_template_runs() {
    let home = Home::new();
    let list = home.call(["new"]).end().succeeded();
    let names: Vec<&str> = list.lines().filter_map(|line| line.split(' ').next()).collect();
    let names: Vec<&str> = names.into_iter().filter(|name| !name.starts_with('`')).collect();
    assert!(names.contains(&"plate_impact") && names.len() >= 9, "{list}");
    for name in names {
        let file = format!("{name}.json");
        assert!(home.call(["new", name]).end().succeeded().contains(&file));
        // those in two dimensions on coarser cells and for a shorter time
        let bytes = std::fs::read(home.at(&file)).unwrap();
        let checked = flyer_mpm::input::parse(&bytes, name, &[]).unwrap();
        assert!(checked.warnings.is_empty(), "{name}: {:?}", checked.warnings);
        let mut args = vec![file.clone(), "--quiet".to_string()];
        if checked.dimension > 1 {
            let end = checked.scene.time.end / 8.0;
            let cell = checked.cell_size[0] * 2.0;
            args.extend(["--set".into(), format!("time.end={end:e}")]);
            args.extend(["--set".into(), format!("domain.cell_size={cell:e}")]);
            args.extend(["--set".into(), format!("output.profiles.times=[{end:e}]")]);
        }
        home.call(args.iter().map(String::as_str)).end().succeeded();
        let results = home.results(&format!("output/{name}"));
        assert_eq!(results.summary["method_choice"]["preset"], "default", "{name}");
        assert!(results.names().iter().any(|file| file.ends_with(".png")), "{name}");
    }
    // nothing is overwritten
    home.call(["new", "empty"]).end().failed(&["empty.json: exists already; allowed: --output"]);
    home.call(["new", "emty"]).end().failed(&["no such template; did you mean empty?"]);
    // defaults that no line of the scene shows
    let checked = home.call(["check", "empty.json"]).end().succeeded();
    assert!(checked.contains("particles per cell   [2] (default): all bodies"), "{checked}");
}
