//! Run-time checks: their bounds and the response to a violation.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Run-time checks of every run: an unstable step ends the run, or is repeated, before the result
/// is wrong. Bounds are relative, so that they hold in any units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Monitor {
    /// Response to a violated bound; default `stop`.
    pub on_alarm: OnAlarm,
    /// With `on_alarm` = `redo`: number of times that one step is repeated, each time with half the
    /// time step, before the run ends; default 8.
    #[schemars(range(min = 1, max = 50))]
    pub max_retries: u32,
    /// Steps between checks of all particles (energy, particles per cell), default 64. The state is
    /// saved in memory at the same steps, to be written if the run fails. With `redo` every step is
    /// checked.
    #[schemars(range(min = 1))]
    pub interval: u64,
    /// Largest growth of the total energy, minus the work of sides and forces, relative to the
    /// energy of the bodies without their common motion [-]. Absent: 1e-3 if the scheme conserves
    /// energy to rounding, 0.5 if it does not, 10 with hat functions at particle centres. Bounds
    /// also the loss of energy if the scheme conserves it, and with at least 0.02 internal energy
    /// below the smallest that is admissible.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub energy_growth: Option<f64>,
    /// Largest particle speed, relative to the largest speed of bodies and waves at the start, of
    /// escaping gas and of loads [-]; default 4.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub speed: f64,
    /// Largest Courant number of a step, computed from the state at its end [-]; default 4. With a
    /// larger value a run that becomes unstable ends later.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub courant: f64,
    /// Smallest stable time step, relative to the time in which the largest initial speed crosses a
    /// cell, or to the initial stable time step if that is smaller [-]; default 1e-4.
    #[schemars(range(max = 1.0), extend("exclusiveMinimum" = 0.0))]
    pub min_time_step_ratio: f64,
    /// Largest number of particles in a cell, relative to the largest number at the start [-];
    /// default 64.
    #[schemars(range(min = 1.0))]
    pub max_particles_per_cell_ratio: f64,
    /// Response to a `time.courant` above the measured stability limit of the method; default
    /// `refuse`.
    pub on_courant_exceeded: OnCourantExceeded,
}

impl Default for Monitor {
    fn default() -> Self {
        Monitor {
            on_alarm: OnAlarm::Stop,
            max_retries: 8,
            interval: 64,
            energy_growth: None,
            speed: 4.0,
            courant: 4.0,
            min_time_step_ratio: 1e-4,
            max_particles_per_cell_ratio: 64.0,
            on_courant_exceeded: OnCourantExceeded::Refuse,
        }
    }
}

impl Monitor {
    /// Whether all values are the defaults.
    pub fn is_default(&self) -> bool {
        *self == Monitor::default()
    }
}

/// Response to a violated bound.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum OnAlarm {
    /// Write the last good state and end all ranks.
    #[default]
    Stop,
    /// Repeat the step with half the time step, up to `max_retries` times, before the run ends as
    /// with `stop`.
    Redo,
}

/// Response to a `time.courant` above the measured stability limit of the method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum OnCourantExceeded {
    /// Reject the scene.
    #[default]
    Refuse,
    /// Use the limit instead, with a warning.
    Reduce,
    /// Use the given value, with a warning.
    Allow,
}
