//! Scenes that pass, and what follows from them.

use flyer_mpm::input;
use flyer_mpm::input::parse;
use flyer_mpm::scene::{Side, Transfer};
use serde_json::{Value, json};

use super::{inputs, mentions, refused, shipped, with};

#[test]
fn shipped_scenes_pass() {
    // made for layouts or for one law, and without an exact solution
    const UNSCORED: [&str; 15] = [
        "crossing.json",
        "detonation.json",
        "disks.json",
        "flyer_strength.json",
        "free_slide.json",
        "gas_gun_window.json",
        "heat_rod.json",
        "hertz.json",
        "jwl_expansion.json",
        "piston_elastic_plastic.json",
        "quarter.json",
        "sliding_block.json",
        "spall.json",
        "taylor_bar.json",
        "three_plates.json",
    ];
    assert!(inputs().len() >= 11);
    for path in inputs() {
        let name = path.file_name().unwrap().to_str().unwrap();
        let checked = with(name, &[]).unwrap();
        let apart = checked.warnings.iter().filter(|w| w.contains("without contact")).count();
        // plates that would part, in scenes for the balance of ranks
        let expected = match name {
            "crossing.json" => 2,
            "quarter.json" => 1,
            _ => 0,
        };
        assert_eq!((apart, checked.warnings.len()), (expected, expected), "{:?}", checked.warnings);
        assert!(checked.scene.description.len() > 100, "{name} names its sources");
        assert_eq!(checked.scene.reference.is_none(), UNSCORED.contains(&name), "{name}");
    }
}

#[test]
fn shipped_scenes_hold_against_the_schema() {
    let schema = input::schema();
    let validator = jsonschema::validator_for(&schema).unwrap();
    for path in inputs() {
        let value: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        assert!(validator.is_valid(&value), "{path:?}: {:?}", validator.iter_errors(&value).next());
    }
    let mut bad: Value = serde_json::from_slice(&shipped("flyer.json")).unwrap();
    bad["time"]["courant"] = json!(1.5);
    assert!(!validator.is_valid(&bad));
}

#[test]
fn a_scene_written_out_is_read_back() {
    for path in inputs() {
        let name = path.file_name().unwrap().to_str().unwrap();
        let first = with(name, &[]).unwrap();
        let text = serde_json::to_string(&first.scene).unwrap();
        let again = parse(text.as_bytes(), name, &[]).unwrap();
        assert_eq!(text, serde_json::to_string(&again.scene).unwrap());
        let made = input::check(first.scene, name).unwrap();
        assert_eq!(made.particles, again.particles);
    }
}

#[test]
fn the_schema_tells_units() {
    let text = input::schema().to_string();
    for unit in ["[m]", "[s]", "[m/s]", "[kg/m3]", "[Pa]", "[-]"] {
        assert!(text.contains(unit), "{unit}");
    }
}

#[test]
fn a_checked_scene_counts_cells_and_particles() {
    let checked = with("flyer.json", &[]).unwrap();
    assert_eq!((checked.dimension, &checked.cells[..]), (1, &[1000][..]));
    assert_eq!(checked.cell_size, [1e-5]);
    assert_eq!(checked.particles, 1700);
    assert_eq!(checked.bodies[0].lattice, [100]);
    assert_eq!(checked.bodies[1].lattice, [1600]);
    // by name: aluminium, copper
    assert_eq!((checked.bodies[0].material, checked.bodies[1].material), (1, 0));
    assert_eq!(checked.profile_times, [0.2e-6, 0.5e-6, 1.0e-6]);
    assert_eq!(checked.history_interval, Some(1e-6 / 200.0));
    let without = with("flyer.json", &["output=null"]);
    assert!(without.is_err(), "output is an object");
    let without = with("flyer.json", &["output={}", "domain.cell_size=[2e-5]"]).unwrap();
    assert_eq!(without.profile_times, [1e-6]);
    assert_eq!(without.history_interval, None);
    assert_eq!((without.cells[0], without.particles), (500, 850));
}

#[test]
fn walls_are_reported_with_their_velocity() {
    let checked = with("piston.json", &[]).unwrap();
    let wall = checked.wall_struck_by(0).unwrap();
    assert_eq!((wall.upper, wall.position, wall.velocity), (false, 0.0, 0.0));
    let sets = ["boundary.x_lower.velocity=1000", "bodies.slab.velocity=[0]"];
    refused("piston.json", &sets, &["boundary.x_lower is \"wall\"", "no key velocity"]);
    let sets = ["boundary.x_lower={\"velocity\": 1000}", "bodies.slab.velocity=[0]"];
    let checked = with("piston.json", &sets).unwrap();
    assert_eq!(checked.wall_struck_by(0).unwrap().velocity, 1000.0);
    assert!(with("flyer.json", &[]).unwrap().walls().is_empty());
}

#[test]
fn overrides_reach_every_place() {
    let checked = with(
        "flyer.json",
        &[
            "domain.patches=[8]",
            "artificial_viscosity.linear=0.2",
            "bodies.flyer.velocity=[500]",
            "bodies.1.particles_per_cell=[3]",
            "bodies[1].box.upper[0]=0.007",
            "method.transfer={\"xpic\": 2}",
            "method.edge_mask=null",
            "method.shape=cpdi",
            "boundary.x_upper=outflow",
            "output.histories.tracers=[{\"name\": \"a\", \"body\": \"target\", \"at\": [1e-3]}]",
            "output.histories.tracers.a.at=[2e-3]",
            "title=500 m/s",
        ],
    )
    .unwrap();
    let scene = &checked.scene;
    assert_eq!(scene.domain.patches, Some(vec![8]));
    assert_eq!(scene.artificial_viscosity.unwrap().linear, 0.2);
    assert_eq!(checked.bodies[0].velocity, [500.0]);
    assert_eq!(checked.bodies[1].lattice, [2100]);
    assert_eq!(scene.method.transfer, Transfer::Xpic(2));
    assert_eq!(scene.boundary.as_ref().unwrap().x_upper, Side::Outflow);
    assert_eq!(scene.output.histories.as_ref().unwrap().tracers[0].at, [2e-3]);
    assert_eq!(scene.title, "500 m/s");
    let later = with("flyer.json", &["time.end=1e-3", "time.end=2e-6"]).unwrap();
    assert_eq!(later.scene.time.end, 2e-6);
}

#[test]
fn overrides_that_fail_are_reported() {
    refused("flyer.json", &["time.end"], &["--set time.end", "no `=`", "PATH=VALUE"]);
    refused("flyer.json", &["bodies.flier.velocity=[1]"], &["did you mean flyer?", "0 to 1"]);
    refused("flyer.json", &["method.shape.x=1"], &["method.shape is \"cpdi_bspline_quadratic\""]);
    refused("flyer.json", &["time.end=NaN"], &["time.end = \"NaN\"", "a number above 0"]);
    refused("flyer.json", &["time.end=1e999"], &["time.end = \"1e999\"", "a number above 0"]);
    refused("flyer.json", &["domian.patches=[8]"], &["domian", "did you mean domain?"]);
}

#[test]
fn what_is_inaccurate_is_warned_of() {
    let warned = |sets: &[&str], fragment: &str| {
        let checked = with("flyer.json", sets).unwrap();
        assert_eq!(checked.warnings.len(), 1, "{:?}", checked.warnings);
        mentions(&checked.warnings[0], &[fragment]);
    };
    warned(&["method.shape=linear"], "method.shape = \"linear\"");
    let above = ["method.shape=gimp", "time.courant=0.95", "monitor.on_courant_exceeded=allow"];
    warned(&above, "time.courant = 0.95");
    warned(
        &["materials.spare={\"density\": 1, \"eos\": {\"type\": \"ideal_gas\", \"gamma\": 1.4}}"],
        "materials.spare",
    );
    warned(&["reference=null", "bodies.flyer.box.upper=[-1e-4]"], "without contact");
    warned(&["bodies.flyer.material=aluminium", "bodies.target.material=copper"], "softer");
    let sets = ["domain.lower=[-0.0005]", "boundary.x_lower=wall"];
    warned(&sets, "rear touches");
}
