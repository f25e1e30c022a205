//! Models from outside of the library.

use decomp::Serial;
use flyer_mpm::material::IdealGas;
use flyer_mpm::material::constitutive::CustomModel;
use flyer_mpm::material::strength::VonMises;
use flyer_mpm::simulation::Simulation;
use serde_json::json;

use crate::tools::{at_most, checked, run, shipped};

#[expect(dead_code, reason = "its main is not called")]
#[path = "../../examples/custom_material.rs"]
mod custom_material;

#[test]
fn a_material_from_outside_keeps_the_jump_conditions() {
    let figures = custom_material::plateau().unwrap();
    assert_eq!(figures.len(), 3);
    for figure in figures {
        at_most(figure.name, figure.run / figure.exact - 1.0, 0.003);
    }
}

#[test]
fn a_model_of_the_library_from_outside_changes_no_bit() {
    let mut scene = shipped("piston_elastic_plastic.json");
    scene["domain"]["cell_size"] = json!(1e-4);
    let named = run::<1>(&scene).digest;
    scene["materials"]["aluminium"]["strength"]["yield_stress"] = json!(1e6);
    let scene = checked(&scene);
    let strength = VonMises { shear_modulus: 28.6e9, yield_stress: 0.26e9, hardening: 0.0 };
    let models = |_: &str| Some(CustomModel::strength(strength));
    let mut simulation = Simulation::<1>::with_models(&scene, &Serial, 1, &models).unwrap();
    while simulation.time() < scene.scene.time.end {
        simulation.advance(scene.scene.time.end).unwrap();
    }
    assert_eq!(simulation.gather().unwrap().1, named);
}

#[test]
fn what_the_scene_has_no_place_for_is_refused() {
    let message = |sets: &[(&str, serde_json::Value)],
                   models: &dyn Fn(&str) -> Option<CustomModel>| {
        let mut scene = shipped("piston_elastic_plastic.json");
        let material = scene["materials"]["aluminium"].as_object_mut().unwrap();
        for (key, value) in sets {
            material.insert(key.to_string(), value.clone());
        }
        let scene = checked(&scene);
        let made = Simulation::<1>::with_models(&scene, &Serial, 1, models);
        made.err().expect("refused").to_string()
    };
    let none = ("strength", json!(null));
    let porous = json!({"type": "p_alpha", "solid": {"type": "mie_gruneisen", "c0": 5330.0,
        "s": 1.34, "gamma0": 2.0}, "solid_density": 3100.0, "elastic_pressure": 1e8,
        "full_compaction_pressure": 1e9});
    let gas = |rho0: f64| move |_: &str| Some(CustomModel::fluid(IdealGas { rho0, gamma: 1.4 }));
    let strength = VonMises { shear_modulus: 1e9, yield_stress: 1e8, hardening: 0.0 };
    let error = message(std::slice::from_ref(&none), &|_| Some(CustomModel::strength(strength)));
    assert!(error.contains("materials.aluminium: it names no strength"), "{error}");
    let error = message(&[], &gas(1.0));
    assert!(error.contains("density = 2790.0") && error.contains("1.0;"), "{error}");
    let error = message(&[none, ("eos", porous)], &gas(2790.0));
    assert!(error.contains("supports shear or has a history"), "{error}");
}
