//! Elastic solids: stress, waves, energy, mixtures, and what sleeps.

use serde_json::{Value, json};

use crate::tools::{at_most, midpoint, run};

const SOLIDS: [&str; 2] = ["linear_elastic", "neo_hookean"];

/// A free block of edge 1 m, 10 cells, with lambda = 1.5 and mu = 1 Pa.
fn block(eos: &str, method: Value, motion: Value, end: f64) -> Value {
    json!({
        "title": "Block",
        "domain": {"lower": [-1.0, -1.0], "upper": [1.0, 1.0], "cell_size": 0.1},
        "time": {"end": end},
        "method": method,
        "materials": {"solid": {"density": 1.0, "eos":
            {"type": eos, "youngs_modulus": 2.6, "poissons_ratio": 0.3}}},
        "bodies": [{
            "name": "block", "material": "solid",
            "box": {"lower": [-0.5, -0.5], "upper": [0.5, 0.5]},
            "velocity_field": motion, "particles_per_cell": [2, 2]
        }]
    })
}

fn slide(speed: f64) -> Value {
    json!({"shear_layer": {"profile": "sine", "speed": speed, "height": 2.0, "centre": 0.0}})
}

#[test]
fn a_block_that_turns_bears_what_holds_it_together_and_no_more() {
    for eos in SOLIDS {
        // a quarter turn at a rim far slower than sound
        let rate = 0.01;
        let motion = json!({"rotation": {"about": [0.0, 0.0], "rate": rate}});
        let end = 0.5 * std::f64::consts::PI / rate;
        let value = block(eos, midpoint("bspline_quadratic", json!("apic")), motion, end);
        let outcome = run::<2>(&value);
        let held = rate * rate * 0.5;
        for stress in ["stress_xx", "stress_yy", "stress_xy", "stress_zz"] {
            at_most(&format!("{eos} {stress}"), outcome.greatest(stress), held);
        }
        assert!(outcome.greatest("stress_xx") > 0.1 * held, "the block is held together");
        // the corner has come round
        let (x, y) = (outcome.column("x"), outcome.column("y"));
        let first = outcome.last.ids.iter().position(|&id| id == 0).unwrap();
        at_most("x", x[first] - 0.475, 0.01);
        at_most("y", y[first] + 0.475, 0.01);
    }
}

#[test]
fn energy_and_momentum_are_kept_to_rounding() {
    for eos in SOLIDS {
        for shape in ["gimp", "cpdi", "bspline_quadratic", "cpdi_bspline_quadratic"] {
            for transfer in [json!("flip"), json!({"xpic": 2}), json!({"fmpm": 4})] {
                let value = block(eos, midpoint(shape, transfer.clone()), slide(0.5), 1.0);
                let outcome = run::<2>(&value);
                let what = format!("{eos} {shape} {transfer}");
                at_most(&what, outcome.energy_drift(), 1e-13);
                let scale = outcome.totals[0].absolute_momentum;
                at_most(&what, outcome.momentum_drift(scale), 1e-13);
                // the block supports shear
                assert!(outcome.greatest("stress_xy") > 0.2, "{what}");
            }
        }
    }
}

#[test]
fn every_order_of_a_leapfrog_step_nearly_keeps_energy() {
    for update in ["last", "first", "modified_last"] {
        for shape in ["gimp", "cpdi"] {
            let method = json!({"shape": shape, "transfer": "flip", "stress_update": update});
            let outcome = run::<2>(&block("neo_hookean", method, slide(0.1), 2.0));
            at_most(&format!("{update} {shape}"), outcome.energy_drift(), 0.06);
            assert!(outcome.greatest("stress_xy") > 0.05);
        }
    }
}

/// A plate of 20 cells strikes one of 20 at a hundredth of a per cent of the sound speed, on a
/// line or as a strip of 3 cells that is joined to itself.
fn impact(eos: &str, plane: bool, rest: Value) -> Value {
    let c = 3.5f64.sqrt();
    let ends = |x: f64, y: f64| if plane { json!([x, y]) } else { json!([x]) };
    let count = if plane { json!([2, 2]) } else { json!([2]) };
    let body = |name: &str, from: f64, to: f64, v: f64| {
        json!({
            "name": name, "material": "solid", "velocity": ends(v, 0.0),
            "box": {"lower": ends(from, 0.0), "upper": ends(to, 0.3)},
            "particles_per_cell": count
        })
    };
    let mut value = json!({
        "title": "Bars",
        "domain": {"lower": ends(-2.5, 0.0), "upper": ends(2.5, 0.3), "cell_size": 0.1},
        "time": {"end": 1.2 / c},
        "method": midpoint("cpdi_bspline_quadratic", json!({"fmpm": 4})),
        "materials": {"solid": {"density": 1.0, "eos":
            {"type": eos, "youngs_modulus": 2.6, "poissons_ratio": 0.3}}},
        "bodies": [body("flyer", -2.0, 0.0, 1e-4 * c), body("target", 0.0, 2.0, 0.0)],
        "artificial_viscosity": {"linear": 0.1, "quadratic": 0.5}
    });
    if plane {
        value["boundary"] = json!({"y_lower": "periodic", "y_upper": "periodic"});
    }
    value.as_object_mut().unwrap().extend(rest.as_object().unwrap().clone());
    value
}

#[test]
fn a_wave_on_a_line_has_the_longitudinal_speed_and_impedance() {
    for eos in SOLIDS {
        let outcome = run::<1>(&impact(eos, false, json!({})));
        let c = 3.5f64.sqrt();
        // rho c v/2 behind, and the half height at c t = 1.2 m
        let behind = -0.5e-4 * c * c;
        let (x, stress) = (outcome.column("x"), outcome.column("stress_xx"));
        let plateau: Vec<f64> =
            (0..x.len()).filter(|&r| x[r].abs() < 0.6).map(|r| stress[r] / behind).collect();
        assert!(!plateau.is_empty());
        plateau.iter().for_each(|s| at_most("stress behind", s - 1.0, 0.02));
        let front = (0..x.len()).rev().find(|&r| stress[r] / behind > 0.5).unwrap();
        at_most("front", x[front] - 1.2, 0.1);
        // across, Hooke's law: lambda/(lambda + 2 mu)
        let middle = (0..x.len()).find(|&r| x[r] > 0.0).unwrap();
        let share = outcome.column("stress_zz")[middle] / stress[middle];
        at_most("stress across", share - 1.5 / 3.5, 1e-3);
        at_most("energy", outcome.energy_drift(), 1e-11);
    }
}

#[test]
fn uniaxial_strain_in_a_plane_is_that_on_a_line() {
    for eos in SOLIDS {
        let line = run::<1>(&impact(eos, false, json!({})));
        let strip = run::<2>(&impact(eos, true, json!({})));
        let most = line.greatest("stress_xx");
        for stress in ["stress_xx", "stress_zz", "pressure"] {
            // six particles of the strip for each on the line, in order of x
            for (r, on_line) in line.column(stress).iter().enumerate() {
                for k in 0..6 {
                    let off = strip.column(stress)[6 * r + k] - on_line;
                    at_most(&format!("{eos} {stress}"), off / most, 1e-6);
                }
            }
        }
        at_most("shear", strip.greatest("stress_xy") / most, 1e-9);
    }
}

/// A copper plate, a fluid, strikes a block of steel, a solid, in the middle of a wide domain.
fn mixed() -> Value {
    let body = |name: &str, material: &str, lower: [f64; 2], upper: [f64; 2], v: f64| {
        json!({
            "name": name, "material": material, "velocity": [v, 0.0],
            "box": {"lower": lower, "upper": upper}, "particles_per_cell": [2, 2]
        })
    };
    let mut method = midpoint("cpdi_bspline_quadratic", json!({"fmpm": 4}));
    method["pressure_relaxation"] = json!({"rate": 0.2, "interval": 1});
    method["edge_mask"] = json!(0.3);
    method["domain_limit"] = json!(1.0);
    json!({
        "title": "Mixed",
        "domain": {"lower": [-0.001, -0.001], "upper": [0.0022, 0.001], "cell_size": 5e-5},
        "time": {"end": 5e-8},
        "method": method,
        "materials": {
            "copper": {"density": 8930.0, "eos":
                {"type": "mie_gruneisen", "c0": 3940.0, "s": 1.489, "gamma0": 1.96}},
            "steel": {"density": 7800.0, "eos":
                {"type": "linear_elastic", "youngs_modulus": 2.0e11, "poissons_ratio": 0.3}}
        },
        "bodies": [
            body("plate", "copper", [-0.0003, -0.0003], [0.0, 0.0003], 300.0),
            body("block", "steel", [0.0, -0.0006], [0.002, 0.0006], 0.0)
        ],
        "artificial_viscosity": {"linear": 0.1, "quadratic": 0.75, "limiter": "christensen"}
    })
}

#[test]
fn fluids_and_solids_share_a_scene() {
    let outcome = run::<2>(&mixed());
    at_most("energy", outcome.energy_drift(), 1e-12);
    at_most("momentum", outcome.momentum_drift(outcome.totals[0].absolute_momentum), 1e-13);
    let shear = |body: u32| {
        let own = |r: &usize| outcome.last.body[*r] == body;
        let rows = (0..outcome.last.len()).filter(own);
        rows.fold(0.0f64, |most, r| most.max(outcome.column("stress_xy")[r].abs()))
    };
    assert_eq!(shear(0), 0.0, "a fluid supports no shear");
    assert!(shear(1) > 1e8, "{}", shear(1));
}

#[test]
fn patches_and_sleep_change_no_bit() {
    let digest = |patches: Value, skip: bool, halo: &str| {
        let mut value = mixed();
        value["domain"]["patches"] = patches;
        value["decomposition"] = json!({"skip_quiescent": skip, "filter_halo": halo});
        run::<2>(&value).digest
    };
    let one = digest(json!([1, 1]), false, "exchange");
    assert_eq!(one, digest(json!([4, 2]), false, "exchange"));
    assert_eq!(one, digest(json!([4, 2]), true, "exchange"));
    assert_eq!(one, digest(json!([3, 1]), true, "redundant"));
}

#[test]
fn a_cylinder_keeps_energy_about_its_axis() {
    for (eos, transfer) in [("linear_elastic", json!({"fmpm": 4})), ("neo_hookean", json!("flip"))]
    {
        let value = json!({
            "title": "Cylinder on a wall",
            "domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.6], "cell_size": 0.1,
                       "geometry": "axisymmetric"},
            "time": {"end": 1.0},
            "method": midpoint("cpdi_bspline_quadratic", transfer),
            "materials": {"solid": {"density": 1.0, "eos":
                {"type": eos, "youngs_modulus": 2.6, "poissons_ratio": 0.3}}},
            "bodies": [{
                "name": "cylinder", "material": "solid", "velocity": [0.0, -0.1],
                "box": {"lower": [0.0, 0.0], "upper": [0.5, 1.0]}, "particles_per_cell": [2, 2]
            }],
            "boundary": {"x_lower": "symmetry", "y_lower": "wall"}
        });
        let outcome = run::<2>(&value);
        at_most("energy", outcome.energy_drift(), 1e-12);
        // it bulges, so it is stretched about the axis
        assert!(outcome.greatest("stress_zz") > 0.01);
        let on_axis = (0..outcome.last.len()).find(|&r| outcome.column("x")[r] < 0.05).unwrap();
        let (hoop, radial) = (outcome.column("stress_zz"), outcome.column("stress_xx"));
        at_most(
            "on the axis",
            (hoop[on_axis] - radial[on_axis]) / outcome.greatest("stress_yy"),
            0.1,
        );
    }
}
