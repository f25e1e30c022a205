//! Spall: pull-back of the free surface, where the plate parts, what energy it keeps.

use flyer_mpm::driver::output::csv::{CsvTable, read_csv};

use crate::bounds::effects as bounds;
use crate::runs::{Job, Outcome};
use crate::table::Table;

/// Both plates as shipped, and a thick target, in which the fan is wide enough for the pull-back.
pub fn check(table: &mut Table) {
    if let Some(run) = table.take("spall.json", Job::new("spall").run()) {
        let plane = plane(&run, 1e-3, 1e-5);
        table.check("spall: plane off the flyer's thickness [cells]", plane, bounds::spall::PLANE);
        table.check("spall: energy drift", run.summary.energy.drift, bounds::spall::ENERGY_DRIFT);
        let momentum = run.summary.momentum.drift;
        table.check("spall: momentum drift", momentum, bounds::spall::MOMENTUM_DRIFT);
    }
    let limit = r#"{"type":"tension_limit","stress":1e9}"#;
    let job = Job::new("spall")
        .set(format!("materials.aluminium.failure={limit}"))
        .set("domain.upper=[0.0215]")
        .set("domain.cell_size=2.5e-6")
        .set("bodies.target.box.upper=[0.02]")
        .set("time.end=4.3e-6")
        .set("output.profiles.times=[4.3e-6]")
        .set("output.histories.interval=1e-9");
    if let Some(run) = table.take("spall by a limit in a thick target", job.run()) {
        let acoustic = 2e9 / (2785.0 * 5386.0);
        let error = pull_back(&run).map(|fall| fall / acoustic - 1.0);
        table.check(
            "spall by a limit: pull-back against 2 sigma/(rho0 c0)",
            error,
            bounds::spall::PULL_BACK,
        );
    }
}

/// How far the innermost plane of the scab is from `thickness` [m] off the rear [cells].
fn plane(run: &Outcome, thickness: f64, cell: f64) -> Option<f64> {
    let last: CsvTable = run.tables().ok()?.pop()?;
    let damage = last.numbers("damage")?;
    let x = last.numbers("x")?;
    // where the plate has opened widest; two particles a cell, in order from the rear
    let rows = 1..x.len();
    let widest = rows.max_by(|&a, &b| (x[a] - x[a - 1]).total_cmp(&(x[b] - x[b - 1])))?;
    damage.iter().any(|d| *d >= 1.0).then(|| {
        let scab = (x.len() - widest) as f64 * 0.5 * cell;
        (scab - thickness) / cell
    })
}

/// The first fall of the free surface's velocity from its plateau [m/s].
fn pull_back(run: &Outcome) -> Option<f64> {
    let histories = read_csv(&run.folder.join("histories.csv")).ok()?;
    let u = histories.numbers("target_upper_velocity")?;
    let arrived = u.iter().position(|u| *u > 150.0)?;
    let falls = (arrived + 40..u.len()).find(|&k| u[k] < 194.0)?;
    let plateau = u[arrived + 20..falls - 5].iter().sum::<f64>() / (falls - arrived - 25) as f64;
    let lowest = (falls..u.len() - 1).find(|&k| u[k + 1] > u[k])?;
    Some(plateau - u[lowest])
}
