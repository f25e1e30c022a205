//! Run-time checks (monitor): bounds of a run, and likely causes of alarms.
//!
//! Quantities that a step computes anyway are checked in every step at no cost: the longest stable
//! time step, the longest particle, and particles whose state is outside the range of their model.
//! Checks that need a sum over all particles, of energy and of particles per cell, run every
//! [`interval`](crate::scene::Monitor::interval) steps and at the end, so that the final state of a
//! successful run has passed them. All bounds are relative to the scene.
//!
//! This module does not depend on patches or ranks; [`simulation`](crate::simulation) does.

mod cause;
mod limits;
mod peaks;
mod self_contact;

pub use cause::likely_cause;
pub use limits::{Energies, Limits, keeps_energy};
pub use peaks::Peaks;
pub use self_contact::SelfContactEvent;

/// Kind of a failed check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alarm {
    /// The state of a particle is outside the range of its model, or the particle has left the
    /// domain.
    State,
    /// A particle is faster than any wave could make it.
    Speed,
    /// The step was longer than a wave in the final state needs to cross a cell.
    Courant,
    /// The stable time step has collapsed.
    TimeStep,
    /// Total energy has grown, or has fallen further than the scheme explains.
    Energy,
    /// Internal energy has fallen below the admissible minimum of the materials.
    Cold,
    /// A cell holds more particles than compression can explain.
    Crowding,
}
