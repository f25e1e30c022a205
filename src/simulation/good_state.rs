//! The last good state of a run, and the initial sums.

use decomp::{Census, ExactSum, StoredParticles};

use super::monitor::Energies;

/// State columns of this rank's particles after the last step that passed the checks. The memory is
/// reused from step to step.
#[derive(Debug, Default)]
pub(super) struct LastGoodState {
    pub(super) particles: StoredParticles,
    pub(super) sums: Vec<ExactSum>,
    pub(super) left: Census,
    pub(super) time: f64,
    pub(super) step: u64,
    pub(super) stable: f64,
    pub(super) longest: f64,
}

/// Initial sums, from which changes are counted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start<const D: usize> {
    pub(super) energies: Energies,
    pub(super) momentum: [f64; D],
    /// Mass [kg].
    pub(super) mass: f64,
}

impl<const D: usize> Start<D> {
    /// Empty sums.
    pub(super) const NONE: Self = Start {
        energies: Energies {
            kinetic: 0.0,
            internal: 0.0,
            common: 0.0,
            available: 0.0,
            above_least: 0.0,
            below_zero_kelvin: 0.0,
        },
        momentum: [0.0; D],
        mass: 0.0,
    };
}
