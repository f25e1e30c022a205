//! The quantity that a scaling study holds fixed.

use serde::Serialize;

/// The quantity that a scaling study holds fixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ScalingKind {
    /// The scene.
    Strong,
    /// The work per worker.
    Weak,
}

impl ScalingKind {
    /// Name of the table of a study, and start of the name of its folder.
    pub fn name(self) -> &'static str {
        match self {
            ScalingKind::Strong => "strong_scaling",
            ScalingKind::Weak => "weak_scaling",
        }
    }
}
