//! Properties of a body that follow from its scene.

use std::sync::Arc;

use super::motion::Motion;
use crate::geometry::Tiling;

/// Properties of a body that follow from its scene.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedBody {
    /// Index of its material in the scene's materials, in order of their names.
    pub material: usize,
    /// Initial velocity [m/s], D numbers; zeros if it varies in space.
    pub velocity: Vec<f64>,
    /// Initial velocity that varies in space, if any.
    pub motion: Option<Motion>,
    /// Upper bound of the initial particle speed [m/s].
    pub top_speed: f64,
    /// Lower corner of the bounding box [m], D numbers.
    pub lower: Vec<f64>,
    /// Upper corner of the bounding box [m], D numbers.
    pub upper: Vec<f64>,
    /// Number of particles in each direction of a box: length over cell size times particles per
    /// cell, rounded. The particles tile the body: each has the length of the body over this
    /// number. 1 for other bodies.
    pub lattice: Vec<usize>,
    /// Tiles of the particles of a body that is not a box or has its own `positions`.
    pub tiling: Option<Arc<Tiling>>,
    /// Total number of particles.
    pub particles: u64,
}

impl CheckedBody {
    /// Number of the particle whose tile contains `at` [m], or else is nearest to it.
    pub fn nearest(&self, at: &[f64]) -> u64 {
        if let Some(tiling) = &self.tiling {
            return tiling.nearest(at);
        }
        let along = |a: usize| {
            let share = (at[a] - self.lower[a]) / (self.upper[a] - self.lower[a]);
            let count = self.lattice[a] as f64;
            (share * count).floor().clamp(0.0, count - 1.0) as u64
        };
        (0..at.len()).rev().fold(0, |k, a| k * self.lattice[a] as u64 + along(a))
    }
}
