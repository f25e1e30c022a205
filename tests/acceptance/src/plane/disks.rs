//! Two elastic disks that collide: what they keep, and how alike they fly apart.

use flyer_mpm::driver::output::csv::CsvTable;

use crate::bounds::{Unit, plane as bounds};
use crate::runs::Job;
use crate::table::Table;

/// The disks through one velocity field, and with contact.
pub fn check(table: &mut Table) {
    for (name, contact) in
        [("disks.json", "null"), ("the same with contact", "{\"type\": \"frictionless\"}")]
    {
        let run = Job::new("disks").set(format!("contact={contact}")).run();
        let Some(run) = table.take(name, run) else { continue };
        let drift = run.summary.energy.drift;
        table.check(&format!("{name}: total energy"), drift, bounds::disks::ENERGY_DRIFT);
        let last = run.tables().ok().and_then(|mut tables| tables.pop());
        let figures = last.as_ref().and_then(halves);
        let of = |figure: fn(&Halves) -> f64| figures.as_ref().map(figure);
        let figure = format!("{name}: sum of momenta, of one");
        table.check(&figure, of(|h| h.momentum), bounds::disks::MOMENTUM);
        let figure = format!("{name}: angular momentum, of one's m v r");
        table.check(&figure, of(|h| h.angular), bounds::disks::ANGULAR_MOMENTUM);
        let figure = format!("{name}: state against its mirror image");
        table.check(&figure, of(|h| h.mirror), bounds::disks::MIRROR_IMAGE);
        table.beside(&format!("{name}: speed back over speed in"), of(|h| h.back), "", Unit::One);
    }
}

/// What the two disks' last states have in common.
struct Halves {
    momentum: f64,
    angular: f64,
    mirror: f64,
    back: f64,
}

/// Sums and differences of the disks below and above the diagonal x + y = 1.
fn halves(table: &CsvTable) -> Option<Halves> {
    let column = |name: &str| table.numbers(name);
    let (x, y) = (column("x")?, column("y")?);
    let (u, v) = (column("velocity_x")?, column("velocity_y")?);
    let (density, volume) = (column("density")?, column("volume")?);
    let mass = |k: usize| density[k] * volume[k];
    let (mut below, mut above): (Vec<_>, Vec<_>) = (0..x.len()).partition(|&k| x[k] + y[k] < 1.0);
    // mirrored in the middle, one disk's particles stand where the other's do
    let tenth_micron = |at: f64| (at * 1e7).round() as i64;
    below.sort_by_key(|&k| (tenth_micron(x[k]), tenth_micron(y[k])));
    above.sort_by_key(|&k| (tenth_micron(1.0 - x[k]), tenth_micron(1.0 - y[k])));
    if below.len() != above.len() {
        return None;
    }
    let momentum = |rows: &[usize]| {
        rows.iter().fold([0.0; 2], |[a, b], &k| [a + mass(k) * u[k], b + mass(k) * v[k]])
    };
    let (p, q) = (momentum(&below), momentum(&above));
    let size = p[0].hypot(p[1]);
    let turn = |k: usize| mass(k) * ((x[k] - 0.5) * v[k] - (y[k] - 0.5) * u[k]);
    let total: f64 = below.iter().map(|&k| mass(k)).sum();
    let mut mirror = 0.0f64;
    for (name, sign, sum) in [
        ("x", -1.0, 1.0),
        ("y", -1.0, 1.0),
        ("velocity_x", -1.0, 0.0),
        ("velocity_y", -1.0, 0.0),
        ("stress_xx", 1.0, 0.0),
        ("stress_xy", 1.0, 0.0),
        ("stress_yy", 1.0, 0.0),
        ("density", 1.0, 0.0),
        ("specific_internal_energy", 1.0, 0.0),
    ] {
        let values = column(name)?;
        let scale = values.iter().fold(0.0f64, |most, v| most.max(v.abs()));
        for (&a, &b) in below.iter().zip(&above) {
            mirror = mirror.max((values[a] - (sum + sign * values[b])).abs() / scale);
        }
    }
    Some(Halves {
        momentum: (p[0] + q[0]).hypot(p[1] + q[1]) / size,
        angular: (0..x.len()).map(turn).sum::<f64>().abs() / (size * 0.2),
        mirror,
        back: size / (total * 0.1f64.hypot(0.1)),
    })
}
