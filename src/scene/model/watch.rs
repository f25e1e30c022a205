//! The watch over a run: its bounds, and what it does where one is passed.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The watch that every run is under: what is no longer stable ends it, or is redone, before the
/// answer is wrong. Bounds are relative, so that they hold in any units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Watch {
    /// What an alarm does.
    pub on_alarm: OnAlarm,
    /// Times that one step is redone, each time half as long, before the run ends after all; with
    /// `on_alarm` `redo`.
    #[schemars(range(min = 1, max = 50))]
    pub most_redos: u32,
    /// Steps from one look at all particles to the next: energy, crowding, and the state that is
    /// held to be written where the run goes wrong. Every step is looked at with `redo`.
    #[schemars(range(min = 1))]
    pub interval: u64,
    /// Growth of the total energy, less what sides and forces have given, that ends a run, over
    /// the energy that bodies bring beside their common motion [-]; absent: 1e-3 where the scheme
    /// keeps energy to rounding, 0.5 where it does not, 10 with hat functions at particles' centres.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub energy_growth: Option<f64>,
    /// Greatest speed of a particle, over the greatest that bodies and waves of the start have [-].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub speed: f64,
    /// Greatest Courant number that a step may turn out to have had, by the state at its end [-].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub courant: f64,
    /// Least time step, over what a wave of the start needs for a cell [-].
    #[schemars(range(max = 1.0), extend("exclusiveMinimum" = 0.0))]
    pub least_step: f64,
    /// Most particles in one cell, over the most that the scene starts with [-].
    #[schemars(range(min = 1.0))]
    pub crowding: f64,
    /// What becomes of a `time.courant` above what the scheme was measured to be stable at.
    pub above_limit: AboveLimit,
}

impl Default for Watch {
    fn default() -> Self {
        Watch {
            on_alarm: OnAlarm::Stop,
            most_redos: 8,
            interval: 64,
            energy_growth: None,
            speed: 4.0,
            courant: 4.0,
            least_step: 1e-4,
            crowding: 64.0,
            above_limit: AboveLimit::Refuse,
        }
    }
}

impl Watch {
    /// Whether nothing differs from the default.
    pub fn is_default(&self) -> bool {
        *self == Watch::default()
    }
}

/// What an alarm does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum OnAlarm {
    /// The last good state is written and all ranks end.
    #[default]
    Stop,
    /// The step is redone with half of the time step, and half of that, before the run ends so.
    Redo,
}

/// What becomes of a Courant number above what the scheme was measured to be stable at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AboveLimit {
    /// The scene is refused.
    #[default]
    Refuse,
    /// The run takes the limit instead, and says so.
    Reduce,
    /// The run goes on as told, with a warning.
    Allow,
}
