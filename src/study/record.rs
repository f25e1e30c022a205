//! What is kept of a case: one file, written aside and renamed, so that an interruption leaves
//! whole ones only.

use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::StudyError;
use crate::driver::output::summary::Summary;
use crate::scene::input_file;

/// Seconds of one run.
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

/// Errors of a profile.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProfileErrors {
    /// Time \[s\].
    pub time: f64,
    /// Errors as in `summary.json`; null without a reference.
    pub errors: Option<Value>,
}

/// What a run that ended well has left.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Particles.
    pub particles: u64,
    /// Cells.
    pub cells: u64,
    /// Steps.
    pub steps: u64,
    /// Drift of the total energy \[-\].
    pub energy_drift: Option<f64>,
    /// Drift of the momentum \[-\].
    pub momentum_drift: Option<f64>,
    /// Errors, a profile each.
    pub profiles: Vec<ProfileErrors>,
    /// The run's own statement of its errors, where the scene asks for it.
    #[serde(default)]
    pub estimate: Option<Value>,
}

/// What is kept of a case.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The result; none where it failed.
    pub measured: Option<Measured>,
    /// Why it failed.
    pub failure: Option<String>,
    /// One entry a repeat.
    pub seconds: Vec<Seconds>,
}

impl Record {
    /// Adds a run that ended well. Repeats have the same bits, so the first one's errors stay.
    pub fn add(&mut self, summary: &Summary) {
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
            estimate: None,
        });
    }

    /// The record of a key, if it is there and whole.
    pub fn read(folder: &Path, key: &str) -> Option<Record> {
        serde_json::from_slice(
            &input_file::read(&path(folder, key), input_file::LARGEST_JSON).ok()?,
        )
        .ok()
    }

    /// Writes it.
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
