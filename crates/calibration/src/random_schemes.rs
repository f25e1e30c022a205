//! Random schemes: shape function, transfer, viscosity, Courant number, particles per cell.

use flyer_mpm::accuracy::estimate::FittedSchemes;
use flyer_mpm::accuracy::plan;
use flyer_mpm::shape::ShapeKind;
use serde_json::{Value, json};

use crate::random::Random;

/// Schemes to draw from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Schemes {
    /// A scene without `method`.
    Default,
    /// The preset `sharpest`.
    Sharpest,
    /// The preset `robust`.
    Robust,
    /// The schemes that a plan can choose.
    Planned,
    /// Random schemes in the total-Lagrangian frame.
    TotalLagrangian,
    /// Random schemes of all families.
    Random,
    /// Random schemes outside of the range of the fit.
    Unusual,
}

/// Orders of `fmpm`.
const FMPM: [u64; 2] = [4, 14];
/// Orders of `xpic`.
const XPIC: [u64; 2] = [2, 5];
/// Rate of the pressure relaxation over its interval.
const RELAXATION: [f64; 2] = [0.04, 0.3];
/// Linear coefficient of the viscosity.
const LINEAR: [f64; 2] = [0.03, 0.2];
/// Quadratic coefficient of the viscosity, except for 0 with growth.
const QUADRATIC: [f64; 2] = [0.3, 2.0];
/// Courant numbers.
const COURANT: [f64; 2] = [0.25, 0.6];
/// Particles per cell.
const PARTICLES: [u64; 2] = [1, 4];

/// The range of the random schemes.
pub fn range() -> FittedSchemes {
    let whole = |[low, high]: [u64; 2]| [low as f64, high as f64];
    FittedSchemes {
        shapes: vec![ShapeKind::CpdiBsplineQuadratic, ShapeKind::Cpdi],
        fmpm: whole(FMPM),
        xpic: whole(XPIC),
        relaxation: RELAXATION,
        linear: LINEAR,
        quadratic: [0.0, QUADRATIC[1]],
        courant: COURANT,
        particles_per_cell: whole(PARTICLES),
    }
}

/// Writes a scheme into a scene; its name.
pub fn apply(random: &mut Random, schemes: Schemes, scene: &mut Value) -> String {
    match schemes {
        Schemes::Default => preset(scene, Value::Null),
        Schemes::Sharpest => preset(scene, json!("sharpest")),
        Schemes::Robust => preset(scene, json!("robust")),
        Schemes::Planned => {
            let all = plan::schemes();
            let scheme = random.one(&all);
            scheme.apply(scene);
            scheme.name.clone()
        }
        Schemes::TotalLagrangian => {
            let method = filtered(random, true);
            free(random, scene, method)
        }
        Schemes::Random => {
            let method = match random.below(10) {
                0..3 => filtered(random, true),
                3..7 => filtered(random, false),
                _ => unfiltered(random),
            };
            free(random, scene, method)
        }
        Schemes::Unusual => unusual(random, scene),
    }
}

fn preset(scene: &mut Value, method: Value) -> String {
    let name = method.as_str().unwrap_or("default").to_string();
    let keys = scene.as_object_mut().expect("a scene is an object");
    keys.remove("artificial_viscosity");
    keys.remove("method");
    if !method.is_null() {
        keys.insert("method".into(), method);
    }
    name
}

fn order(random: &mut Random, [low, high]: [u64; 2]) -> u64 {
    low + random.below(high - low + 1)
}

/// FMPM of a random order.
fn filtered(random: &mut Random, total: bool) -> Value {
    let interval = if random.chance(0.25) { 5 } else { 1 };
    let rate = random.log_between(RELAXATION[0], RELAXATION[1]);
    let rate = (rate * interval as f64).min(1.0);
    let splines = total || random.chance(0.65);
    let mut method = json!({
        "shape": if splines { "cpdi_bspline_quadratic" } else { "cpdi" },
        "transfer": {"fmpm": order(random, if splines { FMPM } else { [4, 8] })},
        "stepping": "midpoint",
        "energy": "compatible",
        "filter_heat": true,
        "pressure_relaxation": {"rate": rate, "interval": interval},
        "edge_mask": random.between(0.3, 0.4),
    });
    if total {
        method["frame"] = json!("total_lagrangian");
    }
    method
}

/// FLIP, APIC, PIC or XPIC.
fn unfiltered(random: &mut Random) -> Value {
    let shape = if random.chance(0.7) { "cpdi" } else { "cpdi_bspline_quadratic" };
    let transfer = match random.below(8) {
        0..4 => json!("flip"),
        4..6 => json!("apic"),
        6 => json!("pic"),
        _ => json!({"xpic": order(random, XPIC)}),
    };
    json!({"shape": shape, "transfer": transfer})
}

/// A random viscosity within the range.
fn viscosity(random: &mut Random) -> Value {
    let mut viscosity = json!({
        "linear": random.log_between(LINEAR[0], LINEAR[1]),
        "quadratic": random.log_between(QUADRATIC[0], QUADRATIC[1]),
    });
    if random.chance(0.65) {
        viscosity["limiter"] = json!("christensen");
        viscosity["limited"] = json!("linear");
    }
    if random.chance(0.4) {
        viscosity["growth"] = json!({"rate": 6.0, "max": 2.1});
        if random.chance(0.3) {
            viscosity["quadratic"] = json!(0.0);
        }
    }
    viscosity
}

/// A method with a random viscosity, Courant number and number of particles.
fn free(random: &mut Random, scene: &mut Value, method: Value) -> String {
    let particles = *random.one(&[1, 2, 2, 2, 2, 3, 4]);
    scene["artificial_viscosity"] = viscosity(random);
    let courant = if random.chance(0.5) { 0.4 } else { random.between(COURANT[0], COURANT[1]) };
    write(scene, method, courant, particles)
}

fn write(scene: &mut Value, method: Value, courant: f64, particles: u64) -> String {
    let words = |value: &Value| value.to_string().replace(['"', '{', '}'], "");
    let name = format!(
        "{} {} {}, {}/{:.2}, {particles} a cell, Courant {courant:.2}",
        if method.get("frame").is_some() { "TL" } else { "UL" },
        words(&method["shape"]),
        words(&method["transfer"]),
        scene["artificial_viscosity"]["linear"].as_f64().map_or("-".into(), |a| format!("{a:.3}")),
        scene["artificial_viscosity"]["quadratic"].as_f64().unwrap_or(0.0),
    );
    scene["method"] = method;
    scene["time"]["courant"] = json!(courant);
    for body in scene["bodies"].as_array_mut().into_iter().flatten() {
        body["particles_per_cell"] = json!([particles]);
    }
    name
}

/// A scheme with one key outside of the range.
fn unusual(random: &mut Random, scene: &mut Value) -> String {
    let mut method = match random.below(2) {
        0 => filtered(random, false),
        _ => unfiltered(random),
    };
    scene["artificial_viscosity"] = viscosity(random);
    let (mut courant, mut particles) = (0.4, 2);
    match random.below(6) {
        0 => scene["artificial_viscosity"]["linear"] = json!(random.between(0.25, 0.5)),
        1 => scene["artificial_viscosity"]["quadratic"] = json!(random.between(2.2, 4.0)),
        2 => courant = random.between(0.1, 0.2),
        3 => particles = 5 + random.below(4),
        4 => method = json!({"shape": "gimp", "transfer": "flip"}),
        _ => method = json!({"shape": "cpdi", "transfer": {"flip_pic": 0.98}}),
    }
    write(scene, method, courant, particles)
}
