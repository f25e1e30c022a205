//! The crater that a sphere of copper makes in a plate of steel at 3 km/s, with strength and failure,
//! by the default scheme.

use decomp::Serial;
use flyer_mpm::input;
use flyer_mpm::simulation::{Compiled, ParticleTable, Simulation};
use flyer_mpm::solver::Stepper;
use serde_json::{Value, json};

use crate::bounds::{Unit, contact::crater as bounds};
use crate::section::Extent;
use crate::table::Table;

/// Radius of the sphere [m].
const RADIUS: f64 = 2.5e-3;

/// Speed of the sphere [m/s].
const SPEED: f64 = 3e3;

/// Radius and thickness of the plate [m].
const PLATE: [f64; 2] = [0.015, 0.0125];

/// Width of the column at the axis, and depth of the layer below the surface, in which the steel is
/// summed [m].
const WIDTH: f64 = 1e-3;

/// Depth of that column and radius of that layer [m].
const EXTENT: [f64; 2] = [0.01, 0.0125];

/// Ratio to the temperature of the plane shock above which a particle counts as hot.
const HOT: f64 = 1.2;

/// Copper and steel with their spall strengths \[Pa\]: Johnson and Cook's law of failure alone lets a
/// release at the axis pull without limit, as long as nothing flows.
fn materials() -> Value {
    let metal = |library: &str, [c0, s, gamma0]: [f64; 3], spall: f64| {
        let eos = json!({
            "type": "mie_gruneisen", "c0": c0, "s": s, "gamma0": gamma0, "tension_cutoff": spall
        });
        json!({"library": library, "eos": eos, "failure": {"library": "johnson_cook"}})
    };
    json!({
        "copper": metal("copper_johnson_cook", [3940.0, 1.489, 1.96], 2e9),
        "steel": metal("steel_4340_johnson_cook", [4578.0, 1.33, 1.67], 4e9)
    })
}

/// The impact on cells of which `cells` fit into the radius of the sphere, to 10 us.
fn scene(cells: f64) -> Value {
    let [width, thickness] = PLATE;
    let plate = json!({"lower": [0.0, -thickness], "upper": [width, 0.0]});
    let disk = json!({"centre": [0.0, RADIUS], "radius": RADIUS});
    json!({
        "title": "crater",
        "domain": {
            "lower": [0.0, -0.0175], "upper": [0.02, 0.015], "cell_size": RADIUS / cells,
            "geometry": "axisymmetric"
        },
        "time": {"end": 1e-5},
        "materials": materials(),
        "bodies": [
            {"name": "sphere", "material": "copper", "disk": disk, "velocity": [0.0, -SPEED]},
            {"name": "plate", "material": "steel", "box": plate}
        ],
        "boundary": {
            "x_lower": "symmetry", "x_upper": "outflow", "y_lower": "outflow", "y_upper": "outflow"
        }
    })
}

/// The plane impact of the same metals, before its first release.
fn plane() -> Value {
    json!({
        "title": "plane impact",
        "domain": {"lower": [-0.012], "upper": [0.012], "cell_size": 5e-5},
        "time": {"end": 1e-6},
        "materials": materials(),
        "bodies": [
            {"name": "flyer", "material": "copper", "velocity": [SPEED],
                "box": {"lower": [-0.008], "upper": [0.0]}},
            {"name": "target", "material": "steel", "box": {"lower": [0.0], "upper": [0.01]}}
        ]
    })
}

/// Particles at the end, and relative drifts of energy and of momentum along the axis.
fn run<const D: usize>(scene: &Value) -> Result<(ParticleTable, [f64; 2]), String>
where
    Stepper<D>: Compiled<D>,
{
    let text = scene.to_string();
    let scene =
        input::parse(text.as_bytes(), "scene.json", &[]).map_err(|error| error.to_string())?;
    let mut simulation =
        Simulation::<D>::new(&scene, &Serial, 1).map_err(|error| error.to_string())?;
    let start = simulation.totals();
    let until = scene.scene.time.end;
    while simulation.time() < until {
        simulation.advance(until).map_err(|error| error.to_string())?;
    }
    let (end, left) = (simulation.totals(), simulation.left());
    let given = simulation.given();
    let energy = end.kinetic + end.internal + left.kinetic + left.internal
        - start.kinetic
        - start.internal
        - given.work;
    let axial = D - 1;
    let momentum =
        end.momentum[axial] + left.momentum[axial] - start.momentum[axial] - given.impulse[axial];
    let drifts = [energy / (start.kinetic + start.internal), momentum / start.absolute_momentum];
    let (table, _) = simulation.gather().ok_or("rank 0 gathers")?;
    Ok((table, drifts.map(f64::abs)))
}

fn column<'a>(table: &'a ParticleTable, name: &str) -> Result<&'a [f64], String> {
    table.column(name).ok_or(format!("no column {name}"))
}

/// Temperatures behind the plane shock in copper and in steel \[K\]: medians of the plateau.
fn plateau() -> Result<[f64; 2], String> {
    let (table, _) = run::<1>(&plane())?;
    let (pressure, temperature) = (column(&table, "pressure")?, column(&table, "temperature")?);
    let most = pressure.iter().copied().fold(0.0, f64::max);
    Ok([0, 1].map(|body| {
        let inside = |r: &usize| table.body[*r] == body && pressure[*r] > 0.9 * most;
        let mut plateau: Vec<f64> =
            (0..pressure.len()).filter(inside).map(|r| temperature[r]).collect();
        plateau.sort_by(f64::total_cmp);
        plateau[plateau.len() / 2]
    }))
}

/// Result of an impact.
struct Crater {
    /// Mean depth of the steel below the original surface, within a millimetre of the axis [mm].
    depth: f64,
    /// Mean radius of the hole in the steel, in the uppermost millimetre of the plate [mm].
    radius: f64,
    /// Mass fractions of sphere and plate hotter than [`HOT`] times the plane shock.
    hot: [f64; 2],
    drifts: [f64; 2],
}

/// Fraction of the length `size` around `centre` that lies between `lower` and `upper`.
fn share(centre: f64, size: f64, lower: f64, upper: f64) -> f64 {
    ((centre + 0.5 * size).min(upper) - (centre - 0.5 * size).max(lower)).max(0.0) / size
}

fn crater(cells: f64, shock: [f64; 2]) -> Result<Crater, String> {
    let (table, drifts) = run::<2>(&scene(cells))?;
    let (r, z) = (column(&table, "x")?, column(&table, "y")?);
    let (density, volume) = (column(&table, "density")?, column(&table, "volume")?);
    let temperature = column(&table, "temperature")?;
    let [depth, radius] = EXTENT;
    let (mut below, mut aside) = (0.0, 0.0);
    let mut hot = [[0.0; 2]; 2];
    for (p, &body) in table.body.iter().enumerate() {
        let (body, mass) = (body as usize, density[p] * volume[p]);
        hot[body][0] += mass;
        hot[body][1] += if temperature[p] > HOT * shock[body] { mass } else { 0.0 };
        if body == 1 {
            // the particle as a square in the plane of radius and axis; volumes are per radian
            let area = volume[p] / r[p];
            let size = area.sqrt();
            let within = |x: f64, lower: f64, upper: f64| share(x, size, lower, upper);
            below += area * within(r[p], 0.0, WIDTH) * within(z[p], -depth, 0.0);
            aside += area * within(r[p], 0.0, radius) * within(z[p], -WIDTH, 0.0);
        }
    }
    Ok(Crater {
        depth: 1e3 * (depth - below / WIDTH),
        radius: 1e3 * (radius - aside / WIDTH),
        hot: hot.map(|[all, hot]| hot / all),
        drifts,
    })
}

/// Depth, radius and hot mass on cells of several sizes.
pub fn check(table: &mut Table) {
    let Some(shock) = table.take("plane shock", plateau()) else { return };
    for (name, kelvin) in ["copper", "steel"].into_iter().zip(shock) {
        table.beside(&format!("{name} behind the plane shock [K]"), Some(kelvin), "", Unit::One);
    }
    let mut sizes = vec![5.0, 10.0, 20.0];
    if table.extent == Extent::Full {
        sizes.push(40.0);
    }
    let mut found: Vec<Crater> = Vec::new();
    for &cells in &sizes {
        let name = format!("{cells} cells a radius");
        let Some(crater) = table.take(&name, crater(cells, shock)) else { return };
        let figure = |what: &str| format!("{name}: {what}");
        table.beside(&figure("depth [mm]"), Some(crater.depth), "", Unit::One);
        table.beside(&figure("radius [mm]"), Some(crater.radius), "", Unit::One);
        let [energy, momentum] = crater.drifts;
        table.check(&figure("energy drift"), Some(energy), bounds::ENERGY_DRIFT);
        table.check(&figure("momentum drift"), Some(momentum), bounds::MOMENTUM_DRIFT);
        for (k, body) in ["sphere", "plate"].into_iter().enumerate() {
            let what = figure(&format!("mass above 1.2 of the plane shock's temperature, {body}"));
            table.beside(&what, Some(crater.hot[k]), "", Unit::Fraction);
            if let Some(coarser) = found.last() {
                let ratio = Some(crater.hot[k] / coarser.hot[k]);
                table.check(&format!("{what}, over that before"), ratio, bounds::HOT_MASS);
            }
        }
        found.push(crater);
    }
    for (what, of) in [("depth", depth as fn(&Crater) -> f64), ("radius", radius)] {
        let changes: Vec<f64> =
            found.windows(2).map(|pair| of(&pair[1]) / of(&pair[0]) - 1.0).collect();
        for (k, change) in changes.iter().enumerate().skip(1) {
            let figure = format!("{what}: change from {} to {} cells", sizes[k], sizes[k + 1]);
            table.check(&figure, Some(change.abs()), bounds::CHANGE);
            let ratio = (change / changes[k - 1]).abs();
            table.check(&format!("{figure}, over that before"), Some(ratio), bounds::CONVERGES);
        }
    }
}

fn depth(crater: &Crater) -> f64 {
    crater.depth
}

fn radius(crater: &Crater) -> f64 {
    crater.radius
}
