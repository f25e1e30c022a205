//! Error estimate of a run without an exact solution.
//!
//! Before the run, the same scene is run on cells two and four times as large ([`coarse_runs`]).
//! The indicators are the differences between the answers and the noise of the run. Richardson's
//! extrapolation does not hold at shocks; instead, the error follows from the indicators by models
//! fitted on random impacts and validated on others ([`error_model`]), one for each family of
//! schemes ([`scheme_family`]). Estimated are the pressure of the first plateau ([`plateau`]), the
//! arrival times of the wave ([`arrival`]), and a bound of the L1 of each profile. No plateau is
//! reported if the waves have left none of sufficient length ([`impact_waves`]).
//!
//! Only for scenes on a line. The models were fitted on impacts of fluids ([`range`]); elsewhere
//! the estimate is marked as a guess, and its intervals hold in fewer cases.

pub mod arrival;
pub mod coarse_runs;
pub mod error_model;
pub mod fitted_schemes;
pub mod impact_waves;
pub mod indicators;
pub mod plateau;
mod polyline;
pub mod range;
pub mod scheme_family;
mod shock_state;
mod surroundings;
mod within;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

pub use arrival::Arrivals;
pub use coarse_runs::{Companion, Companions};
pub use error_model::{Laws, QuantityLaws};
pub use fitted_schemes::FittedSchemes;
pub use impact_waves::{ImpactWaves, PlateauLeft};
pub use polyline::{Polyline, line};
pub use range::{EstimateBasis, FittedRange, OutOfRange};
pub use scheme_family::SchemeFamily;

use self::polyline::least_pressure;
use self::shock_state::ShockState;
use crate::accuracy::reference::ReferenceSolution;
use crate::scene::CheckedScene;
use crate::simulation::ParticleTable;

/// A value with an interval that contains the exact value in 95 of 100 cases, if the estimate is
/// calibrated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounded {
    /// Value computed by the run, in the SI unit of its quantity: \[Pa\], \[s\] or \[-\].
    pub value: f64,
    /// Half-width of the interval, in the unit of `value`; `None` if indicators are missing.
    pub half_width: Option<f64>,
    /// Indicators from which the half-width follows, by name \[-\].
    pub evidence: BTreeMap<String, f64>,
    /// Exact value in the unit of `value`, if the scene has an exact solution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exact: Option<f64>,
}

/// Error estimate of a profile.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProfileEstimate {
    /// Time \[s\].
    pub time: f64,
    /// Whether the error models were fitted on such profiles.
    #[serde(default)]
    pub basis: EstimateBasis,
    /// Pressure of the plateau behind the shock \[Pa\]; `None` if there is none over 20 cells.
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EstimatedErrors {
    /// Name of the body.
    pub body: String,
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
    /// One entry per profile.
    pub profiles: Vec<ProfileEstimate>,
    /// One entry per position.
    pub arrivals: Vec<ArrivalEstimate>,
    /// Reasons for missing estimates, one line each.
    pub notes: Vec<String>,
}

/// Input of the estimate: a finished run.
pub struct Answer<'a> {
    /// The scene.
    pub scene: &'a CheckedScene,
    /// Index of the body.
    pub body: usize,
    /// Particles at the profile times.
    pub tables: Vec<&'a ParticleTable>,
    /// Arrivals recorded by the run.
    pub arrivals: &'a Arrivals,
    /// Number of time steps.
    pub steps: u64,
    /// The exact solution, if there is one.
    pub reference: Option<&'a ReferenceSolution>,
}

/// Relative difference from the coarse run beyond which a plateau is rejected, because the coarse
/// run has another wave or none at this position \[-\].
const OTHER_WAVE: f64 = 0.5;

/// Shortest plateau that is reported \[cells\].
pub const LEAST_PLATEAU: f64 = 20.0;

/// Estimates the errors of a finished run.
pub fn estimate(answer: &Answer<'_>, companions: &Companions, laws: &Laws) -> EstimatedErrors {
    let estimator = Estimator::new(answer, companions, laws);
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
    let mut notes = companions.notes.clone();
    notes.extend(reasons(&missing));
    EstimatedErrors {
        body: answer.scene.scene.bodies[answer.body].name.clone(),
        basis: estimator.outside.basis(),
        outside: estimator.outside.lines(),
        companions: companions.done.iter().map(|c| c.cell_size).collect(),
        cpu_seconds: companions.cpu_seconds,
        profiles,
        arrivals,
        notes,
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
    companions: &'a Companions,
    laws: &'a Laws,
    family: SchemeFamily,
    outside: OutOfRange,
    waves: Option<ImpactWaves>,
    /// Sound transit time of a cell \[s\].
    cell_time: f64,
    /// Pressure rise up to which there is no wave \[Pa\].
    least: f64,
}

impl<'a> Estimator<'a> {
    fn new(answer: &'a Answer<'a>, companions: &'a Companions, laws: &'a Laws) -> Self {
        let (scene, body) = (answer.scene, answer.body);
        let time = &scene.scene.time;
        let cell_time = time.end / answer.steps.max(1) as f64 / time.courant;
        Estimator {
            answer,
            companions,
            laws,
            family: SchemeFamily::of(&scene.scene.method),
            outside: laws.fitted.outside(scene, body),
            waves: ImpactWaves::new(scene, body),
            cell_time,
            least: least_pressure(scene, body, cell_time),
        }
    }

    /// Estimate of profile `k`, and the reason if it has no plateau.
    fn profile(&self, k: usize) -> (ProfileEstimate, Option<String>) {
        let (answer, table) = (self.answer, self.answer.tables[k]);
        let basis = self.outside.of_profile(k);
        let laws = self.laws.of(self.family, basis);
        let own = line(table, answer.body);
        let others: Vec<(f64, &Polyline)> =
            self.companions.done.iter().map(|c| (c.factor, &c.profiles[k])).collect();
        let (plateau, reason) = match self.plateau(table, &own, &others) {
            Ok((found, evidence)) => {
                let half_width = laws.plateau_pressure.half_width(&evidence);
                let start = answer.scene.scene.bodies[answer.body].pressure;
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
        let half_width = laws.l1.half_width(&evidence);
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
        let (scene, body) = (self.answer.scene, self.answer.body);
        let h = scene.cell_size[0];
        let left = self.waves.as_ref().map_or(PlateauLeft::Unknown, |w| w.plateau(table.time));
        let start = scene.scene.bodies[body].pressure;
        let above = |line: &Polyline| line.iter().map(|q| (q.0, q.1 - start)).collect::<Polyline>();
        let found = match left {
            PlateauLeft::None(reason) => return Err(reason),
            PlateauLeft::Length(length) if length < LEAST_PLATEAU * h => {
                let cells = (length / h).floor();
                return Err(format!(
                    "the plateau is {cells} cells long, and its pressure is reported from \
                     {LEAST_PLATEAU} cells on"
                ));
            }
            PlateauLeft::Length(length) => plateau::of_length(&above(own), h, length),
            PlateauLeft::Unknown => plateau::find(&above(own), h, LEAST_PLATEAU as usize),
        };
        let found = found.filter(|found| found.pressure > self.least).ok_or_else(|| {
            format!("no level pressure over {LEAST_PLATEAU} cells behind a shock")
        })?;
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
        Ok((found, evidence))
    }

    /// Initial density and velocity of the other of two bodies.
    fn other_body(&self) -> Option<ShockState> {
        let scene = self.answer.scene;
        let [_, _] = scene.bodies[..] else { return None };
        let other = 1 - self.answer.body;
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
                .companions
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
