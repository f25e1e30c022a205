//! Shocks of each equation of state against its jump conditions: a slab runs into a wall.

use crate::bounds::{Unit, effects as bounds};
use crate::runs::{Job, Outcome};
use crate::table::Table;

/// Name, material and speed of the slab [m/s].
const SLABS: [(&str, &str, f64); 12] = [
    (
        "mie_gruneisen",
        r#"{"density": 2785.0, "eos": {"type": "mie_gruneisen", "c0": 5386.0, "s": 1.339, "gamma0": 2.1}}"#,
        1000.0,
    ),
    (
        "mie_gruneisen, s2",
        r#"{"density": 2785.0, "eos": {"type": "mie_gruneisen", "c0": 5386.0, "s": 1.339, "s2": 3e-5, "gamma0": 2.1}}"#,
        1000.0,
    ),
    (
        "mie_gruneisen, Gamma",
        r#"{"density": 2785.0, "eos": {"type": "mie_gruneisen", "c0": 5386.0, "s": 1.339, "gamma0": 2.1, "gruneisen": "gamma_constant"}}"#,
        1500.0,
    ),
    (
        "stiffened_gas",
        r#"{"density": 1000.0, "eos": {"type": "stiffened_gas", "gamma": 4.4, "p_inf": 6e8}}"#,
        500.0,
    ),
    ("tait", r#"{"library": "water"}"#, 500.0),
    ("tillotson, aluminium", r#"{"library": "aluminium_tillotson"}"#, 2000.0),
    ("tillotson, iron", r#"{"library": "iron_tillotson"}"#, 3000.0),
    ("jwl, burnt", r#"{"library": "tnt", "eos": {"burn": "complete"}}"#, 500.0),
    ("tantalum", r#"{"library": "tantalum"}"#, 1000.0),
    (
        "noble_abel_stiffened_gas",
        r#"{"density": 1057.0, "eos": {"type": "noble_abel_stiffened_gas", "gamma": 1.19, "p_inf": 7028e5, "covolume": 6.61e-4}}"#,
        200.0,
    ),
    (
        "vinet",
        r#"{"density": 8930.0, "eos": {"type": "vinet", "bulk_modulus": 138.6e9, "bulk_modulus_derivative": 4.96, "gamma0": 1.96}}"#,
        800.0,
    ),
    (
        "davis_reactants",
        r#"{"density": 1895.0, "eos": {"type": "davis_reactants", "a": 1800.0, "b": 4.6, "c": 0.34, "gamma0": 0.56, "z": 0.3}}"#,
        500.0,
    ),
];

/// Plateaus of the last profile, and the energy of the whole.
fn plateaus(table: &mut Table, name: &str, run: &Outcome) {
    let last = run.summary.profiles.last();
    for (key, what) in
        [("plateau", "pressure"), ("density_plateau", "density"), ("energy_plateau", "energy")]
    {
        let value = last.and_then(|p| p.error(key));
        table.check(&format!("{name}: {what} behind the shock"), value, bounds::equations::PLATEAU);
    }
    let drift = run.summary.energy.drift;
    table.check(&format!("{name}: energy drift"), drift, bounds::equations::ENERGY_DRIFT);
}

/// Each equation of state.
pub fn check(table: &mut Table) {
    for (name, material, speed) in SLABS {
        let job = Job::new("piston")
            .set(format!("materials.aluminium={material}"))
            .set(format!("bodies.slab.velocity=[{}]", -speed))
            .set("time.end=4e-7")
            .set("output={\"profiles\": {\"times\": [4e-7]}}");
        // products are under pressure on their own: held at the far side too
        let job = match name.starts_with("jwl") {
            true => job
                .set("domain.upper=[0.006]")
                .set("bodies.slab.box.upper=[0.006]")
                .set("boundary.x_upper=outflow")
                .set("time.end=3e-7")
                .set("output={\"profiles\": {\"times\": [3e-7]}}"),
            false => job,
        };
        let Some(run) = table.take(name, job.run()) else { continue };
        plateaus(table, name, &run);
    }
}

/// Pores that close.
pub fn porous(table: &mut Table) {
    let run = Job::new("porous_impact").run();
    if let Some(run) = table.take("porous_impact.json", run) {
        plateaus(table, "p_alpha, with a precursor", &run);
        let l1 = run.summary.profiles.last().and_then(|p| p.error("l1"));
        table.beside("p_alpha, with a precursor: L1", l1, "", Unit::Fraction);
    }
    let solid = r#"{"type": "tillotson", "a": 0.5, "b": 1.63, "bulk_modulus": 75.2e9, "second_modulus": 65e9, "alpha": 5.0, "beta": 5.0, "e0": 5e6, "e_iv": 3e6, "e_cv": 13.9e6}"#;
    for (name, speed, solid, density, solid_density) in [
        ("p_alpha, 2 km/s", 2000.0, "", 7144.0, 8930.0),
        ("p_alpha over tillotson", 1500.0, solid, 2160.0, 2700.0),
    ] {
        let job = Job::new("porous_impact")
            .set(format!("bodies.slab.velocity=[{}]", -speed))
            .set("time.end=4e-7")
            .set("output={\"profiles\": {\"times\": [4e-7]}}")
            .set(format!("materials.\"porous copper\".density={density}"))
            .set(format!("materials.\"porous copper\".eos.solid_density={solid_density}"));
        let job = match solid {
            "" => job,
            solid => job.set(format!("materials.\"porous copper\".eos.solid={solid}")),
        };
        let Some(run) = table.take(name, job.run()) else { continue };
        plateaus(table, name, &run);
    }
}
