//! Results of the coarse runs, with which the run itself is compared.

use super::arrival::Levels;
use super::gauge_records::GaugeRecords;
use super::polyline::Polyline;
use crate::simulation::ParticleTable;

/// Results of one coarse run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CoarseRun {
    /// Nominal cell size over that of the scene \[-\].
    pub factor: f64,
    /// Actual cell size over that of the scene, the least over the directions \[-\]. It is below
    /// `factor` where both sides of the domain are fixed.
    pub ratio: f64,
    /// Cell size along x \[m\].
    pub cell_size: f64,
    /// Pressures \[Pa\] of the body whose errors are estimated over x \[m\], one line per profile;
    /// empty in a plane.
    pub profiles: Vec<Polyline>,
    /// Arrival times of the wave at the given positions \[s\].
    pub arrivals: Vec<Option<f64>>,
    /// Particles with the quantities whose errors are estimated, one table per profile; empty
    /// without such quantities.
    pub tables: Vec<ParticleTable>,
    /// Records of the gauges.
    pub gauges: GaugeRecords,
}

/// All coarse runs of a scene.
#[derive(Clone, Debug, Default)]
pub struct CoarseRuns {
    /// Coarse runs that reached their end, the finest last; on rank 0 only.
    pub done: Vec<CoarseRun>,
    /// Levels of the wave at each position in the finest coarse run; `None`: no wave came.
    pub levels: Vec<Option<Levels>>,
    /// User CPU time of this process in the coarse runs \[s\].
    pub cpu_seconds: f64,
    /// Reasons why a coarse run has no results.
    pub notes: Vec<String>,
}
