//! A row of the table of a study: labels, errors and times of a case.

use std::collections::BTreeMap;

use super::convergence::HISTORIES;
use super::record::{Seconds, StudyRecord};

/// A case and its result.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyRow {
    /// Labels of the case.
    pub labels: BTreeMap<String, String>,
    /// Ranks.
    pub ranks: usize,
    /// Threads of each rank.
    pub threads: usize,
    /// Stored result.
    pub record: StudyRecord,
    /// Difference of the histories from those of the reference case \[-\].
    pub histories: Option<f64>,
}

/// Errors of each profile in the table, with their names in `summary.json`; a dot selects a key of
/// a nested object.
pub const ERRORS: [&str; 26] = [
    "l1",
    "l2",
    "e1_cells",
    "plateau",
    "noise",
    "rise_cells",
    "shock_position_cells",
    "overshoot",
    "second_plateau",
    "density_plateau",
    "energy_plateau",
    "density_l1",
    "density_interface",
    "energy_interface",
    "mean_density_error",
    "waves.shock",
    "waves.fan",
    "waves.plateau_2",
    "waves.second_plateau",
    "displacement_l2",
    "velocity_rms",
    "velocity_l1",
    "pressure_rms",
    "kinetic_energy_loss",
    "energy_loss",
    "angular_momentum_loss",
];

impl StudyRow {
    /// Median of a time over the repeats \[s\].
    pub fn seconds(&self, of: fn(&Seconds) -> f64) -> Option<f64> {
        let mut all: Vec<f64> = self.record.seconds.iter().map(of).collect();
        all.sort_by(f64::total_cmp);
        let middle = all.len() / 2;
        match all.len() {
            0 => None,
            n if n % 2 == 1 => Some(all[middle]),
            _ => Some(0.5 * (all[middle - 1] + all[middle])),
        }
    }

    /// Smallest and largest value of a time over the repeats \[s\].
    pub fn spread(&self, of: fn(&Seconds) -> f64) -> Option<(f64, f64)> {
        let all = self.record.seconds.iter().map(of);
        all.fold(None, |range: Option<(f64, f64)>, s| match range {
            None => Some((s, s)),
            Some((low, high)) => Some((low.min(s), high.max(s))),
        })
    }

    /// The error `name` of the profile at `time` \[s\], or of the last profile, signed; `None` if
    /// undefined.
    pub fn error(&self, name: &str, time: Option<f64>) -> Option<f64> {
        let profiles = &self.record.measured.as_ref()?.profiles;
        let near = |t: f64, time: f64| (t - time).abs() <= 1e-9 * time.abs();
        let profile = match time {
            Some(time) => profiles.iter().find(|p| near(p.time, time))?,
            None => profiles.last()?,
        };
        name.split('.').try_fold(profile.errors.as_ref()?, |v, key| v.get(key))?.as_f64()
    }

    /// A number by its name: `loop_cpu_seconds`, `loop_wall_seconds`, `cpu_seconds`, `core_seconds`
    /// (wall time of the loop times cores), `energy_drift`, `momentum_drift`, `particles`, `steps`,
    /// a numeric label, or an error at `time` \[s\] or of the last profile.
    pub fn number(&self, name: &str, time: Option<f64>) -> Option<f64> {
        let measured = self.record.measured.as_ref();
        match name {
            "loop_cpu_seconds" => self.seconds(|s| s.loop_cpu),
            "loop_wall_seconds" => self.seconds(|s| s.loop_wall),
            "cpu_seconds" => self.seconds(|s| s.cpu),
            "core_seconds" => {
                self.seconds(|s| s.loop_wall).map(|s| s * (self.ranks * self.threads) as f64)
            }
            "energy_drift" => measured?.energy_drift,
            "momentum_drift" => measured?.momentum_drift,
            "particles" => Some(measured?.particles as f64),
            "steps" => Some(measured?.steps as f64),
            HISTORIES => self.histories,
            _ => match self.labels.get(name) {
                Some(label) => label.parse().ok(),
                None => self.error(name, time),
            },
        }
    }

    /// The values of these labels, joined to one name.
    pub fn name(&self, labels: &[String]) -> String {
        let values = labels.iter().filter_map(|label| self.labels.get(label).map(String::as_str));
        values.collect::<Vec<_>>().join(", ")
    }
}
