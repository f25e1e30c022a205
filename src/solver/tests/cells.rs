//! Kernels on cells whose edges are not 1 m, where factors of the edge show.

use serde_json::{Value, json};

use super::fixture::{Fixture, close};

/// Particles of 1 kg at 1.75 and 2.25 m in the cells 3 and 4 of half a metre.
fn halved(method: Value) -> Fixture<1> {
    halved_between(method, json!({}))
}

/// The same with these sides.
fn halved_between(method: Value, boundary: Value) -> Fixture<1> {
    let body = json!({"name": "body", "material": "fluid", "particles_per_cell": [1],
        "box": {"lower": [1.5], "upper": [2.5]}});
    Fixture::new(json!({
        "domain": {"upper": [4.0], "cell_size": 0.5},
        "bodies": [body],
        "method": method,
        "artificial_viscosity": {"linear": 0.5, "quadratic": 2.0},
        "boundary": boundary,
    }))
}

/// Particles of 2 kg at (1.75, 7) and (2.25, 7) m in cells of 1/2 and 2 m.
fn oblong(method: Value) -> Fixture<2> {
    let body = json!({"name": "body", "material": "fluid", "particles_per_cell": [1, 1],
        "box": {"lower": [1.5, 6.0], "upper": [2.5, 8.0]}});
    Fixture::new(json!({
        "domain": {"upper": [4.0, 16.0], "cell_size": [0.5, 2.0]},
        "bodies": [body],
        "method": method,
    }))
}

#[test]
fn gradients_are_per_metre() {
    let mut f = halved(json!({"transfer": "apic"}));
    f.set("position", &[1.625, 2.25]).set("mass", &[2.0, 4.0]).set("stress_volume", &[5.0, 7.0]);
    f.set("affine_velocity", &[4.0, 8.0]).scatter(0.1);
    // N = (3/4, 1/4) and (1/2, 1/2), G = (-2, 2), C (x_i - x) with -1/8, 3/8 m and -1/4, 1/4 m
    close(&f.line("mass", 3..=5), &[1.5, 2.5, 2.0]);
    close(&f.line("acceleration", 3..=5), &[-10.0 / 1.5, (10.0 - 14.0) / 2.5, 7.0]);
    close(&f.line("lumped_velocity", 3..=5), &[-0.5, (0.5 * 1.5 - 2.0 * 2.0) / 2.5, 2.0]);
    for (node, end) in [(3, 14.0), (4, 28.0), (5, 32.0)] {
        f.set_node("velocity_star", [node], end);
    }
    f.run(0.1, |s, step, patch| s.gather_leapfrog(patch, step.dt, true));
    close(&f.get("velocity_gradient"), &[28.0, 8.0]);
    close(&f.get("affine_velocity"), &[28.0, 8.0]);
}

#[test]
fn linear_velocities_are_exact_on_oblong_cells() {
    for shape in ["linear", "gimp", "cpdi", "bspline_quadratic", "cpdi_bspline_quadratic"] {
        let mut f = oblong(json!({"shape": shape, "transfer": "apic"}));
        f.set_flow([(0.0, [0.0; 2]); 2], [(2.0, [3.0, 5.0]), (7.0, [11.0, 13.0])]);
        f.run(0.1, |s, step, patch| s.gather_leapfrog(patch, step.dt, true));
        close(&f.get("velocity_x"), &[2.0 + 3.0 * 1.75 + 35.0, 2.0 + 3.0 * 2.25 + 35.0]);
        close(&f.get("velocity_y"), &[7.0 + 11.0 * 1.75 + 91.0, 7.0 + 11.0 * 2.25 + 91.0]);
        close(&f.get("velocity_gradient"), &[16.0; 2]);
        for (of, value) in [("xx", 3.0), ("xy", 5.0), ("yx", 11.0), ("yy", 13.0)] {
            close(&f.get(&format!("affine_{of}")), &[value; 2]);
        }
    }
}

#[test]
fn the_affine_velocity_moves_nodes_by_metres() {
    let mut f = oblong(json!({"transfer": "apic"}));
    f.set("affine_xx", &[4.0, 4.0]).set("affine_xy", &[10.0, 10.0]).scatter(0.1);
    // node (3, 3) is 1/4 and 1 m below the first particle alone
    close(&[f.node("lumped_velocity_x", [3, 3])], &[-1.0 - 10.0]);
    close(&[f.node("lumped_velocity_x", [5, 4])], &[1.0 + 10.0]);
}

#[test]
fn places_and_domains_are_in_cells() {
    let mut f = halved(json!({"shape": "cpdi"}));
    f.set("position", &[1.625, 2.25]).set("jacobian", &[1.5, 0.5]);
    f.run(0.1, |s, step, patch| s.find_cells(patch, 0.0, step.jacobian));
    assert_eq!(f.patch.block.cells, [[3], [4]]);
    close(&f.get("cell_fraction"), &[0.25, 0.5]);
    close(&f.get("cell_length"), &[1.5, 0.5]);
    f.run(0.1, |s, _, patch| assert_eq!(s.filled_cells(&patch.block, 0), 1.5));
    let mut f = oblong(json!({"shape": "cpdi"}));
    f.set("deformation_xy", &[0.5, 0.0]);
    f.run(0.1, |s, step, patch| s.find_cells(patch, 0.0, step.jacobian));
    // sheared by half of its half height of 1 m, which is one cell
    close(&f.get("cell_edge1_x"), &[0.5, 0.5]);
    close(&f.get("cell_edge2_x"), &[1.0, 0.0]);
    close(&f.get("cell_edge2_y"), &[0.5, 0.5]);
    let mut f = oblong(json!({"shape": "gimp"}));
    f.run(0.1, |s, step, patch| s.find_cells(patch, 0.0, step.jacobian));
    assert_eq!((f.get("cell_width"), f.get("cell_height")), (vec![1.0; 2], vec![1.0; 2]));
}

#[test]
fn a_particle_that_passes_a_cell_is_a_fault() {
    // from the cells 3 and 4 by one cell, and by two
    for (x, fault) in
        [([1.25, 2.75], None), ([1.75, 1.25], Some((4, 2))), ([0.75, 2.25], Some((3, 2)))]
    {
        let mut f = halved(json!({}));
        f.set("position", &x);
        f.run(0.1, |s, step, patch| s.find_cells(patch, 0.0, step.jacobian));
        let found = f.patch.report.fault.as_ref().map(|f| (f.cell[0], f.what.clone()));
        let what = |by: i64| format!("it moves by {by} cells in one step, allowed: 1");
        assert_eq!(found, fault.map(|(cell, by)| (cell, what(by))));
        // it stays where its patch knows it
        assert!(fault.is_none_or(|(cell, _)| f.patch.block.cells.contains(&[cell as i32])));
    }
}

#[test]
fn a_particle_moves_across_a_periodic_side_the_shorter_way() {
    // of 8 cells, from cell 3: 16 cells away is the same cell, 9 the next one, 6 the second one
    for (x, by) in [(1.75 + 8.0, None), (1.25 - 4.0, None), (0.75 + 4.0, Some(2)), (3.9, Some(4))] {
        let sides = json!({"x_lower": "periodic", "x_upper": "periodic"});
        let mut f = halved_between(json!({}), sides);
        f.set("position", &[x, 2.25]);
        f.run(0.1, |s, step, patch| s.find_cells(patch, 0.0, step.jacobian));
        let what = |by: i64| format!("it moves by {by} cells in one step, allowed: 1");
        assert_eq!(f.patch.report.fault.as_ref().map(|f| f.what.clone()), by.map(what), "{x}");
    }
}

#[test]
fn viscosity_and_time_step_know_the_edge() {
    let mut f = halved(json!({}));
    f.set("velocity_gradient", &[-3.0, 0.0]).set("velocity", &[0.0, 2.0]);
    f.run(0.1, |s, step, patch| s.find_viscosity(patch, step.jacobian));
    // h |D| = 1.5 m/s
    close(&f.get("artificial_viscosity"), &[2.0 * (0.5 * 10.0 * 1.5 + 2.0 * 2.25), 0.0]);
    f.refresh();
    close(&[f.patch.report.time_step], &[0.5 / (10.0 + 2.0 * (5.0 + 2.0 * 1.5))]);
    let mut f = halved(json!({"frame": "total_lagrangian"}));
    f.set("jacobian", &[0.5, 1.0]).refresh();
    close(&[f.patch.report.time_step], &[0.5 * 0.5 / 20.0]);
    let mut f = oblong(json!({"frame": "total_lagrangian"}));
    f.set("deformation_yy", &[0.2, 1.0]).refresh();
    // 0.4 m along y, 0.5 m along x
    close(&[f.patch.report.time_step], &[0.4 / 10.0]);
}

#[test]
fn the_compliance_knows_the_velocity_jump_over_a_cell() {
    let mut f = halved(
        json!({"stepping": "midpoint", "pressure_relaxation": {"rate": 0.1, "interval": 1}}),
    );
    f.set("velocity_gradient", &[-8.0, 0.0]);
    f.run(0.1, |s, _, patch| s.mid_step_stress(patch, true));
    // V = 1/2 m, m = 1 kg, h D = 4 m/s, S = 2^-30 rho c^2
    let floor = 0.5 * 200.0 * 2f64.powi(-30);
    close(&f.get("compliance"), &[0.25 / (116.0 + floor), 0.25 / (100.0 + floor)]);
}

#[test]
fn contact_knows_the_edge() {
    let body = |name: &str, lower: f64, velocity: f64| {
        json!({"name": name, "material": "fluid", "particles_per_cell": [1],
            "box": {"lower": [lower], "upper": [lower + 0.5]}, "velocity": [velocity]})
    };
    // m u + A s dt > 0 with the reduced mass 1/4 kg, u = -3 m/s and A = 1: above 7.5 Pa; a gap of
    // 0.004 m is closed, as it is below 1/100 cell
    for (stress, gap, touches) in [(7.0, 0.0, false), (8.0, 0.0, true), (8.0, 0.03, false)] {
        let mut f = Fixture::<1>::new(json!({
            "domain": {"upper": [4.0], "cell_size": 0.5},
            "bodies": [body("a", 1.5, 2.0), body("b", 2.0, -1.0)],
            "contact": {"type": "frictionless"},
            "method": {"transfer": "pic"},
        }));
        f.set("velocity", &[-2.0, 1.0]).set("position", &[1.75 - gap, 2.25]);
        f.set("stress_volume", &[0.5 * stress, 0.5 * stress]).scatter(0.1);
        assert_eq!(f.patch.contact.constraints.len(), usize::from(touches), "{stress} Pa, {gap} m");
    }
}
