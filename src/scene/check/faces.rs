//! Which faces of bodies are free surfaces.

use super::super::model::Side;
use super::CheckedScene;

impl CheckedScene {
    /// Whether the upper (or lower) face of body `i` along the waves is a free surface throughout:
    /// no body and no rigid side lies beyond it, and no side presses on it.
    pub fn face_is_free(&self, i: usize, upper: bool) -> bool {
        let Some(span) = self.span(i) else { return false };
        let (domain, tolerance) = (&self.scene.domain, self.tolerance(0));
        let sides = self.scene.boundary.clone().unwrap_or_default();
        let (side, at_side) = match upper {
            true => (sides.x_upper, (domain.upper[0] - span[1]).abs() <= tolerance),
            false => (sides.x_lower, (span[0] - domain.lower[0]).abs() <= tolerance),
        };
        let held = match side {
            Side::Free | Side::Outflow => false,
            Side::Transmitting | Side::Pressure(_) => at_side,
            _ => true,
        };
        let beyond = (0..self.bodies.len()).filter(|&other| other != i).any(|other| {
            self.span(other).is_none_or(|other| match upper {
                true => other[0] >= span[1] - tolerance,
                false => other[1] <= span[0] + tolerance,
            })
        });
        !held && !beyond
    }
}
