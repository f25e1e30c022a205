//! Tests on one patch with two particles: see [`Fixture`].

use serde_json::{Value, json};

use crate::solver::effect::Phase;
use crate::solver::tests::fixture::Fixture;

fn eroding(material: Value) -> Fixture<1> {
    let mut f = Fixture::new(json!({"materials": {"fluid": material}}));
    f.set("mass", &[2.0, 4.0]).set("velocity", &[3.0, 5.0]);
    f.set("specific_internal_energy", &[6.0, 7.0]);
    f
}

#[test]
fn a_particle_is_removed_at_its_limit_of_volume() {
    let mut f = eroding(json!({"erosion": {"volume_ratio": 2.0}}));
    f.set("jacobian", &[1.9, 2.0]).act(Phase::EndState, 0.1);
    assert_eq!((f.patch.block.own(), f.get("mass")), (1, vec![2.0]));
    let gone = f.patch.removed[0];
    assert_eq!((gone.id, gone.mass, gone.velocity, gone.energy), (1, 4.0, [5.0], 7.0));
    assert!(gone.eroded && f.patch.removed.len() == 1);
}

#[test]
fn or_at_its_limit_of_plastic_strain() {
    let strength = json!({"type": "von_mises", "shear_modulus": 30.0, "yield_stress": 6.0});
    let mut f = eroding(json!({"strength": strength, "erosion": {"plastic_strain": 0.5}}));
    f.set("plastic_strain", &[0.6, 0.4]).set("jacobian", &[1.0, 9.0]).act(Phase::EndState, 0.1);
    assert_eq!((f.patch.block.ids.clone(), f.patch.removed.len()), (vec![1], 1));
}
