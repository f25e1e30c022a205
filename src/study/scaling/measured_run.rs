//! The part of `summary.json` that a scaling study reads.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde::Deserialize;

use super::error::ScalingError;
use crate::driver::output::SUMMARY_FILE;

/// Sizes and times of one run.
#[derive(Clone, Debug, Deserialize)]
pub struct MeasuredRun {
    /// Particles at the start.
    pub particles: u64,
    /// Steps of the time loop.
    pub steps: u64,
    /// Patches in each direction.
    pub patches: Vec<usize>,
    /// Wall time of the time loop \[s\].
    pub loop_wall_seconds: f64,
    /// User CPU time of all ranks, set-up and files included \[s\].
    pub cpu_seconds: f64,
    /// Costs of the decomposition; absent if the program does not count them.
    pub decomposition: Option<MeasuredDecomposition>,
}

/// Costs of the decomposition, over all ranks.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct MeasuredDecomposition {
    /// Number of computed particle-steps \[-\]: particles, summed over steps.
    pub particle_steps_computed: f64,
    /// Number of skipped particle-steps \[-\]: particles of quiescent patches, summed over steps.
    pub particle_steps_skipped: f64,
    /// Work of the busiest rank over the mean of all \[-\].
    pub imbalance: Option<f64>,
    /// Bytes sent per step \[B\].
    pub bytes_per_step: Option<f64>,
    /// Number of messages sent per step \[-\].
    pub messages_per_step: Option<f64>,
    /// Times of each rank.
    pub ranks: Vec<MeasuredRank>,
}

/// Times of one rank.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct MeasuredRank {
    /// Wall time of each part of the loop by name \[s\].
    pub seconds: BTreeMap<String, f64>,
}

impl MeasuredDecomposition {
    /// Share of particle-steps that were skipped \[-\]; `None` without particle-steps.
    pub fn skipped(&self) -> Option<f64> {
        let all = self.particle_steps_computed + self.particle_steps_skipped;
        (all > 0.0).then(|| self.particle_steps_skipped / all)
    }
}

impl MeasuredRun {
    /// Reads the summary of the results in `folder`.
    ///
    /// # Errors
    ///
    /// If the file cannot be read or has another format.
    pub fn read(folder: &Path) -> Result<MeasuredRun, ScalingError> {
        let path = folder.join(SUMMARY_FILE);
        let text = fs::read_to_string(&path).map_err(ScalingError::io(&path))?;
        serde_json::from_str(&text).map_err(ScalingError::format(&path))
    }
}
