//! Blocks with corners that slide without friction, and that pass each other.

use super::measure::{Measured, run};
use super::scenes::{CELL, Material, around, block, contact, scene, turned};
use crate::bounds::contact as bounds;
use crate::section::Extent;
use crate::table::Table;

/// A block of `height` cells that slides on a base at `speed` [m/s] for 20 cells.
fn slide(
    material: Material,
    speed: f64,
    height: f64,
    degrees: f64,
    shift: f64,
) -> serde_json::Value {
    let (width, travel) = (2.5 * height * CELL, 20.0 * CELL);
    let length = width + travel + 0.1;
    let lower = block([-0.05, -0.04], [length - 0.05, 0.0], degrees);
    let upper = block([0.0, 0.0], [width, height * CELL], degrees);
    let corners = [
        [-0.05, -0.04],
        [length - 0.05, -0.04],
        [-0.05, height * CELL],
        [length - 0.05, height * CELL],
    ];
    let bodies = [(upper, turned([speed, 0.0], degrees)), (lower, [0.0; 2])];
    scene(&bodies, around(&corners, degrees, shift), material, contact(None), travel / speed)
}

/// A stack of three blocks of which each slides on the one below, 1 m/s faster.
fn stack(degrees: f64) -> serde_json::Value {
    let bodies: Vec<_> = (0..3)
        .map(|k| {
            let (x, y, width) =
                (0.03 * f64::from(k), 0.04 * f64::from(k), 0.3 - 0.1 * f64::from(k));
            let region = block([x, y], [x + width, y + 0.04], degrees);
            (region, turned([f64::from(k), 0.0], degrees))
        })
        .collect();
    let corners = [[0.0, 0.0], [0.56, 0.0], [0.0, 0.12], [0.56, 0.12]];
    scene(&bodies, around(&corners, degrees, 0.0), Material::Rubber, contact(None), 0.2)
}

/// Two blocks of copper that pass each other at a corner at 500 m/s, half a cell apart.
pub fn pass(degrees: f64, shift: f64) -> serde_json::Value {
    let upper = block([0.0, 0.005], [0.06, 0.065], degrees);
    let lower = block([0.075, -0.06], [0.135, 0.0], degrees);
    let corners = [[0.0, -0.06], [0.27, -0.06], [0.0, 0.065], [0.27, 0.065]];
    let bodies = [(upper, turned([500.0, 0.0], degrees)), (lower, [0.0; 2])];
    let domain = around(&corners, degrees, shift);
    scene(&bodies, domain, Material::Copper, contact(None), 0.15 / 500.0)
}

/// Pressure of these blocks, of rho c u.
pub fn passing_pressure(found: &Measured) -> f64 {
    found.pressure / (Material::Copper.impedance() * 500.0)
}

/// Speed lost, pressure and momentum of blocks that slide.
pub fn check(table: &mut Table) {
    let mut cases = Vec::new();
    for degrees in [0.0, 17.0, 45.0] {
        cases.push((Material::Rubber, 1.0, 4.0, degrees, 0.0));
        cases.push((Material::Copper, 500.0, 4.0, degrees, 0.0));
        if table.extent != Extent::Quick {
            cases.push((Material::Rubber, 1.0, 8.0, degrees, 0.0));
            cases.push((Material::Rubber, 1.0, 4.0, degrees, 0.37));
            cases.push((Material::Rubber, 1.0, 16.0, degrees, 0.0));
            cases.push((Material::Copper, 500.0, 40.0, degrees, 0.0));
        }
    }
    for (material, speed, height, degrees, shift) in cases {
        let what = if material == Material::Copper { "copper" } else { "rubber" };
        let name = format!("{what}, {height} cells, {degrees} degrees, grid +{shift}");
        let found = run(&slide(material, speed, height, degrees, shift));
        let Some(found) = table.take(&name, found) else { continue };
        let along = turned(found.bodies[0].velocity, -degrees)[0];
        let figure = |what: &str| format!("{name}: {what}");
        table.check(&figure("speed lost"), Some(1.0 - along / speed), bounds::sliding::SPEED_LOST);
        let pressure = found.pressure / (material.impedance() * speed);
        table.check(&figure("pressure / rho c u"), Some(pressure), bounds::sliding::PRESSURE);
        let drift = Some(found.momentum_drift);
        table.check(&figure("momentum drift"), drift, bounds::sliding::MOMENTUM_DRIFT);
    }
    for degrees in [0.0, 17.0] {
        let name = format!("stack of three, {degrees} degrees");
        let Some(found) = table.take(&name, run(&stack(degrees))) else { continue };
        let along = turned(found.bodies[2].velocity, -degrees)[0];
        let lost = Some(1.0 - along / 2.0);
        table.check(&format!("{name}: speed lost"), lost, bounds::sliding::SPEED_LOST);
    }
    for (degrees, shift) in [(0.0, 0.0), (0.0, 0.37), (17.0, 0.0), (45.0, 0.0)] {
        let name = format!("passing at a corner, {degrees} degrees, grid +{shift}");
        let Some(found) = table.take(&name, run(&pass(degrees, shift))) else { continue };
        let pressure = Some(passing_pressure(&found));
        table.check(&format!("{name}: pressure"), pressure, bounds::passing::PRESSURE);
    }
}
