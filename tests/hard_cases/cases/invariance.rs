//! Translation, mirror image, shift, units, a moving frame, borders of patches, odd times.

use decomp::Serial;
use decomp::comm::local::run_ranks;
use serde_json::{Value, json};

use super::scenes::{shipped, with};
use super::tools::{
    CELL, Ended, FIELDS, apart, failed, flyer, hard, run, run_on, scored, short, until,
};
use super::{Figure, figure};

/// 10 km/s through patches and a periodic domain, a body under pressure among them.
pub fn translation() -> Vec<Figure> {
    let mut value = hard("flight.json");
    value["domain"]["patches"] = json!([5]);
    match run(&until(&value, &[2e-7])) {
        Ok(ended) => {
            let v =
                ended.column("velocity").iter().map(|v| (v / 1e4 - 1.0).abs()).fold(0.0, f64::max);
            let rho = ended.column("density").iter().map(|r| (r / 8930.0 - 1.0).abs());
            let p = ended.column("pressure").iter().map(|p| p.abs()).fold(0.0, f64::max);
            vec![
                figure("10 km/s for 200 cells: velocity", v, 1e-9),
                figure("10 km/s for 200 cells: density", rho.fold(0.0, f64::max), 1e-9),
                figure("10 km/s for 200 cells: pressure over rho c^2", p / 1.386e11, 1e-9),
            ]
        }
        Err(e) => vec![figure("10 km/s", failed("10 km/s", &e), 0.0)],
    }
}

/// The greatest difference of any field, of its scale.
fn fields_apart(a: &Ended<1>, b: &Ended<1>) -> f64 {
    FIELDS.iter().map(|name| apart(b.column(name), a.column(name))).fold(0.0, f64::max)
}

fn edit(value: &mut Value, places: &[&str], map: impl Fn(f64) -> f64) {
    for place in places {
        let number = value.pointer_mut(place).expect("a place");
        *number = json!(map(number.as_f64().expect("a number")));
    }
}

const PLACES: [&str; 6] = [
    "/domain/lower/0",
    "/domain/upper/0",
    "/bodies/0/box/lower/0",
    "/bodies/0/box/upper/0",
    "/bodies/1/box/lower/0",
    "/bodies/1/box/upper/0",
];

/// The mirror image, and a shift by whole cells.
pub fn mirror_and_shift() -> Vec<Figure> {
    let scene = short(0.3e-6);
    let mut mirror = scene.clone();
    let turn = |extent: &mut Value| {
        let [lower, upper] =
            ["lower", "upper"].map(|key| extent[key][0].as_f64().expect("a number"));
        extent["lower"] = json!([-upper]);
        extent["upper"] = json!([-lower]);
    };
    turn(&mut mirror["domain"]);
    for body in 0..2 {
        turn(&mut mirror["bodies"][body]["box"]);
        edit(&mut mirror, &[&format!("/bodies/{body}/velocity/0")], |v| 0.0 - v);
    }
    let mut shifted = scene.clone();
    edit(&mut shifted, &PLACES, |x| x - 240.0 * CELL);
    let compare = |other: &Value, turned: bool| -> Result<f64, String> {
        let (here, mut there) = (run(&scene)?, run(other)?);
        if let (true, Some(table)) = (turned, there.tables.last_mut()) {
            for column in &mut table.columns {
                column.values.reverse();
                if column.name == "velocity" {
                    column.values.iter_mut().for_each(|v| *v = -*v);
                }
            }
        }
        Ok(fields_apart(&here, &there))
    };
    vec![
        figure(
            "mirror image",
            compare(&mirror, true).unwrap_or_else(|e| failed("mirror", &e)),
            1e-9,
        ),
        figure(
            "shift by 240 cells",
            compare(&shifted, false).unwrap_or_else(|e| failed("shift", &e)),
            1e-9,
        ),
    ]
}

/// The scene in units that are 2^length metres, 2^time seconds, 2^mass kilograms.
fn in_units(scene: &Value, [length, time, mass]: [i32; 3]) -> Value {
    let factor = |l: i32, t: i32, m: i32| 2f64.powi(-(length * l + time * t + mass * m));
    fn scale(value: &mut Value, factor: f64) {
        match value {
            Value::Array(values) => values.iter_mut().for_each(|v| scale(v, factor)),
            _ => *value = json!(value.as_f64().expect("a number") * factor),
        }
    }
    let mut value = scene.clone();
    for key in ["lower", "upper", "cell_size"] {
        scale(&mut value["domain"][key], factor(1, 0, 0));
    }
    scale(&mut value["time"]["end"], factor(0, 1, 0));
    scale(&mut value["output"]["profiles"]["times"], factor(0, 1, 0));
    for body in value["bodies"].as_array_mut().expect("bodies") {
        for key in ["lower", "upper"] {
            scale(&mut body["box"][key], factor(1, 0, 0));
        }
        scale(&mut body["velocity"], factor(1, -1, 0));
    }
    for material in value["materials"].as_object_mut().expect("materials").values_mut() {
        scale(&mut material["density"], factor(-3, 0, 1));
        scale(&mut material["eos"]["c0"], factor(1, -1, 0));
    }
    value
}

/// Rows whose velocity, in its unit, is not the same bits.
fn other_bits(scene: &Value, units: [i32; 3]) -> Result<f64, String> {
    let (plain, other) = (run(scene)?, run(&in_units(scene, units))?);
    let factor = 2f64.powi(units[1] - units[0]);
    let pairs = plain.column("velocity").iter().zip(other.column("velocity"));
    Ok(pairs.filter(|(a, b)| (**a * factor).to_bits() != b.to_bits()).count() as f64)
}

/// Units scaled by powers of two.
pub fn units() -> Vec<Figure> {
    let scene = short(0.2e-6);
    [[7, 0, 0], [0, -9, 0], [0, 0, 13], [-5, 11, -3]]
        .into_iter()
        .map(|units| {
            let what = format!("units of 2^{units:?}: rows of other bits");
            let rows = other_bits(&scene, units).unwrap_or_else(|e| failed(&what, &e));
            figure(what, rows, 0.0)
        })
        .collect()
}

/// Cells of 1e-12 m, a domain of 1e6 m and more.
pub fn scales() -> Vec<Figure> {
    let scene = short(0.2e-6);
    [("cells of 1.2e-12 m", [23, 23, 0]), ("a domain of 4.3e6 m", [-30, -30, 0])]
        .into_iter()
        .map(|(what, units)| {
            let rows = other_bits(&scene, units).unwrap_or_else(|e| failed(what, &e));
            figure(format!("{what}: rows of other bits"), rows, 0.0)
        })
        .collect()
}

/// The standard problem seen from a moving frame.
pub fn galilean() -> Vec<Figure> {
    let last = |value: &Value| -> Result<f64, String> {
        let (_, errors) = scored(value)?;
        Ok(errors[1].l1.unwrap_or(f64::NAN))
    };
    let usual = last(&flyer()).unwrap_or_else(|e| failed("at rest", &e));
    [137.0, -411.0, 3000.0]
        .into_iter()
        .map(|speed| {
            let mut value = flyer();
            edit(&mut value, &["/domain/lower/0"], |x| x - 5e-4);
            edit(&mut value, &["/domain/upper/0"], |x| x + 15e-4);
            edit(&mut value, &["/bodies/0/velocity/0", "/bodies/1/velocity/0"], |v| v + speed);
            let what = format!("seen from {speed} m/s: L1 more by");
            let l1 = last(&value).unwrap_or_else(|e| failed(&what, &e));
            figure(what, l1 / usual - 1.0, 0.2)
        })
        .collect()
}

/// Borders of patches and of ranks at the interface, the shock and a free surface: the same bits.
pub fn borders() -> Vec<Figure> {
    // cells -70 to 330; the interface is at 70, the flyer's rear at 20, the shock at 0.2 us at 190
    let scene = short(0.2e-6);
    let with_patches = |n: usize| with(&scene, &json!({"domain": {"patches": [n]}}));
    let whole = run(&with_patches(1)).map_or_else(|e| e, |ended| ended.digest);
    let mut figures = Vec::new();
    for (patches, ranks) in [(40, 1), (20, 2), (40, 3), (40, 4), (19, 4)] {
        let value = with_patches(patches);
        let ends = run_ranks(ranks, |comm| run_on::<1>(&value, comm).map(|e| e.digest));
        let digest = ends.into_iter().next().expect("rank 0").unwrap_or_else(|e| e);
        let what = format!("{patches} patches on {ranks} ranks: other bits");
        figures.push(figure(what, f64::from(digest != whole), 0.0));
    }
    figures
}

/// Profiles at odd moments, a last step of 1e-16 s, a remainder of nothing.
pub fn odd_times() -> Vec<Figure> {
    let end = 0.2e-6;
    let plain = short(end);
    let times = [1e-16, 1.234567e-8, 1.2345670000001e-8, 0.99999999e-7, 1e-7, 0.2e-6 - 1e-16, end];
    let usual = run(&plain);
    let odd = run(&until(&plain, &times));
    let (off, energy) = match (&usual, &odd) {
        (Ok(usual), Ok(odd)) => {
            let (a, b) = (odd.column("pressure"), usual.column("pressure"));
            let off = a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>();
            (off / b.iter().map(|p| p.abs()).sum::<f64>(), odd.energy_drift())
        }
        (Err(e), _) | (_, Err(e)) => (failed("odd times", e), f64::NAN),
    };
    // a run that ends where a step ends anyway
    let step = run_on::<1>(&short(1e-9), &Serial);
    let nothing = step.map_or_else(|e| failed("no remainder", &e), |ended| ended.steps as f64);
    let shipped_times = shipped("flyer.json")["time"]["end"].as_f64().unwrap_or(0.0);
    vec![
        figure("profiles at odd moments: pressure, L1 from that without", off, 1e-3),
        figure("profiles at odd moments: energy", energy, 1e-12),
        figure("steps to 1 ns", nothing, 10.0 * (shipped_times / 1e-6)),
    ]
}
