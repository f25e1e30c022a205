//! The stored result of a case: one file, written under another name and then renamed, so that an
//! interrupted write leaves no incomplete record.

use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::StudyError;
use super::convergence::{Convergence, Histories};
use crate::driver::output::summary::Summary;
use crate::input::input_file;

/// CPU and wall times of one run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Seconds {
    /// User CPU time of the time loop, all ranks \[s\].
    pub loop_cpu: f64,
    /// Wall time of the time loop \[s\].
    pub loop_wall: f64,
    /// User CPU time of the whole process, all ranks \[s\].
    pub cpu: f64,
    /// Wall time of the whole process \[s\].
    pub wall: f64,
}

/// Errors of one profile.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProfileErrors {
    /// Time \[s\].
    pub time: f64,
    /// Errors as in `summary.json`; `None` without a reference.
    pub errors: Option<Value>,
}

/// Result of a successful run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Number of particles.
    pub particles: u64,
    /// Number of cells.
    pub cells: u64,
    /// Number of time steps.
    pub steps: u64,
    /// Drift of the total energy \[-\].
    pub energy_drift: Option<f64>,
    /// Drift of the momentum \[-\].
    pub momentum_drift: Option<f64>,
    /// Errors, one entry per profile.
    pub profiles: Vec<ProfileErrors>,
    /// Histories that the study compares.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub histories: Option<Histories>,
    /// Error estimate of the run, if the scene requests it.
    #[serde(default)]
    pub estimate: Option<Value>,
}

/// The stored result of a case.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StudyRecord {
    /// The result; `None` if the case failed.
    pub measured: Option<Measured>,
    /// Reason of the failure.
    pub failure: Option<String>,
    /// Times, one entry per repeat.
    pub seconds: Vec<Seconds>,
}

impl StudyRecord {
    /// Adds a successful run. Repeats are bitwise identical, so the errors of the first one are
    /// kept.
    pub fn add(&mut self, summary: &Summary, histories: Option<Histories>) {
        self.seconds.push(Seconds {
            loop_cpu: summary.loop_cpu_seconds,
            loop_wall: summary.loop_wall_seconds,
            cpu: summary.cpu_seconds,
            wall: summary.wall_seconds,
        });
        let profile = |p: &crate::driver::output::summary::ProfileSummary| ProfileErrors {
            time: p.time,
            errors: p.errors.clone(),
        };
        self.measured.get_or_insert_with(|| Measured {
            particles: summary.particles,
            cells: summary.cells,
            steps: summary.steps,
            energy_drift: summary.energy.drift,
            momentum_drift: summary.momentum.drift,
            profiles: summary.profiles.iter().map(profile).collect(),
            histories,
            estimate: None,
        });
    }

    /// Whether a successful run has the histories that a study compares.
    pub fn has_histories(&self, convergence: Option<&Convergence>) -> bool {
        let (Some(convergence), Some(measured)) = (convergence, &self.measured) else {
            return true;
        };
        measured.histories.as_ref().is_some_and(|own| own.have(&convergence.columns))
    }

    /// Reads the record of a key; `None` if it is missing or damaged.
    pub fn read(folder: &Path, key: &str) -> Option<StudyRecord> {
        serde_json::from_slice(
            &input_file::read(&path(folder, key), input_file::LARGEST_JSON).ok()?,
        )
        .ok()
    }

    /// Writes the record.
    ///
    /// # Errors
    ///
    /// If the file cannot be written.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn write(&self, folder: &Path, key: &str) -> Result<(), StudyError> {
        let (place, aside) = (path(folder, key), folder.join(format!("{key}.part")));
        let text = serde_json::to_vec_pretty(self).expect("a record is plain data");
        fs::write(&aside, text).map_err(StudyError::io("cannot be written", &aside))?;
        fs::rename(&aside, &place).map_err(StudyError::io("cannot be written", &place))
    }
}

fn path(folder: &Path, key: &str) -> PathBuf {
    folder.join(format!("{key}.json"))
}
