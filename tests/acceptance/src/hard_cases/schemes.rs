//! The presets, and every shape function with every transfer, in hard cases: stable and its error,
//! ended by the monitor, or refused; written to `docs/hard_cases.md`.

use std::fmt::Write;

use serde_json::{Value, json};

use super::cases::scenes::{SHAPES, shipped, with};
use super::cases::tools::{checked, hard, run, scored, until, with_flyers_scheme};
use crate::contact::{self, Measured, run as run_plane};
use crate::program::root;
use crate::table::Table;

const HEAD: &str = "# Schemes in hard cases

The [presets](methods.md#presets), and every shape function with every transfer, measured by `cargo run --release -p
acceptance -- hard_cases/schemes`. The presets choose their method and, but for the case without, their viscosity
for each case; with contact all have the method of `default`. All other runs have mid-point steps, the viscosity of
`inputs/flyer.json`, and those of its options that the scheme allows. The Courant number is 0.4 unless the column
has another. The first columns are variations of the flyer plate: without viscosity, with 1 and 16 particles per
cell, with a grid shifted by 0.37 cells, at higher speeds, with a softer flyer and contact. The columns torn and
flight have the scenes `inputs/hard/torn.json` and `inputs/hard/flight.json`.

A number is an error in per cent: the relative L1 norm of the pressure at 0.2 us, in columns marked `e` the drift of
the energy, in columns marked `s` the speed that a block of rubber loses while it slides on a base for 20 cells
without friction at 17 degrees to the grid, in columns marked `p` the pressure over rho c u of copper blocks that pass
each other at a corner at 500 m/s with a gap of half a cell. **monitor** means that the run-time checks ended the run
before its result was wrong; the reason follows. **refused** means that the check of the scene refused it. In both
cases the exit code is not 0. The energy of a transfer in italics is not exact.

- state: the state of a particle is outside of its model, mostly by growing tension
- courant: a time step was too long
- speed: a particle was faster than any wave
- energy: the total energy grew
- cold: the internal energy fell below its minimum
- crowd: too many particles in one cell
- step: the stable time step became too small

[Methods](methods.md#courant-number) describes the limits of the Courant number.

";

/// Heading of the case without artificial viscosity.
const NO_VISCOSITY: &str = "no viscosity";

/// A case: its heading, and the scene with the standard method.
fn cases() -> Vec<(&'static str, Value)> {
    let base = || {
        let mut value = until(&shipped("flyer.json"), &[0.2e-6]);
        value["domain"]["lower"] = json!([-0.0007]);
        value["domain"]["upper"] = json!([0.0033]);
        value["bodies"][1]["box"]["upper"] = json!([0.0026]);
        value
    };
    let each = |edit: &dyn Fn(&mut Value)| {
        let mut value = base();
        (0..2).for_each(|body| edit(&mut value["bodies"][body]));
        value
    };
    let faster = |speed: f64, end: f64| {
        let mut value = until(&base(), &[end]);
        value["bodies"][0]["velocity"] = json!([speed]);
        value
    };
    let soft = {
        let mut value = until(&with_flyers_scheme(shipped("soft_flyer.json")), &[0.2e-6]);
        value["domain"]["upper"] = json!([0.0033]);
        value["bodies"][1]["box"]["upper"] = json!([0.003]);
        value
    };
    vec![
        ("standard", base()),
        (NO_VISCOSITY, with(&base(), &json!({"artificial_viscosity": null}))),
        ("1 per cell", each(&|b| b["particles_per_cell"] = json!([1]))),
        ("16 per cell", each(&|b| b["particles_per_cell"] = json!([16]))),
        ("grid +0.37", {
            let mut value = base();
            value["domain"]["lower"] = json!([-0.0007 - 0.37e-5]);
            value["domain"]["upper"] = json!([0.0033 - 0.37e-5]);
            value
        }),
        ("5 km/s", faster(5e3, 0.1e-6)),
        ("10 km/s", faster(1e4, 0.1e-6)),
        ("soft, contact", soft),
        ("courant 0.8", with(&base(), &json!({"time": {"courant": 0.8}}))),
        ("torn e", hard("torn.json")),
        ("10 km/s flight e", hard("flight.json")),
        ("sliding s", contact::slide(17.0)),
        ("corner p", contact::pass(17.0, 0.0)),
    ]
}

fn transfers() -> [(&'static str, Value); 8] {
    [
        ("flip", json!("flip")),
        ("pic", json!("pic")),
        ("apic", json!("apic")),
        ("flip 0.9", json!({"flip_pic": 0.9})),
        ("xpic 3", json!({"xpic": 3})),
        ("fmpm 4", json!({"fmpm": 4})),
        ("fmpm 6", json!({"fmpm": 6})),
        ("fmpm 8", json!({"fmpm": 8})),
    ]
}

/// Rows of the presets: name, and `method`.
fn presets() -> [(&'static str, Value); 4] {
    [
        ("default", json!({"preset": "default"})),
        ("default, updated frame", json!({"preset": "default", "frame": "updated_lagrangian"})),
        ("sharpest", json!({"preset": "sharpest"})),
        ("robust", json!({"preset": "robust"})),
    ]
}

/// The scene of a case with a preset, which also chooses the viscosity unless the case is without.
fn with_preset(case: &str, base: &Value, method: &Value) -> Value {
    let mut value = base.clone();
    value["method"] = method.clone();
    match case {
        NO_VISCOSITY => value["artificial_viscosity"] = Value::Null,
        _ => drop(value.as_object_mut().expect("a scene").remove("artificial_viscosity")),
    }
    value
}

/// The scene with a scheme, and what it allows of the options.
fn scheme(base: &Value, shape: &str, transfer: &Value) -> Value {
    let mut value = base.clone();
    let (affine, plain) = (transfer == "apic", transfer == "flip");
    let method = value["method"].as_object_mut().expect("a method");
    method.insert("shape".into(), json!(shape));
    method.insert("transfer".into(), transfer.clone());
    method.insert("filter_heat".into(), json!(!affine && !plain));
    method.insert("energy".into(), json!(if affine { "textbook" } else { "compatible" }));
    if transfer.get("fmpm").is_none() {
        method.remove("edge_mask");
    }
    // contact in a plane has spin by default
    if method.contains_key("spin") {
        let allowed = transfer.get("fmpm").is_some() && shape != "linear";
        method.insert("spin".into(), json!(allowed));
    }
    value
}

/// One word for a message of the monitor.
fn word(message: &str) -> &'static str {
    let words = [
        ("Courant number", "courant"),
        ("faster than any wave", "speed"),
        ("energy has grown", "energy"),
        ("below none", "cold"),
        ("in its cell", "crowd"),
        ("stable time step", "step"),
    ];
    words.iter().find(|(text, _)| message.contains(text)).map_or("state", |(_, word)| word)
}

/// The end of a run in a cell of the table.
fn cell(name: &str, value: &Value) -> String {
    if let Err(message) = checked(value) {
        let reason = message.split("allowed:").next().unwrap_or("").to_string();
        let above = reason.find("above ").map(|at| &reason[at..]).and_then(|r| r.split(',').next());
        return format!("**refused**, {}", above.unwrap_or("see the message"));
    }
    let error = |message: String| match message.contains("at set-up") {
        true => "**refused**".to_string(),
        false => format!("**monitor**, {}", word(&message)),
    };
    let in_plane = |figure: fn(&Measured) -> f64| {
        // without the sign of a zero
        let rounded = |found: &Measured| (1e4 * figure(found)).round() / 100.0 + 0.0;
        run_plane(value).map_or_else(error, |found| format!("{:.2}", rounded(&found)))
    };
    if name.ends_with(" s") {
        return in_plane(|found| contact::speed_lost(found, 17.0));
    }
    if name.ends_with(" p") {
        return in_plane(contact::passing_pressure);
    }
    if name.ends_with(" e") {
        return run(value)
            .map_or_else(error, |e| format!("{:.1e}", 100.0 * e.energy_drift().abs()));
    }
    scored(value).map_or_else(error, |(_, errors)| {
        errors.last().and_then(|e| e.l1).map_or("-".into(), |l1| format!("{:.2}", 100.0 * l1))
    })
}

/// Writes the table; counts rows of presets that are not stable as misses, but for `sharpest`.
pub fn check(table: &mut Table) {
    let cases = cases();
    let mut text = HEAD.to_string();
    let names: Vec<&str> = cases.iter().map(|(name, _)| *name).collect();
    let _ = writeln!(text, "| preset, or shape and transfer | {} |", names.join(" | "));
    let _ = writeln!(text, "|---|{}", "---|".repeat(names.len()));
    let mut add = |name: &str, scene: &dyn Fn(&str, &Value) -> Value| -> bool {
        let row: Vec<String> =
            cases.iter().map(|(case, base)| cell(case, &scene(case, base))).collect();
        let _ = writeln!(text, "| {name} | {} |", row.join(" | "));
        row.iter().all(|cell| !cell.contains("monitor"))
    };
    for (name, method) in presets() {
        let ok = add(name, &|case, base| with_preset(case, base, &method));
        if name != "sharpest" {
            let figure = format!("the preset {name} in all cases");
            table.holds(&figure, "", "stable or refused", ok);
        }
    }
    let own = shipped("flyer.json")["method"].clone();
    for shape in SHAPES {
        for (name, transfer) in transfers() {
            let name = if name == "apic" { "*apic*" } else { name };
            let ok = add(&format!("{shape}, {name}"), &|_, base| scheme(base, shape, &transfer));
            if own["shape"] == shape && own["transfer"] == transfer {
                table.holds("the scheme of flyer.json in all cases", "", "stable or refused", ok);
            }
        }
    }
    let written = std::fs::write(root().join("docs/hard_cases.md"), text);
    table.holds("docs/hard_cases.md", "", "written", written.is_ok());
}
