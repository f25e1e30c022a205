//! Motions that turn and shear: the generalized vortex, a spinning disk, a shear layer, Gresho's
//! vortex.

use super::schemes::{SHAPES, TRANSFERS, name, scheme};
use super::waves::last;
use crate::bounds::{Unit, plane as bounds};
use crate::runs::{Job, Outcome};
use crate::table::Table;

/// Shape functions that hold the vortex at its strains.
const PARALLELOGRAMS: [&str; 2] = ["cpdi", "cpdi_bspline_quadratic"];

/// Error and order of the vortex at 0.15 s, and what each scheme has left of it at 0.5 s.
pub fn vortex(table: &mut Table) {
    let error = |run: &Outcome| last(run, |p| p.error("displacement_l2"));
    for shape in PARALLELOGRAMS {
        for transfer in ["\"flip\"", "\"apic\"", "{\"fmpm\": 4}"] {
            let name = format!("vortex, 0.15 s: {}", name(shape, transfer));
            let errors = [16, 32, 64].map(|cells| {
                let job = scheme(Job::new("vortex"), shape, transfer);
                let run = job.set(format!("domain.cell_size={}", 1.0 / f64::from(cells))).run();
                let error = table.take(&name, run).and_then(|run| error(&run));
                table.beside(&format!("{name}: error at 1/{cells}"), error, "", Unit::Fraction);
                error
            });
            let [coarse, _, fine] = errors;
            if transfer.contains("fmpm") {
                table.check(&format!("{name}: at 1/64"), fine, bounds::vortex::FMPM_ERROR);
            } else {
                let order = coarse.zip(fine).map(|(coarse, fine)| 0.5 * (coarse / fine).log2());
                table.check(&format!("{name}: order"), order, bounds::vortex::ORDER);
            }
        }
    }
    let mut best = None;
    for shape in PARALLELOGRAMS {
        for transfer in TRANSFERS {
            for limit in ["null", "2"] {
                let job = scheme(Job::new("vortex"), shape, transfer)
                    .set("time.end=0.5")
                    .set("output.profiles.times=[0.5]")
                    .set(format!("method.domain_limit={limit}"));
                let limit = if limit == "null" { "" } else { ", domains to 2" };
                let name = format!("vortex, 0.5 s: {}{limit}", name(shape, transfer));
                // a run that a scheme does not survive is listed, not counted as missed
                let run = job.run();
                let found = run.as_ref().ok().and_then(error);
                table.beside(
                    &name,
                    found,
                    if run.is_ok() { "" } else { "ends early" },
                    Unit::Fraction,
                );
                best = match (best, found) {
                    (Some(best), Some(found)) => Some(f64::min(best, found)),
                    (best, found) => best.or(found),
                };
            }
        }
    }
    table.check("vortex, 0.5 s: the best of them", best, bounds::vortex::BEST_LATE_ERROR);
}

/// What each scheme takes of a rotation in three turns; the scene's own choice is bounded.
pub fn disk(table: &mut Table) {
    let loss = |run: &Outcome, name| last(run, |p| p.error(name));
    let run = Job::new("spinning_disk").run();
    if let Some(run) = table.take("spinning_disk.json", run) {
        let taken = loss(&run, "angular_momentum_loss");
        table.check(
            "spinning_disk.json: angular momentum lost",
            taken,
            bounds::disk::ANGULAR_MOMENTUM_LOSS,
        );
        let taken = loss(&run, "energy_loss");
        table.beside("spinning_disk.json: energy lost", taken, "", Unit::Fraction);
    }
    for shape in SHAPES {
        for transfer in TRANSFERS {
            let name = format!("disk: {}", name(shape, transfer));
            let run = scheme(Job::new("spinning_disk"), shape, transfer).run();
            let Ok(run) = run else {
                table.beside(&name, None, "ends early", Unit::Fraction);
                continue;
            };
            let energy = loss(&run, "energy_loss")
                .map_or(String::new(), |e| format!("energy {:.1} %", 100.0 * e));
            table.beside(&name, loss(&run, "angular_momentum_loss"), &energy, Unit::Fraction);
        }
    }
}

/// A gas sheared by 8.
pub fn shear(table: &mut Table) {
    let Some(run) = table.take("shear_layer.json", Job::new("shear_layer").run()) else { return };
    let velocity = last(&run, |p| p.error("velocity_rms"));
    table.check("shear_layer.json: velocity, strain 8", velocity, bounds::shear::VELOCITY);
    let drift = run.summary.energy.drift;
    table.check("shear_layer.json: energy drift", drift, bounds::shear::ENERGY_DRIFT);
}

/// One turn of a vortex in a gas, with the method of the scene, which is the default, and with the
/// default and the centre of the vortex in other places of a cell; velocity over the greatest,
/// pressure over rho V^2/2.
pub fn gresho(table: &mut Table) {
    let by_default = |[x, y]: [f64; 2]| {
        // cells of 0.025 m
        let centre = format!("[{}, {}]", 0.025 * x, 0.025 * y);
        let key = "bodies.gas.velocity_field.gresho.centre";
        vec!["method=\"default\"".to_string(), format!("{key}={centre}")]
    };
    let scenes = [
        ("gresho.json", Vec::new()),
        ("by default, centre at 0.3, 0.1 cells", by_default([0.3, 0.1])),
        ("by default, centre at 0.5, 0.5 cells", by_default([0.5, 0.5])),
    ];
    for (name, sets) in scenes {
        let job = sets.iter().fold(Job::new("gresho"), |job, set| job.set(set));
        let Some(run) = table.take(name, job.run()) else { continue };
        for (profile, turns) in run.summary.profiles.iter().zip(["half a turn", "one turn"]) {
            let whole = turns == "one turn";
            for (error, what, bound) in [
                ("velocity_rms", "velocity", bounds::gresho::VELOCITY),
                ("pressure_rms", "pressure", bounds::gresho::PRESSURE),
            ] {
                let figure = format!("{name}, {turns}: {what}");
                match whole {
                    true => table.check(&figure, profile.error(error), bound),
                    false => table.beside(&figure, profile.error(error), "", Unit::Fraction),
                }
            }
        }
        let drift = run.summary.energy.drift;
        table.check(&format!("{name}: energy drift"), drift, bounds::gresho::ENERGY_DRIFT);
    }
}
