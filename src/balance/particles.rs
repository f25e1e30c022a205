//! Number of particles.

use super::PatchLoad;

pub(super) const MEASURES_TIME: bool = false;

pub(super) fn cost(load: &PatchLoad) -> u64 {
    load.particles
}
