//! Plates on a line that part, meet, and press on each other as one.

use flyer_mpm::driver::output::csv::read_csv;
use flyer_mpm::exact::{Accuracy, Impact, ImpactBody, Separation};
use flyer_mpm::material::MieGruneisen;

use super::waves::last;
use crate::bounds::{Bound, plane as bounds};
use crate::runs::{Job, Outcome};
use crate::table::Table;

const COPPER: MieGruneisen = MieGruneisen { rho0: 8930.0, c0: 3940.0, s: 1.489, gamma0: 1.96 };
const ALUMINIUM: MieGruneisen = MieGruneisen { rho0: 2785.0, c0: 5386.0, s: 1.339, gamma0: 2.1 };

/// Edge of a cell of all scenes here [m].
const CELL: f64 = 1e-5;

/// A softer flyer parts, a gap closes, and a plate cut in two is one plate.
pub fn check(table: &mut Table) {
    for thickness in [0.5e-3, 1e-3] {
        parting(table, thickness);
    }
    closing(table);
    cut_in_two(table);
}

/// Force between the bodies at each step's end: time [s] and force per area [Pa].
fn forces(run: &Outcome) -> Option<Vec<(f64, f64)>> {
    let histories = read_csv(&run.folder.join("histories.csv")).ok()?;
    let [times, forces] = ["time", "contact_force"].map(|name| histories.numbers(name));
    Some(times?.iter().copied().zip(forces?.iter().copied()).collect())
}

/// With a row of the histories every step.
fn every_step(scene: &'static str) -> Job {
    Job::new(scene).set("output.histories={\"interval\": 1e-13}")
}

/// Aluminium of `thickness` [m] at 1500 m/s on copper.
fn parting(table: &mut Table, thickness: f64) {
    let name = format!("soft_flyer.json, {} mm", 1e3 * thickness);
    let job = every_step("soft_flyer")
        .set("domain.lower=[-0.0015]")
        .set(format!("bodies.flyer.box.lower=[{}]", -thickness));
    let Some(run) = table.take(&name, job.run()) else { return };
    let plate = |material, lower, upper, velocity| ImpactBody { material, lower, upper, velocity };
    let flyer = plate(ALUMINIUM, -thickness, 0.0, 1500.0);
    let impact = Impact::new(flyer, plate(COPPER, 0.0, 0.008, 0.0)).ok();
    let separation =
        impact.and_then(|i| Separation::new(&i, 5e-7, Accuracy::default()).ok().flatten());
    let late = separation.zip(forces(&run)).map(|(exact, forces)| {
        let level = 0.01 * exact.peak_pressure;
        let ends = forces.iter().rfind(|f| f.1 > level).map_or(0.0, |f| f.0);
        let falls = exact.falls_to(0.01);
        ((ends - falls).abs() / falls, 2.0 * CELL / ALUMINIUM.c0 / falls)
    });
    let share = bounds::contact::LAST_CONTACT;
    let two_cells = late.map_or(0.0, |(_, two_cells)| two_cells);
    let bound = Bound { at_most: Some(two_cells.max(share.number())), ..share };
    let figure = format!("{name}: last contact, of its time");
    table.check(&figure, late.map(|(late, _)| late), bound);
    let l1 = last(&run, |p| p.error("l1"));
    table.check(&format!("{name}: L1 at 0.5 us"), l1, bounds::contact::PARTING_L1);
    let drift = run.summary.energy.drift;
    table.check(&format!("{name}: energy drift"), drift, bounds::contact::PARTING_ENERGY_DRIFT);
}

/// Copper at 1 km/s, 0.1 mm before aluminium.
fn closing(table: &mut Table) {
    let Some(run) = table.take("gap.json", every_step("gap").run()) else { return };
    let first = forces(&run).and_then(|all| Some(all.iter().find(|f| f.1 != 0.0)?.0));
    let early = first.map(|time| (time - 1e-7).abs());
    table.check("gap.json: closes, off 100 ns [s]", early, bounds::contact::GAP_CLOSES);
}

/// Two bodies of one material that the impact presses together, against one body.
fn cut_in_two(table: &mut Table) {
    let job = || Job::new("flyer").set("time.end=2e-7").set("output.profiles.times=[2e-7]");
    let pressures = |run: Outcome| -> Option<Vec<f64>> {
        Some(run.tables().ok()?.last()?.numbers("pressure")?.to_vec())
    };
    let Some(one) = table.take("flyer.json to 0.2 us", job().run()).map(pressures) else { return };
    let plate = |name: &str, material: &str, [lower, upper]: [f64; 2], velocity: f64| {
        format!(
            r#"{{"name": "{name}", "material": "{material}", "box": {{"lower": [{lower}],
            "upper": [{upper}]}}, "velocity": [{velocity}], "particles_per_cell": [2]}}"#
        )
    };
    let flyer = plate("flyer", "copper", [-0.0005, 0.0], 1000.0);
    let front = plate("target", "aluminium", [0.0, 0.0005], 0.0);
    let rear = plate("rear", "aluminium", [0.0005, 0.008], 0.0);
    let cut = job()
        .set(format!("bodies=[{flyer}, {front}, {rear}]"))
        .set("contact={\"type\": \"frictionless\"}")
        .set("reference=null");
    let Some(two) = table.take("the same cut in two", cut.run()).map(pressures) else { return };
    let apart = one.zip(two).filter(|(one, two)| one.len() == two.len()).map(|(one, two)| {
        let apart = one.iter().zip(&two).map(|(a, b)| (a - b).abs() / 12.144294e9);
        apart.fold(0.0, f64::max)
    });
    table.check("plate cut in two against one, of P2", apart, bounds::contact::PLATE_CUT_IN_TWO);
}
