//! Plates of finite width, and waves at an angle to the grid.

use flyer_mpm::driver::output::csv::CsvTable;
use flyer_mpm::driver::output::summary::ProfileSummary;

use crate::bounds::{Unit, plane as bounds};
use crate::runs::{Job, Outcome};
use crate::table::Table;

/// A figure of the last profile time that has it.
pub fn last(run: &Outcome, of: impl Fn(&ProfileSummary) -> Option<f64>) -> Option<f64> {
    run.summary.profiles.iter().rev().find_map(of)
}

/// The plate of finite width lives through corners and jets; its centre line is that of a line
/// until the edge release comes.
pub fn finite_flyer(table: &mut Table) {
    let Some(run) = table.take("flyer_2d.json to 1 us", Job::new("flyer_2d").run()) else { return };
    table.check(
        "flyer_2d.json: energy drift",
        run.summary.energy.drift,
        bounds::finite::ENERGY_DRIFT,
    );
    let momentum = run.summary.momentum.drift;
    table.check("flyer_2d.json: momentum drift", momentum, bounds::finite::MOMENTUM_DRIFT);
    // 0.9 of the edge release's time to the centre
    let early =
        || Job::new("flyer_2d").set("time.end=2.1e-7").set("output.profiles.times=[2.1e-7]");
    let line = [
        "domain.upper=[0.0048, 2e-5]",
        "bodies.flyer.box.upper=[0, 2e-5]",
        "bodies.target.box.upper=[0.004, 2e-5]",
        "boundary.y_upper=symmetry",
    ];
    let line = line.iter().fold(early(), |job, set| job.set(*set)).run();
    let Some(line) = table.take("the same as one row of cells", line) else { return };
    let Some(plate) = table.take("flyer_2d.json to 0.21 us", early().run()) else { return };
    let apart = centre_lines(&plate, &line);
    table.check("centre line against one row, of P2", apart, bounds::finite::CENTRE_LINE);
}

/// Largest difference of the pressure on the lowest row of particles, of the largest.
fn centre_lines(plate: &Outcome, line: &Outcome) -> Option<f64> {
    let row = |run: &Outcome| -> Option<Vec<(f64, f64)>> {
        let tables = run.tables().ok()?;
        let table = tables.last()?;
        let (x, y) = (table.numbers("x")?, table.numbers("y")?);
        let p = table.numbers("pressure")?;
        let mut row: Vec<(f64, f64)> =
            (0..x.len()).filter(|&k| y[k] < 1e-5).map(|k| (x[k], p[k])).collect();
        row.sort_by(|a, b| a.0.total_cmp(&b.0));
        Some(row)
    };
    let (plate, line) = (row(plate)?, row(line)?);
    let scale = line.iter().fold(0.0f64, |m, (_, p)| m.max(p.abs()));
    let apart = plate.iter().zip(&line).map(|(a, b)| (a.1 - b.1).abs() / scale);
    (plate.len() == line.len()).then(|| apart.fold(0.0, f64::max))
}

/// Waves at 30 degrees against waves along x, on the same cells.
pub fn oblique(table: &mut Table) {
    let Some(turned) = table.take("oblique_impact.json", Job::new("oblique_impact").run()) else {
        return;
    };
    // the folder is the same
    let turned_interface = interface_errors(&turned, 30.0);
    let sets = [
        "bodies.flyer.rotation=null",
        "bodies.target.rotation=null",
        "bodies.flyer.box={\"lower\": [-0.0005, -0.003], \"upper\": [0, 0.003]}",
        "bodies.target.box={\"lower\": [0, -0.003], \"upper\": [0.002, 0.003]}",
        "bodies.flyer.velocity=[1000, 0]",
        "reference.flyer_impact.front.angle=0",
    ];
    let aligned = sets.iter().fold(Job::new("oblique_impact"), |job, set| job.set(*set)).run();
    let Some(aligned) = table.take("the same along x", aligned) else { return };
    let aligned_interface = interface_errors(&aligned, 0.0);
    let l1 = |run: &Outcome| last(run, |p| p.error("l1"));
    let ratio = l1(&turned).zip(l1(&aligned)).map(|(a, b)| a / b);
    table.beside("along x: L1", l1(&aligned), "", Unit::Fraction);
    table.beside("at 30 degrees: L1", l1(&turned), "", Unit::Fraction);
    table.check("L1 at 30 degrees over that along x", ratio, bounds::oblique::L1_OVER_THAT_ALONG_X);
    let noise = last(&turned, |p| p.error("noise"));
    table.check("at 30 degrees: plateau noise", noise, bounds::oblique::NOISE);
    let interface = |of: &str, time: usize| {
        format!("{of}: pressure at the interface, {} us", 0.1 * (time + 1) as f64)
    };
    let at = |errors: &Option<Vec<f64>>, k: usize| errors.as_ref().map(|all| all[k]);
    table.check(
        &interface("at 30 degrees", 0),
        at(&turned_interface, 0),
        bounds::oblique::INTERFACE_PRESSURE,
    );
    table.beside(&interface("along x", 0), at(&aligned_interface, 0), "", Unit::Fraction);
    // the head of the fan is 4 cells away by then, and smeared over them
    table.beside(&interface("at 30 degrees", 1), at(&turned_interface, 1), "", Unit::Fraction);
    table.beside(&interface("along x", 1), at(&aligned_interface, 1), "", Unit::Fraction);
    for (of, run) in [("at 30 degrees", &turned), ("along x", &aligned)] {
        let (density, energy) = (
            last(run, |p| p.error("density_interface")),
            last(run, |p| p.error("energy_interface")),
        );
        table.beside(&format!("{of}: density at the interface"), density, "", Unit::Fraction);
        table.beside(&format!("{of}: energy at the interface"), energy, "", Unit::Fraction);
    }
    let drift = turned.summary.energy.drift;
    table.check("at 30 degrees: energy drift", drift, bounds::oblique::ENERGY_DRIFT);
}

/// Greatest error of pressure among the particles within ten cells of the interface, of P2, at
/// each profile time; on the target's side alone once the release is near on the flyer's.
/// `angle` [degrees] is that of the waves.
fn interface_errors(run: &Outcome, angle: f64) -> Option<Vec<f64>> {
    // state 2 of copper at 1 km/s on aluminium
    let (u2, p2) = (690.935777, 12.144294e9);
    let (normal_y, normal_x) = angle.to_radians().sin_cos();
    let near = 10.0 * 2e-5;
    let release = 1.5e-7;
    let times = run.summary.profiles.iter().map(|p| p.time);
    let tables = run.tables().ok()?;
    let of_time = |(time, table): (f64, &CsvTable)| -> Option<f64> {
        let (x, y) = (table.numbers("x")?, table.numbers("y")?);
        let p = table.numbers("pressure")?;
        let from = if time < release { -near } else { 0.0 };
        let errors = (0..x.len()).filter_map(|k| {
            let along = x[k] * normal_x + y[k] * normal_y - u2 * time;
            let across = y[k] * normal_x - x[k] * normal_y;
            let looked_at = (from..near).contains(&along) && across.abs() < 1e-3;
            looked_at.then_some((p[k] - p2).abs() / p2)
        });
        errors.reduce(f64::max)
    };
    times.zip(&tables).map(of_time).collect()
}
