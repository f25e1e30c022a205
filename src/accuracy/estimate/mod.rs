//! Error estimate of a run without an exact solution.
//!
//! Before the run, the same scene is run on cells two and four times as large ([`coarse_runs`]).
//! The indicators are the differences between the answers and the noise of the run. Richardson's
//! extrapolation does not hold at shocks; instead, the error follows from the indicators by models
//! fitted on random impacts and validated on others ([`error_model`]). Estimated are the pressure
//! of the first plateau ([`plateau`]), the arrival times of the wave ([`arrival`]), and a bound of
//! the L1 of each profile.
//!
//! Only for scenes on a line. The models were fitted on impacts of fluids between 300 m/s and 3
//! km/s, with 25 to 60 cells per flyer ([`range`]); elsewhere the estimate is marked as a guess.

pub mod arrival;
pub mod coarse_runs;
pub mod error_model;
pub mod indicators;
pub mod plateau;
mod polyline;
pub mod range;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

pub use arrival::Arrivals;
pub use coarse_runs::{Companion, Companions};
pub use error_model::Laws;
pub use polyline::{Polyline, line};
pub use range::{EstimateBasis, FittedRange, OutOfRange};

use self::polyline::least_pressure;
use crate::accuracy::reference::ReferenceSolution;
use crate::scene::CheckedScene;
use crate::simulation::ParticleTable;

/// A value with an interval that contains the exact value in 95 of 100 cases.
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

/// Finds the plateau of a profile above the start pressure `start` \[Pa\], with its indicators.
/// `None` if the pressure rises by at most `least` \[Pa\], or if the coarse runs lack the plateau.
fn find_plateau(
    own: &Polyline,
    others: &[(f64, &Polyline)],
    h: f64,
    [start, least]: [f64; 2],
) -> Option<(plateau::Plateau, indicators::Evidence)> {
    let above = |line: &Polyline| line.iter().map(|q| (q.0, q.1 - start)).collect::<Polyline>();
    let found = plateau::find(&above(own), h).filter(|found| found.pressure > least)?;
    let lines: Vec<(f64, Polyline)> = others.iter().map(|(f, line)| (*f, above(line))).collect();
    let lines: Vec<(f64, &Polyline)> = lines.iter().map(|(f, line)| (*f, line)).collect();
    let evidence = indicators::of_plateau(&found, &lines, h);
    let nearest = lines.iter().map(|(factor, _)| *factor).reduce(f64::min);
    let differs = nearest.and_then(|f| evidence.get(&format!("difference_{f}")).copied());
    differs.is_none_or(|d| d < OTHER_WAVE).then_some((found, evidence))
}

/// Estimates the errors of a finished run.
pub fn estimate(answer: &Answer<'_>, companions: &Companions, laws: &Laws) -> EstimatedErrors {
    let scene = answer.scene;
    let h = scene.cell_size[0];
    let cell_time = scene.scene.time.end / answer.steps.max(1) as f64 / scene.scene.time.courant;
    let start = scene.scene.bodies[answer.body].pressure;
    let least = least_pressure(scene, answer.body, cell_time);
    let outside = laws.fitted.outside(scene, answer.body);
    let profiles = answer.tables.iter().enumerate().map(|(k, table)| {
        let own = line(table, answer.body);
        let others: Vec<(f64, &Polyline)> =
            companions.done.iter().map(|c| (c.factor, &c.profiles[k])).collect();
        let marks = match answer.reference {
            Some(ReferenceSolution::Impact(all)) => all.solution.snapshots[k].landmarks.as_ref(),
            _ => None,
        };
        let plateau = find_plateau(&own, &others, h, [start, least]).map(|(found, evidence)| {
            let half_width = laws.plateau_pressure.half_width(&evidence);
            Bounded {
                value: start + found.pressure,
                half_width: half_width.map(|w| w * found.pressure.abs()),
                evidence,
                exact: marks.map(|m| m.p2),
            }
        });
        let is_silent = own.iter().all(|q| q.1.abs() <= least);
        let others = if is_silent { Vec::new() } else { others };
        let evidence = indicators::of_profile(&own, &others);
        let half_width = laws.l1.half_width(&evidence);
        let l1 = Bounded { value: 0.0, half_width, evidence, exact: None };
        let basis = outside.of_profile(k);
        ProfileEstimate { time: table.time, basis, plateau_pressure: plateau, l1 }
    });
    let places = &scene.scene.error_estimate.as_ref().map_or(&[][..], |e| &e.arrivals);
    let exact = answer.reference.map_or(Vec::new(), |r| r.arrivals(scene));
    let arrivals = places.iter().enumerate().map(|(k, &at)| {
        let time = answer.arrivals.time(k).map(|(time, rise)| {
            let others: Vec<(f64, f64)> = companions
                .done
                .iter()
                .filter_map(|c| Some((c.factor, c.arrivals.get(k).copied()??)))
                .collect();
            let evidence = indicators::of_arrival(time, rise, &others, cell_time);
            let half_width = laws.arrival_time.half_width(&evidence).map(|w| w * cell_time);
            let exact = exact.get(k).copied().flatten();
            Bounded { value: time, half_width, evidence, exact }
        });
        ArrivalEstimate { at, basis: outside.of_arrival(k), time }
    });
    EstimatedErrors {
        body: scene.scene.bodies[answer.body].name.clone(),
        basis: outside.basis(),
        outside: outside.lines(),
        companions: companions.done.iter().map(|c| c.cell_size).collect(),
        cpu_seconds: companions.cpu_seconds,
        profiles: profiles.collect(),
        arrivals: arrivals.collect(),
        notes: companions.notes.clone(),
    }
}
