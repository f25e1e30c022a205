//! Numbers at the ends of what a double holds, in every numeric key of the shipped scenes: refused
//! in one line, or a run of some steps whose numbers are finite.

use std::panic::{AssertUnwindSafe, catch_unwind};

use decomp::Serial;
use flyer_mpm::input;
use flyer_mpm::input::parse;
use flyer_mpm::scene::CheckedScene;
use flyer_mpm::simulation::{Compiled, Simulation};
use flyer_mpm::solver::Stepper;
use serde_json::{Value, json};

use super::{inputs, refused};

/// What is put in the place of a number.
const NUMBERS: [f64; 14] = [
    1e308, -1e308, 1e-308, 5e-324, 0.0, -1.0, 1e75, -1e75, 1e-150, 1e30, -1e30, 1e-30, 1e12, 1e-12,
];

/// What is put in the place of a whole number.
const COUNTS: [u64; 6] = [0, 1, 1 << 31, 1 << 53, 1 << 63, u64::MAX];

/// Most particles of a scene that is run.
const PARTICLES: u64 = 4000;

/// Most cells along a scene as it is coarsened.
const CELLS: f64 = 60.0;

/// The shipped scenes whole, with larger cells.
fn corpus() -> Vec<(String, Value)> {
    let coarse = |path: std::path::PathBuf| {
        let name = path.file_name()?.to_string_lossy().into_owned();
        let checked = parse(&input::read(&path).ok()?, &name, &[]).ok()?;
        let mut value = serde_json::to_value(&checked.scene).ok()?;
        let most = checked.cells.iter().copied().max()? as f64;
        let divides = |k: &usize| checked.cells.iter().all(|cells| cells.is_multiple_of(*k));
        let coarser = (1..1000).filter(divides).find(|k| most / *k as f64 <= CELLS).unwrap_or(1);
        value["domain"]["cell_size"] =
            checked.cell_size.iter().map(|size| size * coarser as f64).collect();
        value["domain"].as_object_mut()?.remove("patches");
        value.as_object_mut()?.remove("error_estimate");
        Some((name, value))
    };
    inputs().into_iter().filter_map(coarse).collect()
}

/// Paths of the numbers in a scene; of long arrays the first and the last.
fn numbers(value: &Value, path: &str, found: &mut Vec<String>) {
    match value {
        Value::Number(_) => found.push(path.to_string()),
        Value::Array(entries) => {
            let ends = [0, 1, entries.len().saturating_sub(1)];
            for (k, entry) in entries.iter().enumerate().filter(|(k, _)| ends.contains(k)) {
                numbers(entry, &format!("{path}/{k}"), found);
            }
        }
        Value::Object(entries) => {
            for (key, entry) in entries {
                let key = key.replace('~', "~0").replace('/', "~1");
                numbers(entry, &format!("{path}/{key}"), found);
            }
        }
        _ => {}
    }
}

/// Some steps; what ends them, or what is not finite.
fn steps<const D: usize>(scene: &CheckedScene) -> Result<(), String>
where
    Stepper<D>: Compiled<D>,
{
    let one_line = |error: flyer_mpm::simulation::RunError| {
        let text = error.to_string();
        assert_eq!(text.lines().count(), 1, "{text}");
        text
    };
    let mut run = Simulation::<D>::new(scene, &Serial, 1).map_err(one_line)?;
    for _ in 0..4 {
        if run.time() < scene.scene.time.end {
            run.advance(scene.scene.time.end).map_err(one_line)?;
        }
    }
    let totals = run.totals();
    assert!(totals.kinetic.is_finite() && totals.internal.is_finite(), "{totals:?}");
    let (table, _) = run.gather().expect("rank 0");
    for column in &table.columns {
        let odd = column.values.iter().find(|value| !value.is_finite());
        assert!(odd.is_none(), "{} is {odd:?}", column.name);
    }
    Ok(())
}

/// Checks a scene, and runs it if it passes and is small; whether it ran.
fn judged(text: &str) -> bool {
    let (available, message) = (Some(64 << 20), |error: input::SceneError| {
        assert!(super::is_clear(&error.to_string()), "{error}");
    });
    if input::check_size(text.as_bytes(), "scene.json", &[], available).is_err() {
        return false;
    }
    let checked = match parse(text.as_bytes(), "scene.json", &[]) {
        Ok(checked) => checked,
        Err(error) => {
            message(error);
            return false;
        }
    };
    if checked.particles > PARTICLES || checked.check_memory(available).is_err() {
        return false;
    }
    let ended = match checked.dimension {
        1 => steps::<1>(&checked),
        _ => steps::<2>(&checked),
    };
    ended.is_ok()
}

/// Every FLYER_MPM_EXTREMES-th change is tried, each in the long form with 1.
#[test]
fn extreme_numbers_in_every_key() {
    let every = std::env::var("FLYER_MPM_EXTREMES").ok().and_then(|n| n.parse().ok());
    let every: usize = every.unwrap_or(97);
    let (mut count, mut tried, mut ran) = (0, 0, 0);
    for (name, scene) in corpus() {
        let mut paths = Vec::new();
        numbers(&scene, "", &mut paths);
        for path in paths {
            let whole = scene.pointer(&path).is_some_and(Value::is_u64);
            let counts = COUNTS.iter().filter(|_| whole).map(|&count| json!(count));
            for number in NUMBERS.iter().map(|&number| json!(number)).chain(counts) {
                count += 1;
                if count % every != 0 {
                    continue;
                }
                let mut changed = scene.clone();
                *changed.pointer_mut(&path).unwrap() = number.clone();
                let text = changed.to_string();
                let end = catch_unwind(AssertUnwindSafe(|| judged(&text)));
                tried += 1;
                ran += usize::from(end.unwrap_or_else(|_| panic!("{name}: {path} = {number}")));
            }
        }
    }
    assert!(tried * every > count - every && ran > tried / 20, "{tried} of {count}, {ran} ran");
}

#[test]
fn numbers_beyond_all_scenes_are_refused_by_their_key() {
    for set in [
        "bodies.flyer.velocity=[-1e308]",
        "bodies.flyer.velocity=[1e76]",
        "bodies.flyer.pressure=1e200",
        "domain.upper=[1e300]",
        "time.end=1e100",
        "materials.copper.eos.c0=1e90",
        "artificial_viscosity.linear=1e80",
        "output.profiles.times=[1e99]",
    ] {
        let path = set.split('=').next().unwrap();
        refused("flyer.json", &[set], &[path, "magnitude of at most 1e75"]);
    }
    for set in ["time.end=1e-200", "materials.copper.eos.s=5e-324", "time.courant=1e-151"] {
        let path = set.split('=').next().unwrap();
        refused("flyer.json", &[set], &[path, "too small", "at least 1e-150"]);
    }
    refused("taylor_bar.json", &["materials.42CrMo4.strength.c=1e308"], &["strength.c = 1e+308"]);
    let set = "materials.42CrMo4.thermal.specific_heat=1e-308";
    refused("taylor_bar.json", &[set], &["thermal.specific_heat = 1e-308", "at least 1e-150"]);
    // for one that has bounds of its own, the message has those
    refused("flyer.json", &["time.courant=1e308"], &["a number above 0 and at most 1"]);
    refused(
        "flyer.json",
        &["time.end=-1e308"],
        &["time.end = -1e+308", "allowed: a number above 0"],
    );
}
