//! Random plate impacts: materials, speeds, thicknesses, schemes, cell sizes, position of the
//! interface on the grid.

use flyer_mpm::accuracy::estimate::FittedRange;
use flyer_mpm::accuracy::plan;
use flyer_mpm::exact::{Impact, ImpactBody};
use flyer_mpm::input;
use flyer_mpm::input::LIBRARY;
use flyer_mpm::material::MieGruneisen;
use flyer_mpm::scene::CheckedScene;
use serde_json::{Value, json};

use crate::random::Random;
use crate::random_schemes::{self, Schemes};

/// Library materials of the fit.
pub const FITTED: [&str; 7] =
    ["copper", "aluminium_2024", "tantalum", "steel_304", "lead", "pmma", "nickel"];
/// Library materials with which the error models are compared. No material is in both lists.
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

/// Density of the materials of the fit \[kg/m3\].
const DENSITY: [f64; 2] = [900.0, 20_000.0];
/// Their bulk sound speed \[m/s\].
const C0: [f64; 2] = [1500.0, 8000.0];
/// Their slope of the Us-up line.
const SLOPE: [f64; 2] = [0.75, 2.0];
/// Their Grueneisen coefficient.
const GAMMA0: [f64; 2] = [0.5, 3.0];
/// Speeds of the impacts \[m/s\].
const SPEED: [f64; 2] = [100.0, 5000.0];
/// Cells in a flyer.
const FLYER_CELLS: [f64; 2] = [5.0, 120.0];
/// End of the run over the time at which the release from the flyer's rear reaches the interface.
const DURATION: [f64; 2] = [0.6, 4.0];
/// Place of the arrival over the way of the shock to the end.
const PLACE: [f64; 2] = [0.3, 0.8];
/// Most cells that the shock crosses, which limits the cost of a run.
const MOST_WAY: f64 = 800.0;

/// What impacts are drawn from.
#[derive(Clone, Copy, Debug)]
pub struct Draw<'a> {
    /// Names of library materials.
    pub library: &'a [&'a str],
    /// Share of bodies of a random material that no library has.
    pub invented: f64,
    /// Schemes.
    pub schemes: Schemes,
    /// Whether speed or cells are outside of the range of the fit.
    pub beyond: bool,
}

/// The range of the impacts of the fit.
pub fn range() -> FittedRange {
    FittedRange {
        density: DENSITY,
        c0: C0,
        s: SLOPE,
        gamma0: GAMMA0,
        speed: SPEED,
        flyer_cells: FLYER_CELLS,
        duration: DURATION,
        place: PLACE,
        schemes: random_schemes::range(),
    }
}

/// A random impact.
#[derive(Clone, Debug)]
pub struct RandomImpact {
    /// What it is, in words.
    pub name: String,
    /// Speed of the flyer \[m/s\].
    pub speed: f64,
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

/// A random material: its constants and its entry in a scene.
fn any_material(random: &mut Random, draw: &Draw<'_>) -> (String, MieGruneisen, Value) {
    if !random.chance(draw.invented) {
        let name = *random.one(draw.library);
        return (name.to_string(), material(name), json!({"library": name}));
    }
    let m = MieGruneisen {
        rho0: random.log_between(DENSITY[0], DENSITY[1]),
        c0: random.log_between(C0[0], C0[1]),
        s: random.between(SLOPE[0], SLOPE[1]),
        gamma0: random.between(GAMMA0[0], GAMMA0[1]),
    };
    let name = format!("{:.0} kg/m3 with c0 {:.0} m/s", m.rho0, m.c0);
    let eos = json!({"type": "mie_gruneisen", "c0": m.c0, "s": m.s, "gamma0": m.gamma0});
    (name, m, json!({"density": m.rho0, "eos": eos}))
}

/// The next impact that a scene can be made of.
pub fn impact(random: &mut Random, draw: &Draw<'_>) -> RandomImpact {
    loop {
        if let Some(impact) = attempt(random, draw) {
            return impact;
        }
    }
}

/// Speed and cells in the flyer.
fn speed_and_cells(random: &mut Random, draw: &Draw<'_>) -> [f64; 2] {
    let speed = random.log_between(SPEED[0], SPEED[1]);
    let cells = random.log_between(FLYER_CELLS[0], FLYER_CELLS[1]);
    // an unusual scheme is outside already
    if !draw.beyond || draw.schemes == Schemes::Unusual {
        return [speed, cells];
    }
    match random.below(4) {
        0 => [random.between(SPEED[1] + 1.0, 7000.0), cells],
        1 => [random.log_between(50.0, SPEED[0] - 1.0), cells],
        2 => [speed, random.between(2.0, FLYER_CELLS[0] - 1.0)],
        _ => [speed, random.between(FLYER_CELLS[1] + 1.0, 160.0)],
    }
}

fn attempt(random: &mut Random, draw: &Draw<'_>) -> Option<RandomImpact> {
    let (flyer, f, flyer_entry) = any_material(random, draw);
    let (target, t, target_entry) = any_material(random, draw);
    let [speed, cells] = speed_and_cells(random, draw);
    let (speed, cells) = (speed.round(), cells.round());
    let thickness = random.between(0.2e-3, 1e-3);
    let duration = random.log_between(DURATION[0], DURATION[1]);
    let place = random.between(PLACE[0], PLACE[1]);
    let offset = random.between(0.0, 1.0);
    let flyer_body = ImpactBody { material: f, lower: -thickness, upper: 0.0, velocity: speed };
    let target_body = ImpactBody { material: t, lower: 0.0, upper: 1.0, velocity: 0.0 };
    let release = Impact::new(flyer_body, target_body).ok()?.release(4).ok()?;
    let end = duration * release.head_time;
    let h = thickness / cells;
    let travel = release.target_shock * end;
    if travel > MOST_WAY * h {
        return None;
    }
    let length = (1.15 * travel / h).ceil() * h;
    let margin = ((speed * end / h).ceil() + 20.0) * h;
    let mut names = serde_json::Map::new();
    names.insert("of flyer".into(), flyer_entry);
    names.insert("of target".into(), target_entry);
    let body = |name: &str, lower: f64, upper: f64, velocity: f64| {
        json!({"name": name, "material": format!("of {name}"), "velocity": [velocity],
               "box": {"lower": [lower], "upper": [upper]}, "particles_per_cell": [2]})
    };
    let mut scene = plan::standard();
    // the interface lies anywhere between two grid lines
    let lower = -thickness - margin - offset * h;
    let all = ((thickness + margin + length) / h + 12.0).round() * h;
    for (key, value) in [
        ("domain", json!({"lower": [lower], "upper": [lower + all], "cell_size": h})),
        ("time", json!({"end": end, "courant": 0.4})),
        ("materials", Value::Object(names)),
        (
            "bodies",
            json!([body("flyer", -thickness, 0.0, speed), body("target", 0.0, length, 0.0)]),
        ),
        ("output", json!({"pictures": false, "hdf5": false})),
        ("error_estimate", json!({"arrivals": [place * travel]})),
    ] {
        scene[key] = value;
    }
    // a flyer softer than its target leaves it
    if f.rho0 * f.c0 < t.rho0 * t.c0 {
        scene["contact"] = json!({"type": "frictionless"});
    }
    let scheme = random_schemes::apply(random, draw.schemes, &mut scene);
    let name = format!("{flyer} on {target} at {speed} m/s, {cells} cells, {scheme}");
    scene["title"] = json!(name);
    let impact = RandomImpact { name, speed, scene };
    impact.checked().is_ok().then_some(impact)
}

impl RandomImpact {
    /// Its scene, checked.
    ///
    /// # Errors
    ///
    /// If the scene is refused.
    pub fn checked(&self) -> Result<CheckedScene, String> {
        input::parse(self.scene.to_string().as_bytes(), &self.name, &[]).map_err(|e| e.to_string())
    }
}
