//! Chooses the cheapest scheme and cell size that reach a target error in 19 of 20 runs, within the
//! range of the fit.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::cell_counts::Lengths;
use super::data::{Data, SchemeAccuracy};
use super::pilot::{self, Pilot};
use super::quantities::ErrorScale;
use super::run_time::RunTime;
use super::schemes::{PlannedScheme, schemes};
use crate::accuracy::estimate::{
    EstimateBasis, ImpactWaves, LEAST_LEVEL, LEAST_PLATEAU, Laws, PlateauLeft, other_cells,
};
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
    /// Predicted error: 19 of 20 runs do not exceed it \[-\].
    pub error: f64,
    /// Error that half of the runs do not exceed \[-\].
    pub error_median: f64,
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
        "an error of {} cannot be had within {budget:.3} s of wall time and the range of the fit; the best is {}, with {scheme} on cells of {cell_size:.3e} m in {seconds:.3} s",
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

/// Particles of the last pilot run over those of a run that takes longer than [`SHORT`]; its time
/// scales with the square.
const LAST_PILOT: f64 = 0.35;

/// Largest number of particles of the last pilot run.
const MOST_PILOT: f64 = 4000.0;

/// Number of the cheapest schemes that the last pilot runs compare, besides all up to [`SHORT`].
const TIMED: usize = 3;
/// Greatest time of such a scheme over that of the cheapest \[-\].
const NEARLY_CHEAPEST: f64 = 1.5;
/// Wall time \[s\] up to which the last pilot runs compare all schemes and have the cells of the run,
/// since they then cost little.
const SHORT: f64 = 0.05;

/// Largest number of particles of a plan, to limit memory and run time.
const MOST_PARTICLES: f64 = 1e7;

/// A scheme with the results of its pilot runs.
struct Candidate {
    scheme: PlannedScheme,
    measured: SchemeAccuracy,
    time: RunTime,
}

/// A candidate on the cells of its run, timed by the last pilot runs.
struct Timed {
    candidate: Candidate,
    /// The scene to run.
    scene: Value,
    /// The same, checked.
    run: CheckedScene,
    /// Wall time of the run \[s\].
    wall: f64,
}

/// A scene to plan, with the lengths on which the choice depends.
struct Task<'a> {
    scene: Value,
    file: &'a str,
    target: &'a ErrorTarget,
    data: &'a Data,
    body: usize,
    place: Option<f64>,
    lengths: Lengths,
    /// Particles per cell of the domain, for a scheme with one particle per cell, over the length
    /// \[1/m\].
    filled: f64,
    /// Smallest and largest cell size within the range of the fit \[m\].
    fitted: [f64; 2],
}

/// Plans a scene.
///
/// # Errors
///
/// If the scene cannot be planned, or if no scheme reaches the target in the allowed time.
pub fn plan(
    scene: &Value,
    file: &str,
    target: &ErrorTarget,
    data: &Data,
) -> Result<Plan, PlanError> {
    let fail = |reason: String| PlanError::Scene(reason);
    let start = std::time::Instant::now();
    let (task, checked) = Task::new(scene, file, target, data).map_err(fail)?;
    let (candidates, scale) = task.candidates(&checked).map_err(fail)?;
    if let Err(reason) = target.quantity.length(&scale) {
        return Err(fail(format!("{file}: {reason}")));
    }
    let nearly = task.cheapest(&candidates, &scale)?;
    let Timed { candidate: timed, scene: mut chosen, run, .. } =
        task.fastest(&nearly, &scale).map_err(fail)?;
    let h = run.cell_size[0];
    let error = target.quantity.error(&timed.measured, &scale, h);
    let error = error.ok_or_else(|| fail(format!("{file}: the error cannot be predicted")))?;
    let mut outside = Laws::shipped().fitted.outside(&run, task.body);
    match target.quantity.at_place() {
        true => outside.profiles.clear(),
        false => outside.arrivals.clear(),
    }
    let mut plan = Plan {
        scheme: timed.scheme.name.clone(),
        cell_size: h,
        particles_per_cell: timed.scheme.particles_per_cell,
        courant: timed.scheme.courant,
        error: error.most,
        error_median: error.median,
        cpu_seconds: timed.time.cpu(h),
        wall_seconds: timed.time.wall(h, target.ranks, data.rank_step_seconds),
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

impl<'a> Task<'a> {
    /// The task with the checked scene; the error is the reason why the scene cannot be planned.
    fn new(
        scene: &Value,
        file: &'a str,
        target: &'a ErrorTarget,
        data: &'a Data,
    ) -> Result<(Task<'a>, CheckedScene), String> {
        let mut scene = scene.clone();
        if scene.get("error_estimate").is_none_or(Value::is_null) {
            scene["error_estimate"] = json!({});
        }
        if scene.pointer("/domain/lower/1").is_some() {
            return Err(format!("{file}: plan: a scene in a plane; allowed: a scene on a line"));
        }
        if let Some(at) = target.place {
            scene["error_estimate"]["arrivals"] = json!([at]);
        }
        let checked = input::parse(scene.to_string().as_bytes(), file, &[]);
        let checked = checked.map_err(|error| error.to_string())?;
        let body = checked.estimated_body().ok_or_else(|| {
            let all = checked.scene.bodies.iter().map(|body| body.name.as_str());
            let all = all.collect::<Vec<_>>().join(", ");
            format!("{file}: error_estimate.body: missing key; allowed: {all}")
        })?;
        let asked = checked.scene.error_estimate.as_ref().and_then(|e| e.arrivals.first().copied());
        let place = asked.filter(|_| target.quantity.at_place());
        if target.quantity.at_place() && place.is_none() {
            return Err(format!(
                "{file}: error_estimate.arrivals: missing key; allowed: places, or --at METRES"
            ));
        }
        let lengths = Lengths::new(&checked);
        let filled = lengths.filled() / lengths.domain;
        let fitted = fitted_cell_sizes(&checked, body);
        let task = Task { scene, file, target, data, body, place, lengths, filled, fitted };
        Ok((task, checked))
    }

    /// The schemes that can run the scene, with the lengths and pressure that scale the errors.
    fn candidates(&self, checked: &CheckedScene) -> Result<(Vec<Candidate>, ErrorScale), String> {
        let (mut candidates, mut scale, mut faults) = (Vec::new(), None, Vec::new());
        for scheme in schemes() {
            let Some(measured) = self.data.schemes.get(&scheme.name) else { continue };
            let pilots = PILOTS.map(|particles| {
                let cells = particles as f64 / scheme.particles_per_cell as f64 / self.filled;
                let cells = cells.ceil() as usize;
                let cells = self.lengths.of_run(cells, scheme.particles_per_cell, usize::MAX);
                let (_, scene) = pilot::with_cells(&self.scene, self.file, &scheme, cells)?;
                pilot::typical(&scene, self.body, self.place)
            });
            let [coarse, fine] = match pilots {
                [Ok(coarse), Ok(fine)] => [coarse, fine],
                // a scheme that cannot run the scene cannot be chosen
                [Err(reason), _] | [_, Err(reason)] => {
                    faults.push(format!("{}: {reason}", scheme.name));
                    continue;
                }
            };
            if scale.is_none() {
                scale = Some(scale_of(&fine, checked, self.body, self.place)?);
            }
            let time = RunTime::from_two(&coarse, &fine);
            candidates.push(Candidate { scheme, measured: measured.clone(), time });
        }
        let scale =
            scale.ok_or_else(|| format!("no scheme can run the scene: {}", faults.join("; ")))?;
        Ok((candidates, scale))
    }

    /// The fastest of these candidates by the last pilot runs. The error is that of the first one, if
    /// none can be timed.
    fn fastest(
        &self,
        candidates: &[(&Candidate, f64)],
        scale: &ErrorScale,
    ) -> Result<Timed, String> {
        let all = candidates.iter().map(|&(candidate, h)| self.timed(candidate, h, scale));
        let faster = |best, next: Result<Timed, String>| match (best, next) {
            (Ok(Timed { wall, .. }), Ok(next)) if next.wall < wall => Ok(next),
            (Err(_), Ok(next)) => Ok(next),
            (best, _) => best,
        };
        all.reduce(faster).unwrap_or_else(|| Err(format!("{}: no scheme", self.file)))
    }

    /// A candidate on cells of about `h` \[m\], timed by the last pilot runs.
    fn timed(&self, candidate: &Candidate, h: f64, scale: &ErrorScale) -> Result<Timed, String> {
        let cells = (self.lengths.domain / h).ceil() as usize;
        // a float that is too large becomes the largest integer
        let most = (self.lengths.domain / self.fitted[0]) as usize;
        let more = self.lengths.of_run(cells, candidate.scheme.particles_per_cell, most);
        // far from the mean of the fit a law can rise with the number of cells
        let error = |cells: usize| {
            let h = self.lengths.domain / cells as f64;
            self.target.quantity.error(&candidate.measured, scale, h).map(|error| error.most)
        };
        let reaches = error(more).is_some_and(|error| error <= self.target.error);
        let cells = if reaches { more } else { cells };
        let (scene, run) = pilot::with_cells(&self.scene, self.file, &candidate.scheme, cells)?;
        let h = run.cell_size[0];
        // pilot runs have one rank
        let time = if candidate.time.wall(h, 1, 0.0) <= SHORT {
            RunTime::from_one(&pilot::typical(&run, self.body, None)?)
        } else {
            self.last_time(candidate, run.particles as f64, cells)?
        };
        let (scheme, measured) = (candidate.scheme.clone(), candidate.measured.clone());
        let candidate = Candidate { scheme, measured, time };
        let wall = candidate.time.wall(h, self.target.ranks, self.data.rank_step_seconds);
        Ok(Timed { candidate, scene, run, wall })
    }

    /// Times from two pilot runs of a run on `cells` cells: one with about [`LAST_PILOT`] of these
    /// cells, and one with half as many.
    fn last_time(
        &self,
        candidate: &Candidate,
        particles: f64,
        cells: usize,
    ) -> Result<RunTime, String> {
        let share = LAST_PILOT.min(MOST_PILOT / particles);
        let fine = ((cells as f64 * share) as usize).max(cells.min(64));
        let [coarse, fine] = [fine.div_ceil(2), fine].map(|pilot| {
            let pilot = self.lengths.of_pilot(pilot, candidate.scheme.particles_per_cell, cells);
            let (_, scene) = pilot::with_cells(&self.scene, self.file, &candidate.scheme, pilot)?;
            pilot::typical(&scene, self.body, None)
        });
        Ok(RunTime::from_two(&coarse?, &fine?))
    }

    /// The cheapest schemes that reach the target within the budget, with their cell sizes \[m\], the
    /// cheapest first.
    fn cheapest<'b>(
        &self,
        candidates: &'b [Candidate],
        scale: &ErrorScale,
    ) -> Result<Vec<(&'b Candidate, f64)>, PlanError> {
        let (target, extra) = (self.target, self.data.rank_step_seconds);
        let fewest = filled_cells_limit(self.filled, self.lengths.domain);
        let mut able: Vec<(&Candidate, f64, f64)> = Vec::new();
        let mut nearest: Option<(&Candidate, f64, f64)> = None;
        for candidate in candidates {
            let floor = fewest * candidate.scheme.particles_per_cell as f64;
            let limits = [floor.max(self.fitted[0]), self.fitted[1]];
            let measured = &candidate.measured;
            if let Some(h) = target.quantity.cells_for(measured, scale, target.error, limits) {
                let wall = candidate.time.wall(h, target.ranks, extra);
                if wall <= target.budget {
                    able.push((candidate, h, wall));
                }
            }
            for h in target.quantity.sizes(scale, limits) {
                if candidate.time.wall(h, target.ranks, extra) <= target.budget
                    && let Some(error) = target.quantity.error(measured, scale, h)
                    && nearest.is_none_or(|n| error.most < n.2)
                {
                    nearest = Some((candidate, h, error.most));
                }
            }
        }
        able.sort_by(|a, b| a.2.total_cmp(&b.2));
        if let Some(&(_, _, least)) = able.first() {
            let is_near = |k: usize, wall: f64| k < TIMED && wall <= NEARLY_CHEAPEST * least;
            let numbered = able.iter().enumerate();
            let near = numbered.filter(|&(k, a)| a.2 <= SHORT || is_near(k, a.2));
            return Ok(near.map(|(_, &(candidate, h, _))| (candidate, h)).collect());
        }
        let none = || PlanError::Scene("nothing can be had".into());
        let (candidate, h, error) = nearest.ok_or_else(none)?;
        Err(PlanError::Impossible {
            wanted: target.error,
            budget: target.budget,
            best: error,
            scheme: candidate.scheme.name.clone(),
            cell_size: h,
            seconds: candidate.time.wall(h, target.ranks, extra),
        })
    }
}

/// Smallest and largest cell size at which the flyer has as many cells as those of the fit \[m\];
/// without limits unless the scene has two bodies.
fn fitted_cell_sizes(scene: &CheckedScene, body: usize) -> [f64; 2] {
    let [_, _] = scene.bodies[..] else { return [0.0, f64::INFINITY] };
    let flyer = &scene.bodies[1 - body];
    let thickness = flyer.upper[0] - flyer.lower[0];
    let [fewest, most] = Laws::shipped().fitted.flyer_cells;
    // the domain has whole cells, which are somewhat smaller than those that the plan asks for
    [1.05 * thickness / most, thickness / fewest]
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
    let pulse =
        (0..pilot.profiles.len()).filter_map(|k| pilot.pulse(k)).fold(f64::INFINITY, f64::min);
    if !pulse.is_finite() {
        return Err(format!("{}: no pressure in the body at any profile", scene.file));
    }
    let waves = ImpactWaves::new(scene, body);
    let plateau = shortest_plateau(pilot, scene, waves.as_ref());
    let seen = || pilot.profiles.iter().flatten().map(|q| q.1).fold(0.0, f64::max);
    let pressure = waves.as_ref().map_or_else(seen, |waves| waves.release.states[0].p);
    let cell_time = scene.scene.time.end / pilot.steps.max(1) as f64 / pilot.courant;
    let stiffness = scene.material_of(body).density * (pilot.cell_size / cell_time).powi(2);
    let compressions = waves.as_ref().and_then(ImpactWaves::compressions);
    let other_thickness = other_cells(scene, body).map(|cells| cells * scene.cell_size[0]);
    // the wave's way, from the end of the body that it comes from
    let way = place.zip(pilot.arrival).map(|(at, _)| {
        let own = &scene.bodies[body];
        let (lower, upper) = (at - own.lower[0], own.upper[0] - at);
        lower.min(upper)
    });
    if place.is_some() && way.is_none() {
        return Err(format!("{}: nothing arrives there within the run", scene.file));
    }
    Ok(ErrorScale {
        pulse,
        plateau,
        least_plateau: least_plateau(scene, body, waves.as_ref()),
        way,
        strength: pressure / stiffness,
        compressions,
        other_thickness,
    })
}

/// Shortest plateau that a plan accepts \[cells\]: one that the run reports in all profiles. In a scene
/// outside of the fit it is longer, since the errors of short plateaus are not known there.
fn least_plateau(scene: &CheckedScene, body: usize, waves: Option<&ImpactWaves>) -> f64 {
    let is_exact =
        |&time: &f64| waves.is_some_and(|waves| waves.plateau(time) != PlateauLeft::Unknown);
    let mut outside = Laws::shipped().fitted.outside(scene, body);
    outside.arrivals.clear();
    let is_fitted = outside.basis() == EstimateBasis::Calibrated;
    if is_fitted && scene.profile_times.iter().all(is_exact) { LEAST_PLATEAU } else { LEAST_LEVEL }
}

/// Length of the shortest plateau of the profiles \[m\], by the exact waves if they are known, else as
/// the pilot run sees it. Profiles without a plateau do not count; the error is the reason of the
/// last one if there is no other.
fn shortest_plateau(
    pilot: &Pilot,
    scene: &CheckedScene,
    waves: Option<&ImpactWaves>,
) -> Result<f64, String> {
    let seen = |k: usize| {
        let none = || "no plateau in the body that a pilot sees".to_string();
        pilot.plateau(k).ok_or_else(none)
    };
    let left = |k: usize| match waves.map(|waves| waves.plateau(scene.profile_times[k])) {
        Some(PlateauLeft::Length(length)) => Ok(length),
        Some(PlateauLeft::None(reason)) => {
            Err(format!("no plateau pressure at {:.4} us: {reason}", 1e6 * scene.profile_times[k]))
        }
        Some(PlateauLeft::Unknown) | None => seen(k),
    };
    let all: Vec<Result<f64, String>> = (0..pilot.profiles.len()).map(left).collect();
    let shortest = all.iter().filter_map(|length| length.as_ref().ok().copied());
    match shortest.reduce(f64::min) {
        Some(length) => Ok(length),
        None => all.into_iter().last().unwrap_or_else(|| Err("no profile".into())),
    }
}
