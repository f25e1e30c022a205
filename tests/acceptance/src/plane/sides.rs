//! Sides that waves pass, and walls that rub.

use flyer_mpm::driver::output::csv::CsvTable;

use crate::bounds::plane as bounds;
use crate::runs::{Job, Outcome};
use crate::table::Table;

/// Cells next to the side that are not looked at.
const NEAR: f64 = 10.0;

/// Greatest difference of pressure between a target that ends at `length` [m] and one that goes
/// on, on cells of 10 um, at each profile time.
fn differences(cut: &Outcome, whole: &Outcome, length: f64) -> Option<Vec<f64>> {
    let (cut, whole) = (cut.tables().ok()?, whole.tables().ok()?);
    cut.iter().zip(&whole).map(|(a, b)| difference(a, b, length)).collect()
}

fn difference(cut: &CsvTable, whole: &CsvTable, length: f64) -> Option<f64> {
    let row = |table: &CsvTable| -> Option<Vec<(f64, f64)>> {
        let pressure = table.numbers("pressure")?.iter().copied();
        Some(table.numbers("x")?.iter().copied().zip(pressure).collect())
    };
    let (cut, whole) = (row(cut)?, row(whole)?);
    let at = |x: f64| {
        let next = whole.partition_point(|o| o.0 < x).clamp(1, whole.len() - 1);
        let ((x0, p0), (x1, p1)) = (whole[next - 1], whole[next]);
        p0 + (p1 - p0) * (x - x0) / (x1 - x0)
    };
    let looked_at = cut.iter().filter(|(x, _)| *x < length - NEAR * 1e-5);
    Some(looked_at.map(|(x, p)| (p - at(*x)).abs()).fold(0.0, f64::max))
}

/// `job` with the target's rear at a transmitting side at `length` [m], against the target whole.
fn compare(table: &mut Table, name: &str, job: Job, length: f64, pressure: f64) {
    let cut = (job.clone())
        .set(format!("domain.upper=[{length}]"))
        .set(format!("bodies.target.box.upper=[{length}]"))
        .set("boundary={\"x_upper\": \"transmitting\"}");
    let Some(whole) = table.take(&format!("{name}, target whole"), job.run()) else { return };
    // the folder is the same
    let whole = Outcome { folder: whole.folder.with_extension("whole"), ..whole };
    let _ = std::fs::remove_dir_all(&whole.folder);
    if std::fs::rename(whole.folder.with_extension(""), &whole.folder).is_err() {
        return table.holds(&format!("{name}: files"), "lost", "kept", false);
    }
    let Some(cut) = table.take(&format!("{name}, target cut"), cut.run()) else { return };
    let all = differences(&cut, &whole, length);
    let times = cut.summary.profiles.iter().map(|p| p.time);
    for (k, time) in times.enumerate() {
        let share = all.as_ref().map(|all| all[k] / pressure);
        let figure = format!("{name}: what comes back, {:.2} us", 1e6 * time);
        table.check(&figure, share, bounds::sides::REFLECTED);
    }
    table.check(
        &format!("{name}: energy drift"),
        cut.summary.energy.drift,
        bounds::sides::TRANSMITTING_ENERGY_DRIFT,
    );
    let momentum = cut.summary.momentum.drift;
    table.check(
        &format!("{name}: momentum drift"),
        momentum,
        bounds::sides::TRANSMITTING_MOMENTUM_DRIFT,
    );
}

/// The shock of the standard problem and a pulse of sound leave; a block is slowed by friction.
pub fn check(table: &mut Table) {
    let flyer = || Job::new("flyer").set("reference=null").set("output.histories=null");
    let shock = flyer().set("output.profiles.times=[6.5e-7, 7e-7, 8e-7, 1e-6]");
    compare(table, "shock of 691 m/s", shock, 0.004, 12.144294e9);
    let pulse = flyer()
        .set("bodies.flyer.material=aluminium")
        .set("bodies.flyer.box.lower=[-0.0002]")
        .set("bodies.flyer.velocity=[2]")
        .set("time.end=3e-7")
        .set("output.profiles.times=[2.1e-7, 2.4e-7, 3e-7]");
    // rho c u
    compare(table, "pulse of 1 m/s, 40 cells", pulse, 0.001, 2785.0 * 5386.0);
    let Some(run) = table.take("sliding_block.json", Job::new("sliding_block").run()) else {
        return;
    };
    let mean = run.tables().ok().and_then(|tables| {
        let velocity = tables.last()?.numbers("velocity_x")?;
        Some(velocity.iter().sum::<f64>() / velocity.len() as f64)
    });
    let slowed = mean.map(|v| (1.0 - v) / 0.3 - 1.0);
    table.check(
        "sliding_block.json: slowing over mu g, less 1",
        slowed,
        bounds::sides::SLIDING_BLOCK,
    );
    let momentum = run.summary.momentum.drift;
    table.check(
        "sliding_block.json: momentum drift",
        momentum,
        bounds::sides::SLIDING_MOMENTUM_DRIFT,
    );
}
