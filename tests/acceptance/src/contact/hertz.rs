//! Cylinders that press on each other against Hertz's solution.

use std::f64::consts::PI;

use decomp::Serial;
use flyer_mpm::input;
use flyer_mpm::simulation::Simulation;

use super::scenes::CELL;
use crate::bounds::contact::hertz as bounds;
use crate::program;
use crate::table::Table;

/// Radius of both cylinders [m], and their Young's modulus [Pa] and Poisson's ratio.
const RADIUS: f64 = 1.2;
const YOUNG: f64 = 1e6;
const POISSON: f64 = 0.3;

/// Number of steps at the end over which the force is averaged.
const STEPS: usize = 40;

/// What a run of `hertz.json` ends with.
struct Pressed {
    /// Force per length of the whole cylinders [N/m].
    force: f64,
    /// x [m] and normal stress [Pa] of the particles at the face of the upper cylinder.
    face: Vec<[f64; 2]>,
}

fn run() -> Result<Pressed, String> {
    let path = program::root().join("inputs/hertz.json");
    let text = std::fs::read(&path).map_err(|e| e.to_string())?;
    let scene = input::parse(&text, "hertz.json", &[]).map_err(|e| e.to_string())?;
    let mut simulation = Simulation::<2>::new(&scene, &Serial, 1).map_err(|e| e.to_string())?;
    let mut forces = Vec::new();
    while simulation.time() < scene.scene.time.end {
        simulation.advance(scene.scene.time.end).map_err(|e| e.to_string())?;
        // x = 0 is a plane of symmetry
        forces.push(2.0 * simulation.contact_force()[0]);
    }
    let last = &forces[forces.len().saturating_sub(STEPS)..];
    let (table, _) = simulation.gather().ok_or("rank 0 gathers")?;
    let column = |name: &str| table.column(name).ok_or(format!("no column {name}"));
    let [x, y, stress] = ["x", "y", "stress_yy"].map(column);
    let (x, y, stress) = (x?, y?, stress?);
    let at_face = |r: &usize| table.body[*r] == 0 && y[*r] < 0.75 * CELL;
    let face = (0..x.len()).filter(at_face).map(|r| [x[r], stress[r].abs()]).collect();
    Ok(Pressed { force: last.iter().sum::<f64>() / last.len() as f64, face })
}

/// Half width and greatest pressure of the face, by least squares of the squared pressure, which is
/// p0^2 (1 - x^2/b^2), over nine tenths of the half width `b`.
fn fit(face: &[[f64; 2]], b: f64) -> [f64; 2] {
    let inner = face.iter().filter(|[x, _]| *x < 0.9 * b);
    let mut sums = [0.0; 5];
    for [x, p] in inner {
        let (square, value) = (x * x, p * p);
        let terms = [1.0, square, square * square, value, square * value];
        sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
    }
    let [n, x, xx, y, xy] = sums;
    let slope = (n * xy - x * y) / (n * xx - x * x);
    let top = (y - slope * x) / n;
    [(-top / slope).sqrt(), top.sqrt()]
}

/// Contact width and peak pressure.
pub fn check(table: &mut Table) {
    let Some(found) = table.take("hertz.json", run()) else { return };
    let stiffness = YOUNG / (2.0 * (1.0 - POISSON * POISSON));
    let radius = 0.5 * RADIUS;
    let exact = [
        (4.0 * found.force * radius / (PI * stiffness)).sqrt(),
        (found.force * stiffness / (PI * radius)).sqrt(),
    ];
    let fitted = fit(&found.face, exact[0]);
    let off = |k: usize| Some(fitted[k] / exact[k] - 1.0);
    table.check("hertz.json: contact width off", off(0), bounds::WIDTH);
    table.check("hertz.json: peak pressure off", off(1), bounds::PRESSURE);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fit_finds_an_ellipse() {
        let at = |x: f64| [x, 7.0 * (1.0 - x * x / 4.0).sqrt()];
        let face: Vec<_> = (0..18).map(|k| at(0.1 * f64::from(k))).collect();
        let [b, p] = fit(&face, 2.0);
        assert!((b - 2.0).abs() < 1e-12 && (p - 7.0).abs() < 1e-12);
    }
}
