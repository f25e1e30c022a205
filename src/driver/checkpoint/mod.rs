//! Checkpoints: files from which a run goes on, to the bits of one that was never broken.
//!
//! A checkpoint is itself an input: it holds the whole scene, all that the next step needs
//! ([`Saved`]), and what was recorded so far. [`folder`] writes them aside, flushes and renames
//! them, [`seal`] shows that not a bit has changed since, [`mod@file`] is the form on disk,
//! [`schedule`] says when one is due. Called on one rank; knows no MPI.

pub mod error;
pub mod file;
pub mod fit;
pub mod folder;
pub mod schedule;
pub mod seal;

pub use error::CheckpointError;
pub use schedule::Schedule;

use serde::{Deserialize, Serialize};

use crate::accuracy::estimate::arrival::Passing;
use crate::driver::figures::PressureRow;
use crate::driver::output::histories::Histories;
use crate::driver::output::origin::{Origin, RUN};
use crate::simulation::ParticleTable;
use crate::simulation::Saved;

/// A column of the state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StateColumn {
    /// Name.
    pub name: String,
    /// SI unit.
    pub unit: String,
}

/// What is due next of what a run records, alike on all ranks.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Due {
    /// The next row of the histories, in intervals.
    pub history: u64,
    /// The interval [s]; none: no histories.
    pub history_interval: Option<f64>,
    /// The next row of the x-t diagram.
    pub wave: u64,
    /// The end of the run that its rows divide [s].
    pub end: f64,
    /// What has come to the places whose arrivals are told.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub arrivals: Vec<[Passing; 2]>,
}

/// What a run has recorded.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Profiles and the digests of their states.
    pub tables: Vec<(ParticleTable, String)>,
    /// Rows of the x-t diagram.
    pub waves: Vec<PressureRow>,
    /// Histories.
    pub histories: Option<Histories>,
}

/// A checkpoint in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// Version of the program that wrote it.
    pub version: String,
    /// The command and the scene's file of the run; none where it does not say.
    pub origin: Option<Origin>,
    /// The scene as run, JSON.
    pub scene: String,
    /// Dimension of the scene.
    pub dimension: usize,
    /// What the next step needs.
    pub saved: Saved,
    /// The columns of its rows.
    pub columns: Vec<StateColumn>,
    /// What is due next.
    pub due: Due,
    /// What was recorded.
    pub record: Record,
}

/// A checkpoint that is written: what [`Checkpoint`] holds, not copied.
#[derive(Clone, Debug)]
pub struct Contents<'a> {
    /// The command and the scene's file of the run.
    pub origin: Option<&'a Origin>,
    /// The scene as run, JSON.
    pub scene: &'a str,
    /// Dimension of the scene.
    pub dimension: usize,
    /// What the next step needs.
    pub saved: &'a Saved,
    /// The columns of its rows.
    pub columns: &'a [StateColumn],
    /// What is due next.
    pub due: Due,
    /// Profiles and digests.
    pub tables: &'a [(ParticleTable, String)],
    /// Rows of the x-t diagram.
    pub waves: &'a [PressureRow],
    /// Histories.
    pub histories: Option<&'a Histories>,
}

impl Checkpoint {
    /// The origin of the run; of one that is not recorded the command alone.
    pub fn run_origin(&self) -> Origin {
        let unknown = || Origin { command: RUN.into(), ..Origin::default() };
        self.origin.clone().unwrap_or_else(unknown)
    }
}

impl Contents<'_> {
    /// About the bytes that its file takes.
    pub fn bytes(&self) -> u64 {
        let rows = self.saved.rows.ids.len() * (16 + 8 * self.columns.len());
        let table = |t: &ParticleTable| t.len() * (16 + 8 * (t.columns.len() + 4));
        let tables: usize = self.tables.iter().map(|t| table(&t.0)).sum();
        let waves: usize = self.waves.iter().map(|w| 16 * (w.points.len() + 1)).sum();
        let histories = self.histories.map_or(0, |h| 8 * h.len() * h.columns().len());
        // what HDF5 takes for itself
        (rows + tables + waves + histories + self.scene.len() + (64 << 10)) as u64
    }
}
