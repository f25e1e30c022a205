//! Mirror image, shift by whole cells, Galilean shift.

use flyer_mpm::simulation::ParticleTable;
use serde_json::{Value, json};

use crate::tools::{apart, at_most, column, greatest, run, scored, shipped, short, with};

/// Schemes that are tested: the default, that of Burghardt (2010), and one of each other kind.
fn schemes() -> Vec<Value> {
    let mut scenes = vec![short("flyer.json", 0.3e-6), short("flyer_uintah.json", 0.3e-6)];
    for (name, method) in [
        ("flyer.json", json!({"shape": "cpdi", "transfer": {"fmpm": 4}})),
        (
            "flyer.json",
            json!({"shape": "bspline_cubic", "transfer": {"flip_pic": 0.9}, "edge_mask": null}),
        ),
        ("flyer_uintah.json", json!({"shape": "gimp", "transfer": "pic"})),
        ("flyer_uintah.json", json!({"shape": "bspline_quadratic", "transfer": "apic"})),
        ("flyer_uintah.json", json!({"shape": "cpdi", "transfer": {"xpic": 3}})),
    ] {
        scenes.push(with(&short(name, 0.3e-6), &json!({"method": method})));
    }
    let nodal = json!({"artificial_viscosity": {"limiter": "nodal"}});
    scenes.push(with(&short("flyer.json", 0.3e-6), &nodal));
    let total = json!({"frame": "total_lagrangian"});
    for (name, edit) in [
        ("flyer.json", json!({})),
        ("flyer.json", nodal.clone()),
        ("flyer_uintah.json", json!({"method": {"shape": "gimp", "transfer": "flip"}})),
    ] {
        let scene = with(&short(name, 0.3e-6), &json!({"method": total}));
        scenes.push(with(&scene, &edit));
    }
    scenes
}

/// Maps the number at each place of a scene.
fn edit(value: &mut Value, places: &[&str], map: impl Fn(f64) -> f64) {
    for place in places {
        let number = value.pointer_mut(place).unwrap();
        *number = json!(map(number.as_f64().unwrap()));
    }
}

/// Fields of two tables, the second in the order of the first; scales are those of the first.
#[track_caller]
fn close(what: &str, a: &ParticleTable, b: &ParticleTable, names: &[&str], bound: f64) {
    for name in names {
        let (a, b) = (column(a, name), column(b, name));
        assert!(greatest(b) > 0.0 || greatest(a) == 0.0);
        at_most(&format!("{what}: {name}"), apart(b, a), bound);
    }
}

const FIELDS: [&str; 5] =
    ["pressure", "velocity", "density", "specific_internal_energy", "artificial_viscosity"];

#[test]
fn the_mirror_image_of_a_scene_is_the_mirror_image_of_its_run() {
    for scene in schemes() {
        let mut mirror = scene.clone();
        flip(&mut mirror["domain"]);
        for body in 0..2 {
            flip(&mut mirror["bodies"][body]["box"]);
            edit(&mut mirror, &[&format!("/bodies/{body}/velocity/0")], |v| 0.0 - v);
        }
        let (there, mut back) = (run(&scene), run(&mirror));
        let table = back.tables.last_mut().unwrap();
        for column in &mut table.columns {
            column.values.reverse();
            if ["x", "velocity"].contains(&column.name.as_str()) {
                column.values.iter_mut().for_each(|value| *value = -*value);
            }
        }
        let what = scene["method"].to_string();
        close(&what, there.last(), table, &["x"], 1e-9);
        close(&what, there.last(), table, &FIELDS, 1e-9);
    }
}

/// Turns an interval round.
fn flip(extent: &mut Value) {
    let [lower, upper] = ["lower", "upper"].map(|key| extent[key][0].as_f64().unwrap());
    extent["lower"] = json!([-upper]);
    extent["upper"] = json!([-lower]);
}

const PLACES: [&str; 6] = [
    "/domain/lower/0",
    "/domain/upper/0",
    "/bodies/0/box/lower/0",
    "/bodies/0/box/upper/0",
    "/bodies/1/box/lower/0",
    "/bodies/1/box/upper/0",
];

#[test]
fn a_shift_by_whole_cells_shifts_the_run() {
    for scene in schemes() {
        for cells in [17.0, -240.0] {
            let shift = cells * 1e-5;
            let mut shifted = scene.clone();
            edit(&mut shifted, &PLACES, |x| x + shift);
            let (there, mut back) = (run(&scene), run(&shifted));
            let table = back.tables.last_mut().unwrap();
            table.columns[0].values.iter_mut().for_each(|x| *x -= shift);
            let what = format!("{} by {cells}", scene["method"]);
            close(&what, there.last(), table, &["x"], 1e-9);
            close(&what, there.last(), table, &FIELDS, 1e-9);
        }
    }
}

/// The domain cut off elsewhere where nothing touches it.
#[test]
fn an_empty_margin_changes_nothing() {
    for scene in schemes() {
        let mut wider = scene.clone();
        edit(&mut wider, &["/domain/lower/0"], |x| x - 40.0 * 1e-5);
        edit(&mut wider, &["/domain/upper/0"], |x| x + 30.0 * 1e-5);
        let (a, b) = (run(&scene), run(&wider));
        let what = scene["method"].to_string();
        close(&what, a.last(), b.last(), &["x"], 1e-9);
        close(&what, a.last(), b.last(), &FIELDS, 1e-9);
    }
}

#[test]
fn a_galilean_shift_leaves_the_error() {
    for method in [json!({}), json!({"shape": "cpdi", "transfer": {"fmpm": 4}})] {
        let base = with(&shipped("flyer.json"), &json!({"method": method}));
        let errors = scored(&base).1;
        for speed in [137.0, -411.0] {
            let mut moved = base.clone();
            moved["domain"]["lower"] = json!([-0.0015]);
            moved["domain"]["upper"] = json!([0.0095]);
            edit(&mut moved, &["/bodies/0/velocity/0", "/bodies/1/velocity/0"], |v| v + speed);
            let (outcome, shifted) = scored(&moved);
            for (a, b) in errors.iter().zip(&shifted).skip(1) {
                let change = b.l1.unwrap() / a.l1.unwrap() - 1.0;
                at_most(&format!("change of L1 with {speed} m/s, {method}"), change, 0.2);
            }
            at_most("energy", outcome.energy_drift(), 1e-12);
            at_most("momentum", outcome.momentum_drift(), 1e-12);
        }
    }
}
