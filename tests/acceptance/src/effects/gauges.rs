//! Readings of gauges as experimenters have them, against closed values.

use super::plates::{Plate, meet};
use crate::bounds::{Unit, effects::gauges as bounds};
use crate::runs::{Job, Outcome};
use crate::table::Table;

/// The reading of a quantity of a gauge, and its time [s].
fn timed(run: &Outcome, gauge: &str, quantity: &str) -> Option<(f64, Option<f64>)> {
    let found = run.summary.gauges.iter().find(|r| r.gauge == gauge && r.quantity == quantity);
    found.map(|reading| (reading.value, reading.time))
}

/// The reading of a quantity of a gauge.
fn reading(run: &Outcome, gauge: &str, quantity: &str) -> Option<f64> {
    timed(run, gauge, quantity).map(|(value, _)| value)
}

/// Checks a reading against its closed value.
fn against(table: &mut Table, what: &str, reading: Option<f64>, exact: Option<f64>) {
    let error = reading.zip(exact).map(|(reading, exact)| reading / exact - 1.0);
    let figure = format!("{what}, {:.5e}", exact.unwrap_or(f64::NAN));
    table.check(&figure, error, bounds::READING);
}

/// Interface, free surface and pull-back.
fn spall(table: &mut Table) {
    let (thickness, speed, stress) = (3e-3, 200.0, 1e9);
    let run = Job::new("spall").set("output.histories.interval=5e-10").run();
    let Some(run) = table.take("spall.json", run) else { return };
    let of = |u: f64| Plate::of(&run, "aluminium", u);
    let met = of(speed).zip(of(0.0)).and_then(|(flyer, target)| meet(&flyer, &target));
    let front = met.and_then(|u| of(0.0)?.shock(u));
    let released = met.and_then(|u| Some(of(0.0)?.shocked(u)?.released_until(|s| s.p).u));
    let interface = reading(&run, "target_lower", "plateau velocity");
    against(table, "spall: interface velocity [m/s]", interface, met);
    let surface = |quantity: &str| reading(&run, "target_upper", quantity);
    let velocity = surface("plateau velocity");
    against(table, "spall: free-surface velocity [m/s]", velocity, released);
    let arrival = front.map(|front| thickness / front.speed);
    against(table, "spall: arrival at the free surface [s]", surface("arrival"), arrival);
    // in tension the cold curve is linear, K = rho0 c0^2: p = K chi + gamma0 rho0 e; along the
    // isentrope dp/du = sqrt(rho0 (K + gamma0 p))
    let (rho0, c0, gamma0) = (2785.0f64, 5386.0, 2.1);
    let stiffness = rho0 * c0 * c0;
    let root = |p: f64| (stiffness + gamma0 * p).sqrt();
    let fall = 4.0 / (gamma0 * rho0.sqrt()) * (root(0.0) - root(-stress));
    against(table, "spall: pull-back [m/s]", surface("pull-back"), Some(fall));
    let strength = surface("spall strength").map(|s| s / (0.5 * rho0 * c0 * fall));
    against(table, "spall: strength over 1/2 rho0 c0 du", strength, Some(1.0));
    // a limit that acts at once cuts off the sharp minimum of the velocity
    let limit = r#"{"type":"tension_limit","stress":1e9}"#;
    for cells in [1, 2] {
        let job = Job::new("spall")
            .set(format!("domain.cell_size={:e}", 1e-5 / f64::from(cells)))
            .set(format!("materials.aluminium.failure={limit}"))
            .set("output.histories.interval=5e-10");
        if let Some(run) = table.take("spall.json with a tension limit", job.run()) {
            let error = reading(&run, "target_upper", "pull-back").map(|u| u / fall - 1.0);
            let figure =
                format!("spall.json with a limit, {cells}00 cells a flyer: pull-back off by");
            table.beside(&figure, error, "tension_limit", Unit::Fraction);
        }
    }
}

/// A window, its interferometer, and the impulse across a plane.
fn window(table: &mut Table) {
    let (fringe, correction, at) = (50.0, 0.28, 5e-4);
    let visar = format!(
        r#"[{{"name":"visar","body":"sample","at":[2e-3],"fringe":{fringe},"window_correction":{correction}}}]"#
    );
    let job = Job::new("gas_gun_window").set(format!("output.histories.velocimeters={visar}"));
    if let Some(run) = table.take("gas_gun_window.json with a velocimeter", job.run()) {
        let seen = super::plates::seen(&run).map(|(exact, _)| exact);
        let velocity = reading(&run, "visar", "plateau velocity");
        against(table, "window: velocity of the interface [m/s]", velocity, seen);
        let fringes = super::plates::histories(&run).and_then(|histories| {
            let rows = histories.numbers("time")?.iter().zip(histories.numbers("visar_fringes")?);
            rows.filter(|(t, _)| **t > 0.6e-6).map(|(_, n)| *n).next()
        });
        let exact = seen.map(|u| u * (1.0 + correction) / fringe);
        against(table, "window: fringes", fringes, exact);
    }
    // before the shock has crossed the sample
    let planes = format!(r#"[{{"name":"plane","at":{at}}}]"#);
    let job = Job::new("gas_gun_window")
        .set("time.end=3e-7")
        .set("output.profiles.times=[3e-7]")
        .set(format!("output.histories.planes={planes}"));
    if let Some(run) = table.take("gas_gun_window.json with a plane", job.run()) {
        let found = timed(&run, "plane", "impulse");
        let impulse = || {
            let (flyer, sample) =
                (Plate::of(&run, "copper", 600.0)?, Plate::of(&run, "aluminium", 0.0)?);
            let u = meet(&flyer, &sample)?;
            let front = sample.shock(u)?;
            let density = 2703.0 * front.speed / (front.speed - u);
            Some(density * u * (front.speed * found?.1? - at))
        };
        let exact = impulse();
        against(table, "plane: impulse [N s/m2]", found.map(|(value, _)| value), exact);
    }
}

/// All gauges.
pub fn check(table: &mut Table) {
    spall(table);
    window(table);
}
