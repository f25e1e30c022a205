//! Chooses the cheapest scheme and cell size that reach a target error.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::data::{Data, SchemeAccuracy};
use super::pilot::{self, Pilot};
use super::quantities::ErrorScale;
use super::schemes::{PlannedScheme, schemes};
use crate::accuracy::estimate::{EstimateBasis, Laws};
use crate::input;
use crate::scene::{CheckedScene, PlannedQuantity};

/// The target of a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorTarget {
    /// Quantity.
    pub quantity: PlannedQuantity,
    /// Largest relative error \[-\].
    pub error: f64,
    /// Largest wall time of the time loop \[s\].
    pub budget: f64,
    /// Ranks.
    pub ranks: usize,
    /// Position of the arrival \[m\].
    pub place: Option<f64>,
}

/// The chosen settings, with the expected error and cost.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Name of the scheme.
    pub scheme: String,
    /// Cell size \[m\].
    pub cell_size: f64,
    /// Particles per cell.
    pub particles_per_cell: usize,
    /// Courant number \[-\].
    pub courant: f64,
    /// Expected error \[-\].
    pub error: f64,
    /// Error that 19 of 20 runs do not exceed \[-\].
    pub error_most: f64,
    /// User CPU time of the time loop \[s\].
    pub cpu_seconds: f64,
    /// Wall time of the time loop \[s\].
    pub wall_seconds: f64,
    /// Wall time of the pilot runs \[s\].
    pub pilot_seconds: f64,
    /// Whether the errors of the schemes were measured on such scenes.
    pub basis: EstimateBasis,
    /// Inputs outside of the range of these measurements, one line each.
    pub outside: Vec<String>,
    /// The scene to run.
    pub scene: Value,
}

/// Reasons why there is no plan.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// The scene cannot be planned.
    #[error("{0}")]
    Scene(String),
    /// The target cannot be reached; with the smallest error that can.
    #[error(
        "an error of {} cannot be had within {budget:.3} s of wall time; the best is {}, with {scheme} on cells of {cell_size:.3e} m in {seconds:.3} s",
        percent(*wanted), percent(*best)
    )]
    Impossible {
        /// Target error \[-\].
        wanted: f64,
        /// Largest wall time \[s\].
        budget: f64,
        /// Smallest error within that time \[-\].
        best: f64,
        /// Its scheme.
        scheme: String,
        /// Its cell size \[m\].
        cell_size: f64,
        /// Its wall time \[s\].
        seconds: f64,
    },
}

/// A fraction \[-\] as text in per cent.
pub fn percent(fraction: f64) -> String {
    format!("{:.4} %", 100.0 * fraction)
}

/// Particles of the two pilot runs of each scheme.
const PILOTS: [usize; 2] = [300, 600];

/// Particles of the last pilot run over those of the run; its time scales with the square.
const LAST_PILOT: f64 = 0.35;

/// Largest number of particles of the last pilot run.
const MOST_PILOT: f64 = 4000.0;

/// Largest number of particles of a plan, to limit memory and run time.
const MOST_PARTICLES: f64 = 1e7;

/// CPU seconds as a function of the cell size h: a / h^2 + b / h.
#[derive(Clone, Copy, Debug)]
struct Cost {
    a: f64,
    b: f64,
}

impl Cost {
    /// Cost through two pilot runs, with a and b not negative.
    fn through(coarse: (f64, f64), fine: (f64, f64)) -> Cost {
        let ((h0, s0), (h1, s1)) = (coarse, fine);
        // s h = a / h + b
        let a = (s1 * h1 - s0 * h0) / (1.0 / h1 - 1.0 / h0);
        let b = s1 * h1 - a / h1;
        match (a > 0.0, b > 0.0) {
            (true, true) => Cost { a, b },
            (false, _) => Cost { a: 0.0, b: s1 * h1 },
            (_, false) => Cost { a: s1 * h1 * h1, b: 0.0 },
        }
    }

    fn at(&self, h: f64) -> f64 {
        self.a / (h * h) + self.b / h
    }

    /// Cell size at which the cost is `seconds`.
    fn cells_for(&self, seconds: f64) -> f64 {
        (self.b + (self.b * self.b + 4.0 * self.a * seconds).sqrt()) / (2.0 * seconds)
    }
}

/// A scheme with the results of its pilot runs.
struct Candidate {
    scheme: PlannedScheme,
    measured: SchemeAccuracy,
    cost: Cost,
    /// Wall time over CPU time.
    wall: f64,
    /// Number of steps times the cell size \[m\].
    steps: f64,
}

impl Candidate {
    fn wall(&self, h: f64, ranks: usize, extra: f64) -> f64 {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let share = ranks.min(cores).max(1) as f64;
        let messages = if ranks > 1 { extra * self.steps / h } else { 0.0 };
        self.cost.at(h) * self.wall / share + messages
    }
}

/// Plans a scene.
///
/// # Errors
///
/// If the scene cannot be planned, or if no scheme reaches the target in the allowed time.
#[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
pub fn plan(
    scene: &Value,
    file: &str,
    target: &ErrorTarget,
    data: &Data,
) -> Result<Plan, PlanError> {
    let fail = |reason: String| PlanError::Scene(reason);
    let mut scene = scene.clone();
    if scene.get("error_estimate").is_none_or(Value::is_null) {
        scene["error_estimate"] = json!({});
    }
    if scene.pointer("/domain/lower/1").is_some() {
        return Err(fail(format!("{file}: plan: a scene in a plane; allowed: a scene on a line")));
    }
    if let Some(at) = target.place {
        scene["error_estimate"]["arrivals"] = json!([at]);
    }
    let checked = input::parse(scene.to_string().as_bytes(), file, &[])
        .map_err(|error| fail(error.to_string()))?;
    let body = checked.estimated_body().expect("the check has found it");
    let asked = checked.scene.error_estimate.as_ref().and_then(|e| e.arrivals.first().copied());
    let place = asked.filter(|_| target.quantity.at_place());
    if target.quantity.at_place() && place.is_none() {
        return Err(fail(format!(
            "{file}: error_estimate.arrivals: missing key; allowed: places, or --at METRES"
        )));
    }
    let start = std::time::Instant::now();
    let length = checked.scene.domain.upper[0] - checked.scene.domain.lower[0];
    // particles per cell of the domain, for a scheme with one particle per cell
    let filled = filled(&checked) / length;
    let mut candidates = Vec::new();
    let mut scale = None;
    let mut faults = Vec::new();
    for scheme in schemes() {
        let Some(measured) = data.schemes.get(&scheme.name) else { continue };
        let timed: Result<Vec<Pilot>, String> = PILOTS
            .iter()
            .map(|&particles| {
                let cells = particles as f64 / scheme.particles_per_cell as f64 / filled;
                let cells = cells.ceil() as usize;
                let (_, scene) = pilot::with_cells(&scene, file, &scheme, cells)?;
                pilot::run(&scene, body, place)
            })
            .collect();
        match timed.as_deref() {
            Ok([coarse, fine]) => {
                if scale.is_none() {
                    scale = Some(scale_of(fine, &checked, body, place).map_err(fail)?);
                }
                let seconds = |p: &Pilot| (p.cell_size, p.cpu_seconds.max(1e-6));
                candidates.push(Candidate {
                    scheme,
                    measured: *measured,
                    cost: Cost::through(seconds(coarse), seconds(fine)),
                    wall: (fine.wall_seconds / fine.cpu_seconds.max(1e-6)).max(1.0),
                    steps: fine.steps as f64 * fine.cell_size,
                });
            }
            Ok(_) => unreachable!("two pilots"),
            // a scheme that cannot run the scene cannot be chosen
            Err(reason) => faults.push(format!("{}: {reason}", scheme.name)),
        }
    }
    let Some(scale) = scale else {
        return Err(fail(format!("no scheme can run the scene: {}", faults.join("; "))));
    };
    let extra = data.rank_step_seconds;
    // the cheapest scheme that reaches the target within the budget, else the smallest error
    let least = filled_cells_limit(filled, length);
    let mut best: Option<(&Candidate, f64, f64)> = None;
    let mut nearest: Option<(&Candidate, f64, f64)> = None;
    for candidate in &candidates {
        let Some(h) = target.quantity.cells_for(&candidate.measured, &scale, target.error) else {
            return Err(fail(format!("{file}: no plateau in the body that a pilot sees")));
        };
        let floor = least * candidate.scheme.particles_per_cell as f64;
        let wall = candidate.wall(h, target.ranks, extra);
        if h >= floor && wall <= target.budget && best.is_none_or(|b| wall < b.2) {
            best = Some((candidate, h, wall));
        }
        let within = candidate.cost.cells_for(target.budget / candidate.wall * target.ranks as f64);
        let h = within.max(floor);
        if let Some(error) = target.quantity.error(&candidate.measured, &scale, h)
            && nearest.is_none_or(|n| error.most < n.2)
        {
            nearest = Some((candidate, h, error.most));
        }
    }
    let Some((candidate, h, _)) = best else {
        let (candidate, h, error) = nearest.ok_or_else(|| fail("nothing can be had".into()))?;
        return Err(PlanError::Impossible {
            wanted: target.error,
            budget: target.budget,
            best: error,
            scheme: candidate.scheme.name.clone(),
            cell_size: h,
            seconds: candidate.wall(h, target.ranks, extra),
        });
    };
    let cells = (length / h).ceil() as usize;
    let (mut chosen, run) =
        pilot::with_cells(&scene, file, &candidate.scheme, cells).map_err(fail)?;
    let h = run.cell_size[0];
    let cost = last_pilot(&scene, file, candidate, (h, run.particles as f64), body, cells);
    let (cost, wall_over_cpu, steps) = cost.map_err(fail)?;
    let candidate = Candidate {
        scheme: candidate.scheme.clone(),
        cost,
        wall: wall_over_cpu,
        steps,
        ..*candidate
    };
    let error =
        target.quantity.error(&candidate.measured, &scale, h).expect("it has been looked at");
    // the plan chooses the cell size itself
    let mut outside = Laws::shipped().fitted.outside_but_cells(&run, body);
    match target.quantity.at_place() {
        true => outside.profiles.clear(),
        false => outside.arrivals.clear(),
    }
    let mut plan = Plan {
        scheme: candidate.scheme.name.clone(),
        cell_size: h,
        particles_per_cell: candidate.scheme.particles_per_cell,
        courant: candidate.scheme.courant,
        error: error.median,
        error_most: error.most,
        cpu_seconds: candidate.cost.at(h),
        wall_seconds: candidate.wall(h, target.ranks, extra),
        pilot_seconds: start.elapsed().as_secs_f64(),
        basis: outside.basis(),
        outside: outside.lines(),
        scene: Value::Null,
    };
    chosen["output"]["plan"] = json!({
        "quantity": target.quantity,
        "wanted": target.error,
        "error": plan.error,
        "cpu_seconds": plan.cpu_seconds,
        "wall_seconds": plan.wall_seconds,
        "guess": plan.basis == EstimateBasis::Guess,
    });
    plan.scene = chosen;
    Ok(plan)
}

/// Total length of the bodies \[m\].
fn filled(scene: &CheckedScene) -> f64 {
    scene.bodies.iter().map(|b| b.upper[0] - b.lower[0]).sum()
}

/// Smallest cell size of a scheme with one particle per cell \[m\].
fn filled_cells_limit(filled: f64, length: f64) -> f64 {
    filled * length / MOST_PARTICLES
}

/// Lengths of the scene, from its finest pilot run.
fn scale_of(
    pilot: &Pilot,
    scene: &CheckedScene,
    body: usize,
    place: Option<f64>,
) -> Result<ErrorScale, String> {
    let all = 0..pilot.profiles.len();
    let pulse = all.clone().filter_map(|k| pilot.pulse(k)).fold(f64::INFINITY, f64::min);
    if !pulse.is_finite() {
        return Err(format!("{}: no pressure in the body at any profile", scene.file));
    }
    let lengths: Vec<f64> = all.filter_map(|k| pilot.plateau(k)).collect();
    let plateau = lengths.into_iter().reduce(f64::min);
    // the wave's way, from the end of the body that it comes from
    let way = place.zip(pilot.arrival).map(|(at, _)| {
        let own = &scene.bodies[body];
        let (lower, upper) = (at - own.lower[0], own.upper[0] - at);
        lower.min(upper)
    });
    if place.is_some() && way.is_none() {
        return Err(format!("{}: nothing arrives there within the run", scene.file));
    }
    Ok(ErrorScale { pulse, plateau, way })
}

/// Cost by a pilot run slightly coarser than the run and one with half of its cells; also the wall
/// time over CPU time, and the number of steps times the cell size.
fn last_pilot(
    scene: &Value,
    file: &str,
    candidate: &Candidate,
    (h, particles): (f64, f64),
    body: usize,
    cells: usize,
) -> Result<(Cost, f64, f64), String> {
    let share = LAST_PILOT.min(MOST_PILOT / particles);
    let fine = ((cells as f64 * share) as usize).max(cells.min(64));
    let timed = [fine.div_ceil(2), fine].map(|cells| {
        let (_, scene) = pilot::with_cells(scene, file, &candidate.scheme, cells)?;
        // use the faster of two runs: other load on the machine only slows a run
        let both = [pilot::run(&scene, body, None)?, pilot::run(&scene, body, None)?];
        let [a, b] = both;
        Ok::<Pilot, String>(if a.cpu_seconds <= b.cpu_seconds { a } else { b })
    });
    let [coarse, fine] = timed;
    let (coarse, fine) = (coarse?, fine?);
    let seconds = |p: &Pilot| (p.cell_size, p.cpu_seconds.max(1e-6));
    let steps = fine.steps as f64 * fine.cell_size;
    debug_assert!(h > 0.0);
    let wall = (fine.wall_seconds / fine.cpu_seconds.max(1e-6)).max(1.0);
    Ok((Cost::through(seconds(&coarse), seconds(&fine)), wall, steps))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_go_through_pilots_and_back() {
        let cost = Cost { a: 2.0, b: 3.0 };
        let fitted = Cost::through((0.5, cost.at(0.5)), (0.25, cost.at(0.25)));
        assert!((fitted.a - 2.0).abs() < 1e-12 && (fitted.b - 3.0).abs() < 1e-12, "{fitted:?}");
        assert!((cost.cells_for(cost.at(0.1)) - 0.1).abs() < 1e-12);
        // cheaper on finer cells: noise
        let odd = Cost::through((0.5, 4.0), (0.25, 3.0));
        assert!(odd.a >= 0.0 && odd.b >= 0.0 && (odd.at(0.25) - 3.0).abs() < 1e-12);
    }
}
