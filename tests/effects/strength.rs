//! Strength in runs: waves in uniaxial strain, turning, every kind of step.

use decomp::Serial;
use flyer_mpm::exact::{ElasticPlastic, Plastic};
use flyer_mpm::material::MieGruneisen;
use flyer_mpm::simulation::Simulation;
use serde_json::{Value, json};

use crate::tools::{Outcome, at_most, checked, midpoint, run, shipped};

const ALUMINIUM: Plastic<MieGruneisen> = Plastic {
    eos: MieGruneisen { rho0: 2790.0, c0: 5330.0, s: 1.34, gamma0: 2.0 },
    shear_modulus: 28.6e9,
    yield_stress: 0.26e9,
};

/// The shipped piston, coarser and shorter.
fn piston() -> Value {
    let mut scene = shipped("piston_elastic_plastic.json");
    scene["domain"]["cell_size"] = json!(2.5e-5);
    scene["output"]["profiles"]["times"] = json!([0.6e-6]);
    scene["time"]["end"] = json!(0.6e-6);
    scene
}

/// Mean of a column over the places between two shares of the way from `from` to `to`.
fn mean<const D: usize>(run: &Outcome<D>, name: &str, [from, to]: [f64; 2]) -> f64 {
    let (x, values) = (run.column("x"), run.column(name));
    let within = |r: &usize| (from + 0.3 * (to - from)..from + 0.7 * (to - from)).contains(&x[*r]);
    let rows: Vec<usize> = (0..x.len()).filter(within).collect();
    rows.iter().map(|&r| values[r]).sum::<f64>() / rows.len() as f64
}

/// Holds both plateaus of a piston's run against the exact ones.
fn check_plateaus<const D: usize>(run: &Outcome<D>, axial: &str, velocity: &str, bound: f64) {
    let exact = ElasticPlastic::new(&ALUMINIUM, 100.0).unwrap();
    let first = exact.precursor.unwrap();
    // seen from the wall, the metal comes in at 100 m/s
    let at = |speed: f64| (speed - 100.0) * 0.6e-6;
    let behind = [0.0, at(exact.last.speed)];
    let between = [at(exact.last.speed), at(first.speed)];
    let near = |what: &str, value: f64, wanted: f64| at_most(what, value / wanted - 1.0, bound);
    near("final stress", -mean(run, axial, behind), exact.last.stress);
    near("final pressure", mean(run, "pressure", behind), exact.last.p);
    near("final density", mean(run, "density", behind), exact.last.rho);
    near("precursor's stress", -mean(run, axial, between), first.stress);
    near("precursor's velocity", mean(run, velocity, between) + 100.0, first.u);
}

#[test]
fn a_precursor_runs_ahead_of_a_plastic_shock() {
    let outcome = run::<1>(&piston());
    check_plateaus(&outcome, "stress_xx", "velocity", 0.003);
    at_most("energy", outcome.energy_drift(), 1e-12);
    let strain = outcome.column("plastic_strain");
    assert!(strain.iter().all(|&e| e >= 0.0) && outcome.greatest("plastic_strain") > 0.008);
    // next to nothing yields in the precursor, and nothing ahead of it
    let x = outcome.column("x");
    for r in 0..x.len() {
        let most = if x[r] > 0.0041 { 0.0 } else { 2e-4 };
        assert!(x[r] < 0.0035 || strain[r] <= most, "{} {}", x[r], strain[r]);
    }
}

/// Sound of a metal with strength is that along: c^2 = c0^2 + 4 G/(3 rho).
#[test]
fn shear_stiffness_shortens_the_step() {
    let step = |strong: bool| {
        let mut scene = piston();
        scene.as_object_mut().unwrap().remove("reference");
        if !strong {
            let materials = scene["materials"].as_object_mut().unwrap();
            materials
                .values_mut()
                .for_each(|m| drop(m.as_object_mut().unwrap().remove("strength")));
        }
        let scene = checked(&scene);
        Simulation::<1>::new(&scene, &Serial, 1).unwrap().time_step()
    };
    let ratio = step(true) / step(false);
    let exact = 5330.0 / (5330.0f64.powi(2) + 4.0 / 3.0 * 28.6e9 / 2790.0).sqrt();
    // the metal comes in at 100 m/s, which counts too
    at_most("step", ratio / exact - 1.0, 0.02);
}

#[test]
fn every_kind_of_step_knows_strength() {
    let steps = [
        json!({"shape": "cpdi", "transfer": "flip"}),
        json!({"shape": "gimp", "transfer": "apic", "stress_update": "first"}),
        json!({"shape": "cpdi", "transfer": {"xpic": 2}, "stress_update": "modified_last"}),
        midpoint("bspline_cubic", json!("apic")),
        midpoint("cpdi", json!({"fmpm": 2})),
    ];
    for method in steps {
        let mut scene = piston();
        scene["method"] = method.clone();
        scene["artificial_viscosity"] = json!({"linear": 0.2, "quadratic": 2.0});
        // plain FLIP is noisy, and the precursor is narrow on such cells
        check_plateaus(&run::<1>(&scene), "stress_xx", "velocity", 0.05);
    }
}

/// The piston as a strip in a plane, along y.
fn strip(geometry: &str) -> Value {
    let mut scene = piston();
    scene["domain"] = json!({"lower": [0.0, 0.0], "upper": [1e-4, 0.007], "cell_size": 2.5e-5,
        "geometry": geometry});
    scene["bodies"][0]["box"] = json!({"lower": [0.0, 0.0], "upper": [1e-4, 0.006]});
    scene["bodies"][0]["velocity"] = json!([0.0, -100.0]);
    scene["bodies"][0]["particles_per_cell"] = json!([2, 2]);
    scene["boundary"] = json!({"x_lower": "symmetry", "x_upper": "symmetry", "y_lower": "wall"});
    scene["time"]["end"] = json!(0.6e-6);
    scene
}

#[test]
fn in_a_plane_and_about_an_axis_uniaxial_strain_is_the_same() {
    for (geometry, noise) in [("plane_strain", 0.01), ("axisymmetric", 0.03)] {
        let outcome = run::<2>(&strip(geometry));
        let (y, stress) = (outcome.column("y"), outcome.column("stress_yy"));
        let exact = ElasticPlastic::new(&ALUMINIUM, 100.0).unwrap();
        let shock = (exact.last.speed - 100.0) * 0.6e-6;
        let within = |r: &usize| (0.3 * shock..0.7 * shock).contains(&y[*r]);
        for r in (0..y.len()).filter(within) {
            at_most(geometry, -stress[r] / exact.last.stress - 1.0, noise);
            let across = [outcome.column("stress_xx")[r], outcome.column("stress_zz")[r]];
            at_most("across", (across[0] - across[1]) / exact.last.stress, noise);
        }
        at_most("energy", outcome.energy_drift(), 1e-12);
    }
}

/// A bar whose halves run into each other vibrates without yielding: what shear takes up it gives
/// back, as the work of a step is that of its mean stress. By that of its start, the bar would lose
/// a share of its energy that grows with the time step, a quarter of it and more here.
#[test]
fn a_bar_that_vibrates_gets_its_work_back_in_leapfrog_steps() {
    for update in ["first", "modified_last"] {
        let mut scene = piston();
        let half = |name: &str, lower: f64, speed: f64| {
            json!({
                "name": name, "material": "aluminium", "velocity": [speed],
                "particles_per_cell": [2], "box": {"lower": [lower], "upper": [lower + 5e-4]}
            })
        };
        for key in ["reference", "artificial_viscosity", "boundary", "output"] {
            scene.as_object_mut().unwrap().remove(key);
        }
        scene["domain"]["lower"] = json!([-2e-4]);
        scene["domain"]["upper"] = json!([1.2e-3]);
        scene["bodies"] = json!([half("left", 0.0, 1.0), half("right", 5e-4, -1.0)]);
        scene["method"] = json!({"shape": "cpdi", "transfer": "flip", "stress_update": update});
        // two periods
        scene["time"]["end"] = json!(4e-3 / 6500.0);
        let outcome = run::<1>(&scene);
        at_most(update, outcome.energy_drift(), 0.02);
        assert_eq!(outcome.greatest("plastic_strain"), 0.0);
    }
}

/// Laws whose parameters leave a constant yield stress are von Mises', bit by bit; others are not.
#[test]
fn laws_with_a_constant_yield_stress_are_von_mises() {
    let digest = |strength: Value| {
        let mut scene = shipped("piston_elastic_plastic.json");
        scene["domain"]["cell_size"] = json!(1e-4);
        let material = &mut scene["materials"]["aluminium"];
        material["strength"] = strength;
        material["thermal"] = json!({"specific_heat": 900.0, "reference_temperature": 300.0});
        run::<1>(&scene).digest
    };
    let mises = |yield_stress: f64| {
        digest(json!({"type": "von_mises", "shear_modulus": 28e9, "yield_stress": yield_stress}))
    };
    let armstrong = |c2: f64, c3: f64| {
        digest(json!({
            "type": "zerilli_armstrong", "shear_modulus": 28e9, "c1": 0.25e9, "c2": c2, "c3": c3,
            "c4": 0.0
        }))
    };
    assert_eq!(armstrong(0.0, 0.0), mises(0.25e9));
    assert_ne!(armstrong(1e9, 0.0), mises(0.25e9));
    assert_ne!(armstrong(0.0, 1e-3), mises(0.25e9));
    let preston = |kappa: f64, alpha: f64| {
        digest(json!({
            "type": "preston_tonks_wallace", "shear_modulus": 28e9, "alpha": alpha,
            "melt_temperature": 930.0, "atomic_mass": 4.48e-26, "theta": 0.03, "p": 1.0,
            "s0": 0.0078125, "s_inf": 0.001, "kappa": kappa, "gamma": 1.0, "y0": 0.0078125,
            "y_inf": 0.001, "y1": 0.0, "y2": 1.0, "beta": 0.25
        }))
    };
    assert_eq!(preston(0.0, 0.0), mises(2.0 * 28e9 * 0.0078125));
    assert_ne!(preston(0.1, 0.0), preston(0.0, 0.0));
    assert_ne!(preston(0.0, 0.2), preston(0.0, 0.0));
}
