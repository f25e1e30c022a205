//! Measures the Courant numbers up to which each shape function is stable with each transfer, and
//! prints the table that stands in `src/input/check/courant.rs`; then the same of the presets.
//!
//! `cargo run --release --example courant_limits` takes some minutes.

use std::path::Path;

use decomp::Serial;
use flyer_mpm::input;
use flyer_mpm::simulation::Simulation;
use serde_json::{Value, json};

const SHAPES: [(&str, &str); 6] = [
    ("linear", "Linear"),
    ("gimp", "Gimp"),
    ("cpdi", "Cpdi"),
    ("bspline_quadratic", "BsplineQuadratic"),
    ("bspline_cubic", "BsplineCubic"),
    ("cpdi_bspline_quadratic", "CpdiBsplineQuadratic"),
];

/// Courant numbers that are tried, in tenths.
const TENTHS: std::ops::RangeInclusive<u32> = 2..=10;

/// Pressures beyond this are no longer those of the impact [Pa]: twice 12.14 GPa.
const MOST_PRESSURE: f64 = 24.3e9;

fn transfers() -> [Value; 9] {
    [
        json!("flip"),
        json!("pic"),
        json!("apic"),
        json!({"xpic": 2}),
        json!({"xpic": 5}),
        json!({"fmpm": 2}),
        json!({"fmpm": 4}),
        json!({"fmpm": 6}),
        json!({"fmpm": 8}),
    ]
}

/// The standard problem with a target of 2 mm, to 0.3 us: the shock, the release from the flyer's
/// rear and both free surfaces.
fn short(name: &str) -> Value {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs").join(name);
    let text = std::fs::read(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let mut value: Value = serde_json::from_slice(&text).expect("a shipped scene");
    value["domain"]["lower"] = json!([-0.0007]);
    value["domain"]["upper"] = json!([0.0033]);
    value["bodies"][1]["box"]["upper"] = json!([0.0026]);
    value["time"]["end"] = json!(0.3e-6);
    value["output"] = json!({});
    value["monitor"] = json!({"on_courant_exceeded": "allow"});
    value
}

/// The scene with a shape function and a transfer, and the options that they allow.
fn scheme(base: &Value, shape: &str, transfer: &Value) -> Value {
    let mut value = base.clone();
    let method = value["method"].as_object_mut().expect("a method");
    let fmpm = transfer.get("fmpm").is_some();
    method.insert("shape".into(), json!(shape));
    method.insert("transfer".into(), transfer.clone());
    if method.get("stepping") == Some(&json!("midpoint")) {
        let affine = transfer == "apic";
        method.insert("filter_heat".into(), json!(!affine && transfer != "flip"));
        method.insert("energy".into(), json!(if affine { "textbook" } else { "compatible" }));
        if !fmpm {
            method.remove("edge_mask");
        }
    }
    value
}

/// Whether the scene runs to its end with the pressures of its impact.
fn is_stable(value: &Value) -> bool {
    let text = value.to_string();
    let scene =
        input::parse(text.as_bytes(), "courant.json", &[]).unwrap_or_else(|e| panic!("{e}"));
    let Ok(mut simulation) = Simulation::<1>::new(&scene, &Serial, 1) else { return false };
    let end = scene.scene.time.end;
    while simulation.time() < end {
        if simulation.advance(end).is_err() {
            return false;
        }
    }
    let (table, _) = simulation.gather().expect("one rank");
    let pressure = table.column("pressure").expect("every table has it");
    pressure.iter().all(|p| p.abs() < MOST_PRESSURE)
}

/// The greatest Courant number up to which all `bases` are stable with a scheme; 0: none.
fn limit(bases: &[Value], shape: &str, transfer: &Value) -> f64 {
    let scenes: Vec<Value> = bases.iter().map(|base| scheme(base, shape, transfer)).collect();
    limit_of(&scenes)
}

/// The greatest Courant number up to which all `scenes` are stable; 0: none.
fn limit_of(scenes: &[Value]) -> f64 {
    let stable = |tenths: &u32| {
        scenes.iter().all(|scene| {
            let mut scene = scene.clone();
            scene["time"]["courant"] = json!(f64::from(*tenths) / 10.0);
            is_stable(&scene)
        })
    };
    f64::from(TENTHS.take_while(stable).last().unwrap_or(0)) / 10.0
}

/// Prints the limits of the presets in both frames, with 1, 2 and 3 particles per cell.
fn print_presets() {
    for preset in ["default", "sharpest", "robust"] {
        for frame in ["updated_lagrangian", "total_lagrangian"] {
            let with_particles = |count: u32| {
                let mut scene = short("flyer.json");
                scene["method"] = json!({"preset": preset, "frame": frame});
                scene.as_object_mut().expect("a scene").remove("artificial_viscosity");
                (0..2).for_each(|k| scene["bodies"][k]["particles_per_cell"] = json!([count]));
                format!("{:.1}", limit_of(&[scene]))
            };
            let limits: Vec<String> = (1..=3).map(with_particles).collect();
            println!("preset {preset}, {frame}, 1, 2, 3 particles per cell: {}", limits.join(", "));
        }
    }
}

fn main() {
    // the default's viscosity grows with the shock; one that does not is as usual
    let mut fixed = short("flyer.json");
    fixed["artificial_viscosity"] = json!({
        "linear": 0.1, "quadratic": 1.25, "limiter": "christensen", "limited": "linear"
    });
    let bases = [vec![short("flyer_defaults.json")], vec![short("flyer.json"), fixed]];
    println!("const LIMITS: [Row; 6] = [");
    for (shape, name) in SHAPES {
        println!("    (\n        ShapeKind::{name},");
        for base in &bases {
            let row: Vec<String> =
                transfers().iter().map(|t| format!("{:.1}", limit(base, shape, t))).collect();
            println!("        [{}],", row.join(", "));
        }
        println!("    ),");
    }
    println!("];");
    let [_, mut open] = bases;
    for scene in &mut open {
        scene["boundary"] = json!({"x_upper": "transmitting"});
        scene["domain"]["upper"] = json!([0.001]);
        scene["bodies"][1]["box"]["upper"] = json!([0.001]);
        scene.as_object_mut().expect("a scene").remove("reference");
    }
    for order in [2, 4, 6, 8] {
        let transfer = json!({"fmpm": order});
        println!(
            "transmitting, FMPM({order}): {:.1}",
            limit(&open, "cpdi_bspline_quadratic", &transfer)
        );
    }
    print_presets();
}
