//! Random scenes outside of the range of the fit: strength, contact, gaps, layers, limited tension,
//! free surfaces, and bodies in a plane.

use flyer_mpm::input;
use flyer_mpm::input::LIBRARY;
use flyer_mpm::scene::CheckedScene;
use serde_json::{Value, json};

use crate::random::Random;

/// Kind of a random scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Two plates with strength.
    Strength,
    /// Two plates in contact without friction.
    Contact,
    /// Two plates with a gap between them.
    Gap,
    /// A flyer and two or three layers of target.
    Layers,
    /// Two plates with a `tension_cutoff`; the run ends after the release waves have met.
    LimitedTension,
    /// Two plates, until after the shock has reached the free surface of the target.
    FreeSurface,
    /// Two plates of finite width in a plane, joined, in contact or with friction.
    Plane,
    /// A disk or a sphere that strikes a plate, in a plane or about an axis.
    Round,
}

impl Kind {
    /// The kinds on a line.
    pub const LINES: [Kind; 6] = [
        Kind::Strength,
        Kind::Contact,
        Kind::Gap,
        Kind::Layers,
        Kind::LimitedTension,
        Kind::FreeSurface,
    ];

    /// The kinds in a plane.
    pub const PLANES: [Kind; 2] = [Kind::Plane, Kind::Round];

    /// Its name in words.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Strength => "strength",
            Kind::Contact => "contact",
            Kind::Gap => "gap",
            Kind::Layers => "layers",
            Kind::LimitedTension => "limited tension",
            Kind::FreeSurface => "free surface",
            Kind::Plane => "plates in a plane",
            Kind::Round => "disk or sphere on a plate",
        }
    }
}

/// Materials of the library: fluids.
const FLUIDS: [&str; 12] = [
    "aluminium_1100",
    "aluminium_2024",
    "copper",
    "iron",
    "lead",
    "lithium_fluoride",
    "nickel",
    "pmma",
    "steel_304",
    "tantalum",
    "titanium",
    "tungsten",
];

/// Materials of the library with strength.
const WITH_STRENGTH: [&str; 6] = [
    "copper_johnson_cook",
    "steel_4340_johnson_cook",
    "aluminium_2024_johnson_cook",
    "copper_steinberg_guinan",
    "aluminium_6061_steinberg_guinan",
    "tantalum_steinberg_guinan",
];

/// Impact speeds \[m/s\].
const SPEED: [f64; 2] = [100.0, 3000.0];
/// Cells in the flyer of a line, and along an edge or a diameter in a plane.
const CELLS: [[f64; 2]; 2] = [[10.0, 60.0], [10.0, 20.0]];
/// Cell size \[m\].
const CELL: f64 = 2e-5;
/// Tension that a material with limited tension carries \[Pa\].
const TENSION: [f64; 2] = [3e8, 3e9];

/// A random scene whose errors are estimated.
#[derive(Clone, Debug)]
pub struct RandomScene {
    /// Description in words.
    pub name: String,
    /// Its kind.
    pub kind: Kind,
    /// The scene.
    pub scene: Value,
}

impl RandomScene {
    /// The next scene of a kind that the program accepts.
    pub fn draw(random: &mut Random, kind: Kind) -> RandomScene {
        loop {
            let (name, scene) = match kind {
                Kind::Plane | Kind::Round => in_plane(random, kind),
                _ => on_line(random, kind),
            };
            let drawn = RandomScene { name, kind, scene };
            if drawn.checked().is_ok() {
                return drawn;
            }
        }
    }

    /// The scene, checked.
    ///
    /// # Errors
    ///
    /// If the scene is refused.
    pub fn checked(&self) -> Result<CheckedScene, String> {
        input::parse(self.scene.to_string().as_bytes(), &self.name, &[]).map_err(|e| e.to_string())
    }
}

/// A plate: its material, its thickness in cells, its bulk sound speed \[m/s\], and its impedance
/// \[kg/m2/s\].
struct Plate {
    material: &'static str,
    cells: f64,
    sound_speed: f64,
    impedance: f64,
}

impl Plate {
    fn draw(random: &mut Random, pool: &[&'static str], cells: f64) -> Plate {
        let material = *random.one(pool);
        let (_, text) = LIBRARY.iter().find(|(n, _)| *n == material).expect("it is in the library");
        let entry: Value = serde_json::from_str(text).expect("the library is valid");
        let sound_speed = entry["eos"]["c0"].as_f64().expect("a Mie-Grueneisen material");
        let density = entry["density"].as_f64().expect("a material has a density");
        Plate { material, cells: cells.round(), sound_speed, impedance: density * sound_speed }
    }

    /// Time in which a sound wave crosses it \[s\].
    fn transit(&self) -> f64 {
        self.cells * CELL / self.sound_speed
    }

    fn thickness(&self) -> f64 {
        self.cells * CELL
    }
}

/// Writes a preset of the method: the default in half of the scenes.
fn method(random: &mut Random, scene: &mut Value) -> &'static str {
    let preset = *random.one(&["default", "default", "sharpest", "robust"]);
    if preset != "default" {
        scene["method"] = json!(preset);
    }
    preset
}

fn speed(random: &mut Random) -> f64 {
    random.log_between(SPEED[0], SPEED[1]).round()
}

/// Plates on a line: the flyer flies from below.
fn on_line(random: &mut Random, kind: Kind) -> (String, Value) {
    let pool: &[&str] = if kind == Kind::Strength { &WITH_STRENGTH } else { &FLUIDS };
    let cells = random.log_between(CELLS[0][0], CELLS[0][1]);
    let flyer = Plate::draw(random, pool, cells);
    let times = random.between(1.5, 3.0);
    let target = Plate::draw(random, pool, times * cells);
    let (speed, offset) = (speed(random), random.between(0.0, 1.0) * CELL);
    let gap = if kind == Kind::Gap { random.between(0.5, 10.0) * CELL } else { 0.0 };
    let layers = if kind == Kind::Layers { 1 + random.below(2) } else { 0 };
    let behind: Vec<Plate> = (0..layers)
        .map(|_| {
            let cells = random.between(0.5, 1.5) * cells;
            Plate::draw(random, pool, cells)
        })
        .collect();
    let crossed = match kind {
        Kind::FreeSurface => random.between(1.1, 1.6),
        Kind::LimitedTension => random.between(1.8, 2.5),
        _ => random.between(0.5, 0.9),
    };
    let passed: f64 = behind.iter().map(Plate::transit).sum();
    let end = gap / speed + crossed * (target.transit() + passed);
    let mut bodies = vec![json!({
        "name": "flyer", "material": flyer.material, "velocity": [speed],
        "box": {"lower": [-gap - flyer.thickness()], "upper": [-gap]}, "particles_per_cell": [2],
    })];
    let mut from = 0.0;
    for (k, plate) in std::iter::once(&target).chain(&behind).enumerate() {
        let name = if k == 0 { "target".to_string() } else { format!("layer_{k}") };
        bodies.push(json!({
            "name": name, "material": plate.material, "particles_per_cell": [2],
            "box": {"lower": [from], "upper": [from + plate.thickness()]},
        }));
        from += plate.thickness();
    }
    let margin = (speed * end / CELL + 20.0).ceil() * CELL;
    let lower = -gap - flyer.thickness() - margin - offset;
    let all = ((from + margin - lower) / CELL).ceil() * CELL;
    let mut materials = serde_json::Map::new();
    for plate in [&flyer, &target].into_iter().chain(&behind) {
        materials.insert(plate.material.into(), json!({"library": plate.material}));
    }
    let tension = random.log_between(TENSION[0], TENSION[1]);
    if kind == Kind::LimitedTension {
        for entry in materials.values_mut() {
            let name = entry["library"].as_str().expect("it was just written").to_string();
            *entry = limited(&name, tension);
        }
    }
    let mut scene = json!({
        "format": 2,
        "domain": {"lower": [lower], "upper": [lower + all], "cell_size": CELL},
        "time": {"end": end},
        "materials": materials,
        "bodies": bodies,
        "output": {
            "profiles": {"times": [0.5 * end, end]}, "pictures": false, "hdf5": false,
            "histories": {
                "stations": [{"name": "station", "at": [0.4 * target.thickness()]}],
                "velocimeters": [{"name": "rear", "body": last_body(&bodies), "at": [from]}],
            },
        },
        "error_estimate": {
            "body": "target", "arrivals": [0.4 * target.thickness()], "fields": ["pressure", "velocity"],
        },
    });
    // a flyer of lower impedance rebounds from the target, so that the scene needs contact
    if matches!(kind, Kind::Contact | Kind::Gap) || flyer.impedance < target.impedance {
        scene["contact"] = json!({"type": "frictionless"});
    }
    let preset = method(random, &mut scene);
    let name = format!(
        "{}: {} on {} at {speed} m/s, {:.0} cells, {preset}",
        kind.name(),
        flyer.material,
        target.material,
        flyer.cells
    );
    scene["title"] = json!(name);
    (name, scene)
}

/// The library material `name` with the greatest tension `tension` \[Pa\].
fn limited(name: &str, tension: f64) -> Value {
    let (_, text) = LIBRARY.iter().find(|(n, _)| *n == name).expect("it is in the library");
    let mut entry: Value = serde_json::from_str(text).expect("the library is valid");
    entry["eos"]["tension_cutoff"] = json!(tension);
    entry
}

fn last_body(bodies: &[Value]) -> &Value {
    &bodies.last().expect("there are two bodies")["name"]
}

/// Bodies in a plane or about an axis: the striking one falls along y.
fn in_plane(random: &mut Random, kind: Kind) -> (String, Value) {
    let pool: &[&str] = if random.chance(0.3) { &WITH_STRENGTH } else { &FLUIDS };
    let cell = 2.0 * CELL;
    let size = random.between(CELLS[1][0], CELLS[1][1]).round();
    let (flyer, target) = (Plate::draw(random, pool, size), Plate::draw(random, pool, size));
    let (speed, is_axis) = (speed(random), random.chance(0.5));
    let [width, target_width] = [random.between(0.6, 1.5) * size, random.between(1.6, 2.5) * size]
        .map(|cells| cells.round() * cell);
    let thickness = size * cell;
    let shift = random.between(0.0, 1.0) * cell;
    let end = random.between(0.6, 1.2) * (target.transit() + flyer.transit());
    let margin = ((1.2 * speed * end + 10.0 * cell) / cell).ceil() * cell;
    let (shape, widest) = match kind {
        Kind::Round => {
            let radius = 0.5 * thickness;
            (json!({"disk": {"centre": [0.0, radius], "radius": radius}}), radius)
        }
        _ => (json!({"box": {"lower": [0.0, 0.0], "upper": [width, thickness]}}), width),
    };
    let mut striking =
        json!({"name": "flyer", "material": flyer.material, "velocity": [0.0, -speed]});
    for (key, value) in shape.as_object().expect("a shape is an object") {
        striking[key] = value.clone();
    }
    let across = target_width.max(widest) + margin;
    let below = thickness + margin + shift;
    let upward = ((thickness + margin + below) / cell).ceil() * cell;
    let mut materials = serde_json::Map::new();
    for plate in [&flyer, &target] {
        materials.insert(plate.material.into(), json!({"library": plate.material}));
    }
    let at = [0.25 * widest, -0.4 * thickness];
    let mut scene = json!({
        "format": 2,
        "domain": {
            "lower": [0.0, -below], "upper": [(across / cell).ceil() * cell, upward - below],
            "cell_size": cell,
        },
        "time": {"end": end},
        "boundary": {"x_lower": "symmetry"},
        "materials": materials,
        "bodies": [striking, {
            "name": "target", "material": target.material,
            "box": {"lower": [0.0, -thickness], "upper": [target_width, 0.0]},
        }],
        "output": {
            "profiles": {"times": [0.5 * end, end]}, "pictures": false, "hdf5": false,
            "histories": {
                "stations": [{"name": "station", "at": at}],
                "tracers": [{"name": "tracer", "body": "target", "at": at}],
            },
        },
        "error_estimate": {"fields": ["pressure", "velocity"]},
    });
    if is_axis {
        scene["domain"]["geometry"] = json!("axisymmetric");
    }
    let contact = *random.one(&["joined", "frictionless", "friction"]);
    match contact {
        "frictionless" => scene["contact"] = json!({"type": "frictionless"}),
        "friction" => {
            let coefficient = random.between(0.1, 0.5);
            scene["contact"] = json!({"type": "friction", "coefficient": coefficient});
        }
        _ => {}
    }
    let preset = method(random, &mut scene);
    let name = format!(
        "{}: {} on {} at {speed} m/s, {size:.0} cells, {contact}, {preset}{}",
        kind.name(),
        flyer.material,
        target.material,
        if is_axis { ", axis" } else { "" },
    );
    scene["title"] = json!(name);
    (name, scene)
}
