//! Smoothing of an impact on a line: velocities that change over some cells instead of a jump.
//!
//! A jump of velocity heats the first cells on both sides of an interface too much (Noh 1987), since
//! the shocks form there over several steps. Graded over the length w on each side,
//!
//! ```text
//! v(x) = v_c + (v_body - v_c) min(1, |x - x_c|/w),  v_c = (rho_a v_a + rho_b v_b)/(rho_a + rho_b)
//! ```
//!
//! with the place x_c of the interface, the velocities form over the same cells from the start. The
//! momentum of the bodies does not change; their kinetic energy is less, by an amount that falls
//! with w.

use super::checked::CheckedScene;

impl CheckedScene {
    /// Initial velocity of the material of `body` at `x` [m/s], on a line and without a motion of
    /// its own: that of the body, graded near bodies that it strikes, if the scene smooths impacts.
    pub fn graded_velocity(&self, body: usize, x: f64) -> f64 {
        let own = &self.bodies[body];
        let velocity = own.velocity[0];
        let Some(cells) = self.scene.impact_smoothing else { return velocity };
        let struck = (0..self.bodies.len()).filter(|&other| self.strikes(body, other));
        let mut graded = struck.filter_map(|other| {
            let beside = &self.bodies[other];
            // not beyond the middle of the thinner body, which may be struck from both sides
            let thinner = (own.upper[0] - own.lower[0]).min(beside.upper[0] - beside.lower[0]);
            let width = (cells * self.cell_size[0]).min(0.5 * thinner);
            let interface = match beside.lower[0] < own.lower[0] {
                true => own.lower[0],
                false => own.upper[0],
            };
            let away = (x - interface).abs() / width;
            let [rho, rho_beside] = [body, other].map(|i| self.material_of(i).density);
            let common = (rho * velocity + rho_beside * beside.velocity[0]) / (rho + rho_beside);
            (away < 1.0).then_some(common + (velocity - common) * away)
        });
        graded.next().unwrap_or(velocity)
    }

    /// Whether two bodies on a line touch at the start and approach each other.
    pub(crate) fn strikes(&self, one: usize, other: usize) -> bool {
        let (a, b) = (&self.bodies[one], &self.bodies[other]);
        let (a, b) = if a.lower[0] < b.lower[0] { (a, b) } else { (b, a) };
        one != other
            && (b.lower[0] - a.upper[0]).abs() <= self.tolerance(0)
            && a.velocity[0] > b.velocity[0]
    }
}
