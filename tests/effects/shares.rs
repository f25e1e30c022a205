//! The share of the step that each effect takes is measured, by either step.

use std::collections::BTreeSet;

use decomp::Serial;
use flyer_mpm::effects::{EffectUse, ledger};
use flyer_mpm::input;
use flyer_mpm::scene;
use flyer_mpm::simulation::{Compiled, Simulation};
use flyer_mpm::solver::Stepper;
use serde_json::{Value, json};

/// The ledger of a scene after its first step, the one that is timed.
fn measured(scene: &Value) -> Result<Vec<EffectUse>, String> {
    fn of<const D: usize>(scene: &scene::CheckedScene) -> Vec<EffectUse>
    where
        Stepper<D>: Compiled<D>,
    {
        let mut simulation = Simulation::<D>::new(scene, &Serial, 1).unwrap();
        simulation.advance(scene.scene.time.end).unwrap();
        let (computed, parts) = simulation.part_seconds();
        let shares: Vec<f64> = parts.iter().map(|seconds| seconds / computed).collect();
        ledger(scene, simulation.columns(), Some(&shares))
    }
    let inputs = concat!(env!("CARGO_MANIFEST_DIR"), "/inputs/scene.json");
    let checked = input::parse(scene.to_string().as_bytes(), inputs, &[]);
    let checked = checked.map_err(|error| error.to_string())?;
    Ok(if checked.dimension == 1 { of::<1>(&checked) } else { of::<2>(&checked) })
}

/// Checks that each active effect takes time and no other does, and gives those that are active.
fn check(name: &str, scene: &Value, faults: &mut Vec<String>) -> Result<BTreeSet<String>, String> {
    let all = measured(scene)?;
    let share = |line: &EffectUse| line.step_share.unwrap();
    let wrong = all.iter().filter(|line| line.active != (share(line) > 0.0));
    let wrong: Vec<&str> = wrong.map(|line| &line.effect[..]).collect();
    let sum: f64 = all.iter().map(share).sum();
    if !wrong.is_empty() || (sum - 1.0).abs() > 1e-12 {
        faults.push(format!("{name}: {wrong:?}, sum {sum}"));
    }
    Ok(all.into_iter().filter(|line| line.active).map(|line| line.effect).collect())
}

/// The same scene by the textbook's step.
fn leapfrog(scene: &Value) -> Value {
    let mut scene = scene.clone();
    scene.as_object_mut().unwrap().remove("error_estimate");
    let method = scene["method"].as_object_mut().unwrap();
    for key in ["filter_heat", "pressure_relaxation", "volume_relaxation", "edge_mask"] {
        method.remove(key);
    }
    method.insert("stepping".into(), json!("leapfrog"));
    method.insert("stress_update".into(), json!("modified_last"));
    method.insert("energy".into(), json!("textbook"));
    scene
}

/// Half a plane of metal with an effect of every kind that the shipped scenes do not have.
fn block() -> Value {
    json!({
        "title": "block",
        "domain": {"lower": [0.0, 0.0], "upper": [0.004, 0.004], "cell_size": 2.5e-4},
        "time": {"end": 1e-6},
        "method": {"shape": "gimp", "transfer": "apic", "stepping": "midpoint",
            "energy": "textbook"},
        "materials": {"metal": {
            "density": 7800.0,
            "eos": {"type": "mie_gruneisen", "c0": 4600.0, "s": 1.4, "gamma0": 2.0},
            "strength": {"type": "von_mises", "shear_modulus": 77e9, "yield_stress": 0.4e9},
            "failure": {"type": "tension_limit", "stress": 5e9},
            "erosion": {"plastic_strain": 0.3},
            "thermal": {"specific_heat": 450.0, "conductivity": 50.0, "source": "plastic_work",
                "reference_temperature": 300.0}
        }},
        "bodies": [{"name": "block", "material": "metal",
            "box": {"lower": [0.0, 0.0], "upper": [0.004, 0.002]},
            "velocity": [100.0, -100.0], "particles_per_cell": [2, 2]}],
        "artificial_viscosity": {"linear": 0.2, "quadratic": 2.0},
        "heat_mixing": {"coefficient": 10.0},
        "boundary": {"x_lower": {"pressure": 1e8}, "x_upper": "transmitting",
            "y_lower": {"friction": 0.3}}
    })
}

#[test]
fn every_active_effect_has_a_share_of_the_step() {
    let inputs = concat!(env!("CARGO_MANIFEST_DIR"), "/inputs");
    let mut scenes: Vec<(String, Value)> = vec![("block".into(), block())];
    let mut piston = block();
    piston["boundary"] = json!({"y_lower": {"velocity": [[0.0, 0.0], [1e-6, 100.0]]}});
    scenes.push(("piston".into(), piston));
    let disk = std::fs::read(format!("{inputs}/spinning_disk.json")).unwrap();
    let mut disk: Value = serde_json::from_slice(&disk).unwrap();
    disk["method"]["spin"] = json!(true);
    disk["method"]["filter_heat"] = json!(true);
    disk["method"]["heat_spreading"] = json!({"steps": 10});
    disk["method"]["transfer"] = json!({"fmpm": 2});
    disk["output"] = json!({});
    scenes.push(("disk with spin".into(), disk));
    for entry in std::fs::read_dir(inputs).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "json") {
            let mut scene: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
            scene["output"] = json!({});
            // the first step is the one that is timed
            if let Some(relaxation) = scene["method"].get_mut("pressure_relaxation") {
                relaxation["interval"] = json!(1);
            }
            scenes.push((path.file_name().unwrap().to_string_lossy().into_owned(), scene));
        }
    }
    let (mut seen, mut both, mut faults) = (BTreeSet::new(), 0, Vec::new());
    for (name, scene) in &scenes {
        seen.extend(check(name, scene, &mut faults).unwrap());
        match check(&format!("{name}, leapfrog"), &leapfrog(scene), &mut faults) {
            Ok(_) => both += 1,
            Err(why) => println!("{name}: {why}"),
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(both > 25, "{both} by either step");
    let all = measured(&block()).unwrap();
    let never: Vec<_> = all.iter().filter(|line| !seen.contains(&line.effect)).collect();
    assert!(never.is_empty(), "{never:?}");
}
