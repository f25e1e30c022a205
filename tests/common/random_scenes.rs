//! Random scenes in one dimension: bodies, sides and schemes.

use proptest::prelude::*;
use proptest::sample::select;
use serde_json::{Value, json};

use super::scenes::SHAPES;

/// Cell size [m].
pub const CELL: f64 = 1e-5;

/// A body: empty cells before it, its length [cells], velocity [m/s], material, particles per cell.
type Lump = (f64, f64, f64, &'static str, usize);

fn lump() -> impl Strategy<Value = Lump> {
    let gap = prop_oneof![Just(0.0), 0.0..12.0];
    let length = prop_oneof![Just(6.0), 1.0..30.0];
    // half of the bodies are at rest, so that patches are quiescent
    let velocity = prop_oneof![4 => Just(0.0), 3 => -900.0..900.0, 1 => -3000.0..3000.0];
    let material = select(&["copper", "aluminium", "aluminium", "gas"][..]);
    (gap, length, velocity, material, 1usize..=3)
}

/// Boxes in a row, as many as fit into the domain.
fn bodies(cells: usize, lumps: &[Lump]) -> Vec<Value> {
    let (mut bodies, mut at) = (Vec::new(), 0.0);
    for (k, &(gap, length, velocity, material, particles)) in lumps.iter().enumerate() {
        let (lower, upper) = (at + gap, (at + gap + length).min(cells as f64));
        if upper - lower < 1.0 {
            break;
        }
        bodies.push(json!({
            "name": format!("body {k}"),
            "material": material,
            "box": {"lower": [lower * CELL], "upper": [upper * CELL]},
            "velocity": [velocity],
            "pressure": if material == "gas" { 1e8 } else { 0.0 },
            "particles_per_cell": [particles],
        }));
        at = upper;
    }
    bodies
}

fn boundary() -> impl Strategy<Value = Value> {
    let side = || {
        let sides = ["free", "symmetry", "wall", "outflow", "transmitting"];
        select(sides.map(|side| json!(side)).to_vec())
    };
    let two = (side(), side()).prop_map(|(a, b)| json!({"x_lower": a, "x_upper": b}));
    let periodic = json!({"x_lower": "periodic", "x_upper": "periodic"});
    let piston = json!({"x_lower": {"velocity": 400.0}, "x_upper": "outflow"});
    prop_oneof![4 => two, 2 => Just(periodic), 1 => Just(piston)]
}

fn transfer() -> impl Strategy<Value = Value> {
    prop_oneof![
        Just(json!("flip")),
        Just(json!("pic")),
        Just(json!("apic")),
        (0.0..=1.0).prop_map(|a| json!({"flip_pic": a})),
        (1u32..=6).prop_map(|m| json!({"xpic": m})),
        (1u32..=6).prop_map(|m| json!({"fmpm": m})),
    ]
}

/// A scheme with those of the drawn options that its transfer and stepping support.
pub fn method() -> impl Strategy<Value = Value> {
    let update = select(&["last", "first", "modified_last"][..]);
    let relaxation = select(&[0u32, 1, 3][..]);
    let options = (any::<bool>(), any::<bool>(), any::<bool>(), relaxation);
    let scheme = (select(&SHAPES[..]), transfer(), any::<bool>(), update, options);
    scheme.prop_map(|(shape, transfer, midpoint, update, (exact, heat, mask, interval))| {
        let mut method = json!({"shape": shape, "transfer": transfer});
        if !midpoint {
            method["stress_update"] = json!(update);
            return method;
        }
        method["stepping"] = json!("midpoint");
        if exact && transfer != "apic" {
            method["energy"] = json!("compatible");
        }
        method["filter_heat"] = json!(heat && transfer != "flip" && transfer != "apic");
        if mask && transfer.get("fmpm").is_some() {
            method["edge_mask"] = json!(0.3);
        }
        if mask && transfer["fmpm"].as_u64().is_some_and(|order| order > 1) {
            method["mass_lumping"] = json!(0.1);
        }
        if mask && (method["energy"] == "compatible" || method["filter_heat"] == true) {
            method["heat_spreading"] = json!({"steps": 5});
        }
        if interval > 0 {
            method["pressure_relaxation"] = json!({"rate": 0.2, "interval": interval});
        }
        method
    })
}

/// Artificial viscosity with and without a limiter and a part in expansion, or none.
pub fn viscosity() -> impl Strategy<Value = Value> {
    let limiter = select(vec![json!(null), json!("christensen"), json!("nodal")]);
    let expansion = select(vec![json!(null), json!(0.1)]);
    let some = (limiter, expansion).prop_map(|(limiter, expansion)| {
        let mut viscosity = json!({"linear": 0.1, "quadratic": 1.0, "expansion": expansion});
        if !limiter.is_null() {
            viscosity["limiter"] = limiter;
        }
        viscosity
    });
    prop_oneof![1 => Just(json!(null)), 4 => some]
}

/// A scene, which the check may reject.
pub fn scene() -> impl Strategy<Value = Value> {
    let lumps = prop::collection::vec(lump(), 1..=4);
    // about 40 to 200 steps
    let end = 2e-8..8e-8;
    let parts = (20usize..=80, lumps, boundary(), method(), viscosity(), end);
    parts.prop_map(|(cells, lumps, boundary, method, viscosity, end)| {
        let solid = |density: f64, c0: f64, s: f64, gamma0: f64| {
            let eos = json!({"type": "mie_gruneisen", "c0": c0, "s": s, "gamma0": gamma0});
            json!({"density": density, "eos": eos})
        };
        let mut scene = json!({
            "title": "random",
            "domain": {"lower": [0.0], "upper": [cells as f64 * CELL], "cell_size": CELL},
            "time": {"end": end},
            "method": method,
            "materials": {
                "copper": solid(8930.0, 3940.0, 1.489, 1.96),
                "aluminium": solid(2785.0, 5386.0, 1.339, 2.1),
                "gas": {"density": 50.0, "eos": {"type": "ideal_gas", "gamma": 1.4}},
            },
            "bodies": bodies(cells, &lumps),
            "boundary": boundary,
        });
        if !viscosity.is_null() {
            scene["artificial_viscosity"] = viscosity;
        }
        scene
    })
}
