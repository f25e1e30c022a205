//! Artificial viscosity, independent of the equations of state.
//!
//! In compression (D < 0), with h the cell size,
//!
//! ```text
//! q = rho (a1 (1 - phi) c h |D| + a2 h^2 D^2)
//! ```
//!
//! and in expansion (D > 0), if the scene has the coefficient a3,
//!
//! ```text
//! q = -rho a3 (1 - phi) c h D
//! ```
//!
//! The velocity behind a shock oscillates: without a3 only the compressive half of each oscillation
//! is damped. Inside a body phi is 1 in a smooth release, so that it is not smeared; in the cell at
//! a free surface phi is 0.
//!
//! a1 is the linear and a2 the quadratic coefficient (von Neumann & Richtmyer 1950; Landshoff 1955;
//! the form of Uintah, whose documentation calls them the first and the second). phi, between 0 and
//! 1, is the reduction by a limiter where the velocity is smooth. Coefficients that keep weak
//! shocks sharp let strong shocks oscillate, so a2 may grow with the velocity jump over a cell
//! relative to the sound speed, up to a limit: a2 = min(most, a2 + rate h |D|/c). Kuropatenko's
//! (1967) viscosity grows likewise, from the Hugoniot of the material.

use decomp::array::{from_fn, map};

use crate::scene::{ArtificialViscosity, LimitedTerms, Limiter, ViscosityGrowth};
use crate::solver::particle_weights::ParticleWeights;

/// Artificial viscosity of a scene on its grid.
#[derive(Clone, Copy, Debug)]
pub struct Viscosity {
    linear: f64,
    quadratic: f64,
    expansion: Option<f64>,
    growth: Option<ViscosityGrowth>,
    cell: f64,
    limits_both: bool,
    /// Limiter, if any.
    pub limiter: Option<Limiter>,
}

impl Viscosity {
    /// Viscosity of a scene on cells with the edge `cell` [m].
    pub fn new(scene: &ArtificialViscosity, cell: f64) -> Self {
        Viscosity {
            linear: scene.linear,
            quadratic: scene.quadratic,
            expansion: scene.expansion,
            growth: scene.growth,
            cell,
            limits_both: scene.limited == LimitedTerms::Both,
            limiter: scene.limiter,
        }
    }

    /// Whether it acts in expansion too.
    #[inline(always)]
    pub fn acts_in_expansion(&self) -> bool {
        self.expansion.is_some()
    }

    /// q [Pa] of a particle with density [kg/m3], sound speed [m/s], divergence D [1/s] and limiter
    /// phi; `stretch` is the ratio of the current to the initial length of a cell [-].
    #[inline(always)]
    pub fn q(&self, density: f64, sound_speed: f64, gradient: f64, phi: f64, stretch: f64) -> f64 {
        match self.acts_in_expansion() {
            true => self.q_if::<true>(density, sound_speed, gradient, phi, stretch),
            false => self.q_if::<false>(density, sound_speed, gradient, phi, stretch),
        }
    }

    /// The same, in expansion if it `EXPANDS`.
    #[inline(always)]
    fn q_if<const EXPANDS: bool>(
        &self,
        density: f64,
        sound_speed: f64,
        gradient: f64,
        phi: f64,
        stretch: f64,
    ) -> f64 {
        let jump = self.cell * stretch * (-gradient).max(0.0);
        let left = 1.0 - phi;
        let quadratic = self.quadratic(sound_speed, jump);
        let quadratic = if self.limits_both { left * quadratic } else { quadratic };
        let compression = density * jump * (self.linear * left * sound_speed + quadratic * jump);
        if !EXPANDS {
            return compression;
        }
        let (jump, expansion) =
            (self.cell * stretch * gradient.max(0.0), self.expansion.unwrap_or(0.0));
        positive(compression - density * jump * (expansion * left * sound_speed))
    }

    /// q [Pa] of a particle of `at`, likewise.
    #[inline(always)]
    pub fn of(&self, at: &Flow<'_>, particle: usize, phi: f64, stretch: f64) -> f64 {
        self.q(at.density(particle), at.sound_speed[particle], at.gradient[particle], phi, stretch)
    }

    /// The same, in expansion if it `EXPANDS`.
    #[inline(always)]
    fn of_if<const EXPANDS: bool>(
        &self,
        at: &Flow<'_>,
        particle: usize,
        phi: f64,
        stretch: f64,
    ) -> f64 {
        let (density, sound_speed) = (at.density(particle), at.sound_speed[particle]);
        self.q_if::<EXPANDS>(density, sound_speed, at.gradient[particle], phi, stretch)
    }

    /// Writes q [Pa] of consecutive particles to `q`; `phi` is the limiter, `stretch` the ratio of
    /// the current to the initial length of their cells, if it is not 1.
    pub fn fill(&self, q: &mut [f64], at: &Flow<'_>, phi: Option<&[f64]>, stretch: Option<&[f64]>) {
        match self.acts_in_expansion() {
            true => self.fill_if::<true>(q, at, phi, stretch),
            false => self.fill_if::<false>(q, at, phi, stretch),
        }
    }

    /// The same, in expansion if it `EXPANDS`.
    #[inline(never)]
    fn fill_if<const EXPANDS: bool>(
        &self,
        q: &mut [f64],
        at: &Flow<'_>,
        phi: Option<&[f64]>,
        stretch: Option<&[f64]>,
    ) {
        // with constant lengths and coefficients and one loop per case, the compiler vectorizes
        // loops without branches
        let (n, viscosity) = (q.len(), *self);
        let at = Flow {
            mass: &at.mass[..n],
            volume0: &at.volume0[..n],
            jacobian: &at.jacobian[..n],
            sound_speed: &at.sound_speed[..n],
            gradient: &at.gradient[..n],
        };
        match (phi.map(|phi| &phi[..n]), stretch.map(|stretch| &stretch[..n])) {
            (None, None) => {
                (0..n).for_each(|r| q[r] = viscosity.of_if::<EXPANDS>(&at, r, 0.0, 1.0))
            }
            (Some(phi), None) => {
                (0..n).for_each(|r| q[r] = viscosity.of_if::<EXPANDS>(&at, r, phi[r], 1.0))
            }
            (None, Some(stretch)) => {
                (0..n).for_each(|r| q[r] = viscosity.of_if::<EXPANDS>(&at, r, 0.0, stretch[r]))
            }
            (Some(phi), Some(stretch)) => {
                (0..n).for_each(|r| q[r] = viscosity.of_if::<EXPANDS>(&at, r, phi[r], stretch[r]))
            }
        }
    }

    /// Contribution of q to the speed in the Courant condition, 2 (a c + a2 h |D|), where a is the
    /// greater of a1 and a3 [m/s].
    #[inline(always)]
    pub fn speed(&self, sound_speed: f64, gradient: f64, stretch: f64) -> f64 {
        let jump = self.cell * stretch * gradient.abs();
        let linear = self.expansion.map_or(self.linear, |expansion| expansion.max(self.linear));
        2.0 * (linear * sound_speed + self.quadratic(sound_speed, jump) * jump)
    }

    /// Coefficient a2 for a velocity jump of `jump` over a cell [m/s].
    #[inline(always)]
    fn quadratic(&self, sound_speed: f64, jump: f64) -> f64 {
        match self.growth {
            // a gas without pressure has no sound speed: the upper limit applies
            Some(g) if jump > 0.0 => (self.quadratic + g.rate * (jump / sound_speed)).min(g.max),
            _ => self.quadratic,
        }
    }
}

/// Input of the viscosity, one column per quantity.
#[derive(Clone, Copy)]
pub struct Flow<'a> {
    /// Masses [kg].
    pub mass: &'a [f64],
    /// Initial volumes [m3].
    pub volume0: &'a [f64],
    /// Volume ratios [-].
    pub jacobian: &'a [f64],
    /// Sound speeds [m/s].
    pub sound_speed: &'a [f64],
    /// Divergences of the velocity [1/s].
    pub gradient: &'a [f64],
}

impl Flow<'_> {
    /// Density of a particle [kg/m3].
    #[inline(always)]
    pub fn density(&self, particle: usize) -> f64 {
        self.mass[particle] / (self.volume0[particle] * self.jacobian[particle])
    }
}

/// Nodal input of a limiter.
#[derive(Clone, Copy)]
pub struct Nodes<'a, const D: usize> {
    /// Components of the nodal velocity [m/s].
    pub velocity: [&'a [f64]; D],
    /// Inverse mass 1/m_i, 0 at nodes without material [1/kg].
    pub inverse_mass: &'a [f64],
    /// Distance from a node to the next along each direction, in the arrays.
    pub steps: [usize; D],
    /// 1/edge of a cell [1/m].
    pub inverse_cell: [f64; D],
    /// Number of nodes in a layer; the arrays hold the velocity fields of the bodies layer by
    /// layer.
    pub layer: usize,
}

impl<const D: usize> Nodes<'_, D> {
    /// Velocity component of node `i`. If its body has no material there, that of another body:
    /// where two bodies touch, smooth flow continues in the other. None if there is no material.
    #[inline(always)]
    fn velocity(&self, axis: usize, i: usize) -> Option<f64> {
        match self.inverse_mass[i] > 0.0 {
            true => Some(self.velocity[axis][i]),
            false => self.velocity_of_others(axis, i),
        }
    }

    #[cold]
    fn velocity_of_others(&self, axis: usize, i: usize) -> Option<f64> {
        let mut all = (i % self.layer..self.inverse_mass.len()).step_by(self.layer);
        all.find(|&i| self.inverse_mass[i] > 0.0).map(|i| self.velocity[axis][i])
    }
}

/// Maps -0 to 0: which of two zeros a minimum returns is unspecified, and may differ between
/// patches.
#[inline(always)]
fn positive(phi: f64) -> f64 {
    phi + 0.0
}

/// phi of Christensen (1990) along one direction: with the velocity gradients D_c in the cells,
/// r = D_(c+-1)/D_c on both sides, phi = max(0, min(1, (rl + rr)/2, 2 rl, 2 rr)). `v` are the
/// velocities of four consecutive nodes around the cell; beyond the end of the material r is 0.
#[inline(always)]
fn christensen_line(v: [f64; 4], ends: [bool; 2]) -> f64 {
    let centre = v[2] - v[1];
    if centre == 0.0 {
        return 0.0;
    }
    // quotients, not a reciprocal: the reciprocal of a denormal number is infinite
    let left = if ends[0] { (v[1] - v[0]) / centre } else { 0.0 };
    let right = if ends[1] { (v[3] - v[2]) / centre } else { 0.0 };
    let least = (0.5 * (left + right)).min(2.0 * left).min(2.0 * right);
    positive(least.clamp(0.0, 1.0))
}

/// phi of Christensen (1990) for a particle in the cell above node `node` [-], from 0 (no
/// reduction) to 1 (smooth flow). In a plane it is computed along each direction, from that
/// component of the velocity on both lines of nodes of the cell. The result is their mean, weighted
/// by the rate of compression of the cell along each direction, or of expansion if the particle
/// `expands`; on a line phi is the same for both.
#[inline(always)]
pub fn christensen<const D: usize>(nodes: &Nodes<'_, D>, node: usize, expands: bool) -> f64 {
    let along = |axis: usize, from: usize| {
        let step = nodes.steps[axis];
        let places = [from - step, from, from + step, from + 2 * step];
        let v = map(&places, |i| nodes.velocity(axis, i));
        (map(&v, |v| v.unwrap_or(0.0)), [v[0].is_some(), v[3].is_some()])
    };
    if D == 1 {
        let (v, ends) = along(0, node);
        return christensen_line(v, ends);
    }
    let (mut sum, mut weights) = (0.0, 0.0);
    for axis in 0..D {
        let (a, a_ends) = along(axis, node);
        let (b, b_ends) = along(axis, node + nodes.steps[1 - axis]);
        let v: [f64; 4] = from_fn(|k| a[k] + b[k]);
        let rate = if expands { v[2] - v[1] } else { v[1] - v[2] };
        let weight = rate.max(0.0) * nodes.inverse_cell[axis];
        if weight > 0.0 {
            let ends = [a_ends[0] && b_ends[0], a_ends[1] && b_ends[1]];
            sum += weight * christensen_line(v, ends);
            weights += weight;
        }
    }
    if weights > 0.0 { sum / weights } else { 0.0 }
}

/// Fraction of its greatest weight above which a particle touches a node: well above rounding, as
/// the limiter must not depend on the last bit for a particle whose edge is just at the end of a
/// node's function.
const TOUCHES: f64 = 1e-3;

/// phi = clamp(2 min_i D_i/D_p, 0, 1) [-] over the nodes i that a particle touches, with D_p =
/// `gradient` [1/s] and D_i the divergence of the nodal velocity by central differences: a form for
/// any dimension. Differences with respect to initial positions are pushed forward with `push`, the
/// inverse of the particle's F.
#[inline(always)]
pub fn nodal<const K: usize, const D: usize>(
    nodes: &Nodes<'_, D>,
    weights: &ParticleWeights<'_, K, D>,
    gradient: f64,
    push: Option<[[f64; D]; D]>,
) -> f64 {
    if gradient == 0.0 {
        return 0.0;
    }
    let greatest = weights.values.as_flattened().iter().copied().fold(0.0, f64::max);
    let least_weight = TOUCHES * greatest;
    let mut least = f64::INFINITY;
    for (line, values) in weights.values.iter().enumerate() {
        for (k, &value) in values.iter().enumerate() {
            if value > least_weight {
                let i = weights.first + line * weights.stride + k;
                let mut divergence = 0.0;
                let mut add = |axis: usize, along: usize, share: f64| {
                    let step = nodes.steps[along];
                    let ends = [i - step, i + step].map(|i| nodes.velocity(axis, i));
                    if let [Some(before), Some(after)] = ends {
                        divergence += (after - before) * (share * nodes.inverse_cell[along]);
                    }
                };
                match &push {
                    None => (0..D).for_each(|axis| add(axis, axis, 0.5)),
                    Some(push) => (0..D * D).for_each(|k| {
                        let (axis, along) = (k / D, k % D);
                        add(axis, along, 0.5 * push[along][axis]);
                    }),
                }
                least = least.min(divergence / gradient);
            }
        }
    }
    positive((2.0 * least).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const V: ArtificialViscosity = ArtificialViscosity {
        linear: 0.1,
        quadratic: 1.25,
        expansion: None,
        growth: None,
        limiter: None,
        limited: LimitedTerms::Linear,
    };

    #[test]
    fn q_is_the_documented_formula() {
        let v = Viscosity::new(&V, 1e-5);
        let q = v.q(3000.0, 6000.0, -2e6, 0.25, 1.0);
        let exact = 3000.0 * (0.1 * 0.75 * 6000.0 * 1e-5 * 2e6 + 1.25 * 1e-10 * 4e12);
        assert!((q / exact - 1.0).abs() < 1e-14);
        assert_eq!(v.q(3000.0, 6000.0, 2e6, 0.0, 1.0), 0.0, "none in expansion");
    }

    /// In expansion the other coefficient acts, limited, with the other sign; in compression nothing
    /// changes.
    #[test]
    fn q_in_expansion_is_the_documented_formula() {
        let v = Viscosity::new(&ArtificialViscosity { expansion: Some(0.3), ..V }, 1e-5);
        let q = v.q(3000.0, 6000.0, 2e6, 0.25, 1.0);
        let exact = -3000.0 * 0.3 * 0.75 * 6000.0 * 1e-5 * 2e6;
        assert!((q / exact - 1.0).abs() < 1e-14);
        assert_eq!(v.q(3000.0, 6000.0, 2e6, 1.0, 1.0), 0.0, "none in smooth flow");
        let compressed =
            [v, Viscosity::new(&V, 1e-5)].map(|v| v.q(3000.0, 6000.0, -2e6, 0.25, 1.0));
        assert_eq!(compressed[0], compressed[1]);
        assert!(
            (v.speed(6000.0, 0.0, 1.0) - 2.0 * 0.3 * 6000.0).abs() < 1e-9,
            "the greater of both"
        );
    }

    #[test]
    fn limiting_both_terms_takes_all_where_the_velocity_is_smooth() {
        let v = Viscosity::new(&ArtificialViscosity { limited: LimitedTerms::Both, ..V }, 1e-5);
        assert_eq!(v.q(3000.0, 6000.0, -2e6, 1.0, 1.0), 0.0);
        assert!(Viscosity::new(&V, 1e-5).q(3000.0, 6000.0, -2e6, 1.0, 1.0) > 0.0);
    }

    #[test]
    fn the_quadratic_coefficient_grows_up_to_its_limit() {
        let growth = Some(ViscosityGrowth { rate: 6.0, max: 2.0 });
        let v = Viscosity::new(&ArtificialViscosity { linear: 0.0, growth, ..V }, 1e-5);
        let coefficient =
            |d: f64, c: f64| v.q(1000.0, c, d, 0.0, 1.0) / (1000.0 * (1e-5 * d).powi(2));
        assert!((coefficient(-1e7, 5000.0) - (1.25 + 6.0 * 0.02)).abs() < 1e-12);
        assert!((coefficient(-1e8, 5000.0) - 2.0).abs() < 1e-12);
        assert!((coefficient(-1e7, 0.0) - 2.0).abs() < 1e-12, "without sound");
        assert_eq!(v.q(1000.0, 0.0, 0.0, 0.0, 1.0), 0.0);
        let speed = 2.0 * 100.0 * (1.25 + 6.0 * 0.02);
        assert!((v.speed(5000.0, -1e7, 1.0) - speed).abs() < 1e-9);
    }

    fn line<'a>(velocity: &'a [f64], ones: &'a [f64]) -> Nodes<'a, 1> {
        Nodes {
            velocity: [velocity],
            inverse_mass: ones,
            steps: [1],
            inverse_cell: [1.0],
            layer: velocity.len(),
        }
    }

    #[test]
    fn limiters_pass_linear_velocity_and_hold_at_a_jump() {
        let ones = [1.0; 6];
        let linear = [6.0, 5.0, 4.0, 3.0, 2.0, 1.0];
        let jump = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
        assert_eq!(christensen(&line(&linear, &ones), 2, false), 1.0);
        assert_eq!(christensen(&line(&jump, &ones), 2, false), 0.0);
        let weights = |first, values| ParticleWeights::<'_, 3, 1> {
            first,
            stride: 6,
            narrow: false,
            values,
            gradients: &[],
        };
        let (even, peaked) = ([[0.5, 0.5, 0.0]], [[0.2, 0.6, 0.2]]);
        assert_eq!(nodal(&line(&linear, &ones), &weights(2, &even), -1.0, None), 1.0);
        assert_eq!(nodal(&line(&jump, &ones), &weights(1, &peaked), -1.0, None), 0.0);
    }

    #[test]
    fn christensen_looks_to_both_sides() {
        let ones = [1.0; 6];
        // a third of the slope on one side, a twentieth on the other: twice the smaller ratio
        let bent = [7.0, 6.0, 3.0, 2.85, 2.0, 1.0];
        let back: Vec<f64> = bent.iter().rev().map(|v| -v).collect();
        for (v, node) in [(&bent[..], 1), (&back, 3)] {
            assert!((christensen(&line(v, &ones), node, false) - 0.1).abs() < 1e-14);
        }
    }

    #[test]
    fn limiters_see_the_velocity_of_another_body_where_their_own_has_no_mass() {
        // two layers of six nodes: the first body ends at the fourth node, the second continues
        let inverse = [1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        let v = [6.0, 5.0, 4.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0, 2.0, 1.0];
        let nodes = Nodes { layer: 6, ..line(&v, &inverse) };
        assert_eq!(christensen(&nodes, 2, false), 1.0);
        let alone = [&inverse[..6], &[0.0; 6]].concat();
        assert_eq!(christensen(&Nodes { layer: 6, ..line(&v, &alone) }, 2, false), 0.0, "an edge");
    }

    #[test]
    fn nothing_is_a_positive_zero() {
        let (ones, even) = ([1.0; 6], [[0.5, 0.5, 0.0]]);
        let particle = ParticleWeights::<'_, 3, 1> {
            first: 2,
            stride: 6,
            narrow: false,
            values: &even,
            gradients: &[],
        };
        let rest = nodal(&line(&[1.0; 6], &ones), &particle, -1.0, None);
        assert!(rest == 0.0 && rest.is_sign_positive());
        let jump = christensen(&line(&[1.0, 1.0, 1.0, 0.0, 0.0, 0.0], &ones), 2, false);
        assert!(jump == 0.0 && jump.is_sign_positive());
    }

    #[test]
    fn in_a_plane_a_wave_along_an_axis_is_limited_as_on_a_line() {
        let ones = [1.0; 36];
        for v in [
            [6.0, 5.0, 4.0, 3.0, 2.0, 1.0],
            [1.0, 1.0, 1.0, 0.0, 0.0, 0.0],
            [9.0, 7.0, 4.0, 3.0, 2.0, 1.5],
        ] {
            let on_a_line = christensen(&line(&v, &ones), 2, false);
            let rest = [0.0; 36];
            // the same wave in expansion has the opposite velocity
            for (sign, expands) in [(1.0, false), (-1.0, true)] {
                let wave: Vec<f64> = (0..36).map(|i| sign * v[i % 6]).collect();
                let turned: Vec<f64> = (0..36).map(|i| sign * v[i / 6]).collect();
                for velocity in [[&wave[..], &rest], [&rest, &turned[..]]] {
                    let nodes = Nodes {
                        velocity,
                        inverse_mass: &ones,
                        steps: [1, 6],
                        inverse_cell: [1.0; 2],
                        layer: 36,
                    };
                    assert_eq!(christensen(&nodes, 14, expands), on_a_line);
                }
            }
        }
    }
}
