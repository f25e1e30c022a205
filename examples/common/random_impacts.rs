//! Random plate impacts: materials of the library, speeds, thicknesses, schemes, cell sizes.

use flyer_mpm::accuracy::estimate::FittedRange;
use flyer_mpm::accuracy::plan;
use flyer_mpm::exact::{Impact, ImpactBody};
use flyer_mpm::input;
use flyer_mpm::input::LIBRARY;
use flyer_mpm::material::MieGruneisen;
use flyer_mpm::scene::CheckedScene;
use serde_json::{Value, json};

/// Numbers that look random and are the same everywhere (Steele, Lea & Flood 2014, SplitMix64).
pub struct Random(u64);

impl Random {
    /// Those of a seed.
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Evenly between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// An integer below `limit`.
    pub fn below(&mut self, limit: u64) -> u64 {
        self.next() % limit
    }

    /// One of some.
    pub fn one<'a, T>(&mut self, of: &'a [T]) -> &'a T {
        &of[self.below(of.len() as u64) as usize]
    }
}

/// Materials to which laws are fitted, and materials with which they are compared.
#[allow(dead_code, reason = "each program uses a part")]
pub const FITTED: [&str; 7] =
    ["copper", "aluminium_2024", "tantalum", "steel_304", "lead", "pmma", "nickel"];
/// No material is in both.
pub const HELD_OUT: [&str; 8] = [
    "gold",
    "aluminium_6061",
    "aluminium_1100",
    "tungsten",
    "iron",
    "titanium",
    "lithium_fluoride",
    "steel_4340",
];

/// Speeds of the impacts \[m/s\].
const SPEED: [f64; 2] = [300.0, 3000.0];
/// Cells in a flyer.
const FLYER_CELLS: [f64; 2] = [25.0, 60.0];
/// End of the run over the time at which the release from the flyer's rear reaches the interface.
const DURATION: [f64; 2] = [0.6, 3.0];
/// Place of the arrival over the way of the shock to the end.
const PLACE: [f64; 2] = [0.3, 0.8];

/// The range of the impacts of all these materials.
#[allow(dead_code, reason = "each program uses a part")]
pub fn range() -> FittedRange {
    let all: Vec<MieGruneisen> =
        FITTED.iter().chain(&HELD_OUT).map(|name| material(name)).collect();
    let ends = |of: fn(&MieGruneisen) -> f64| {
        let values = || all.iter().map(of);
        [values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)]
    };
    FittedRange {
        density: ends(|m| m.rho0),
        c0: ends(|m| m.c0),
        s: ends(|m| m.s),
        gamma0: ends(|m| m.gamma0),
        speed: SPEED,
        flyer_cells: FLYER_CELLS,
        duration: DURATION,
        place: PLACE,
        schemes: plan::schemes().into_iter().map(|scheme| scheme.name).collect(),
    }
}

/// A random impact.
pub struct RandomImpact {
    /// What it is, in words.
    pub name: String,
    /// Its scene.
    pub scene: Value,
}

fn material(name: &str) -> MieGruneisen {
    let (_, text) = LIBRARY.iter().find(|(n, _)| *n == name).expect("the library has it");
    let value: Value = serde_json::from_str(text).expect("the library is whole");
    let of = |path: &str| value.pointer(path).and_then(Value::as_f64).expect("a fluid");
    MieGruneisen {
        rho0: of("/density"),
        c0: of("/eos/c0"),
        s: of("/eos/s"),
        gamma0: of("/eos/gamma0"),
    }
}

/// The next impact of these materials that a scene can be made of, with any scheme of the
/// planner's list.
pub fn impact(random: &mut Random, materials: &[&str]) -> RandomImpact {
    loop {
        if let Some(impact) = attempt(random, materials) {
            return impact;
        }
    }
}

fn attempt(random: &mut Random, materials: &[&str]) -> Option<RandomImpact> {
    let (flyer, target) = (*random.one(materials), *random.one(materials));
    let speed = random.log_between(SPEED[0], SPEED[1]).round();
    let thickness = random.between(0.2e-3, 1e-3);
    let cells = random.between(FLYER_CELLS[0], FLYER_CELLS[1]).round();
    let schemes = plan::schemes();
    let scheme = random.one(&schemes);
    let duration = random.between(DURATION[0], DURATION[1]);
    let place = random.between(PLACE[0], PLACE[1]);
    let (f, t) = (material(flyer), material(target));
    let flyer_body = ImpactBody { material: f, lower: -thickness, upper: 0.0, velocity: speed };
    let target_body = ImpactBody { material: t, lower: 0.0, upper: 1.0, velocity: 0.0 };
    let release = Impact::new(flyer_body, target_body).ok()?.release(4).ok()?;
    let end = duration * release.head_time;
    let h = thickness / cells;
    let travel = release.target_shock * end;
    let length = (1.15 * travel / h).ceil() * h;
    let margin = ((speed * end / h).ceil() + 20.0) * h;
    let named = |name: &str| json!({"library": name});
    let mut names = serde_json::Map::new();
    names.insert(flyer.into(), named(flyer));
    names.insert(target.into(), named(target));
    let body = |name: &str, material: &str, lower: f64, upper: f64, velocity: f64| {
        json!({"name": name, "material": material, "box": {"lower": [lower], "upper": [upper]},
               "velocity": [velocity], "particles_per_cell": [2]})
    };
    let mut scene = plan::standard();
    let title = format!("{flyer} on {target} at {speed} m/s, {}", scheme.name);
    for (key, value) in [
        ("title", json!(title)),
        (
            "domain",
            json!({
                "lower": [-thickness - margin],
                "upper": [-thickness - margin + ((thickness + margin + length) / h + 10.0).round() * h],
                "cell_size": h,
            }),
        ),
        ("time", json!({"end": end, "courant": 0.4})),
        ("materials", Value::Object(names)),
        (
            "bodies",
            json!([
                body("flyer", flyer, -thickness, 0.0, speed),
                body("target", target, 0.0, length, 0.0),
            ]),
        ),
        ("output", json!({"pictures": false, "hdf5": false})),
        ("error_estimate", json!({"arrivals": [place * travel]})),
    ] {
        scene[key] = value;
    }
    scheme.apply(&mut scene);
    // a flyer softer than its target leaves it
    if f.rho0 * f.c0 < t.rho0 * t.c0 {
        scene["contact"] = json!({"type": "frictionless"});
    }
    let impact = RandomImpact { name: title, scene };
    impact.checked().is_ok().then_some(impact)
}

impl RandomImpact {
    /// Its scene, checked.
    pub fn checked(&self) -> Result<CheckedScene, String> {
        input::parse(self.scene.to_string().as_bytes(), &self.name, &[]).map_err(|e| e.to_string())
    }
}
