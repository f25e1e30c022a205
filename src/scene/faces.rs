//! Faces of bodies that are free surfaces.

use super::checked::CheckedScene;

impl CheckedScene {
    /// Whether the upper (or lower) face of body `i` along the waves is a free surface throughout
    /// the run: there is no body, rigid side or periodic side beyond it, and no side acts on it.
    pub fn face_is_free(&self, i: usize, upper: bool) -> bool {
        let Some(span) = self.span(i) else { return false };
        let (domain, tolerance) = (&self.scene.domain, self.tolerance(0));
        let [[lower, upper_side], _] = self.side_properties::<2>();
        let (side, at_side) = match upper {
            true => (upper_side, (domain.upper[0] - span[1]).abs() <= tolerance),
            false => (lower, (span[0] - domain.lower[0]).abs() <= tolerance),
        };
        let acts_anywhere = side.is_rigid() || side.is_periodic();
        let held = side.acts_on_material() && (acts_anywhere || at_side);
        let beyond = (0..self.bodies.len()).filter(|&other| other != i).any(|other| {
            self.span(other).is_none_or(|other| match upper {
                true => other[0] >= span[1] - tolerance,
                false => other[1] <= span[0] + tolerance,
            })
        });
        !held && !beyond
    }
}
