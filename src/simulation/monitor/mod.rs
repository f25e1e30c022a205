//! The watch that every run is under: what it holds a run to, and what it takes for the cause.
//!
//! What each step tells anyway, the longest stable time step, the longest particle and the rows
//! whose state is outside of their model, is held against bounds at every step and costs nothing.
//! What needs a sum over all particles, energy and crowding, is looked at every
//! [`interval`](crate::scene::Watch::interval) steps and at the end, so that the answer of a run
//! that ends well is one that has passed. All bounds are relative to the scene.
//!
//! Knows no patches and no ranks: those are in [`simulation`](crate::simulation).

mod cause;
mod limits;
mod peaks;

pub use cause::likely_cause;
pub use limits::{Energies, Limits, keeps_energy};
pub use peaks::Peaks;

/// What the watch has found, beside what particles tell of their own state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alarm {
    /// A particle's state is outside of its model, or it has left the domain.
    State,
    /// A particle is faster than any wave could make it.
    Speed,
    /// The step was longer than a wave of the state at its end needs for a cell.
    Courant,
    /// The stable time step has collapsed.
    TimeStep,
    /// Total energy has grown, or fallen further than the scheme explains.
    Energy,
    /// Internal energy has fallen below the least that the materials admit.
    Cold,
    /// A cell holds more particles than compression could bring there.
    Crowding,
}
