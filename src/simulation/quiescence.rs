//! Time from which a patch must be computed, from the first waves of the scene.

use decomp::IndexBox;

use super::expected_peaks::ExpectedPeaks;
use crate::scene::CheckedScene;
use crate::solver::{StencilRadius, Stepper};

/// Distance by which motion is ahead of its wave, over the distance over which the filters spread it
/// in a step: they spread ever smaller values, until these are cut to zero.
const AHEAD: i64 = 3;

/// Bodies of a scene as sources of motion.
pub(super) struct ActiveFrom<'a, const D: usize> {
    scene: &'a CheckedScene,
    expected: Vec<ExpectedPeaks<D>>,
    /// Distance from a wave or a moving body within which patches are active [cells].
    notice: i64,
}

impl<'a, const D: usize> ActiveFrom<'a, D> {
    /// For particles with the stencil radius `reach`.
    pub(super) fn new(scene: &'a CheckedScene, stepper: &Stepper<D>, reach: StencilRadius) -> Self {
        let notice = stepper.influence_radius(reach);
        let spread = notice - reach.cells();
        let expected = ExpectedPeaks::of(scene, stepper);
        ActiveFrom { scene, expected, notice: notice + AHEAD * spread }
    }

    /// Earliest time [s] at which a wave or a moving body comes so near to the cells `patch` that they
    /// must be computed.
    pub(super) fn time(&self, patch: &IndexBox<D>) -> f64 {
        if !self.scene.skips_quiet() || self.scene.scene.body_force.is_some() {
            return 0.0;
        }
        let lower = &self.scene.scene.domain.lower;
        let x = |a: usize, cell: i64| lower[a] + cell as f64 * self.scene.cell_size[a];
        let near = patch.grow(self.notice);
        let corners = [near.lower, near.upper].map(|c| std::array::from_fn(|a| x(a, c[a])));
        let times = (0..self.scene.bodies.len()).filter(|&k| self.meets(k, &corners));
        times.map(|k| self.time_of(k, &corners)).fold(f64::INFINITY, f64::min)
    }

    /// Whether body `k` has a part between `corners` [m].
    fn meets(&self, k: usize, corners: &[[f64; D]; 2]) -> bool {
        let body = &self.scene.bodies[k];
        (0..D).all(|a| body.lower[a] < corners[1][a] && corners[0][a] < body.upper[a])
    }

    /// Earliest time of motion of body `k` between `corners` [m], in [s].
    fn time_of(&self, k: usize, corners: &[[f64; D]; 2]) -> f64 {
        let (body, checked) = (&self.scene.scene.bodies[k], &self.scene.bodies[k]);
        let moves = checked.motion.is_some()
            || checked.velocity != self.scene.grid_velocity::<D>()
            || body.pressure != 0.0;
        match &self.expected[k].ahead {
            Some(ahead) if !moves => ahead.arrival.earliest(corners),
            _ => 0.0,
        }
    }
}
