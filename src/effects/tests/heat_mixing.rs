//! Tests on one patch with two particles: see [`Fixture`].

use serde_json::json;

use crate::solver::effect::Phase;
use crate::solver::tests::fixture::{Fixture, close};

/// Particles at 3.5 m and 4.5 m with linear shape functions: each has weights of 1/2 on its two nodes
/// and shares the node at 4 m with the other one.
fn two(coefficient: f64) -> Fixture<1> {
    let mut f = Fixture::new(json!({"heat_mixing": {"coefficient": coefficient}}));
    f.set("mass", &[2.0, 6.0]);
    f
}

#[test]
fn the_weight_is_the_compression_of_the_step_and_at_most_one_half() {
    let mut f = two(4.0);
    f.set("specific_internal_energy", &[10.0, 30.0]).set("velocity_gradient", &[-2.0, 3.0]);
    f.act(Phase::ParticleForce, 0.05);
    // theta = 4 0.05 2 = 0.4; none in expansion
    close(&f.get("mixing_mass"), &[0.8, 0.0]);
    close(&f.get("mixing_energy"), &[8.0, 0.0]);
    f.act(Phase::ParticleForce, 0.5);
    close(&f.get("mixing_mass"), &[1.0, 0.0]);
}

#[test]
fn energies_approach_the_means_and_their_sum_stays() {
    let mut f = two(4.0);
    f.set("specific_internal_energy", &[10.0, 30.0]);
    f.set("mixing_mass", &[1.0, 3.0]).set("mixing_energy", &[10.0, 90.0]);
    f.solve(0.1).set("specific_internal_energy", &[10.0, 30.0]);
    // means of the nodes at 3, 4 and 5 m: 10, (5 + 45)/(1/2 + 3/2) = 25 and 30 J/kg
    f.act(Phase::Gathered, 0.1);
    let rises = [(17.5 - 10.0) / 2.0, 3.0 * (27.5 - 30.0) / 6.0];
    close(&f.get("specific_internal_energy"), &[10.0 + rises[0], 30.0 + rises[1]]);
}

#[test]
fn particles_of_other_materials_do_not_mix() {
    let body = |name: &str, lower: f64, material: &str| {
        json!({"name": name, "material": material, "particles_per_cell": [1],
            "box": {"lower": [lower], "upper": [lower + 1.0]}})
    };
    let fluid = |density: f64| {
        json!({"density": density,
            "eos": {"type": "tait", "bulk_modulus": 200.0, "exponent": 1.0}})
    };
    for (second, moved) in [("fluid", true), ("other", false)] {
        let mut scene = json!({
            "heat_mixing": {"coefficient": 4.0},
            "materials": {"fluid": fluid(2.0)},
            "bodies": [body("a", 3.0, "fluid"), body("b", 4.0, second)],
        });
        if second == "other" {
            scene["materials"]["other"] = fluid(3.0);
        }
        let mut f = Fixture::<1>::new(scene);
        f.set("mass", &[2.0, 2.0]).set("mixing_mass", &[1.0, 1.0]);
        f.set("mixing_energy", &[10.0, 30.0]);
        f.solve(0.1).set("specific_internal_energy", &[10.0, 30.0]);
        f.act(Phase::Gathered, 0.1);
        // means of 10, 20 and 30 J/kg if they mix: +5 J/kg, of which half the mass takes part
        let rise = if moved { 2.5 } else { 0.0 };
        close(&f.get("specific_internal_energy"), &[10.0 + rise, 30.0 - rise]);
    }
}
