//! The part of `summary.json` that a study reads.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use flyer_mpm::driver::output::SUMMARY_FILE;
use serde::Deserialize;

/// One run.
#[derive(Clone, Debug, Deserialize)]
pub struct RunSummary {
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
    /// What the decomposition cost; absent where the program does not count it.
    pub decomposition: Option<Decomposition>,
}

/// What the decomposition cost, over all ranks.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Decomposition {
    /// Particles computed, summed over steps.
    pub particle_steps_computed: f64,
    /// Particles left out because nothing happens to them, summed over steps.
    pub particle_steps_skipped: f64,
    /// Work of the busiest rank over the mean of all.
    pub imbalance: Option<f64>,
    /// Bytes sent a step.
    pub bytes_per_step: Option<f64>,
    /// Messages sent a step.
    pub messages_per_step: Option<f64>,
    /// Each rank.
    pub ranks: Vec<Rank>,
}

/// One rank.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Rank {
    /// Wall time of each part of the loop by name \[s\].
    pub seconds: BTreeMap<String, f64>,
}

impl Decomposition {
    /// Share of particle-steps that were left out.
    pub fn skipped(&self) -> Option<f64> {
        let all = self.particle_steps_computed + self.particle_steps_skipped;
        (all > 0.0).then(|| self.particle_steps_skipped / all)
    }
}

impl RunSummary {
    /// Reads the summary of the results in `folder`.
    pub fn read(folder: &Path) -> Result<RunSummary, String> {
        let path = folder.join(SUMMARY_FILE);
        let text = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        serde_json::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))
    }
}
