//! Optional parts of a step. Columns and time are accounted for by part: first the parts of the
//! solver itself, which are fused with the sums over particles, then the effects of a
//! program.

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
    /// Spin of particles.
    Spin,
    /// Stress tensor of solids and of fluids with strength.
    StressTensor,
    /// Contact between bodies with separate velocity fields.
    Contact,
}

impl StepPart {
    /// Number of parts of the solver itself; effects are numbered from here on.
    pub const COUNT: usize = Self::NAMES.len();

    /// Names of all parts, in order.
    pub const NAMES: [&'static str; 6] = [
        "artificial viscosity",
        "relaxation",
        "affine velocity",
        "spin",
        "stress tensor",
        "contact",
    ];

    pub(super) const ALL: [StepPart; Self::COUNT] = [
        StepPart::Viscosity,
        StepPart::Relaxation,
        StepPart::Affine,
        StepPart::Spin,
        StepPart::StressTensor,
        StepPart::Contact,
    ];

    pub(super) fn is_active(self, scene: &CheckedScene) -> bool {
        let method = &scene.scene.method;
        match self {
            StepPart::Viscosity => scene.scene.artificial_viscosity.is_some(),
            StepPart::Relaxation => {
                method.pressure_relaxation.is_some() || method.volume_relaxation.is_some()
            }
            StepPart::Affine => method.transfer.plan().is_affine(),
            StepPart::Spin => method.spin,
            StepPart::StressTensor => scene.has_solids(),
            StepPart::Contact => scene.velocity_fields() > 1,
        }
    }
}
