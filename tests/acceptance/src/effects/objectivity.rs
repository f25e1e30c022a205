//! Bodies that are strained, and turned in a run, against their stress turned exactly.
//!
//! A block that starts as dx = F0 dX with the velocities of a rigid turn at the rate w flies on: with
//! F0 alike everywhere its stress is too, so that nothing pushes what no wave from its surface has
//! reached, and there
//!
//! ```text
//! F(t) = (1 + t W) F0 = q R(theta) F0,   q^2 = 1 + (w t)^2,  theta = atan(w t)
//! ```
//!
//! whatever the material. A solid's stress is R sigma(q U0) R^T. The deviator of a material with
//! strength goes by Jaumann's rate: R s0 R^T and what q strains, 2 G ln q (1, 1, -2)/3, as long as it
//! does not yield. In the total-Lagrangian frame such a flow is exact on the grid too, so that what
//! is left is the update of the stress.

use decomp::Serial;
use flyer_mpm::input;
use flyer_mpm::material::Symmetric;
use flyer_mpm::material::strength::{Rate, VonMises};
use flyer_mpm::simulation::{Saved, Simulation};
use serde_json::{Value, json};

use super::strength::by_rates;
use crate::bounds::{Unit, effects as bounds};
use crate::table::Table;

/// Rate of the turn [rad/s] and its time [s]: 30 degrees.
const TURN: f64 = 100.0;
const TIME: f64 = 0.005_773_502_691_896_258;

/// Cells of the block along each direction, and of the domain beyond it; a cell is 1 m.
const BLOCK: f64 = 64.0;
const BEYOND: f64 = 32.0;

/// Stretch of the solids at the start, along x; along y its inverse.
const STRETCH: f64 = 1.2;

/// Constants of the solids, chosen so that sound passes some cells in the time.
const DENSITY: f64 = 1000.0;
const YOUNG: f64 = 1e9;
const POISSON: f64 = 0.3;
const SHEAR: f64 = YOUNG / (2.0 * (1.0 + POISSON));
const LAMBDA: f64 = YOUNG * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));

/// Deviator that the material with strength starts with.
const DEVIATOR: Symmetric = Symmetric { xx: 3e7, yy: -2e7, xy: 1e7, zz: -1e7 };

fn block(material: &Value, method: &Value, courant: f64) -> Value {
    let (half, side) = (0.5 * BLOCK, 0.5 * BLOCK + BEYOND);
    json!({
        "title": "a block that is turned",
        "domain": {"lower": [-side, -side], "upper": [side, side], "cell_size": 1.0},
        "time": {"end": TIME, "courant": courant},
        "method": method,
        "materials": {"material": material},
        "bodies": [{
            "name": "block", "material": "material", "particles_per_cell": [2, 2],
            "box": {"lower": [-half, -half], "upper": [half, half]},
            "velocity_field": {"rotation": {"about": [0.0, 0.0], "rate": TURN}}
        }],
        "monitor": {"energy_growth": 1e3}
    })
}

/// Strains the block by `stretch`, and gives it the deviator `start`.
fn strained(run: &Simulation<'_, 2>, stretch: f64, start: Option<Symmetric>) -> Saved {
    let mut saved = run.save();
    // the particles are changed below
    saved.digest.clear();
    let columns = run.columns();
    let state = columns.state();
    let mut set = |column: usize, value: &dyn Fn(f64) -> f64| {
        let place = state.iter().position(|&k| k == column).expect("it is state");
        saved.particles.columns[place].iter_mut().for_each(|v| *v = value(*v));
    };
    let f = [stretch, 1.0 / stretch];
    for a in 0..2 {
        set(columns.position + a, &|x| x * f[a]);
        // v = w x across
        set(columns.velocity + a, &|v| v * f[1 - a]);
        if let Some(first) = columns.deformation {
            set(first + 3 * a, &|_| f[a]);
        }
    }
    if let Some(first) = columns.velocity_gradient {
        (0..4).for_each(|k| set(first + k, &|_| [0.0, -TURN, TURN, 0.0][k]));
    }
    if let (Some(deviator), Some(s)) = (columns.deviator, start) {
        let of = [s.xx, s.yy, s.xy];
        (0..3).for_each(|k| set(deviator + k, &|_| of[k]));
    }
    // in the updated frame a particle starts in the cell of its new place
    if columns.reference.is_none() {
        let at = state.iter().position(|&k| k == columns.position).expect("it is state");
        let [x, y] = [0, 1].map(|a| &saved.particles.columns[at + a]);
        let cell = |x: f64| (x + 0.5 * BLOCK + BEYOND).floor() as i32;
        let places = x.iter().zip(y).flat_map(|(&x, &y)| [x, y]);
        saved.particles.cells = places.map(cell).collect();
    }
    saved
}

/// Steps, and the stress in the middle of the block at the end.
fn turned(
    material: &Value,
    method: &Value,
    courant: f64,
    (stretch, start): (f64, Option<Symmetric>),
) -> Result<(f64, [f64; 4]), String> {
    let text = block(material, method, courant).to_string();
    let scene = input::parse(text.as_bytes(), "block", &[]).map_err(|e| e.to_string())?;
    let mut run = Simulation::<2>::new(&scene, &Serial, 1).map_err(|e| e.to_string())?;
    let saved = strained(&run, stretch, start);
    run.restore(&saved).map_err(|e| e.to_string())?;
    while run.time() < TIME {
        run.advance(TIME).map_err(|e| e.to_string())?;
    }
    let (table, _) = run.gather().ok_or("nothing gathered")?;
    let column = |name: &str| table.column(name).ok_or(format!("no column {name}"));
    let (x, y) = (column("x")?, column("y")?);
    let away = |r: &usize| x[*r].hypot(y[*r]);
    let middle = (0..x.len()).min_by(|a, b| away(a).total_cmp(&away(b))).ok_or("no particles")?;
    let mut stress = [0.0; 4];
    let names = ["stress_xx", "stress_yy", "stress_xy", "stress_zz"];
    for (value, name) in stress.iter_mut().zip(names) {
        *value = column(name)?[middle];
    }
    Ok((run.steps() as f64, stress))
}

/// A tensor turned by the whole angle.
fn turn(s: &Symmetric) -> Symmetric {
    let (sine, cosine) = (TURN * TIME).atan().sin_cos();
    let both = 2.0 * s.xy * sine * cosine;
    Symmetric {
        xx: cosine * cosine * s.xx + sine * sine * s.yy - both,
        yy: sine * sine * s.xx + cosine * cosine * s.yy + both,
        xy: sine * cosine * (s.xx - s.yy) + (cosine * cosine - sine * sine) * s.xy,
        zz: s.zz,
    }
}

/// ln q at the end.
fn swelling() -> f64 {
    0.5 * (TURN * TIME).powi(2).ln_1p()
}

/// Cauchy stress of a solid at the end; `measure` is mu's factor at a principal stretch.
fn solid(measure: fn(f64) -> f64) -> Symmetric {
    let q = swelling().exp();
    let volume = q * q;
    let of = |stretch: f64| (LAMBDA * volume.ln() + SHEAR * measure(stretch)) / volume;
    turn(&Symmetric { xx: of(q * STRETCH), yy: of(q / STRETCH), xy: 0.0, zz: of(1.0) })
}

/// What the section holds a run against.
struct Case {
    name: &'static str,
    material: Value,
    start: (f64, Option<Symmetric>),
    exact: Symmetric,
    /// Whether the mean of the stress is left out.
    deviator: bool,
}

fn cases() -> Vec<Case> {
    let elastic = |kind: &str| {
        let eos = json!({"type": kind, "youngs_modulus": YOUNG, "poissons_ratio": POISSON});
        json!({"density": DENSITY, "eos": eos})
    };
    let strong = |yield_stress: f64, hardening: f64| {
        json!({
            "density": DENSITY,
            "eos": {"type": "tait", "bulk_modulus": LAMBDA + 2.0 / 3.0 * SHEAR, "exponent": 1.0},
            "strength": {"type": "von_mises", "shear_modulus": SHEAR,
                "yield_stress": yield_stress, "hardening": hardening}
        })
    };
    let kept = turn(&DEVIATOR);
    let swelled = 2.0 / 3.0 * SHEAR * swelling();
    let unyielded = Symmetric {
        xx: kept.xx + swelled,
        yy: kept.yy + swelled,
        xy: kept.xy,
        zz: kept.zz - 2.0 * swelled,
    };
    let model = VonMises { shear_modulus: SHEAR, yield_stress: 6e7, hardening: 1e8 };
    let rate = |t: f64| {
        let grown = 1.0 + (TURN * t).powi(2);
        let [along, spin] = [t * TURN * TURN / grown, TURN / grown];
        Rate { plane: [along, -spin, spin, along], across: 0.0 }
    };
    let (yielded, _) = by_rates(&model, DEVIATOR, &rate, TIME);
    let solids = (STRETCH, None);
    let deviators = (1.0, Some(DEVIATOR));
    let case =
        |name, material, start, exact, deviator| Case { name, material, start, exact, deviator };
    vec![
        case("linear_elastic", elastic("linear_elastic"), solids, solid(|u| 2.0 * u.ln()), false),
        case("neo_hookean", elastic("neo_hookean"), solids, solid(|u| u * u - 1.0), false),
        case("von_mises, elastic", strong(1e9, 0.0), deviators, unyielded, true),
        case("von_mises, plastic", strong(6e7, 1e8), deviators, yielded, true),
    ]
}

impl Case {
    /// Steps, and the greatest difference of a component over the greatest component.
    fn error(&self, method: &Value, courant: f64) -> Result<(f64, f64), String> {
        let (steps, [xx, yy, xy, zz]) = turned(&self.material, method, courant, self.start)?;
        let mean = if self.deviator { (xx + yy + zz) / 3.0 } else { 0.0 };
        let pairs = [
            (xx - mean, self.exact.xx),
            (yy - mean, self.exact.yy),
            (xy, self.exact.xy),
            (zz - mean, self.exact.zz),
        ];
        let most = |f: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(f).fold(0.0, f64::max);
        Ok((steps, most(&|(a, b)| (a - b).abs()) / most(&|(_, b)| b.abs())))
    }
}

/// Each material in each kind of step, with three lengths of step.
pub fn check(table: &mut Table) {
    use bounds::objectivity as b;
    let total = |stepping: &str| {
        json!({"shape": "bspline_quadratic", "transfer": "flip", "stepping": stepping,
            "frame": "total_lagrangian"})
    };
    // the grid's own error is in it: particles no longer stand in rows
    let updated = json!({"shape": "cpdi_bspline_quadratic", "transfer": {"fmpm": 4},
        "stepping": "midpoint"});
    let methods = [
        ("mid-point", total("midpoint")),
        ("leapfrog", total("leapfrog")),
        ("mid-point, updated", updated),
    ];
    for case in cases() {
        // a solid's stress follows from F alone, which has no error; the return to the yield
        // surface is of first order. An upper bound is of the greatest error, a lower one of the
        // order of the error from each length of step to the next.
        let wanted = match case.name {
            "von_mises, elastic" => {
                [b::ELASTIC_ORDER_MIDPOINT, b::ELASTIC_ORDER_LEAPFROG, b::ELASTIC_ERROR_UPDATED]
            }
            "von_mises, plastic" => {
                [b::PLASTIC_ORDER_MIDPOINT, b::PLASTIC_ORDER_LEAPFROG, b::PLASTIC_ORDER_UPDATED]
            }
            _ => [b::SOLID_ERROR, b::SOLID_ERROR, b::SOLID_ERROR_UPDATED],
        };
        for ((kind, method), bound) in methods.iter().zip(wanted) {
            let name = format!("{}, {kind}", case.name);
            let runs: Result<Vec<_>, String> =
                [0.4, 0.2, 0.1].into_iter().map(|c| case.error(method, c)).collect();
            let Some(runs) = table.take(&name, runs) else { continue };
            if bound.at_most.is_some() {
                let most = runs.iter().map(|run| run.1).fold(0.0, f64::max);
                let steps: Vec<String> = runs.iter().map(|(n, _)| format!("{n:.0}")).collect();
                let figure = format!("{name}: {} steps", steps.join(", "));
                table.check(&figure, Some(most), bound);
                continue;
            }
            for (steps, error) in &runs {
                let figure = format!("{name}: {steps:.0} steps");
                table.beside(&figure, Some(*error), "", Unit::One);
            }
            for pair in runs.windows(2) {
                let [(few, coarse), (many, fine)] = [pair[0], pair[1]];
                let order = (coarse / fine).ln() / (many / few).ln();
                table.check(&format!("{name}: order"), Some(order), bound);
            }
        }
    }
}
