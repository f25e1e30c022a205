//! Optional parts of a step. Columns and time are accounted for by part: first the parts of the
//! solver itself, which are fused with the sums over particles, then the [effects](super::effect)
//! of a program.

use super::effect::Registry;
use crate::scene::CheckedScene;

/// Optional part of the solver itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepPart {
    /// Artificial viscosity and its limiter.
    Viscosity,
    /// Relaxation of pressure or volume.
    Relaxation,
    /// Affine part of the velocity in APIC.
    Affine,
    /// Stress tensor of solids and of fluids with strength.
    StressTensor,
    /// Contact between bodies with separate velocity fields.
    Contact,
}

impl StepPart {
    /// Number of parts of the solver itself; effects are numbered from here on.
    pub const COUNT: usize = Self::NAMES.len();

    /// Names of all parts, in order.
    pub const NAMES: [&'static str; 5] =
        ["artificial viscosity", "relaxation", "affine velocity", "stress tensor", "contact"];

    const ALL: [StepPart; Self::COUNT] = [
        StepPart::Viscosity,
        StepPart::Relaxation,
        StepPart::Affine,
        StepPart::StressTensor,
        StepPart::Contact,
    ];

    fn is_active(self, scene: &CheckedScene) -> bool {
        let method = &scene.scene.method;
        match self {
            StepPart::Viscosity => scene.scene.artificial_viscosity.is_some(),
            StepPart::Relaxation => {
                method.pressure_relaxation.is_some() || method.volume_relaxation.is_some()
            }
            StepPart::Affine => method.transfer.plan().is_affine(),
            StepPart::StressTensor => scene.has_solids(),
            StepPart::Contact => scene.velocity_fields() > 1,
        }
    }
}

/// Names of all parts of a program with the effects of `R`.
pub fn names<R: Registry>() -> Vec<&'static str> {
    StepPart::NAMES.iter().chain(R::NAMES).copied().collect()
}

/// Whether `scene` uses part number `part`.
pub fn is_active<R: Registry>(part: usize, scene: &CheckedScene) -> bool {
    match StepPart::ALL.get(part) {
        Some(part) => part.is_active(scene),
        None => R::is_active(part - StepPart::COUNT, scene),
    }
}
