//! A disk that bounces on a base that a wall holds, and on another disk.

use serde_json::json;

use super::measure::{Measured, run};
use super::scenes::{CELL, Material, around, block, contact, disk, scene, turned};
use crate::bounds::contact::bounce as bounds;
use crate::table::Table;

const RADIUS: f64 = 8.0 * CELL;

/// A disk that meets another one head-on, along x of axes at an angle.
fn on_disk(degrees: f64) -> Result<Measured, String> {
    let gap = 0.5 * CELL;
    let bodies = [1.0, -1.0].map(|side| {
        let centre = [-side * (RADIUS + 0.5 * gap), 0.0];
        (disk(centre, RADIUS, degrees), turned([side, 0.0], degrees))
    });
    let corners = [[-0.2, -0.1], [0.2, -0.1], [-0.2, 0.1], [0.2, 0.1]];
    run(&scene(&bodies, around(&corners, degrees, 0.0), Material::Rubber, contact(None), 0.03))
}

/// A disk that falls on the middle of a base that a wall holds.
fn on_base() -> Result<Measured, String> {
    let bodies = [
        (disk([0.0, RADIUS + 0.25 * CELL], RADIUS, 0.0), [0.0, -1.0]),
        (block([-0.16, -0.08], [0.16, 0.0], 0.0), [0.0; 2]),
    ];
    let domain = [[-0.2, -0.08], [0.2, 0.24]];
    let mut scene = scene(&bodies, domain, Material::Rubber, contact(None), 0.03);
    scene["boundary"] = json!({"y_lower": "no_slip"});
    run(&scene)
}

/// Speed after the bounce, sideways motion and spin.
pub fn check(table: &mut Table) {
    if let Some(found) = table.take("disk on a base", on_base()) {
        rest(table, "disk on a base", &found, found.bodies[0].velocity[0]);
    }
    let mut straight = None;
    for degrees in [0.0, 17.0, 45.0] {
        let name = format!("disk on disk, {degrees} degrees");
        let Some(found) = table.take(&name, on_disk(degrees)) else { continue };
        let [along, aside] = turned(found.bodies[0].velocity, -degrees);
        let off = along - *straight.get_or_insert(along);
        table.check(&format!("{name}: speed off that at 0"), Some(off), bounds::SPEED);
        rest(table, &name, &found, aside);
        let drift = Some(found.momentum_drift);
        table.check(&format!("{name}: momentum drift"), drift, bounds::MOMENTUM_DRIFT);
    }
}

fn rest(table: &mut Table, name: &str, found: &Measured, aside: f64) {
    let figure = |what: &str| format!("{name}: {what}");
    table.check(&figure("sideways speed"), Some(aside), bounds::ASIDE);
    let spin = found.bodies[0].spin / (found.bodies[0].mass * RADIUS);
    table.check(&figure("spin / m r u"), Some(spin), bounds::ASIDE);
    table.check(&figure("energy drift"), Some(found.energy_drift), bounds::ENERGY_DRIFT);
}
