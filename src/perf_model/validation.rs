//! Comparison of predictions with measurements of `perf study`.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::cost::predict_run;
use super::load::Work;
use super::machine::Machine;
use super::network::Network;
use super::table::{aligned, extrapolated, halo_name, number};
use crate::input::input_file;
use crate::scene::{CheckedScene, FilterHalo};

/// The required part of `scaling.json` of a strong-scaling study.
#[derive(Clone, Debug, Deserialize)]
pub struct Against {
    /// Kind of scaling: the quantity that the study held fixed.
    kind: String,
    /// Scene file.
    pub scene: PathBuf,
    /// Overrides of the scene.
    pub sets: Vec<String>,
    rows: Vec<ValidationRow>,
}

#[derive(Clone, Debug, Deserialize)]
struct ValidationRow {
    ranks: usize,
    threads: usize,
    skip_quiescent: bool,
    oversubscribed: bool,
    patches: usize,
    particles: u64,
    steps: u64,
    wall_seconds: f64,
    wall_seconds_min: Option<f64>,
    wall_seconds_max: Option<f64>,
    /// Mean share of the time of a rank for outputs, which the model does not contain \[-\].
    output: Option<f64>,
    bytes_per_step: Option<f64>,
    messages_per_step: Option<f64>,
}

impl ValidationRow {
    fn spread(&self) -> Option<f64> {
        Some((self.wall_seconds_max? - self.wall_seconds_min?) / self.wall_seconds)
    }
}

/// A study that cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{file}: {reason}")]
pub struct PredictionError {
    file: String,
    reason: String,
}

/// Prediction and measurement of one configuration.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared {
    /// Ranks.
    pub ranks: usize,
    /// Threads of each rank.
    pub threads: usize,
    /// Patches.
    pub patches: usize,
    /// Particles.
    pub particles: u64,
    /// How filters got values outside of a patch.
    pub halo: FilterHalo,
    /// Predicted time of a step \[s\].
    pub predicted: f64,
    /// Measured time of a step: wall time of the loop, less the mean share of outputs, over its steps
    /// \[s\].
    pub measured: f64,
    /// Difference of the longest and the shortest run over their median \[-\].
    pub spread: Option<f64>,
    /// Predicted over counted bytes of all ranks, minus one \[-\]; the counter includes outputs.
    pub bytes: Option<f64>,
    /// Predicted over counted messages, minus one \[-\].
    pub messages: Option<f64>,
    /// Whether there were more workers than cores, which the model does not describe.
    pub oversubscribed: bool,
}

impl Compared {
    /// Predicted over measured time, minus one \[-\].
    pub fn deviation(&self) -> f64 {
        self.predicted / self.measured - 1.0
    }
}

impl Against {
    /// Reads a study.
    ///
    /// # Errors
    ///
    /// If the file cannot be read or is not a valid study of strong scaling.
    pub fn read(path: &Path) -> Result<Self, PredictionError> {
        let fail = |reason: String| PredictionError { file: path.display().to_string(), reason };
        let bytes = input_file::read(path, input_file::LARGEST_JSON)
            .map_err(|e| fail(format!("{e}; flyer-mpm perf study strong writes scaling.json")))?;
        let study: Against = serde_json::from_slice(&bytes).map_err(|e| {
            fail(format!("no scaling study: {e}; allowed: scaling.json of perf study strong"))
        })?;
        if study.kind != "strong" {
            let kind = &study.kind;
            return Err(fail(format!("kind = {kind:?}; allowed: a study of strong scaling")));
        }
        let sound = |r: &ValidationRow| {
            let counts = [r.ranks, r.threads, r.patches, r.steps as usize];
            let computes = r.output.is_none_or(|share| (0.0..1.0).contains(&share));
            !counts.contains(&0) && r.wall_seconds > 0.0 && computes
        };
        match study.rows.iter().position(|r| !sound(r)) {
            Some(k) => Err(fail(format!("row {k} has a count or time of 0; allowed: above 0"))),
            None => Ok(study),
        }
    }

    /// Compares all configurations that computed quiescent patches too; `scene` is that of the
    /// study, with its overrides.
    ///
    /// # Errors
    ///
    /// If a row of the study is of another scene.
    pub fn compare(
        &self,
        machine: &Machine,
        network: &Network,
        scene: &CheckedScene,
        path: &Path,
    ) -> Result<Vec<Compared>, PredictionError> {
        let work = Work::new(scene);
        let mut found = Vec::new();
        for row in self.rows.iter().filter(|r| !r.skip_quiescent) {
            let &ValidationRow { ranks, threads, patches, particles, oversubscribed, .. } = row;
            if particles != scene.particles {
                return Err(PredictionError {
                    file: path.display().to_string(),
                    reason: format!(
                        "is of {particles} particles, but the scene has {}; allowed: a study of \
                         this scene",
                        scene.particles
                    ),
                });
            }
            let own = predict_run(machine, network, (scene, &work), [ranks, threads], None);
            found.push(Compared {
                ranks,
                threads,
                patches,
                particles,
                halo: own.halo,
                predicted: own.step,
                measured: row.wall_seconds * (1.0 - row.output.unwrap_or(0.0)) / row.steps as f64,
                spread: row.spread(),
                bytes: row.bytes_per_step.filter(|b| *b > 0.0).map(|b| own.bytes / b - 1.0),
                messages: row
                    .messages_per_step
                    .filter(|m| *m > 0.0)
                    .map(|m| own.messages / m - 1.0),
                oversubscribed,
            });
        }
        Ok(found)
    }

    /// Comparisons as aligned text, with the largest deviation of those without oversubscription.
    pub fn table(machine: &Machine, all: &[Compared]) -> String {
        let head = [
            "particles",
            "ranks",
            "threads",
            "patches",
            "halo",
            "predicted us",
            "measured us",
            "deviation %",
            "spread %",
            "bytes %",
            "messages %",
        ];
        let percent =
            |value: Option<f64>| value.map_or("-".into(), |v| format!("{:+.1}", 100.0 * v));
        let mut lines = vec![head.map(String::from).to_vec()];
        for c in all {
            let mark = if extrapolated(machine, c.ranks, c.threads) { "*" } else { "" };
            let note = if c.oversubscribed { " oversubscribed" } else { "" };
            lines.push(vec![
                c.particles.to_string(),
                format!("{mark}{}", c.ranks),
                c.threads.to_string(),
                c.patches.to_string(),
                halo_name(c.halo).into(),
                number(c.predicted * 1e6),
                number(c.measured * 1e6),
                percent(Some(c.deviation())),
                c.spread.map_or("-".into(), |spread| format!("{:.1}", 100.0 * spread)),
                percent(c.bytes),
                percent(c.messages) + note,
            ]);
        }
        let own = all.iter().filter(|c| !c.oversubscribed);
        let largest = own.map(|c| c.deviation().abs()).fold(0.0, f64::max);
        format!("{}largest deviation: {:.1} %\n", aligned(&lines), 100.0 * largest)
    }
}
