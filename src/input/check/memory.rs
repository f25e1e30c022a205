//! Memory estimate of a run, checked before memory is allocated.

use super::super::errors::{SceneError, SceneFault, one_line};
use super::common::MOST;
use crate::geometry::BoundedRegion;
use crate::scene::CheckedScene;
use crate::scene::{CellSize, Region, Scene};

/// Memory per particle, including outputs and the last good state [bytes].
pub const BYTES_PER_PARTICLE: u64 = 800;

/// Memory per cell [bytes].
pub const BYTES_PER_CELL: u64 = 400;

/// Maximum memory per patch that is narrower than its ghost layers, in addition to that of its
/// cells, in one dimension and in a plane [bytes].
pub const BYTES_PER_PATCH: [u64; 2] = [40 << 10, 1 << 20];

impl CheckedScene {
    /// Estimated memory of the run on all ranks together [bytes], from numbers of particles and cells
    /// alone; in a plane a run may take twice as much.
    pub fn memory(&self) -> u64 {
        let particles = self.particles.saturating_mul(BYTES_PER_PARTICLE);
        let nodes = self.cell_count().saturating_mul(self.velocity_fields() as u64);
        // patches chosen by the program are wide and few
        let patches = self.scene.domain.patches.as_deref().unwrap_or(&[]);
        let patches = patches.iter().fold(1, |all: u64, &n| all.saturating_mul(n as u64));
        let patches = patches.saturating_mul(BYTES_PER_PATCH[self.dimension.clamp(1, 2) - 1]);
        particles.saturating_add(nodes.saturating_mul(BYTES_PER_CELL)).saturating_add(patches)
    }

    /// Rejects a run that needs more than `available` bytes on one machine; `None`: unknown, the run
    /// is accepted.
    ///
    /// Separate from the other checks because the available memory differs between machines and over
    /// time.
    ///
    /// # Errors
    ///
    /// If the run needs more than `available` bytes.
    pub fn check_memory(&self, available: Option<u64>) -> Result<(), SceneError> {
        match available {
            Some(available) if self.memory() > available => {
                Err(self.lacks_memory(self.memory(), available))
            }
            _ => Ok(()),
        }
    }

    /// The error of a run that needs `needed` bytes where `available` are left.
    pub fn lacks_memory(&self, needed: u64, available: u64) -> SceneError {
        SceneError::Memory {
            file: one_line(&self.file),
            particles: self.particles,
            cells: self.cell_count(),
            needed,
            available,
        }
    }
}

/// Memory of a tile at the border of a body while a scene is checked [bytes].
pub(in super::super) const BYTES_PER_BORDER_TILE: u64 = 200;

/// Number of tiles at the borders of bodies that are no box, which the check of a scene in a plane
/// makes, estimated from the bounds of the bodies; faults are reported elsewhere.
pub(in super::super) fn border_tiles(scene: &Scene) -> u64 {
    let cell = match &scene.domain.cell_size {
        CellSize::Uniform(size) => [*size; 2],
        CellSize::PerDirection(sizes) => {
            std::array::from_fn(|a| sizes.get(a).copied().unwrap_or(1.0))
        }
    };
    let of_body = |body: &crate::scene::Body| -> Option<f64> {
        let (_, region) = scene.regions_of(body).pop()?;
        let counts = body.particles_per_cell(2);
        let lattice = matches!(region, Region::Box(_)) || body.positions.is_some();
        if lattice || counts.len() != 2 || scene.domain.lower.len() != 2 {
            return None;
        }
        let [lower, upper] = BoundedRegion::new(&region).ok()?.bounds();
        let along = |a: usize| (upper[a] - lower[a]) / cell[a] * counts[a] as f64;
        // a border crosses each row and each column twice
        Some(2.0 * (along(0) + along(1)))
    };
    scene.bodies.iter().filter_map(of_body).sum::<f64>() as u64
}

/// Rejects numbers of cells or particles that exceed any machine.
pub(super) fn check_counts(checked: &CheckedScene) -> Result<(), SceneFault> {
    if checked.particles as f64 > MOST {
        let reason = format!("{} particles in all; allowed: at most {MOST:e}", checked.particles);
        return Err(SceneFault::missing("bodies", reason));
    }
    Ok(())
}

/// Memory available on this machine [bytes]: the value of the kernel, or the rest of the control
/// group's limit if that is less; `None` if neither is known.
pub fn available_memory() -> Option<u64> {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let kernel = read("/proc/meminfo").and_then(|text| mem_available(&text));
    let number = |path: &str| read(path)?.trim().parse::<u64>().ok();
    let group = number("/sys/fs/cgroup/memory.max")
        .zip(number("/sys/fs/cgroup/memory.current"))
        .map(|(most, taken)| most.saturating_sub(taken));
    match (kernel, group) {
        (Some(kernel), Some(group)) => Some(kernel.min(group)),
        (kernel, group) => kernel.or(group),
    }
}

fn mem_available(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kernels_line_is_read() {
        let text = "MemTotal:       16 kB\nMemFree: 2 kB\nMemAvailable:    8 kB\n";
        assert_eq!(mem_available(text), Some(8192));
        assert_eq!(mem_available("MemTotal: 1 kB\n"), None);
    }
}
