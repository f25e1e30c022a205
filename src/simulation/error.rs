//! Reasons why a run stops early.

use decomp::ParticleError;

use super::monitor::Alarm;

/// Reason why a run stopped early.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The state of a particle is invalid: the run cannot continue.
    #[error(
        "particle {id} of body `{body}` at {position}, time {time:.6e} s, step {step}: {what}; likely cause: {cause}"
    )]
    Particle {
        /// Id of the particle.
        id: u64,
        /// Name of its body.
        body: String,
        /// Its position and cell, as text.
        position: String,
        /// Time [s].
        time: f64,
        /// Number of the step.
        step: u64,
        /// The check that failed.
        alarm: Alarm,
        /// Description of the error.
        what: String,
        /// Likely cause and a remedy.
        cause: Box<str>,
    },
    /// The time step has become so short that the run would not finish.
    #[error(
        "time {time:.6e} s, step {step}: the stable time step has fallen to {dt:.3e} s; the run is unstable or the scene too stiff"
    )]
    TimeStep {
        /// Time [s].
        time: f64,
        /// Number of the step.
        step: u64,
        /// Length of the step [s].
        dt: f64,
    },
    /// The run would need too many steps.
    #[error(
        "time.end = {end:?}: beyond {steps:.0e} steps of {dt:.3e} s; allowed: a shorter time.end or a larger time.courant"
    )]
    TooLong {
        /// End of the run [s].
        end: f64,
        /// Length of the first step [s].
        dt: f64,
        /// Largest number of steps.
        steps: f64,
    },
    /// The scene cannot use a custom model.
    #[error("materials.{material}: {reason}")]
    Model {
        /// Name of the material.
        material: String,
        /// Reason.
        reason: String,
    },
    /// A particle was lost by the decomposition.
    #[error(transparent)]
    Exchange(#[from] ParticleError),
    /// Particles were lost or duplicated between patches: an error of this program.
    #[error(
        "time {time:.6e} s, step {step}: {now} particles where {before} should be, or others than those; please report this scene and its layout"
    )]
    Lost {
        /// Time [s].
        time: f64,
        /// Number of the step.
        step: u64,
        /// Expected number of particles.
        before: u64,
        /// Number of particles found.
        now: u64,
    },
    /// The particles of the snapshot do not belong to the scene.
    #[error("the particles of the checkpoint are not those that its scene starts with")]
    Foreign,
    /// Another rank reports the error.
    #[error("another rank has failed")]
    Elsewhere,
}

impl RunError {
    /// Whether all ranks know of the error, so that they can act together.
    pub fn is_known_to_all(&self) -> bool {
        use RunError::{Elsewhere, Lost, Particle, TimeStep};
        matches!(self, Particle { .. } | TimeStep { .. } | Lost { .. } | Elsewhere)
    }
}
