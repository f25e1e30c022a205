//! Checkpoints: files for a restart that gives the same bits as an uninterrupted run.
//!
//! A checkpoint is itself an input: it holds the whole scene, the state that the next step needs
//! ([`Saved`]), and all records so far; [`profiles`] have files of their own, which it names. [`folder`]
//! writes, flushes and renames the files, [`seal`] detects any changed bit, [`mod@file`] defines the format
//! on disk, [`schedule`] decides when a checkpoint is due. All ranks write and read their shares of the
//! particles; independent of MPI.

mod datasets;
pub mod error;
pub mod file;
pub mod fit;
pub mod folder;
pub mod profiles;
pub mod schedule;
pub mod seal;

pub use error::CheckpointError;
pub use schedule::CheckpointSchedule;

use serde::{Deserialize, Serialize};

use crate::accuracy::estimate::arrival::Passing;
use crate::driver::figures::{DiagramQuantity, WaveRow};
use crate::driver::output::histories::HistoryTable;
use crate::driver::output::origin::{Origin, RUN};
use crate::scene::MethodChoice;
use crate::simulation::{BodyRow, ParticleTable, Saved};

/// A column of the particle state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StateColumn {
    /// Name.
    pub name: String,
    /// SI unit.
    pub unit: String,
}

/// Next records that are due in a run; the same on all ranks.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Due {
    /// Number of the next row of the histories, in intervals.
    pub history: u64,
    /// Interval of the histories [s]; `None` without histories.
    pub history_interval: Option<f64>,
    /// Number of the next row of the x-t diagram.
    pub wave: u64,
    /// End time of the run, which the rows of the x-t diagram divide [s].
    pub end: f64,
    /// Frames of the fields written so far.
    #[serde(default)]
    pub frames: u64,
    /// Quantities of the x-t diagrams besides the pressure, in the order of the rows.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub quantities: Vec<DiagramQuantity>,
    /// State of the wave arrivals that the run reports.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub arrivals: Vec<[Passing; 2]>,
}

/// Records of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Profiles and the digests of their states.
    pub tables: Vec<(ParticleTable, String)>,
    /// Rows of the x-t diagram.
    pub waves: Vec<WaveRow>,
    /// Surfaces and failed parts of the bodies, at the times of `waves`.
    pub bodies: Vec<BodyRow>,
    /// Histories.
    pub histories: Option<HistoryTable>,
}

/// A checkpoint in memory: on each rank a share of the particles, on rank 0 the records.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// Version of the program that wrote it.
    pub version: String,
    /// The command and the scene file of the run; `None` if not recorded.
    pub origin: Option<Origin>,
    /// Choice of the method; `None` if the scene gave it in full.
    pub method_choice: Option<MethodChoice>,
    /// The scene as run, JSON.
    pub scene: String,
    /// Dimension of the scene.
    pub dimension: usize,
    /// State that the next step needs.
    pub saved: Saved,
    /// The columns of the particles in `saved`.
    pub columns: Vec<StateColumn>,
    /// Next records that are due.
    pub due: Due,
    /// Records so far.
    pub record: Record,
}

/// Contents of a checkpoint to be written: those of [`Checkpoint`], borrowed. Each rank has its
/// particles, rank 0 the records.
#[derive(Clone, Debug)]
pub struct CheckpointContents<'a> {
    /// The command and the scene file of the run.
    pub origin: Option<&'a Origin>,
    /// Choice of the method; `None` if the scene gave it in full.
    pub method_choice: Option<&'a MethodChoice>,
    /// The scene as run, JSON.
    pub scene: &'a str,
    /// Dimension of the scene.
    pub dimension: usize,
    /// State that the next step needs.
    pub saved: &'a Saved,
    /// The columns of the particles in `saved`.
    pub columns: &'a [StateColumn],
    /// Next records that are due.
    pub due: Due,
    /// Profiles and the digests of their states.
    pub tables: &'a [(ParticleTable, String)],
    /// Rows of the x-t diagram.
    pub waves: &'a [WaveRow],
    /// Surfaces and failed parts of the bodies, at the times of `waves`.
    pub bodies: &'a [BodyRow],
    /// Histories.
    pub histories: Option<&'a HistoryTable>,
}

impl Checkpoint {
    /// The origin of the run; if not recorded, only the command.
    pub fn run_origin(&self) -> Origin {
        let unknown = || Origin { command: RUN.into(), ..Origin::default() };
        self.origin.clone().unwrap_or_else(unknown)
    }
}

impl CheckpointContents<'_> {
    /// Approximate size of this rank's share of the file, without those of the profiles [bytes].
    pub fn bytes(&self) -> u64 {
        let rows = self.saved.particles.ids.len() * (16 + 8 * self.columns.len());
        let waves = self.waves.iter().map(|w| 16 + 8 * w.x.len() * (2 + w.others.len()));
        let waves: usize = waves.sum();
        let bodies = self.bodies.iter();
        let bodies: usize = bodies.map(|b| 16 * (b.ends.len() + b.failed.len() + 1)).sum();
        let histories = self.histories.map_or(0, |h| 8 * h.len() * h.columns().len());
        // overhead of HDF5
        (rows + waves + bodies + histories + self.scene.len() + (64 << 10)) as u64
    }
}
