//! The default scheme of `inputs/flyer.json` and the best one of `inputs/flyer_best.json`: on the
//! standard problem, on other impacts, on Noh's problem, on a smooth wave, and what they cost.

use std::fs;

use flyer_mpm::exact::{Accuracy, Impact, ImpactBody, Snapshot};
use flyer_mpm::material::MieGruneisen;
use serde_json::{Value, json};

use crate::bounds::{Bound, Unit, accuracy as bounds};
use crate::program::root;
use crate::runs::{Job, Outcome};
use crate::table::Table;

/// Cell size at which the errors of impacts are listed [m].
const CELL: f64 = 1e-5;

/// Length of the target [m].
const TARGET: f64 = 8e-3;

/// A scheme: the scene that it is shipped in, its cells [m], and the bounds that it must keep.
struct Scheme {
    scene: &'static str,
    cell: f64,
    l1: Bound,
    plateau: Bound,
    noise: Bound,
    overshoot: Option<Bound>,
    /// Of other impacts: E1 in cells of [`CELL`], plateau, noise.
    others: [Bound; 3],
}

const DEFAULT: Scheme = Scheme {
    scene: "flyer",
    cell: CELL,
    l1: bounds::standard::DEFAULT_L1,
    plateau: bounds::standard::DEFAULT_PLATEAU,
    noise: bounds::standard::DEFAULT_NOISE,
    overshoot: None,
    others: [
        bounds::impacts::DEFAULT_E1,
        bounds::impacts::DEFAULT_PLATEAU,
        bounds::impacts::DEFAULT_NOISE,
    ],
};

const BEST: Scheme = Scheme {
    scene: "flyer_best",
    cell: 0.5 * CELL,
    l1: bounds::standard::BEST_L1,
    plateau: bounds::standard::BEST_PLATEAU,
    noise: bounds::standard::BEST_NOISE,
    overshoot: Some(bounds::standard::BEST_OVERSHOOT),
    others: [bounds::impacts::BEST_E1, bounds::impacts::BEST_PLATEAU, bounds::impacts::BEST_NOISE],
};

/// A part of a shipped scene.
fn part(scene: &str, key: &str) -> Value {
    let path = root().join(format!("inputs/{scene}.json"));
    let text = fs::read_to_string(path).expect("the scene is shipped");
    serde_json::from_str::<Value>(&text).expect("it is JSON")[key].take()
}

/// Another scene with the scheme of this one.
fn with_scheme(job: Job, scheme: &str) -> Job {
    let job = job.set(format!("method={}", part(scheme, "method")));
    let courant = &part(scheme, "time")["courant"];
    let viscosity = part(scheme, "artificial_viscosity");
    job.set(format!("artificial_viscosity={viscosity}")).set(format!("time.courant={courant}"))
}

/// Drift of energy, of every run here.
fn energy(table: &mut Table, name: &str, run: &Outcome) {
    let drift = run.summary.energy.drift;
    table.check(&format!("{name}: energy drift"), drift, bounds::standard::ENERGY_DRIFT);
}

/// Both schemes on the standard problem.
pub fn standard(table: &mut Table) {
    for scheme in [DEFAULT, BEST] {
        let Some(run) = table.take(scheme.scene, Job::new(scheme.scene).run()) else { continue };
        for profile in run.summary.profiles.iter().filter(|p| p.time >= 0.5e-6) {
            let name =
                |what: &str| format!("{}.json, {:.1} us: {what}", scheme.scene, profile.time * 1e6);
            let shock = profile.error("shock_position_cells").map(|s| s * scheme.cell / CELL);
            let at = |error: &str| profile.error(error);
            table.check(&name("L1"), at("l1"), scheme.l1);
            table.check(&name("plateau"), at("plateau"), scheme.plateau);
            table.check(&name("noise"), at("noise"), scheme.noise);
            table.check(&name("shock position, cells"), shock, bounds::standard::SHOCK_POSITION);
            match scheme.overshoot {
                Some(bound) => table.check(&name("overshoot"), at("overshoot"), bound),
                None => table.beside(&name("overshoot"), at("overshoot"), "", Unit::Fraction),
            }
            table.check(
                &name("density behind"),
                at("density_plateau"),
                bounds::standard::DENSITY_BEHIND,
            );
            table.check(
                &name("energy behind"),
                at("energy_plateau"),
                bounds::standard::ENERGY_BEHIND,
            );
        }
        energy(table, &format!("{}.json", scheme.scene), &run);
    }
}

/// Order of the default in L1 at both times, from 20 to 2.5 um, and what is left where cells vanish.
pub fn order(table: &mut Table) {
    let mut errors = Vec::new();
    for cell in [20e-6, 10e-6, 5e-6, 2.5e-6] {
        let name = format!("flyer.json, cells of {:.1} um", cell * 1e6);
        let job = Job::new("flyer").set(format!("domain.cell_size={cell:e}"));
        let Some(run) = table.take(&name, job.run()) else { return };
        let profiles = run.summary.profiles.iter().filter(|p| p.time >= 0.5e-6);
        errors.push(profiles.map(|p| (p.time, p.error("l1"))).collect::<Vec<_>>());
    }
    for k in 0..errors[0].len() {
        let when = format!("at {:.1} us", errors[0][k].0 * 1e6);
        let l1: Vec<Option<f64>> = errors.iter().map(|at| at.get(k).and_then(|e| e.1)).collect();
        for (cell, l1) in [20.0, 10.0, 5.0, 2.5].iter().zip(&l1) {
            let name = format!("flyer.json, cells of {cell:.1} um: L1 {when}");
            table.beside(&name, *l1, "", Unit::Fraction);
        }
        let order = l1[0].zip(l1[3]).map(|(coarse, fine)| (coarse / fine).log(8.0));
        let name = format!("order of convergence, 20 to 2.5 um, {when}");
        table.check(&name, order, bounds::order::ORDER);
        // a straight line through the two finest
        let limit = l1[2].zip(l1[3]).map(|(coarse, fine)| 2.0 * fine - coarse);
        let name = format!("L1 where cells vanish, by a line through the finest two, {when}");
        table.check(&name, limit, bounds::order::L1_OF_VANISHING_CELLS);
    }
}

/// A metal: name, density [kg/m3], c0 [m/s], s [-], gamma0 [-], by the handbooks.
type Metal = (&'static str, f64, f64, f64, f64);

const COPPER: Metal = ("copper", 8930.0, 3940.0, 1.489, 1.96);
const ALUMINIUM: Metal = ("aluminium", 2785.0, 5386.0, 1.339, 2.1);
const TANTALUM: Metal = ("tantalum", 16654.0, 3410.0, 1.2, 1.6);
const TUNGSTEN: Metal = ("tungsten", 19224.0, 4029.0, 1.237, 1.54);
const STEEL: Metal = ("steel", 7890.0, 4580.0, 1.49, 2.2);
const MAGNESIUM: Metal = ("magnesium", 1740.0, 4492.0, 1.263, 1.43);
const PMMA: Metal = ("pmma", 1186.0, 2600.0, 1.52, 0.97);

/// Flyer, target, speed [m/s], thickness of the flyer [m], two times [s], whether the flyer is the
/// softer one and parts from the target.
const IMPACTS: [(Metal, Metal, f64, f64, [f64; 2], bool); 11] = [
    (COPPER, ALUMINIUM, 1000.0, 0.25e-3, [0.3e-6, 0.8e-6], false),
    (COPPER, COPPER, 1000.0, 0.5e-3, [0.5e-6, 1.0e-6], false),
    (ALUMINIUM, ALUMINIUM, 300.0, 0.5e-3, [0.4e-6, 0.9e-6], false),
    (COPPER, ALUMINIUM, 300.0, 0.5e-3, [0.5e-6, 1.0e-6], false),
    (COPPER, ALUMINIUM, 3000.0, 0.5e-3, [0.3e-6, 0.6e-6], false),
    (COPPER, ALUMINIUM, 5000.0, 0.5e-3, [0.25e-6, 0.5e-6], false),
    (TANTALUM, PMMA, 2000.0, 0.5e-3, [0.6e-6, 1.0e-6], false),
    (TUNGSTEN, ALUMINIUM, 600.0, 0.5e-3, [0.5e-6, 1.0e-6], false),
    (STEEL, COPPER, 5000.0, 0.5e-3, [0.25e-6, 0.5e-6], false),
    (ALUMINIUM, COPPER, 1500.0, 0.5e-3, [0.4e-6, 0.8e-6], true),
    (MAGNESIUM, STEEL, 2000.0, 0.5e-3, [0.4e-6, 0.8e-6], true),
];

/// A case's length of the exact plateau at its times [m], 0 where there is none.
fn plateaus(
    (flyer, target, speed, thickness, times, _): (Metal, Metal, f64, f64, [f64; 2], bool),
) -> Result<Vec<f64>, String> {
    let material = |(_, rho0, c0, s, gamma0): Metal| MieGruneisen { rho0, c0, s, gamma0 };
    let body = |metal, [lower, upper]: [f64; 2], velocity| ImpactBody {
        material: material(metal),
        lower,
        upper,
        velocity,
    };
    let impact =
        Impact::new(body(flyer, [-thickness, 0.0], speed), body(target, [0.0, TARGET], 0.0))
            .map_err(|e| e.to_string())?;
    let solution = impact.solve(&times, &[], Accuracy::default()).map_err(|e| e.to_string())?;
    let plateau = |s: &Snapshot| s.landmarks.and_then(|l| l.plateau).map_or(0.0, |[a, b]| b - a);
    Ok(solution.snapshots.iter().map(plateau).collect())
}

fn impact(
    scheme: &Scheme,
    (flyer, target, speed, thickness, times, soft): (Metal, Metal, f64, f64, [f64; 2], bool),
) -> Job {
    let mut materials = serde_json::Map::new();
    for (name, density, c0, s, gamma0) in [flyer, target] {
        let eos = json!({"type": "mie_gruneisen", "c0": c0, "s": s, "gamma0": gamma0});
        materials.insert(name.into(), json!({"density": density, "eos": eos}));
    }
    let job = Job::new(scheme.scene)
        .set(format!("materials={}", Value::Object(materials)))
        .set(format!("bodies.flyer.material={}", flyer.0))
        .set(format!("bodies.target.material={}", target.0))
        .set(format!("bodies.flyer.velocity=[{speed}]"))
        .set(format!("bodies.flyer.box.lower=[{:e}]", -thickness))
        .set(format!("domain.lower=[{:e}]", if soft { -4e-3 } else { -2e-3 }))
        .set("domain.upper=[0.011]")
        .set(format!("time.end={:e}", times[1]))
        .set(format!("output.profiles.times=[{:e},{:e}]", times[0], times[1]));
    if soft { job.set(r#"contact={"type":"frictionless"}"#) } else { job }
}

/// Both schemes on other materials and speeds; plateau and noise where the plateau is over 20
/// cells.
pub fn impacts(table: &mut Table) {
    for scheme in [DEFAULT, BEST] {
        let [e1, plateau, noise] = scheme.others;
        for case in IMPACTS {
            let (flyer, target, speed, ..) = case;
            let name = format!("{}: {} on {} at {speed} m/s", scheme.scene, flyer.0, target.0);
            let Some(exact) = table.take(&name, plateaus(case)) else { continue };
            let Some(run) = table.take(&name, impact(&scheme, case).run()) else { continue };
            for (profile, exact) in run.summary.profiles.iter().zip(exact) {
                let name = |what: &str| format!("{name}, {:.2} us: {what}", profile.time * 1e6);
                let cells = profile.error("e1_cells").map(|e| e * scheme.cell / CELL);
                table.check(&name("E1, cells"), cells, e1);
                if exact > 20.0 * CELL {
                    table.check(&name("plateau"), profile.error("plateau"), plateau);
                    table.check(&name("noise"), profile.error("noise"), noise);
                }
            }
            energy(table, &name, &run);
        }
    }
}

/// Noh's problem on a line with both schemes: mean density away from the wall's heating.
pub fn noh(table: &mut Table) {
    for scheme in ["flyer", "flyer_best"] {
        let mut errors = Vec::new();
        for cells in [100, 200, 400] {
            let name = format!("noh_planar.json by {scheme}.json, {cells} cells");
            let cell = 1.0 / f64::from(cells);
            let job = Job::new("noh_planar").set(format!("domain.cell_size={cell:e}"));
            let job = job.set("heat_mixing=null");
            let Some(run) = table.take(&name, with_scheme(job, scheme).run()) else { return };
            let Some(profile) = run.summary.profiles.last() else { return };
            let mean = profile.error("mean_density_error");
            table.check(&format!("{name}: mean density off 4"), mean, bounds::noh::MEAN_DENSITY);
            errors.push(profile.error("density_l1"));
            energy(table, &name, &run);
        }
        let falls = errors.windows(2).all(|e| e[1] < e[0]);
        let listed: Vec<String> = errors.iter().flatten().map(|e| format!("{e:.4}")).collect();
        table.holds(
            &format!("noh by {scheme}.json: L1 of density falls"),
            &listed.join(", "),
            "",
            falls,
        );
    }
}

/// Order in L2 of pressure on a smooth wave.
pub fn smooth(table: &mut Table) {
    let frame = r#"method.frame="total_lagrangian""#;
    let cpdi = r#"method.shape="cpdi""#;
    // all of it in a step is unstable with hat functions where no viscosity damps
    let relaxed = r#"method.pressure_relaxation={"rate":0.3,"interval":1}"#;
    let limited = r#"artificial_viscosity={"linear":0.1,"quadratic":1.25,"limiter":"christensen","limited":"both"}"#;
    let schemes: [(&str, &[&str]); 6] = [
        ("CPDI", &[cpdi, relaxed]),
        ("CPDI, limited viscosity", &[cpdi, relaxed, limited]),
        ("CPDI on quadratics", &[]),
        ("CPDI on quadratics, limited viscosity", &[limited]),
        ("total-Lagrangian", &[frame]),
        ("total-Lagrangian, limited viscosity", &[frame, limited]),
    ];
    for (name, sets) in schemes {
        let mut errors = Vec::new();
        for cell in [40e-6, 20e-6, 10e-6] {
            let mut job = Job::new("simple_wave").set(format!("domain.cell_size={cell:e}"));
            for set in sets {
                job = job.set(*set);
            }
            let name = format!("smooth wave, {name}, {:.0} um", cell * 1e6);
            let Some(run) = table.take(&name, job.run()) else { return };
            let l2 = run.summary.profiles.last().and_then(|p| p.error("l2"));
            table.beside(&format!("{name}: L2"), l2, "", Unit::Fraction);
            errors.push(l2);
        }
        let order = errors[0].zip(errors[2]).map(|(coarse, fine)| (coarse / fine).log(4.0));
        table.check(&format!("smooth wave, {name}: order"), order, bounds::smooth::ORDER);
    }
}

/// Seconds of the time loop for an error of 1 %, in the total-Lagrangian frame.
pub fn cost(table: &mut Table) {
    let job = Job::new("flyer")
        .set(r#"method.frame="total_lagrangian""#)
        .set(r#"method.transfer={"fmpm":6}"#)
        .set("output.histories=null");
    let name = "total-Lagrangian, FMPM(6)";
    let Some(run) = table.take(name, job.run()) else { return };
    let worst = run.summary.profiles.iter().filter(|p| p.time >= 0.5e-6);
    let worst = worst.filter_map(|p| p.error("l1")).fold(0.0, f64::max);
    table.check(&format!("{name}: worst L1"), Some(worst), bounds::cost::L1);
    let seconds = Some(run.summary.loop_cpu_seconds);
    table.check(&format!("{name}: user CPU seconds of the loop"), seconds, bounds::cost::LOOP_CPU);
}
