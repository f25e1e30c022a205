//! Artificial viscosity, apart from every equation of state.
//!
//! In compression (D < 0), with h the cell size,
//!
//! ```text
//! q = rho (a1 (1 - phi) c h |D| + a2 h^2 D^2)
//! ```
//!
//! a1 the linear and a2 the quadratic coefficient (von Neumann & Richtmyer 1950; Landshoff
//! 1955; the form of Uintah, whose document calls them the first and the second). phi, between
//! 0 and 1, is what a limiter takes away where the velocity is smooth.

use crate::scene::{ArtificialViscosity, LimitedTerms, Limiter};
use crate::transfer::window;

/// The viscosity of a scene on its grid.
#[derive(Clone, Copy, Debug)]
pub struct Viscosity {
    linear: f64,
    quadratic: f64,
    cell: f64,
    limits_both: bool,
    /// The limiter, if there is one.
    pub limiter: Option<Limiter>,
}

impl Viscosity {
    /// The viscosity that a scene asks for on cells of `cell` [m].
    pub fn new(scene: &ArtificialViscosity, cell: f64) -> Self {
        Viscosity {
            linear: scene.linear,
            quadratic: scene.quadratic,
            cell,
            limits_both: scene.limited == LimitedTerms::Both,
            limiter: scene.limiter,
        }
    }

    /// q [Pa] of a particle with density [kg/m3], sound speed [m/s], divergence D [1/s] and
    /// limiter phi.
    #[inline(always)]
    pub fn q(&self, density: f64, sound_speed: f64, gradient: f64, phi: f64) -> f64 {
        let jump = self.cell * (-gradient).max(0.0);
        let left = 1.0 - phi;
        let quadratic = if self.limits_both { left * self.quadratic } else { self.quadratic };
        density * jump * (self.linear * left * sound_speed + quadratic * jump)
    }

    /// The speed that q adds in the Courant bound, 2 (a1 c + a2 h |D|) [m/s].
    #[inline(always)]
    pub fn speed(&self, sound_speed: f64, gradient: f64) -> f64 {
        2.0 * (self.linear * sound_speed + self.quadratic * self.cell * gradient.abs())
    }
}

/// phi of Christensen (1990) for a particle in the cell above node `node`: with the gradients
/// D_c of the nodal velocity over the cells, r = D_(c+-1)/D_c on both sides, phi = max(0, min(1,
/// (rl + rr)/2, 2 rl, 2 rr)). Beyond the material's end r is 0: full viscosity.
#[inline(always)]
pub fn christensen(velocity: &[f64], inverse_mass: &[f64], node: usize) -> f64 {
    let v: &[f64; 4] = window(velocity, node - 1);
    let m: &[f64; 4] = window(inverse_mass, node - 1);
    let centre = v[2] - v[1];
    if centre == 0.0 {
        return 0.0;
    }
    // quotients, not a reciprocal: that of a denormal is infinite
    let left = if m[0] > 0.0 { (v[1] - v[0]) / centre } else { 0.0 };
    let right = if m[3] > 0.0 { (v[3] - v[2]) / centre } else { 0.0 };
    let least = (0.5 * (left + right)).min(2.0 * left).min(2.0 * right);
    least.clamp(0.0, 1.0)
}

/// Weight above which a particle touches a node: well above rounding, for a particle whose edge
/// is just at the end of a node's function must not see the node or not by a bit.
const TOUCHES: f64 = 1e-3;

/// phi = clamp(2 min_i D_i/D_p, 0, 1) over the nodes i that a particle touches, D_i by central
/// differences of the nodal velocity: a form for any dimension.
#[inline(always)]
pub fn nodal<const K: usize>(
    velocity: &[f64],
    inverse_mass: &[f64],
    first: usize,
    values: &[f64; K],
    gradient: f64,
    half_inverse_cell: f64,
) -> f64 {
    if gradient == 0.0 {
        return 0.0;
    }
    let mut least = f64::INFINITY;
    for (k, &value) in values.iter().enumerate() {
        if value > TOUCHES {
            let i = first + k;
            let known = inverse_mass[i - 1] > 0.0 && inverse_mass[i + 1] > 0.0;
            let d =
                if known { (velocity[i + 1] - velocity[i - 1]) * half_inverse_cell } else { 0.0 };
            least = least.min(d / gradient);
        }
    }
    (2.0 * least).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const V: ArtificialViscosity = ArtificialViscosity {
        linear: 0.1,
        quadratic: 1.25,
        limiter: None,
        limited: LimitedTerms::Linear,
    };

    #[test]
    fn q_is_the_documented_formula() {
        let v = Viscosity::new(&V, 1e-5);
        let q = v.q(3000.0, 6000.0, -2e6, 0.25);
        let exact = 3000.0 * (0.1 * 0.75 * 6000.0 * 1e-5 * 2e6 + 1.25 * 1e-10 * 4e12);
        assert!((q / exact - 1.0).abs() < 1e-14);
        assert_eq!(v.q(3000.0, 6000.0, 2e6, 0.0), 0.0, "none in expansion");
    }

    #[test]
    fn limiting_both_terms_takes_all_where_the_velocity_is_smooth() {
        let v = Viscosity::new(&ArtificialViscosity { limited: LimitedTerms::Both, ..V }, 1e-5);
        assert_eq!(v.q(3000.0, 6000.0, -2e6, 1.0), 0.0);
        assert!(Viscosity::new(&V, 1e-5).q(3000.0, 6000.0, -2e6, 1.0) > 0.0);
    }

    #[test]
    fn limiters_pass_linear_velocity_and_hold_at_a_jump() {
        let ones = [1.0; 6];
        let linear = [6.0, 5.0, 4.0, 3.0, 2.0, 1.0];
        let jump = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
        assert_eq!(christensen(&linear, &ones, 2), 1.0);
        assert_eq!(christensen(&jump, &ones, 2), 0.0);
        assert_eq!(nodal(&linear, &ones, 2, &[0.5, 0.5], -1.0, 0.5), 1.0);
        assert_eq!(nodal(&jump, &ones, 1, &[0.2, 0.6, 0.2], -1.0, 0.5), 0.0);
    }
}
