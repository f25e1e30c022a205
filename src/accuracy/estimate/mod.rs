//! Error estimate of a run without an exact solution.
//!
//! Before the run, the same scene is run on cells two and four times as large ([`CoarseRuns`]). There
//! are two kinds of estimates:
//!
//! - On a line, of one body: the pressure of the first plateau ([`plateau`]), the arrival times of the
//!   wave ([`arrival`]), and a bound of the L1 of each profile. The indicators are the differences
//!   between the answers and the noise of the run. Richardson's extrapolation does not hold at shocks;
//!   instead, the error follows from the indicators by models fitted on random impacts and validated
//!   on others ([`error_model`]), one for each family of schemes ([`scheme_family`]). No plateau is
//!   reported if the waves have left none of sufficient length ([`impact_waves`]). The models were
//!   fitted on impacts of fluids ([`range`]); elsewhere the estimate is marked as a guess, and its
//!   intervals hold in fewer cases.
//! - In any scene, of histories at gauges ([`gauges`]) and of fields ([`fields`]): from the
//!   differences alone, always as a guess.

pub mod arrival;
mod bounded;
mod coarse_results;
mod differences;
pub mod error_model;
pub mod fields;
pub mod fitted_schemes;
pub mod gauge_records;
pub mod gauges;
pub mod impact_waves;
pub mod indicators;
mod interpolation;
pub mod plateau;
mod polyline;
pub mod range;
pub mod scheme_family;
mod shock_state;
mod surroundings;
pub mod tensile_failure;
mod within;

use serde::{Deserialize, Serialize};

pub use arrival::Arrivals;
pub use bounded::Bounded;
pub use coarse_results::{CoarseRun, CoarseRuns};
pub use error_model::{Laws, QuantityLaws};
pub use fields::FieldEstimate;
pub use fitted_schemes::FittedSchemes;
pub use gauge_records::{GaugeHistory, GaugeRecords};
pub use gauges::{HistoryEstimate, ReadingEstimate};
pub use impact_waves::{ImpactWaves, PlateauLeft};
pub use polyline::{Polyline, least_pressure, line};
pub use range::{EstimateBasis, FittedRange, OutOfRange};
pub use scheme_family::SchemeFamily;

use self::gauges::Rounding;
use self::indicators::OTHER_CELLS;
use self::polyline::ROUNDING;
use self::shock_state::ShockState;
use crate::accuracy::reference::ReferenceSolution;
use crate::scene::CheckedScene;
use crate::simulation::ParticleTable;

/// Error estimate of a profile.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProfileEstimate {
    /// Time \[s\].
    pub time: f64,
    /// Whether the error models were fitted on such profiles.
    #[serde(default)]
    pub basis: EstimateBasis,
    /// Pressure of the plateau behind the shock \[Pa\]; `None` if there is none of
    /// sufficient length.
    pub plateau_pressure: Option<Bounded>,
    /// Relative L1 of the pressure \[-\]: the value is 0 (no error), the half-width is the bound.
    pub l1: Bounded,
}

/// Error estimate of an arrival.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArrivalEstimate {
    /// Initial position \[m\].
    pub at: f64,
    /// Whether the error models were fitted on such arrivals.
    #[serde(default)]
    pub basis: EstimateBasis,
    /// First time at which the pressure there passes half of its maximum \[s\]; `None`: not in the
    /// run.
    pub time: Option<Bounded>,
}

/// Error estimate of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EstimatedErrors {
    /// Name of the body whose plateau, arrivals and profiles are estimated; absent in a plane.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<String>,
    /// Whether the error models were fitted on such scenes, for all profiles and arrivals.
    #[serde(default)]
    pub basis: EstimateBasis,
    /// Inputs outside of the range of the fit, one line each.
    #[serde(default)]
    pub outside: Vec<String>,
    /// Cell sizes of the coarse runs \[m\].
    pub companions: Vec<f64>,
    /// User CPU time of the coarse runs on this rank \[s\].
    pub cpu_seconds: f64,
    /// One entry per profile; empty in a plane.
    pub profiles: Vec<ProfileEstimate>,
    /// One entry per position.
    pub arrivals: Vec<ArrivalEstimate>,
    /// One entry per profile and quantity of `error_estimate.fields` that is not zero.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fields: Vec<FieldEstimate>,
    /// One entry per history of a gauge that is not zero.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub histories: Vec<HistoryEstimate>,
    /// One entry per value that is read from a history.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub readings: Vec<ReadingEstimate>,
    /// Reasons for missing estimates, one line each.
    pub notes: Vec<String>,
}

/// Input of the estimate: a finished run.
pub struct Answer<'a> {
    /// The scene.
    pub scene: &'a CheckedScene,
    /// Particles at the profile times.
    pub tables: Vec<&'a ParticleTable>,
    /// Error estimates of the fields in the profiles, by [`fields::compare`].
    pub fields: Vec<FieldEstimate>,
    /// Records of the gauges.
    pub gauges: &'a GaugeRecords,
    /// Arrivals recorded by the run.
    pub arrivals: &'a Arrivals,
    /// Number of time steps.
    pub steps: u64,
    /// The exact solution, if there is one.
    pub reference: Option<&'a ReferenceSolution>,
}

/// Mean sound transit time of a cell in a run of this many steps \[s\].
fn cell_time(scene: &CheckedScene, steps: u64) -> f64 {
    scene.scene.time.end / steps.max(1) as f64 / scene.scene.time.courant
}

/// Pressure up to which a change is rounding in every body, not a wave \[Pa\].
pub fn least_pressure_of_all(scene: &CheckedScene, steps: u64) -> f64 {
    let of = |body| least_pressure(scene, body, cell_time(scene, steps));
    (0..scene.bodies.len()).map(of).fold(f64::INFINITY, f64::min)
}

/// Relative difference from the coarse run beyond which a plateau is rejected, because the coarse
/// run has another wave or none at this position \[-\].
const OTHER_WAVE: f64 = 0.5;

/// Shortest plateau that is reported if its length follows from the exact waves \[cells\].
pub const LEAST_PLATEAU: f64 = 10.0;

/// Shortest plateau that is reported if its length is read from the profile \[cells\].
pub const LEAST_LEVEL: f64 = 20.0;

/// Thickness of the other of two bodies \[cells\]; `None` unless there are two.
pub fn other_cells(scene: &CheckedScene, body: usize) -> Option<f64> {
    let [_, _] = scene.bodies[..] else { return None };
    let other = &scene.bodies[1 - body];
    Some((other.upper[0] - other.lower[0]) / scene.cell_size[0])
}

/// Estimates the errors of a finished run.
pub fn estimate(answer: &Answer<'_>, coarse_runs: &CoarseRuns, laws: &Laws) -> EstimatedErrors {
    let factors = tensile_failure::factors(answer.scene, &answer.tables);
    let history_factor = tensile_failure::factor_of_histories(&factors);
    let mut errors = match answer.scene.estimated_body() {
        Some(body) => of_body(answer, body, coarse_runs, laws, factors),
        None => EstimatedErrors::default(),
    };
    errors.companions = coarse_runs.done.iter().map(|c| c.cell_size).collect();
    errors.cpu_seconds = coarse_runs.cpu_seconds;
    errors.notes.splice(..0, coarse_runs.notes.clone());
    errors.fields = answer.fields.clone();
    let rounding = Rounding {
        pressure: least_pressure_of_all(answer.scene, answer.steps),
        velocity: ROUNDING * answer.scene.cell_size[0] / cell_time(answer.scene, answer.steps),
    };
    errors.histories = gauges::of_histories(answer.gauges, coarse_runs, rounding, history_factor);
    errors.readings = gauges::of_readings(answer.gauges, coarse_runs);
    errors
}

/// Estimates the errors of a body on a line.
fn of_body(
    answer: &Answer<'_>,
    body: usize,
    coarse_runs: &CoarseRuns,
    laws: &Laws,
    factors: Vec<f64>,
) -> EstimatedErrors {
    let estimator = Estimator::new(answer, body, coarse_runs, laws, factors);
    let mut missing: Vec<(String, f64)> = Vec::new();
    let profiles: Vec<ProfileEstimate> = (0..answer.tables.len())
        .map(|k| {
            let (profile, reason) = estimator.profile(k);
            missing.extend(reason.map(|reason| (reason, profile.time)));
            profile
        })
        .collect();
    let places = &answer.scene.scene.error_estimate.as_ref().map_or(&[][..], |e| &e.arrivals);
    let exact = answer.reference.map_or(Vec::new(), |r| r.arrivals(answer.scene));
    let arrivals = places
        .iter()
        .enumerate()
        .map(|(k, &at)| estimator.arrival(k, at, exact.get(k).copied().flatten()))
        .collect();
    EstimatedErrors {
        body: Some(answer.scene.scene.bodies[body].name.clone()),
        basis: estimator.outside.basis(),
        outside: estimator.outside.lines(),
        profiles,
        arrivals,
        notes: reasons(&missing),
        ..EstimatedErrors::default()
    }
}

/// A line per reason for a missing plateau, with its times.
fn reasons(missing: &[(String, f64)]) -> Vec<String> {
    let mut lines: Vec<(&str, Vec<String>)> = Vec::new();
    for (reason, time) in missing {
        let time = format!("{:.4} us", 1e6 * time);
        match lines.iter_mut().find(|line| line.0 == reason) {
            Some((_, times)) => times.push(time),
            None => lines.push((reason, vec![time])),
        }
    }
    let line = |(reason, times): (&str, Vec<String>)| {
        format!("no plateau pressure at {}: {reason}", times.join(", "))
    };
    lines.into_iter().map(line).collect()
}

/// A finished run with what its estimates depend on.
struct Estimator<'a> {
    answer: &'a Answer<'a>,
    /// Index of the body.
    body: usize,
    coarse_runs: &'a CoarseRuns,
    laws: &'a Laws,
    family: SchemeFamily,
    outside: OutOfRange,
    waves: Option<ImpactWaves>,
    /// Sound transit time of a cell \[s\].
    cell_time: f64,
    /// Pressure rise up to which there is no wave \[Pa\].
    least: f64,
    /// Factor on the half-widths of each profile for material that fails in tension \[-\].
    factors: Vec<f64>,
}

impl<'a> Estimator<'a> {
    fn new(
        answer: &'a Answer<'a>,
        body: usize,
        coarse_runs: &'a CoarseRuns,
        laws: &'a Laws,
        factors: Vec<f64>,
    ) -> Self {
        let (scene, cell_time) = (answer.scene, cell_time(answer.scene, answer.steps));
        Estimator {
            answer,
            body,
            coarse_runs,
            laws,
            family: SchemeFamily::of(&scene.scene.method),
            outside: laws.fitted.outside(scene, body),
            waves: ImpactWaves::new(scene, body),
            cell_time,
            least: least_pressure(scene, body, cell_time),
            factors,
        }
    }

    /// Estimate of profile `k`, and the reason if it has no plateau.
    fn profile(&self, k: usize) -> (ProfileEstimate, Option<String>) {
        let (answer, table) = (self.answer, self.answer.tables[k]);
        let (basis, factor) = (self.outside.of_profile(k), self.factors[k]);
        let laws = self.laws.of(self.family, basis);
        let own = line(table, self.body);
        let others: Vec<(f64, &Polyline)> =
            self.coarse_runs.done.iter().map(|c| (c.factor, &c.profiles[k])).collect();
        let (plateau, reason) = match self.plateau(table, &own, &others) {
            Ok((found, evidence)) => {
                let half_width = laws.plateau_pressure.half_width(&evidence).map(|w| factor * w);
                let start = answer.scene.scene.bodies[self.body].pressure;
                let bounded = Bounded {
                    value: start + found.pressure,
                    half_width: half_width.map(|w| w * found.pressure.abs()),
                    evidence,
                    exact: self.exact_plateau(k),
                };
                (Some(bounded), None)
            }
            Err(reason) => (None, Some(reason)),
        };
        let is_silent = own.iter().all(|q| q.1.abs() <= self.least);
        let others = if is_silent { Vec::new() } else { others };
        let evidence = indicators::of_profile(&own, &others);
        let half_width = laws.l1.half_width(&evidence).map(|w| factor * w);
        let l1 = Bounded { value: 0.0, half_width, evidence, exact: None };
        (ProfileEstimate { time: table.time, basis, plateau_pressure: plateau, l1 }, reason)
    }

    /// The plateau of a profile with its indicators, or the reason why there is none.
    fn plateau(
        &self,
        table: &ParticleTable,
        own: &Polyline,
        others: &[(f64, &Polyline)],
    ) -> Result<(plateau::Plateau, indicators::Evidence), String> {
        let (scene, body) = (self.answer.scene, self.body);
        let h = scene.cell_size[0];
        let left = self.waves.as_ref().map_or(PlateauLeft::Unknown, |w| w.plateau(table.time));
        let start = scene.scene.bodies[body].pressure;
        let above = |line: &Polyline| line.iter().map(|q| (q.0, q.1 - start)).collect::<Polyline>();
        let least = if left == PlateauLeft::Unknown { LEAST_LEVEL } else { LEAST_PLATEAU };
        let found = match left {
            PlateauLeft::None(reason) => return Err(reason),
            PlateauLeft::Length(length) if length < least * h => {
                let cells = (length / h).floor();
                return Err(format!(
                    "the plateau is {cells} cells long, and its pressure is reported from \
                     {least} cells on"
                ));
            }
            PlateauLeft::Length(length) => plateau::of_length(&above(own), h, length),
            PlateauLeft::Unknown => plateau::find(&above(own), h, least as usize),
        };
        let found = found
            .filter(|found| found.pressure > self.least)
            .ok_or_else(|| format!("no level pressure over {least} cells behind a shock"))?;
        let lines: Vec<(f64, Polyline)> =
            others.iter().map(|(f, line)| (*f, above(line))).collect();
        let lines: Vec<(f64, &Polyline)> = lines.iter().map(|(f, line)| (*f, line)).collect();
        let mut evidence = indicators::of_plateau(&found, &lines, h);
        let nearest = lines.iter().map(|(factor, _)| *factor).reduce(f64::min);
        let differs = nearest.and_then(|f| evidence.get(&format!("difference_{f}")).copied());
        if differs.is_some_and(|d| d >= OTHER_WAVE) {
            return Err("the run on larger cells has another wave there".into());
        }
        let states = [
            ShockState::ahead(table, body, start),
            ShockState::behind(table, body, found.centre, found.reach),
            self.other_body(),
        ];
        evidence.extend(indicators::of_shock(states));
        evidence.extend(other_cells(scene, body).map(|n| (OTHER_CELLS.to_string(), n)));
        Ok((found, evidence))
    }

    /// Initial density and velocity of the other of two bodies.
    fn other_body(&self) -> Option<ShockState> {
        let scene = self.answer.scene;
        let [_, _] = scene.bodies[..] else { return None };
        let other = 1 - self.body;
        let (density, velocity) = (scene.material_of(other).density, scene.speed_along(other));
        Some(ShockState { density, velocity, ..ShockState::default() })
    }

    /// Exact pressure of the plateau in profile `k` \[Pa\].
    fn exact_plateau(&self, k: usize) -> Option<f64> {
        let Some(ReferenceSolution::Impact(all)) = self.answer.reference else { return None };
        all.solution.snapshots[k].landmarks.as_ref().map(|marks| marks.p2)
    }

    /// Estimate of the arrival at position number `k`, `at` \[m\]; `exact` \[s\] if known.
    fn arrival(&self, k: usize, at: f64, exact: Option<f64>) -> ArrivalEstimate {
        let basis = self.outside.of_arrival(k);
        let laws = self.laws.of(self.family, basis);
        let time = self.answer.arrivals.time(k).map(|(time, rise)| {
            let others: Vec<(f64, f64)> = self
                .coarse_runs
                .done
                .iter()
                .filter_map(|c| Some((c.factor, c.arrivals.get(k).copied()??)))
                .collect();
            let evidence = indicators::of_arrival(time, rise, &others, self.cell_time);
            let half_width = laws.arrival_time.half_width(&evidence).map(|w| w * self.cell_time);
            Bounded { value: time, half_width, evidence, exact }
        });
        ArrivalEstimate { at, basis, time }
    }
}
