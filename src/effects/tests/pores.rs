//! Tests on one patch with two particles: see [`Fixture`].

use serde_json::json;

use crate::solver::tests::fixture::{Fixture, close};

/// A solid of 4 kg/m3 with p = 200 Pa (1/J - 1), half of which is pores that close between 10 and
/// 90 Pa.
fn porous() -> Fixture<1> {
    let solid = json!({"type": "tait", "bulk_modulus": 200.0, "exponent": 1.0});
    let eos = json!({"type": "p_alpha", "solid": solid, "solid_density": 4.0,
        "elastic_pressure": 10.0, "full_compaction_pressure": 90.0});
    Fixture::new(json!({
        "materials": {"fluid": serde_json::Value::Null, "foam": {"density": 2.0, "eos": eos}},
        "bodies": [{"name": "body", "material": "foam", "particles_per_cell": [1],
            "box": {"lower": [3.0], "upper": [5.0]}}],
    }))
}

#[test]
fn pores_stay_while_the_solid_is_elastic() {
    let mut f = porous();
    assert_eq!(f.get("distension"), [2.0; 2]);
    // p = p_solid(v/alpha)/alpha = 100 Pa (1/J - 1): below 10 Pa
    f.set("jacobian", &[0.95, 1.0]);
    f.refresh();
    close(&f.get("pressure"), &[100.0 * (1.0 / 0.95 - 1.0), 0.0]);
    assert_eq!(f.get("distension"), [2.0; 2]);
}

#[test]
fn pores_close_for_good() {
    let mut f = porous();
    // at J = 0.3 the solid is at 0.6 of its volume
    f.set("jacobian", &[0.3, 1.0]);
    f.refresh();
    close(&f.get("pressure"), &[200.0 * (1.0 / 0.6 - 1.0), 0.0]);
    assert_eq!(f.get("distension"), [1.0, 2.0]);
    // on release the solid has its volume back at J = 1/2
    f.set("jacobian", &[0.5, 1.0]);
    f.refresh();
    assert_eq!((f.get("pressure"), f.get("distension")), (vec![0.0; 2], vec![1.0, 2.0]));
}

#[test]
fn in_between_pores_follow_the_crush_curve() {
    let mut f = porous();
    // r = 1/2: alpha = 1.25 at p = 90 - 80/2 = 50 Pa; the solid at 1.25 x 50 Pa has
    // 1/J_s = 1 + 62.5/200, and J = J_s alpha/2
    let jacobian = 1.25 / 2.0 / (1.0 + 62.5 / 200.0);
    f.set("jacobian", &[jacobian, 1.0]);
    f.refresh();
    close(&f.get("distension"), &[1.25, 2.0]);
    close(&f.get("pressure"), &[50.0, 0.0]);
}
