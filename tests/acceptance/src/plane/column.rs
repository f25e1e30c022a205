//! One column of cells between planes of symmetry against the run on a line.

use flyer_mpm::driver::output::csv::CsvTable;

use crate::bounds::plane as bounds;
use crate::runs::Job;
use crate::table::Table;

/// `flyer.json` with a y: one column of cells.
fn column() -> Job {
    let sets = [
        "domain.lower=[-0.001, 0]",
        "domain.upper=[0.009, 1e-5]",
        "bodies.flyer.box.lower=[-0.0005, 0]",
        "bodies.flyer.box.upper=[0, 1e-5]",
        "bodies.target.box.lower=[0, 0]",
        "bodies.target.box.upper=[0.008, 1e-5]",
        "bodies.flyer.velocity=[1000, 0]",
        "bodies.target.velocity=[0, 0]",
        "bodies.flyer.particles_per_cell=[2, 2]",
        "bodies.target.particles_per_cell=[2, 2]",
        "boundary={\"y_lower\": \"symmetry\", \"y_upper\": \"symmetry\"}",
    ];
    sets.iter().fold(Job::new("flyer"), |job, set| job.set(*set))
}

/// Largest difference of a field, of its largest value; each particle of the line has two.
fn apart(line: &CsvTable, column: &CsvTable, names: [&str; 2]) -> Option<f64> {
    let (line, column) = (line.numbers(names[0])?, column.numbers(names[1])?);
    let scale = line.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let apart = column.iter().enumerate().map(|(k, v)| (v - line[k / 2]).abs() / scale);
    Some(apart.fold(0.0, f64::max))
}

/// Every field at each profile time.
pub fn check(table: &mut Table) {
    let end = |job: Job| {
        let job = job.set("time.end=5e-7").set("output.profiles.times=[2e-7, 5e-7]");
        job.set("output.histories=null").run()
    };
    let line = end(Job::new("flyer")).and_then(|run| run.tables());
    let column = end(column()).and_then(|run| run.tables());
    let Some(line) = table.take("flyer.json on a line", line) else { return };
    let Some(column) = table.take("flyer.json as a column", column) else { return };
    for names in [
        ["x", "x"],
        ["velocity", "velocity_x"],
        ["pressure", "pressure"],
        ["density", "density"],
        ["specific_internal_energy", "specific_internal_energy"],
    ] {
        let pairs = line.iter().zip(&column);
        let worst = pairs
            .map(|(line, column)| apart(line, column, names))
            .try_fold(0.0f64, |worst, apart| Some(worst.max(apart?)));
        table.check(
            &format!("column against line: {}", names[0]),
            worst,
            bounds::column::DIFFERENCE,
        );
    }
}
