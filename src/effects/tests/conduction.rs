//! Tests on one patch with two particles: see [`Fixture`].

use serde_json::{Value, json};

use crate::solver::effect::{Account, Phase};
use crate::solver::tests::fixture::{Fixture, close};

/// Two particles of 2 kg and 1 m from `lower` on: specific heat 10 J/(kg K), conductivity 5 W/(m K).
fn conducting(lower: f64, boundary: Value, source: &str) -> Fixture<1> {
    let thermal = json!({"specific_heat": 10.0, "reference_temperature": 300.0, "source": source,
        "conductivity": 5.0});
    let strength = json!({"type": "von_mises", "shear_modulus": 30.0, "yield_stress": 6.0});
    Fixture::new(json!({
        "materials": {"fluid": {"thermal": thermal, "strength": strength}},
        "boundary": boundary,
        "bodies": [{"name": "body", "material": "fluid", "particles_per_cell": [1],
            "box": {"lower": [lower], "upper": [lower + 2.0]}}],
    }))
}

#[test]
fn heat_flows_from_the_warm_to_the_cold() {
    for source in ["energy", "plastic_work"] {
        let mut f = conducting(3.0, json!({}), source);
        f.set("temperature", &[300.0, 340.0]).act(Phase::ParticleForce, 0.1);
        close(&f.get("heat_capacity"), &[20.0, 20.0]);
        f.set("jacobian", &[1.0, 1.0]);
        let before = f.get("specific_internal_energy");
        f.solve(0.1);
        // T_i = 300, 320, 340 K; heat k V grad T = 100 W m over 1 m into node 3 with 10 J/K and out
        // of node 5: +-10 K/s there, half of it at the particles.
        // the grid does not represent (1/2)^4 of +-20 K after four terms: a tenth of it is removed
        let rise = 0.1 * 5.0 + 0.1 * 20.0 / 16.0;
        let energy = f.get("specific_internal_energy");
        close(&[energy[0] - before[0], energy[1] - before[1]], &[10.0 * rise, -10.0 * rise]);
        let follows = if source == "energy" { 0.0 } else { rise };
        close(&f.get("temperature"), &[300.0 + follows, 340.0 - follows]);
    }
}

#[test]
fn compressed_material_conducts_over_its_own_volume() {
    let mut f = conducting(3.0, json!({}), "energy");
    f.set("jacobian", &[0.5, 1.0]).act(Phase::ParticleForce, 0.1);
    close(&f.get("heat_conductance"), &[2.5, 5.0]);
}

#[test]
fn a_side_of_prescribed_temperature_heats() {
    let boundary = json!({"x_lower": "wall", "temperature": {"x_lower": 400.0}});
    let mut f = conducting(0.0, boundary, "energy");
    f.set("temperature", &[300.0, 300.0]).act(Phase::ParticleForce, 0.1).solve(0.1);
    // beside 400 K: -100 K at the nodes 1 and 2, 0 at the side. Into node 1 flow 500 W/(20 J/K)
    let rate = 0.5 * 25.0;
    // the four terms of the projection: K x = x - A x with the particle means x1/2, (x1 + x2)/2,
    // and their means (x1/2 + (x1 + x2)/2)/2 at node 1 and (x1 + x2)/2 at node 2
    let (mut term, mut sum) = ([-100.0, -100.0], [0.0, 0.0]);
    for _ in 0..4 {
        let [x1, x2]: [f64; 2] = term;
        sum = [sum[0] + x1, sum[1] + x2];
        term = [x1 - (0.5 * x1 + 0.25 * x2), x2 - 0.5 * (x1 + x2)];
    }
    let rest = [0.5 * sum[0] + 100.0, 0.5 * (sum[0] + sum[1]) + 100.0];
    let rise = [0.1 * rate + 0.1 * rest[0], 0.1 * rate + 0.1 * rest[1]];
    close(&f.get("specific_internal_energy"), &rise.map(|r| 10.0 * r));
    close(&f.get("heat_received"), &rise.map(|r| 20.0 * r));
    close(&[f.account(Account::ExternalHeat, [0.0])], &[20.0 * (rise[0] + rise[1])]);
}

#[test]
fn conduction_limits_the_step() {
    let f = conducting(3.0, json!({}), "energy");
    let steps: Vec<f64> = f.stepper.effects.iter().map(|effect| effect.diffusion_step()).collect();
    // h^2/(4 kappa) with kappa = 5/(10 x 2)
    close(&[steps.into_iter().fold(f64::INFINITY, f64::min)], &[1.0]);
    // below h/c = 0.1 s with a kappa of 5; in the frame of a grid that is half as long a quarter
    let thermal = json!({"specific_heat": 10.0, "reference_temperature": 300.0,
        "conductivity": 100.0});
    for (frame, jacobian, step) in
        [("updated_lagrangian", 0.5, 0.05), ("total_lagrangian", 0.5, 0.0125)]
    {
        let mut f = Fixture::<1>::new(json!({"method": {"frame": frame},
            "materials": {"fluid": {"thermal": thermal}}}));
        f.set("jacobian", &[jacobian, 1.0]).refresh();
        close(&[f.patch.report.time_step], &[step]);
    }
}

#[test]
fn images_beyond_a_side_of_prescribed_temperature_are_as_much_warmer() {
    let thermal = json!({"specific_heat": 10.0, "reference_temperature": 300.0,
        "conductivity": 5.0});
    let boundary = json!({"x_lower": "wall", "temperature": {"x_lower": 400.0}});
    let mut f = Fixture::<1>::new(json!({
        "method": {"shape": "gimp"},
        "materials": {"fluid": {"thermal": thermal}},
        "boundary": boundary,
        "bodies": [{"name": "body", "material": "fluid", "particles_per_cell": [1],
            "box": {"lower": [0.0], "upper": [2.0]}}],
    }));
    f.set("position", &[0.25, 6.5]).act(Phase::ParticleForce, 0.1).solve(0.1);
    // at node 1 stand 9/32 of the particle with 300 K and 1/32 of its image with 500 K; the nodal
    // temperature is the third field from the last, the node beyond the side is warmer by as much
    close(&[f.added_node(2, [1])], &[0.9 * 300.0 + 0.1 * 500.0]);
    close(&[f.added_node(2, [0]), f.added_node(2, [-1])], &[400.0, 480.0]);
}
