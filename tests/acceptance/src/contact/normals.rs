//! Sources of normals in six cases, on two grids.

use serde_json::{Value, json};

use super::measure::{Measured, run};
use super::scenes::{CELL, Material, around, block, contact, disk, scene, turned};
use crate::bounds::{Bound, Unit, contact::normals as bounds};
use crate::table::Table;

/// Sources; the first is the default.
const SOURCES: [&str; 4] =
    ["boundary_faces", "widest_gap", "volume_gradient", "logistic_regression"];

/// A case: its name, its scene on a grid at an angle [degrees], and its error.
type Case = (&'static str, fn(f64) -> Value, fn(&Measured, f64) -> f64, Bound);

/// Speed along the base that the first body has lost.
pub fn lost(found: &Measured, degrees: f64) -> f64 {
    1.0 - turned(found.bodies[0].velocity, -degrees)[0]
}

/// Spin of the first two bodies, over the first one's mass times its radius and 1 m/s.
fn spun(found: &Measured, _: f64) -> f64 {
    let scale = found.bodies[0].mass * 8.0 * CELL;
    found.bodies[..2].iter().map(|body| body.spin.abs() / scale).fold(0.0, f64::max)
}

fn free(bodies: &[(Value, [f64; 2])], corners: &[[f64; 2]], degrees: f64, end: f64) -> Value {
    scene(bodies, around(corners, degrees, 0.0), Material::Rubber, contact(None), end)
}

fn rectangle(lower: [f64; 2], upper: [f64; 2]) -> [[f64; 2]; 4] {
    [lower, [upper[0], lower[1]], upper, [lower[0], upper[1]]]
}

/// A base, longer than the block that slides on it for 20 cells.
pub fn flat(degrees: f64) -> Value {
    let bodies = [
        (block([0.0, 0.0], [0.08, 0.04], degrees), turned([1.0, 0.0], degrees)),
        (block([-0.06, -0.04], [0.34, 0.0], degrees), [0.0; 2]),
    ];
    free(&bodies, &rectangle([-0.06, -0.04], [0.34, 0.04]), degrees, 0.2)
}

/// A block that slides over the end of a base.
fn corner(degrees: f64) -> Value {
    let bodies = [
        (block([0.02, 0.0], [0.1, 0.04], degrees), turned([1.0, 0.0], degrees)),
        (block([-0.03, -0.04], [0.17, 0.0], degrees), [0.0; 2]),
    ];
    free(&bodies, &rectangle([-0.03, -0.04], [0.3, 0.04]), degrees, 0.1)
}

/// A block that slides over the joint between two bases.
fn three(degrees: f64) -> Value {
    let bodies = [
        (block([0.02, 0.0], [0.1, 0.04], degrees), turned([1.0, 0.0], degrees)),
        (block([-0.02, -0.04], [0.1037, 0.0], degrees), [0.0; 2]),
        (block([0.1037, -0.04], [0.28, 0.0], degrees), [0.0; 2]),
    ];
    free(&bodies, &rectangle([-0.02, -0.04], [0.28, 0.04]), degrees, 0.15)
}

/// A ball that strikes the middle of a block aslant.
fn ball_on_flat(degrees: f64) -> Value {
    let bodies = [
        (disk([0.145, 0.082], 0.08, degrees), turned([1.0, -1.0], degrees)),
        (block([0.0, -0.08], [0.3, 0.0], degrees), [0.0; 2]),
    ];
    free(&bodies, &rectangle([0.0, -0.1], [0.32, 0.2]), degrees, 0.03)
}

/// A ball that strikes another beside its centre.
fn ball_on_ball(degrees: f64) -> Value {
    let [x, y] = [-0.162 * 0.75f64.sqrt(), -0.081];
    let bodies = [
        (disk([x, y], 0.08, degrees), turned([1.0, 0.0], degrees)),
        (disk([0.0, 0.0], 0.08, degrees), [0.0; 2]),
    ];
    free(&bodies, &rectangle([-0.23, -0.17], [0.13, 0.1]), degrees, 0.04)
}

/// A plate that strikes a plate, both oblique to the grid.
fn oblique(degrees: f64) -> Value {
    let bodies = [
        (block([-0.1, -0.12], [-0.001, 0.12], degrees), turned([1.0, 0.0], degrees)),
        (block([0.0, -0.16], [0.16, 0.16], degrees), [0.0; 2]),
    ];
    free(&bodies, &rectangle([-0.1, -0.16], [0.2, 0.16]), degrees, 8e-3)
}

const CASES: [Case; 6] = [
    ("flat: speed lost", flat, lost, bounds::SPEED_LOST),
    ("corner: speed lost", corner, lost, bounds::SPEED_LOST),
    ("three bodies: speed lost", three, lost, bounds::SPEED_LOST),
    ("ball on flat: spin / m r u", ball_on_flat, |f, _| spun_first(f), bounds::TURNED),
    ("ball on ball: spin / m r u", ball_on_ball, spun, bounds::TURNED),
    (
        "oblique plates: speed along the plates",
        oblique,
        |f, degrees| turned(f.bodies[0].velocity, -degrees)[1],
        bounds::TURNED,
    ),
];

/// Spin of the first body alone: the block turns if it is not struck in its middle.
fn spun_first(found: &Measured) -> f64 {
    found.bodies[0].spin / (found.bodies[0].mass * 8.0 * CELL)
}

/// Errors of all sources in all cases; the bounds are those of the default.
pub fn check(table: &mut Table) {
    for source in SOURCES {
        for (name, make, error, bound) in CASES {
            for degrees in [0.0, 17.0] {
                let mut scene = make(degrees);
                scene["contact"]["normals"] = json!(source);
                let figure = format!("{source}, {degrees} degrees, {name}");
                let found = match run(&scene) {
                    Ok(found) => found,
                    // the other sources may end a run; the default may not
                    Err(_) if source != SOURCES[0] => {
                        table.beside(&figure, None, "the run ends", Unit::Fraction);
                        continue;
                    }
                    Err(message) => {
                        table.take::<()>(&figure, Err(message));
                        continue;
                    }
                };
                let value = Some(error(&found, degrees));
                match source == SOURCES[0] {
                    true => table.check(&figure, value, bound),
                    false => table.beside(&figure, value, "", Unit::Fraction),
                }
                if source == SOURCES[0] {
                    let figure = format!("{figure}: momentum drift");
                    table.check(&figure, Some(found.momentum_drift), bounds::MOMENTUM_DRIFT);
                }
            }
        }
    }
}
