//! How wrong a run's answer is, told without an exact solution.
//!
//! Before the run the same scene is run on cells two and four times as large ([`coarse_runs`]). What
//! its answer differs from theirs by, and how noisy it is, is the evidence; how the error follows
//! from the evidence is no theory, for at shocks differences do not fall as Richardson's
//! extrapolation supposes, but a law fitted on random impacts and held against others ([`error_model`]).
//! Told are the pressure of the first plateau ([`plateau`]), the times at which the wave arrives
//! at places ([`arrival`]), and a bound of each profile's L1.
//!
//! On a line. The laws were fitted on impacts of fluids between 300 m/s and 3 km/s, 25 to 60 cells a
//! flyer ([`range`]): elsewhere the estimate is marked as a guess.

pub mod arrival;
pub mod coarse_runs;
pub mod error_model;
pub mod indicators;
pub mod plateau;
pub mod range;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

pub use arrival::Arrivals;
pub use coarse_runs::{Companion, Companions};
pub use error_model::Laws;
pub use range::{Basis, FittedRange, Outside};

use crate::accuracy::reference::Reference;
use crate::scene::CheckedScene;
use crate::simulation::ParticleTable;

/// Pressures of one body by place: \[m\], \[Pa\].
pub type Line = Vec<(f64, f64)>;

/// A value and how far the truth is from it at most, in 95 of 100 cases.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounded {
    /// The run's answer, in SI units.
    pub value: f64,
    /// Half the width of the interval about it, in the same unit; none where there is too little
    /// evidence.
    pub half_width: Option<f64>,
    /// What the half-width follows from, by name.
    pub evidence: BTreeMap<String, f64>,
    /// The true value, where the scene has an exact solution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exact: Option<f64>,
}

/// What is told of a profile.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProfileEstimate {
    /// Time \[s\].
    pub time: f64,
    /// Whether the laws were fitted on such a profile.
    #[serde(default)]
    pub basis: Basis,
    /// Pressure of the plateau behind the shock \[Pa\]; none where there is none over 20 cells.
    pub plateau_pressure: Option<Bounded>,
    /// Relative L1 of the pressure: its value is 0, what no error would be, and its half-width the
    /// bound \[-\].
    pub l1: Bounded,
}

/// What is told of an arrival.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArrivalEstimate {
    /// The place, at the start \[m\].
    pub at: f64,
    /// Whether the laws were fitted on such an arrival.
    #[serde(default)]
    pub basis: Basis,
    /// When the pressure there first passes half of its greatest \[s\]; none: not within the run.
    pub time: Option<Bounded>,
}

/// The errors of a run, told by itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorEstimate {
    /// The body that it is about.
    pub body: String,
    /// Whether the laws were fitted on scenes like this one, at all of its profiles and places.
    #[serde(default)]
    pub basis: Basis,
    /// Inputs outside of the range that the laws were fitted on, one line each.
    #[serde(default)]
    pub outside: Vec<String>,
    /// Cell sizes of the companions \[m\].
    pub companions: Vec<f64>,
    /// User CPU time of the companions, this rank's \[s\].
    pub cpu_seconds: f64,
    /// One entry a profile.
    pub profiles: Vec<ProfileEstimate>,
    /// One entry a place.
    pub arrivals: Vec<ArrivalEstimate>,
    /// Why something could not be told, one line each.
    pub notes: Vec<String>,
}

/// What the estimate is made from.
pub struct Answer<'a> {
    /// The scene.
    pub scene: &'a CheckedScene,
    /// The body's number.
    pub body: usize,
    /// The run's profiles.
    pub tables: Vec<&'a ParticleTable>,
    /// What the run has told of arrivals.
    pub arrivals: &'a Arrivals,
    /// Steps that it has made.
    pub steps: u64,
    /// The exact solution, if there is one.
    pub reference: Option<&'a Reference>,
}

/// The body's particles as a line.
pub fn line(table: &ParticleTable, body: usize) -> Line {
    let column = |name| table.column(name).expect("the table has its own columns");
    let (x, p) = (column("x"), column("pressure"));
    let own = (0..table.len()).filter(|&r| table.body[r] as usize == body);
    own.map(|r| (x[r], p[r])).collect()
}

/// A pressure of this share of rho c^2 is rounding and no wave \[-\].
const ROUNDING: f64 = 1e-9;

/// Pressures of `body` up to this one are rounding and no wave \[Pa\], where sound takes `cell_time`
/// \[s\] through a cell.
pub(crate) fn least_pressure(scene: &CheckedScene, body: usize, cell_time: f64) -> f64 {
    ROUNDING * scene.material_of(body).density * (scene.cell_size[0] / cell_time).powi(2)
}

/// The difference from the companion's pressure beyond which a plateau is none: the companion has
/// another wave there, or none \[-\].
const OTHER_WAVE: f64 = 0.5;

/// The plateau of a profile above the pressure `start` of the body at the start \[Pa\], with its
/// evidence; none where the pressure has risen by no more than `least` \[Pa\] or the companions do
/// not have it.
fn find_plateau(
    own: &Line,
    others: &[(f64, &Line)],
    h: f64,
    [start, least]: [f64; 2],
) -> Option<(plateau::Plateau, indicators::Evidence)> {
    let above = |line: &Line| line.iter().map(|q| (q.0, q.1 - start)).collect::<Line>();
    let found = plateau::find(&above(own), h).filter(|found| found.pressure > least)?;
    let lines: Vec<(f64, Line)> = others.iter().map(|(f, line)| (*f, above(line))).collect();
    let lines: Vec<(f64, &Line)> = lines.iter().map(|(f, line)| (*f, line)).collect();
    let evidence = indicators::of_plateau(&found, &lines, h);
    let nearest = lines.iter().map(|(factor, _)| *factor).reduce(f64::min);
    let differs = nearest.and_then(|f| evidence.get(&format!("difference_{f}")).copied());
    differs.is_none_or(|d| d < OTHER_WAVE).then_some((found, evidence))
}

/// States the errors of a finished run.
pub fn estimate(answer: &Answer<'_>, companions: &Companions, laws: &Laws) -> ErrorEstimate {
    let scene = answer.scene;
    let h = scene.cell_size[0];
    let cell_time = scene.scene.time.end / answer.steps.max(1) as f64 / scene.scene.time.courant;
    let start = scene.scene.bodies[answer.body].pressure;
    let least = least_pressure(scene, answer.body, cell_time);
    let outside = laws.fitted.outside(scene, answer.body);
    let profiles = answer.tables.iter().enumerate().map(|(k, table)| {
        let own = line(table, answer.body);
        let others: Vec<(f64, &Line)> =
            companions.done.iter().map(|c| (c.factor, &c.profiles[k])).collect();
        let marks = match answer.reference {
            Some(Reference::Impact(all)) => all.solution.snapshots[k].landmarks.as_ref(),
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
    ErrorEstimate {
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
