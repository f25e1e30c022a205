//! A run in memory: the particles of the scene on their patches, advanced step by step.
//!
//! It has no global state: several runs can exist in one process. Other modules write files and
//! pictures from its results.

mod accounts;
mod arrival;
mod balance;
mod bins;
mod body_row;
mod conservation;
mod counted_layout;
mod diagnostics;
mod error;
mod exchange_plan;
mod expected_peaks;
mod gauges;
mod good_state;
mod memory;
pub mod monitor;
mod particle_table;
mod patches;
mod peaks;
mod preview;
mod quiescence;
mod run;
mod run_checks;
mod self_contact;
mod snapshot;
mod state_digest;
pub mod threads;

pub use crate::solver::patch::BoundaryWork;
pub use accounts::{Counters, Removed, RemovedByKind};
pub use body_row::BodyRow;
pub use counted_layout::{CountedLayout, CountedPatch, CountedRank, WantedLayout, count_layout};
pub use diagnostics::{Followed, HALF_EDGES, Totals};
pub use error::RunError;
pub use gauges::Around;
pub use memory::rank_memory;
pub use particle_table::{ParticleTable, TableColumn, part_of, quantity_of, with_suffix};
pub(crate) use patches::LEAST_CELLS;
pub use patches::{initial_particles, may_skip, patch_counts};
pub use preview::Preview;
pub use run::{Compiled, Simulation};
pub use snapshot::{Saved, saved_sums};
