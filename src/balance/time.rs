//! Computing time.

use super::PatchLoad;

pub(super) const MEASURES_TIME: bool = true;

/// Time in nanoseconds, so that a patch that was measured once has a cost; before the first
/// measurement the number of particles.
pub(super) fn cost(load: &PatchLoad) -> u64 {
    load.seconds.map_or(load.particles, |seconds| (seconds * 1e9) as u64)
}
