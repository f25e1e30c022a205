//! The stress tensor of solids: sigma J = 40 Pa (ln J 1 + F F^T - 1), density 2 kg/m3.

use serde_json::json;

use super::fixture::{Fixture, close};

#[test]
fn the_stress_of_a_line() {
    let mut f = Fixture::<1>::solid(json!({}));
    f.set("jacobian", &[1.25, 1.0]);
    f.run(0.1, |s, step, patch| {
        s.refresh(patch, step);
        s.current_stress(patch);
    });
    // F = (J, 1, 1)
    let log = 40.0 * 1.25f64.ln();
    let xx = log + 40.0 * (1.25 * 1.25 - 1.0);
    close(&f.get("stress_volume"), &[-xx, 0.0]);
    close(&f.get("stress_xx"), &[xx / 1.25, 0.0]);
    close(&f.get("pressure"), &[-(xx + 2.0 * log) / 3.0 / 1.25, 0.0]);
    // rho0 c^2 = lambda (1 - ln J) + mu (1 + b)
    close(&f.get("sound_speed")[1..], &[60.0f64.sqrt()]);
}

#[test]
fn the_stress_of_a_plane_at_the_middle_of_the_step() {
    let mut f =
        Fixture::<2>::solid(json!({"artificial_viscosity": {"linear": 0.5, "quadratic": 0.0}}));
    // the first is stretched to twice its length, the second sheared by 1/2 after 0.1 s
    f.set("deformation_xx", &[2.0, 1.0]).set("deformation_xy", &[0.0, 0.3]);
    f.set("velocity_gradient_xy", &[0.0, 2.0]).set("jacobian", &[2.0, 1.0]);
    f.set("artificial_viscosity", &[3.0, 0.0]);
    f.run(0.1, |s, step, patch| s.find_solid_stress(patch, 0.1, step.jacobian, None));
    let log = 40.0 * 2f64.ln();
    // S = q V - tau V0
    close(&f.get("stress_volume_xx"), &[6.0 - (log + 120.0), -40.0 * 0.25]);
    close(&f.get("stress_volume_yy"), &[6.0 - log, 0.0]);
    close(&f.get("stress_volume_xy"), &[0.0, -40.0 * 0.5]);
}

#[test]
fn with_axial_symmetry_the_hoop_is_stretched_by_the_rest_of_the_volume() {
    let mut f = Fixture::<2>::solid(
        json!({"domain": {"geometry": "axisymmetric"}, "boundary": {"x_lower": "symmetry"}}),
    );
    f.set("jacobian", &[2.0, 1.0]);
    f.run(0.1, |s, step, patch| s.find_solid_stress(patch, 0.0, step.jacobian, None));
    // F = (1, 1, 2) in 3.5 m3 per radian
    let log = 40.0 * 2f64.ln();
    close(&f.get("stress_volume_xx"), &[-3.5 * log, 0.0]);
    close(&f.get("stress_volume_zz"), &[-3.5 * (log + 120.0), 0.0]);
}

#[test]
fn a_fluid_with_strength_has_its_deviator() {
    let strength = json!({"type": "von_mises", "shear_modulus": 30.0, "yield_stress": 6.0});
    let mut f = Fixture::<2>::new(json!({"materials": {"fluid": {"strength": strength}}}));
    let deviator = f.stepper.columns.deviator;
    f.set("stress_volume_xx", &[10.0, 10.0]).set("jacobian", &[0.5, 1.0]);
    f.set("deviator_xx", &[3.0, 0.0]).set("deviator_yy", &[-1.0, 0.0]);
    f.set("deviator_xy", &[2.0, 0.0]);
    f.run(0.1, |s, step, patch| s.find_solid_stress(patch, 0.0, step.jacobian, deviator));
    // p V 1 - s V with V = 1/2
    close(&f.get("stress_volume_xx"), &[8.5, 10.0]);
    close(&f.get("stress_volume_yy"), &[10.5, 10.0]);
    close(&f.get("stress_volume_xy"), &[-1.0, 0.0]);
    // n.S n
    let pressing = f.run(0.1, |s, _, patch| s.pressing(patch, 0, &[0.6, 0.8]));
    close(&[pressing], &[8.5 * 0.36 + 10.5 * 0.64 - 2.0 * 0.48]);
    // stress = s - p
    f.set("pressure", &[20.0, 20.0]);
    f.run(0.1, |s, _, patch| {
        let (mut p, mut c) = (vec![20.0; 2], vec![10.0; 2]);
        s.refresh_solids(patch, &mut p, &mut c)
    });
    close(&f.get("stress_xx"), &[-17.0, -20.0]);
    close(&f.get("stress_yy"), &[-21.0, -20.0]);
    close(&f.get("stress_xy"), &[2.0, 0.0]);
}

#[test]
fn the_work_of_a_leapfrog_step() {
    let mut f =
        Fixture::<1>::solid(json!({"artificial_viscosity": {"linear": 0.5, "quadratic": 0.0}}));
    f.set("velocity_gradient", &[2.0, -2.0]).set("sound_speed", &[8.0, 8.0]);
    let before = f.get("specific_internal_energy");
    f.update_stress(0.1);
    close(&f.get("jacobian"), &[1.2, 0.8]);
    // (tau : dF F_h^-1 - q dV)/m with F_h = 1.1 and 0.9; q = rho c/2 |D| in compression
    let tau = |j: f64| 40.0 * j.ln() + 40.0 * (j * j - 1.0);
    let q = 2.0 / 0.8 * 0.5 * 8.0 * 2.0;
    let work = [tau(1.1) * 0.2 / 1.1, tau(0.9) * -0.2 / 0.9 + q * 0.2];
    let found = f.get("specific_internal_energy");
    close(&[found[0] - before[0], found[1] - before[1]], &work.map(|w| w / 2.0));
}
