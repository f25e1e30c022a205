//! Random valid scenes over all options of a scene: one dimension, plane and axisymmetric; every
//! shape function, transfer, stepping, energy, frame, contact, side and material model; cold and
//! hot bodies, bodies in initial tension or pressure, conduction at rest.

use proptest::prelude::*;
use proptest::sample::select;
use serde_json::{Map, Value, json};

use crate::random_scenes;

/// Cell size [m].
const CELL: f64 = 1e-4;

/// A material and the range of initial states of a body of it.
#[derive(Clone, Debug)]
struct Choice {
    name: &'static str,
    value: Value,
    /// Smallest and largest initial pressure [Pa].
    pressure: [f64; 2],
    /// Whether it has a temperature.
    thermal: bool,
}

fn material(name: &'static str, pressure: [f64; 2], value: Value) -> Choice {
    let thermal = value.get("thermal").is_some();
    Choice { name, value, pressure, thermal }
}

fn metal(extra: Value) -> Value {
    let mut value = json!({
        "density": 8930.0,
        "eos": {"type": "mie_gruneisen", "c0": 3940.0, "s": 1.489, "gamma0": 1.96},
    });
    super::scenes::merge(&mut value, &extra);
    value
}

/// Every kind of material in the scene format.
fn materials() -> Vec<Choice> {
    let thermal = json!({"specific_heat": 385.0, "reference_temperature": 300.0});
    let conducting =
        json!({"specific_heat": 385.0, "reference_temperature": 300.0, "conductivity": 400.0});
    let strong = json!({"type": "von_mises", "shear_modulus": 47e9, "yield_stress": 0.2e9});
    vec![
        material("copper", [-3e9, 3e9], metal(json!({}))),
        material(
            "aluminium",
            [-1e9, 3e9],
            json!({
                "density": 2785.0,
                "eos": {"type": "mie_gruneisen", "c0": 5386.0, "s": 1.339, "gamma0": 2.1},
            }),
        ),
        material("spalling", [-1e8, 1e9], metal(json!({"eos": {"tension_cutoff": 1.2e9}}))),
        material("gamma", [-1e9, 2e9], metal(json!({"eos": {"gruneisen": "gamma_constant"}}))),
        material("warm", [-1e9, 1e9], metal(json!({"thermal": thermal}))),
        material("conducting", [0.0, 0.0], metal(json!({"thermal": conducting}))),
        material("strong", [0.0, 0.0], metal(json!({"strength": strong}))),
        material("strong_warm", [0.0, 0.0], metal(json!({"strength": strong, "thermal": thermal}))),
        material(
            "failing",
            [0.0, 0.0],
            metal(json!({"strength": strong, "failure": {
                "type": "tension_limit", "stress": 1.5e9, "measure": "principal_stress",
            }})),
        ),
        material("library_steel", [0.0, 0.0], json!({"library": "steel_4340_johnson_cook"})),
        material("library_tantalum", [0.0, 0.0], json!({"library": "tantalum_steinberg_guinan"})),
        material("tillotson", [-1e8, 1e9], json!({"library": "iron_tillotson"})),
        material(
            "gas",
            [1e5, 1e8],
            json!({"density": 50.0, "eos": {"type": "ideal_gas", "gamma": 1.4}}),
        ),
        material(
            "stiff_gas",
            [0.0, 1e8],
            json!({"density": 1000.0, "eos": {"type": "stiffened_gas", "gamma": 4.4, "p_inf": 6e8}}),
        ),
        material(
            "tait",
            [0.0, 0.0],
            json!({"density": 1000.0, "eos": {"type": "tait", "bulk_modulus": 2.2e9, "exponent": 7.15}}),
        ),
        material(
            "tait_cut",
            [0.0, 0.0],
            json!({"density": 1000.0, "eos": {
                "type": "tait", "bulk_modulus": 2.2e9, "exponent": 7.15, "tension_cutoff": 1e7,
            }}),
        ),
        material(
            "noble_abel",
            [0.0, 1e8],
            json!({"density": 1057.0, "eos": {
                "type": "noble_abel_stiffened_gas", "gamma": 1.19, "p_inf": 7028e5, "covolume": 6.61e-4,
            }}),
        ),
        material(
            "vinet",
            [-1e9, 1e9],
            json!({"density": 8930.0, "eos": {
                "type": "vinet", "bulk_modulus": 138.6e9, "bulk_modulus_derivative": 4.96, "gamma0": 1.96,
            }}),
        ),
        material(
            "unreacted",
            [0.0, 1e8],
            json!({"density": 1895.0, "eos": {
                "type": "davis_reactants", "a": 1800.0, "b": 4.6, "c": 0.34, "gamma0": 0.56,
            }}),
        ),
        material("products", [0.0, 0.0], json!({"library": "tnt", "eos": {"burn": "complete"}})),
        material(
            "pores",
            [0.0, 0.0],
            json!({"density": 7144.0, "eos": {
                "type": "p_alpha",
                "solid": {"type": "mie_gruneisen", "c0": 3940.0, "s": 1.489, "gamma0": 1.96},
                "solid_density": 8930.0,
                "elastic_pressure": 0.1e9,
                "full_compaction_pressure": 1.6e9,
            }}),
        ),
        material(
            "hencky",
            [0.0, 0.0],
            json!({"density": 7830.0, "eos": {
                "type": "linear_elastic", "youngs_modulus": 200e9, "poissons_ratio": 0.3,
            }}),
        ),
        material(
            "rubber",
            [0.0, 0.0],
            json!({"density": 1000.0, "eos": {
                "type": "neo_hookean", "youngs_modulus": 1e9, "poissons_ratio": 0.3,
            }}),
        ),
    ]
}

/// The value at the fraction `share` in [0, 1] from `range[0]` to `range[1]`.
fn between(range: [f64; 2], share: f64) -> f64 {
    range[0] + share * (range[1] - range[0])
}

/// Random choices for one body: material, gap before it and length [cells], velocity [m/s],
/// fractions for pressure and temperature, whether each is given, particles per cell.
type Draw = (usize, f64, f64, f64, (f64, f64), (bool, bool), usize);

fn draw(calm: bool) -> impl Strategy<Value = Draw> {
    let most = if calm { 200.0 } else { 2500.0 };
    let velocity = prop_oneof![2 => Just(0.0), 2 => -100.0..100.0, 2 => -most..most];
    let gap = prop_oneof![2 => Just(0.0), 1 => 1.0..6.0];
    (
        0..materials().len(),
        gap,
        4.0..20.0f64,
        velocity,
        (0.0..1.0, 0.0..1.0),
        (any::<bool>(), any::<bool>()),
        1usize..=3,
    )
}

/// Bodies in a row along x, `across` cells wide.
fn bodies(
    draws: &[Draw],
    cells: usize,
    across: usize,
    place: Place,
    touch: bool,
) -> (Value, Value) {
    let plane = place != Place::Line;
    let (mut bodies, mut used) = (Vec::new(), Map::new());
    let mut at = if touch { 0.0 } else { 4.0 };
    let all = materials();
    for (k, &(which, gap, length, velocity, shares, given, count)) in draws.iter().enumerate() {
        let choice = &all[which];
        let gap = if touch && k == 0 { 0.0 } else { gap };
        let (lower, upper) = (at + gap, (at + gap + length).min(cells as f64 - 4.0));
        if upper - lower < 2.0 {
            break;
        }
        at = upper;
        used.insert(choice.name.into(), choice.value.clone());
        let vector = |x: f64, y: f64| if plane { json!([x, y]) } else { json!([x]) };
        let bottom = if touch { 0.0 } else { 2.0 * CELL };
        let top = (across as f64 - 2.0) * CELL;
        let mut body = json!({
            "name": format!("body {k}"),
            "material": choice.name,
            "box": {"lower": vector(lower * CELL, bottom), "upper": vector(upper * CELL, top)},
            "velocity": vector(velocity, 0.1 * velocity),
            "particles_per_cell": if plane { json!([count, 2]) } else { json!([count]) },
        });
        if choice.thermal && given.1 {
            body["temperature"] = json!(between([4.0, 900.0], shares.1));
        } else if given.0 || choice.pressure[0] > 0.0 {
            body["pressure"] = json!(between(choice.pressure, shares.0));
        }
        bodies.push(body);
    }
    (json!(bodies), Value::Object(used))
}

/// A scheme in either frame, with and without a limit on particle domains.
fn method() -> impl Strategy<Value = Value> {
    let options = (prop::bool::weighted(0.2), prop::bool::weighted(0.3));
    (random_scenes::method(), options).prop_map(|(mut method, (total, limit))| {
        let deforms = method["shape"].as_str().is_some_and(|shape| shape.starts_with("cpdi"));
        if total {
            method["frame"] = json!("total_lagrangian");
        } else if limit && deforms {
            method["domain_limit"] = json!(1.0);
        }
        method
    })
}

/// The scheme of `inputs/flyer_2d.json`, which is stable.
fn stable_method() -> Value {
    json!({
        "shape": "cpdi_bspline_quadratic",
        "transfer": {"fmpm": 4},
        "stepping": "midpoint",
        "energy": "compatible",
        "filter_heat": true,
        "pressure_relaxation": {"rate": 0.2, "interval": 1},
        "edge_mask": 0.3,
        "domain_limit": 1.0,
    })
}

/// Sides for bodies apart from them (`touch` false) or touching them.
fn side(plane: bool, touch: bool) -> BoxedStrategy<Value> {
    let mut sides: Vec<Value> =
        ["free", "symmetry", "wall", "outflow", "outflow"].map(|side| json!(side)).to_vec();
    if plane {
        sides.extend([json!("no_slip"), json!({"friction": 0.3})]);
    }
    if touch {
        sides.extend([json!("transmitting"), json!({"pressure": 1e8})]);
    }
    select(sides).boxed()
}

/// Geometry of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    Line,
    Plane,
    Axis,
}

fn boundary(place: Place, touch: bool) -> BoxedStrategy<Value> {
    let plane = place != Place::Line;
    let [near, far] = [touch, false].map(|touch| side(plane, touch));
    let sides = (near.clone(), far.clone(), near, far, 0u32..8);
    sides
        .prop_map(move |(a, b, c, d, kind)| {
            let mut all = json!({"x_lower": a, "x_upper": b});
            if plane {
                all["y_lower"] = c;
                all["y_upper"] = d;
            }
            match (kind, place) {
                (0, Place::Line | Place::Plane) => {
                    all["x_lower"] = json!("periodic");
                    all["x_upper"] = json!("periodic");
                }
                (1, Place::Line | Place::Plane) => {
                    all["x_lower"] = json!({"velocity": 150.0});
                    all["x_upper"] = json!("outflow");
                }
                _ => {}
            }
            if place == Place::Axis {
                all["x_lower"] = json!("symmetry");
            }
            all
        })
        .boxed()
}

fn contact(place: Place) -> BoxedStrategy<Value> {
    let mut all = vec![json!(null), json!(null), json!({"type": "frictionless"})];
    all.push(json!({"type": "stick"}));
    if place != Place::Line {
        all.push(json!({"type": "friction", "coefficient": 0.3}));
    }
    select(all).boxed()
}

/// Removes options that exclude another choice or have no effect.
fn reconcile(scene: &mut Value, place: Place) {
    let elastic = |name: &Value| name == "hencky" || name == "rubber";
    let solids =
        scene["bodies"].as_array().expect("bodies").iter().all(|b| elastic(&b["material"]));
    let total = scene["method"]["frame"] == "total_lagrangian";
    if solids {
        scene["method"].as_object_mut().expect("an object").remove("pressure_relaxation");
    }
    if total {
        if place != Place::Line {
            scene.as_object_mut().expect("an object").remove("contact");
        }
        for side in scene["boundary"].as_object_mut().into_iter().flat_map(|all| all.values_mut()) {
            if *side == "outflow" {
                *side = json!("free");
            }
        }
    }
}

fn scene_at(place: Place, calm: bool, touch: bool) -> BoxedStrategy<Value> {
    let plane = place != Place::Line;
    let method = if calm { Just(stable_method()).boxed() } else { method().boxed() };
    let viscosity = match calm {
        true => Just(json!({"linear": 0.1, "quadratic": 1.25, "limiter": "christensen"})).boxed(),
        false => random_scenes::viscosity().boxed(),
    };
    let open = |keys: &[&str]| {
        let all: Map<_, _> = keys.iter().map(|key| (key.to_string(), json!("outflow"))).collect();
        Value::Object(all)
    };
    let boundary = match (calm, place) {
        (false, _) => boundary(place, touch),
        // gases may leave, but nothing is driven
        (true, Place::Line) => Just(open(&["x_lower", "x_upper"])).boxed(),
        (true, Place::Plane) => Just(open(&["x_lower", "x_upper", "y_lower", "y_upper"])).boxed(),
        (true, Place::Axis) => {
            let mut all = open(&["x_upper", "y_lower", "y_upper"]);
            all["x_lower"] = json!("symmetry");
            Just(all).boxed()
        }
    };
    let parts = (
        prop::collection::vec(draw(calm), 1..=3),
        (28usize..=56, 8usize..=12),
        method,
        viscosity,
        boundary,
        contact(place),
        (0.1..=1.0f64, 0.2..2.0f64),
    );
    parts
        .prop_map(
            move |(
                draws,
                (cells, across),
                method,
                viscosity,
                boundary,
                contact,
                (courant, end),
            )| {
                let (bodies, materials) = bodies(&draws, cells, across, place, touch);
                let vector = |x: f64, y: f64| if plane { json!([x, y]) } else { json!([x]) };
                let mut domain = json!({
                    "lower": vector(0.0, 0.0),
                    "upper": vector(cells as f64 * CELL, across as f64 * CELL),
                    "cell_size": CELL,
                });
                if place == Place::Axis {
                    domain["geometry"] = json!("axisymmetric");
                }
                // a sound wave of 4 km/s crosses about ten to a hundred cells
                let end = end * if plane { 0.4e-6 } else { 1e-6 };
                let mut scene = json!({
                    "title": "valid",
                    "domain": domain,
                    "time": {"end": end, "courant": if calm { 0.4 } else { courant }},
                    "method": method,
                    "materials": materials,
                    "bodies": bodies,
                    "boundary": boundary,
                    "monitor": {"on_courant_exceeded": "reduce"},
                });
                if !viscosity.is_null() {
                    scene["artificial_viscosity"] = viscosity;
                }
                if !contact.is_null() {
                    scene["contact"] = contact;
                }
                reconcile(&mut scene, place);
                scene
            },
        )
        .boxed()
}

fn place() -> impl Strategy<Value = Place> {
    prop_oneof![4 => Just(Place::Line), 2 => Just(Place::Plane), 1 => Just(Place::Axis)]
}

/// A scene, which the check may reject if options exclude each other.
pub fn scene() -> impl Strategy<Value = Value> {
    (place(), any::<bool>()).prop_flat_map(|(place, touch)| scene_at(place, false, touch))
}

/// A scene of slow bodies with a stable scheme and open sides, which no run-time check may end.
pub fn calm_scene() -> impl Strategy<Value = Value> {
    place().prop_flat_map(|place| scene_at(place, true, false))
}
