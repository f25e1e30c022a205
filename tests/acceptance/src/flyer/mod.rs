//! The standard problem, `inputs/flyer.json`, and problems like it.

mod impacts;
mod same_bits;

use flyer_mpm::driver::output::csv::CsvTable;

use crate::bounds::{Unit, flyer as bounds};
use crate::runs::Job;
use crate::section::{Section, quick};
use crate::table::Table;

/// Subject of the group.
pub const TITLE: &str = "The standard problem, inputs/flyer.json, and problems like it";

/// Sections in the order in which they run.
pub const SECTIONS: [Section; 10] = [
    quick("profiles", profiles),
    quick("cpdi", cpdi),
    quick("impacts", impacts::check),
    quick("attenuation", impacts::check_attenuation),
    quick("convergence", convergence),
    quick("uintah", uintah),
    quick("sod", sod),
    quick("symmetric", symmetric),
    quick("speed", speed),
    quick("bits", same_bits::check),
];

/// The main job as shipped, on two ranks.
fn profiles(table: &mut Table) {
    let Some(run) = table.take("flyer.json on 2 ranks", Job::new("flyer").ranks(2).run()) else {
        return;
    };
    for profile in run.summary.profiles.iter().filter(|p| p.time >= 0.5e-6) {
        for (error, what, bound) in [
            ("l1", "L1", bounds::profiles::L1),
            ("plateau", "plateau", bounds::profiles::PLATEAU),
            ("noise", "noise", bounds::profiles::NOISE),
            ("second_plateau", "second plateau", bounds::profiles::SECOND_PLATEAU),
            ("shock_position_cells", "shock position, cells", bounds::profiles::SHOCK_POSITION),
            ("rise_cells", "rise, cells", bounds::profiles::RISE),
            ("overshoot", "overshoot", bounds::profiles::OVERSHOOT),
        ] {
            let name = format!("flyer.json, {:.1} us: {what}", profile.time * 1e6);
            table.check(&name, profile.error(error), bound);
        }
    }
    table.check(
        "flyer.json: momentum drift",
        run.summary.momentum.drift,
        bounds::profiles::MOMENTUM_DRIFT,
    );
    table.check(
        "flyer.json: energy drift",
        run.summary.energy.drift,
        bounds::profiles::ENERGY_DRIFT,
    );
}

/// Linear CPDI with FMPM(4): with nothing else changed, and with two other pairs of viscosity and
/// pressure relaxation.
fn cpdi(table: &mut Table) {
    let job = || {
        let job = Job::new("flyer").set("method.shape=cpdi");
        job.set(r#"method.transfer={"fmpm":4}"#).ranks(2)
    };
    let cheap = job()
        .set(r#"artificial_viscosity={"linear":0.1,"quadratic":0.75,"limiter":"christensen"}"#)
        .set(r#"method.pressure_relaxation={"rate":0.3,"interval":1}"#);
    let both = job()
        .set(
            r#"artificial_viscosity={"linear":0.1,"quadratic":0.5,"limiter":"christensen","limited":"both"}"#,
        )
        .set(r#"method.pressure_relaxation={"rate":1,"interval":1}"#);
    for (what, job) in [("", job()), (" (.1, .75) P .3/1", cheap), (" (.1, .5) both P 1/1", both)] {
        let name = format!("cpdi, FMPM(4){what}");
        let Some(run) = table.take(&name, job.run()) else { continue };
        for profile in run.summary.profiles.iter().filter(|p| p.time >= 0.5e-6) {
            let name = format!("{name}, {:.1} us: L1", profile.time * 1e6);
            table.check(&name, profile.error("l1"), bounds::cpdi::L1);
        }
    }
}

/// Order of convergence in L1 from 20 to 5 um, at the last time.
fn convergence(table: &mut Table) {
    let mut errors = Vec::new();
    for cell in [20e-6, 10e-6, 5e-6] {
        let name = format!("cells of {:.0} um", cell * 1e6);
        let job = Job::new("flyer").set(format!("domain.cell_size={cell:e}"));
        let Some(run) = table.take(&name, job.run()) else { return };
        let l1 = run.summary.profiles.last().and_then(|p| p.error("l1"));
        table.beside(&format!("{name}: L1 at 1 us"), l1, "", Unit::Fraction);
        errors.push(l1);
    }
    let order = errors[0].zip(errors[2]).map(|(coarse, fine)| (coarse / fine).log(4.0));
    table.check("order of convergence, 20 to 5 um", order, bounds::convergence::ORDER);
}

/// The settings of Burghardt (2010), beside the errors of Uintah with the same settings.
fn uintah(table: &mut Table) {
    let Some(run) = table.take("flyer_uintah.json", Job::new("flyer_uintah").run()) else { return };
    for (time, other) in [(0.5e-6, "Uintah 12.0 %"), (1e-6, "Uintah 16.1 %")] {
        let profile = run.summary.profiles.iter().find(|p| p.time == time);
        let l1 = profile.and_then(|p| p.error("l1"));
        let name = format!("flyer_uintah.json, {:.1} us: L1", time * 1e6);
        table.beside(&name, l1, other, Unit::Fraction);
    }
}

fn sod(table: &mut Table) {
    let Some(run) = table.take("sod.json", Job::new("sod").run()) else { return };
    let l1 = run.summary.profiles.last().and_then(|p| p.error("density_l1"));
    let name = format!("sod.json, {} cells: L1 of density", run.summary.cells);
    table.check(&name, l1, bounds::sod::DENSITY_L1);
}

/// Pressure and shock speed from the files alone.
fn symmetric(table: &mut Table) {
    const PRESSURE: f64 = 20.916e9;
    const SHOCK: f64 = 4684.5;
    let Some(run) = table.take("symmetric_impact.json", Job::new("symmetric_impact").run()) else {
        return;
    };
    let Some(files) = table.take("symmetric_impact.json, files", run.tables()) else { return };
    let times: Vec<f64> = run.summary.profiles.iter().map(|p| p.time).collect();
    let ([.., first, last], [.., t0, t1]) = (&files[..], &times[..]) else {
        let error = Err("two profiles are needed".to_owned());
        table.take::<()>("symmetric_impact.json", error);
        return;
    };
    // The interface moves at half the flyer's speed.
    let plateau = mean_pressure(last, 500.0 * t1, SHOCK * t1);
    let error = plateau.map(|p| p / PRESSURE - 1.0);
    table.check(
        "symmetric impact: pressure against 20.916 GPa",
        error,
        bounds::symmetric::PRESSURE,
    );
    let places = crossing(first, 0.5 * PRESSURE).zip(crossing(last, 0.5 * PRESSURE));
    let error = places.map(|(x0, x1)| (x1 - x0) / (t1 - t0) / SHOCK - 1.0);
    table.check("symmetric impact: Us against 4684.5 m/s", error, bounds::symmetric::SHOCK_SPEED);
}

/// Mean pressure over the middle 40 % of an interval [m].
fn mean_pressure(file: &CsvTable, lower: f64, upper: f64) -> Option<f64> {
    let (centre, reach) = (0.5 * (lower + upper), 0.2 * (upper - lower));
    let pairs = file.numbers("x")?.iter().zip(file.numbers("pressure")?);
    let within: Vec<f64> =
        pairs.filter(|(x, _)| (*x - centre).abs() < reach).map(|(_, p)| *p).collect();
    (!within.is_empty()).then(|| within.iter().sum::<f64>() / within.len() as f64)
}

/// Where the pressure first reaches a level, from the right [m].
fn crossing(file: &CsvTable, level: f64) -> Option<f64> {
    let (x, p) = (file.numbers("x")?, file.numbers("pressure")?);
    let i = (1..p.len()).rev().find(|&i| p[i - 1] >= level && p[i] < level)?;
    Some(x[i] + (x[i - 1] - x[i]) * (level - p[i]) / (p[i - 1] - p[i]))
}

/// One rank, one thread.
fn speed(table: &mut Table) {
    for (scene, bound) in
        [("flyer", bounds::speed::FLYER), ("flyer_uintah", bounds::speed::FLYER_UINTAH)]
    {
        let name = format!("{scene}.json: particle-steps per CPU second");
        let Some(run) = table.take(&name, Job::new(scene).run()) else { continue };
        let rate = run.summary.particle_steps_per_cpu_second;
        table.check(&name, Some(rate), bound);
    }
    let name = "flyer.json, whole process: user CPU seconds";
    let Some(run) = table.take(name, Job::new("flyer").whole().run()) else { return };
    table.check(name, Some(run.user_seconds), bounds::speed::PROCESS_CPU);
    table.beside("  as summary.json has it", Some(run.summary.cpu_seconds), "", Unit::One);
}
