//! Estimates of the errors of random scenes on a line, without a reference: each run ends as it does
//! without the estimate, and what is estimated are numbers.
//!
//! `ESTIMATE_CASES=1000 cargo test --release --test hard_cases estimates` runs more.

use std::path::Path;

use decomp::Serial;
use flyer_mpm::accuracy::estimate::EstimateBasis;
use flyer_mpm::driver::output::summary::Summary;
use flyer_mpm::driver::{Beginning, Options, run};
use flyer_mpm::input;
use proptest::prelude::*;
use proptest::sample::select;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use serde_json::{Value, json};

use crate::random_scenes;

/// Scenes that run to their end, unless `ESTIMATE_CASES` says otherwise.
const SCENES: u32 = 40;

fn cases() -> u32 {
    std::env::var("ESTIMATE_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(SCENES)
}

/// Changes of a scene: materials with effects, sides, contact, forces.
fn change() -> impl Strategy<Value = Option<(&'static str, Value)>> {
    let strength = json!({"type": "von_mises", "shear_modulus": 2.76e10, "yield_stress": 2.9e8});
    let thermal = json!({"specific_heat": 900.0, "reference_temperature": 300.0});
    let failure = json!({"type": "tension_limit", "stress": 1e9});
    let pressure = json!({"x_lower": "free", "x_upper": {"pressure": 5e8}});
    let walls = json!({"x_lower": "wall", "x_upper": "wall"});
    let tait = json!({"type": "tait", "bulk_modulus": 2e9, "exponent": 7.0});
    let elastic = json!({"type": "linear_elastic", "youngs_modulus": 7e10, "poissons_ratio": 0.3});
    select(vec![
        None,
        None,
        None,
        Some(("/materials/aluminium/strength", strength)),
        Some(("/materials/aluminium/thermal", thermal)),
        Some(("/materials/copper/failure", failure)),
        Some(("/materials/gas/eos", tait)),
        Some(("/materials/copper/eos", elastic)),
        Some(("/materials/copper", json!({"library": "tungsten"}))),
        Some(("/materials/aluminium", json!({"library": "pmma"}))),
        Some(("/boundary", pressure)),
        Some(("/boundary", walls)),
        Some(("/body_force", json!({"gravity": [1e8]}))),
        Some(("/contact", json!({"type": "frictionless"}))),
        Some(("/method/frame", json!("total_lagrangian"))),
        Some(("/time/courant", json!(0.2))),
    ])
}

/// A scene with an estimate: of a body by name or by default, at up to three places in it.
fn estimating() -> impl Strategy<Value = Value> {
    let places = prop::collection::vec(0.0..=1.0, 0..=3);
    let contact = prop::bool::weighted(0.3);
    let positions = prop::bool::weighted(0.1);
    let parts = (random_scenes::scene(), change(), change(), 0usize..8, places, contact, positions);
    parts.prop_map(|(mut scene, first, second, body, places, contact, positions)| {
        for (path, value) in [first, second].into_iter().flatten() {
            let (parent, key) = path.rsplit_once('/').expect("a path");
            scene.pointer_mut(parent).expect("the parent is there")[key] = value;
        }
        if contact {
            scene["contact"] = json!({"type": "frictionless"});
        }
        let bodies = scene["bodies"].as_array_mut().expect("bodies");
        let ends = |body: &Value| {
            ["lower", "upper"].map(|end| body["box"][end][0].as_f64().expect("a number"))
        };
        if let (true, Some(first)) = (positions, bodies.first_mut()) {
            let [lower, upper] = ends(first);
            let at = |k: usize| lower + (upper - lower) * (k as f64 + 0.4) / 12.0;
            first["positions"] = json!((0..12).map(|k| [at(k)]).collect::<Vec<_>>());
            first.as_object_mut().expect("a body").remove("particles_per_cell");
        }
        let named = bodies.get(body % bodies.len().max(1)).filter(|_| body > 0);
        scene["error_estimate"] = match named {
            None => json!({}),
            Some(named) => {
                let [lower, upper] = ends(named);
                let at: Vec<f64> = places.iter().map(|s| lower + (upper - lower) * s).collect();
                json!({"body": named["name"], "arrivals": at})
            }
        };
        scene["output"] = json!({"pictures": false, "hdf5": false});
        scene
    })
}

/// The run's summary; or how it ended. None: the scene is refused.
fn ends(value: &Value, folder: &Path) -> Option<Result<Summary, String>> {
    let checked = input::parse(value.to_string().as_bytes(), "random.json", &[]);
    let scene = match checked {
        Ok(scene) => scene,
        Err(error) => {
            let error = error.to_string();
            let known = "error_estimate.body: missing key";
            // what the estimate refuses it says with the bodies that there are
            assert!(!error.contains("error_estimate") || error.contains(known), "{error}\n{value}");
            assert!(!error.contains(known) || error.contains("body 0, body 1"), "{error}\n{value}");
            return None;
        }
    };
    let options = Options::quiet(folder.to_path_buf());
    let ended = run(&Serial, &scene, &options, Beginning::Scene).map_err(|e| e.to_string());
    Some(ended.map(|_| Summary::read(folder).expect("a run writes its summary")))
}

/// What is wrong with an estimate.
fn fault(summary: &Summary) -> Option<String> {
    let estimate = summary.error_estimate.as_ref()?;
    let l1 = estimate.profiles.iter().map(|p| &p.l1);
    let plateaus = estimate.profiles.iter().filter_map(|p| p.plateau_pressure.as_ref());
    let times = estimate.arrivals.iter().filter_map(|a| a.time.as_ref());
    let sound = |b: &flyer_mpm::accuracy::estimate::Bounded| {
        let width = b.half_width.is_none_or(|w| w.is_finite() && w > 0.0);
        b.value.is_finite() && width && b.evidence.values().all(|v| v.is_finite())
    };
    if let Some(wrong) = l1.chain(plateaus).chain(times).find(|b| !sound(b)) {
        return Some(format!("{wrong:?}"));
    }
    let end = summary.scene["time"]["end"].as_f64().expect("a number");
    let mut times = estimate.arrivals.iter().filter_map(|a| a.time.as_ref());
    if let Some(wrong) = times.find(|b| !(0.0..=end).contains(&b.value)) {
        return Some(format!("an arrival outside of the run: {wrong:?}"));
    }
    // a guess has its reasons
    let guess = estimate.basis == EstimateBasis::Guess;
    (guess == estimate.outside.is_empty()).then(|| "a guess without a reason".into())
}

#[test]
fn random_scenes_on_a_line_are_estimated_without_a_reference() {
    let mut runner = TestRunner::deterministic();
    let home = tempfile::tempdir().expect("a folder");
    let (mut well, mut stopped, mut refused) = (0, 0, 0);
    let (mut plateaus, mut arrivals, mut companions) = (0, 0, 0);
    let mut wrong = Vec::new();
    while well < cases() {
        let value = estimating().new_tree(&mut runner).expect("a scene").current();
        let folder = home.path().join(format!("{well}-{stopped}-{refused}"));
        match ends(&value, &folder) {
            None => refused += 1,
            Some(Ok(summary)) => {
                well += 1;
                let estimate = summary.error_estimate.as_ref().expect("an estimate");
                companions += estimate.companions.len();
                plateaus +=
                    estimate.profiles.iter().filter(|p| p.plateau_pressure.is_some()).count();
                arrivals += estimate.arrivals.iter().filter(|a| a.time.is_some()).count();
                if let Some(fault) = fault(&summary) {
                    wrong.push(format!("{fault}\n{value}"));
                }
            }
            Some(Err(error)) => {
                stopped += 1;
                assert_eq!(error.lines().count(), 1, "{error}\n{value}");
                let mut plain = value.clone();
                plain.as_object_mut().expect("a scene").remove("error_estimate");
                let plain = ends(&plain, &folder).expect("it was not refused before");
                assert!(plain.is_err(), "only with the estimate: {error}\n{value}");
            }
        }
        let _ = std::fs::remove_dir_all(&folder);
    }
    println!(
        "{well} ended well ({companions} companions, {plateaus} plateaus, {arrivals} arrivals), \
         {stopped} were ended by the monitor as without the estimate, {refused} refused"
    );
    assert!(wrong.is_empty(), "{} of {well}: {}", wrong.len(), wrong[0]);
    assert!(companions > 0 && arrivals > 0);
}
