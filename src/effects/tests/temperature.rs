//! Tests on one patch with two particles: see [`Fixture`].

use serde_json::{Value, json};

use crate::solver::effect::Phase;
use crate::solver::tests::fixture::{Fixture, close};

/// Specific heat 10 J/(kg K), 300 K at rest, shear modulus 30 Pa, and `more` thermal keys.
fn warm(more: Value) -> Fixture<1> {
    let mut thermal = json!({"specific_heat": 10.0, "reference_temperature": 300.0});
    thermal.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
    let strength = json!({"type": "von_mises", "shear_modulus": 30.0, "yield_stress": 6.0});
    let material = json!({"thermal": thermal, "strength": strength});
    let mut f = Fixture::new(json!({"materials": {"fluid": material}}));
    f.set("plastic_work", &[5.0, 0.0]).set("jacobian", &[0.5, 1.0]);
    f
}

#[test]
fn plastic_work_heats() {
    let mut f = warm(json!({"source": "plastic_work", "taylor_quinney": 0.9}));
    assert_eq!(f.get("temperature"), [300.0; 2]);
    f.act(Phase::StressUpdate, 0.0);
    // the strength has found no work in a step without strain
    assert_eq!(f.get("temperature"), [300.0; 2]);
    let mut f = warm(json!({"source": "plastic_work", "taylor_quinney": 0.9}));
    f.set("velocity_gradient", &[5.0, 0.0]).set("jacobian", &[1.0, 1.0]);
    f.update_stress(0.1);
    // 6 Pa x 24/90 in 1.5 m3 and 2 kg
    close(&f.get("temperature"), &[300.0 + 0.9 * 1.6 * 1.5 / 2.0 / 10.0, 300.0]);
}

#[test]
fn the_rest_of_the_plastic_work_is_stored() {
    let mut f = warm(json!({"taylor_quinney": 0.9}));
    f.set("velocity_gradient", &[5.0, 0.0]).set("jacobian", &[1.0, 1.0]);
    f.update_stress(0.1);
    close(&f.get("stored_work"), &[0.1 * 1.6 * 1.5 / 2.0, 0.0]);
}

#[test]
fn the_temperature_follows_from_the_energy() {
    let mut f = warm(json!({"taylor_quinney": 0.9}));
    f.set("jacobian", &[1.0, 1.0]).set("specific_internal_energy", &[20.0, -5.0]);
    f.set("stored_work", &[4.0, 0.0]).set("deviator_xx", &[4.0, 0.0]);
    f.refresh();
    // (e - s:s/(4 G rho) - stored)/cv with s:s = 3/2 x 16
    let shear = 24.0 / (4.0 * 30.0 * 2.0);
    close(&f.get("temperature"), &[300.0 + (20.0 - shear - 4.0) / 10.0, 299.5]);
}

#[test]
fn a_body_may_start_warm() {
    for (source, energy) in [("energy", 100.0), ("plastic_work", 0.0)] {
        let thermal =
            json!({"specific_heat": 10.0, "reference_temperature": 300.0, "source": source});
        let strength = json!({"type": "von_mises", "shear_modulus": 30.0, "yield_stress": 6.0});
        let body = json!({"name": "body", "material": "fluid", "particles_per_cell": [1],
            "box": {"lower": [3.0], "upper": [5.0]}, "temperature": 310.0});
        let f = Fixture::<1>::new(json!({
            "materials": {"fluid": {"thermal": thermal, "strength": strength}},
            "bodies": [body],
        }));
        close(&f.get("temperature"), &[310.0; 2]);
        close(&f.get("specific_internal_energy"), &[energy; 2]);
    }
}
