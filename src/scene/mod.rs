//! The scene: the data of a run as its file gives them, and the quantities that follow from them.
//!
//! [`crate::input`] reads and checks a scene. Independent of MPI and particles.

mod checked;
mod checked_body;
mod clipped_region;
mod effect_options;
mod estimated_body;
mod faces;
mod impact_smoothing;
mod method_choice;
mod model;
pub mod motion;
pub mod moving_frame;
mod walls;
mod wave_direction;

pub use checked::{CheckedScene, TOUCHING};
pub use checked_body::CheckedBody;
pub use effect_options::{EffectKey, EffectOptions};
pub use method_choice::{MethodChoice, Preset};
pub(crate) use model::planned_quantities;
pub use model::*;
pub use walls::{Piston, Wall};
