//! Compressible neo-Hookean solid.
//!
//! With b = F F^T,
//!
//! ```text
//! tau = lambda ln J 1 + mu (b - 1),   sigma = tau/J
//! W = lambda (ln J)^2/2 - mu ln J + mu (tr b - 3)/2      (per volume at F = 1)
//! rho0 c^2 = lambda (1 - ln J) + mu (1 + b_max)
//! ```
//!
//! Source: Bonet & Wood (1997), Nonlinear Continuum Mechanics for Finite Element Analysis, section
//! 5.4.3. The acoustic tensor is mu (n.b.n) 1 + (lambda + mu - lambda ln J) n (x) n, so c is the
//! speed of the fastest wave of all, which runs along the greatest stretch. c grows with that
//! stretch, and so does the number of steps.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::elastic::{Deformation, ElasticSolid, Lame, Symmetric};
use super::{EosContext, EosParameters, SolidVisitor};
use crate::material::ParameterError;

/// Compressible neo-Hookean solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHookean {
    /// Density at rest [kg/m3].
    pub rho0: f64,
    /// Lame's constants.
    pub lame: Lame,
}

impl ElasticSolid for NeoHookean {
    fn reference_density(&self) -> f64 {
        self.rho0
    }

    fn shear_modulus(&self) -> f64 {
        self.lame.mu
    }

    #[inline(always)]
    fn kirchhoff_stress(&self, f: &Deformation) -> Symmetric {
        let b = f.left_cauchy_green();
        let Lame { lambda, mu } = self.lame;
        let even = lambda * f.jacobian().ln();
        Symmetric {
            xx: even + mu * (b.xx - 1.0),
            yy: even + mu * (b.yy - 1.0),
            xy: mu * b.xy,
            zz: even + mu * (b.zz - 1.0),
        }
    }

    fn stored_energy(&self, f: &Deformation) -> f64 {
        let log = f.jacobian().ln();
        let Lame { lambda, mu } = self.lame;
        0.5 * lambda * log * log - mu * log + 0.5 * mu * (f.left_cauchy_green().trace() - 3.0)
    }

    #[inline(always)]
    fn sound_speed_squared(&self, f: &Deformation) -> f64 {
        let b = f.left_cauchy_green();
        let Lame { lambda, mu } = self.lame;
        let greatest = b.mean() + b.radius();
        (lambda * (1.0 - f.jacobian().ln()) + mu * (1.0 + greatest)) / self.rho0
    }

    #[inline(always)]
    fn check_validity(&self, _f: &Deformation) -> Option<&'static str> {
        None
    }
}

/// Neo-Hookean solid, sigma = (lambda ln J 1 + mu (F F^T - 1))/J.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NeoHookeanParameters {
    /// Young's modulus E at small strains, the stress over the strain of a rod in tension [Pa].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub youngs_modulus: f64,
    /// Poisson's ratio nu at small strains, the lateral contraction over the extension of a rod in
    /// tension [-]; towards 0.5 the material becomes incompressible.
    #[schemars(extend("exclusiveMinimum" = -1.0, "exclusiveMaximum" = 0.5))]
    pub poissons_ratio: f64,
}

impl EosParameters for NeoHookeanParameters {
    fn check(&self, at: &EosContext) -> Result<(), ParameterError> {
        Lame::new(self.youngs_modulus, self.poissons_ratio).check(self.youngs_modulus, at.density)
    }

    fn no_initial_pressure(&self) -> Option<&'static str> {
        Some("an elastic body starts without stress")
    }

    fn is_solid(&self) -> bool {
        true
    }

    fn visit_solid<V: SolidVisitor>(&self, rho0: f64, visitor: V) -> Option<V::Output> {
        let lame = Lame::new(self.youngs_modulus, self.poissons_ratio);
        Some(visitor.visit(NeoHookean { rho0, lame }))
    }
}

#[cfg(test)]
mod tests {
    use super::super::elastic::tests::{check_sound_speed, check_stress, states};
    use super::*;
    use crate::exact::plane::Vortex;

    fn solid() -> NeoHookean {
        NeoHookean { rho0: 3.0, lame: Lame::new(2.6, 0.3) }
    }

    #[test]
    fn stress_is_the_derivative_of_energy_and_turns() {
        check_stress(solid(), 3.5);
    }

    #[test]
    fn no_wave_is_faster() {
        check_sound_speed(solid(), 1e-3);
    }

    #[test]
    fn is_the_solid_of_the_vortex() {
        let vortex = Vortex { youngs_modulus: 2.6, poissons_ratio: 0.3, ..Vortex::default() };
        for f in states().iter().filter(|f| f.across == 1.0) {
            let [xx, xy, yx, yy] = f.plane;
            let sigma = vortex.cauchy_stress([[xx, xy], [yx, yy]]);
            let (tau, j) = (solid().kirchhoff_stress(f), f.jacobian());
            for (a, b) in [(tau.xx, sigma[0][0]), (tau.xy, sigma[0][1]), (tau.yy, sigma[1][1])] {
                assert!((a / j - b).abs() < 1e-13, "{f:?}: {a} {b}");
            }
        }
    }

    #[test]
    fn at_rest_there_is_no_stress() {
        let rest = Deformation { plane: [1.0, 0.0, 0.0, 1.0], across: 1.0 };
        assert_eq!(solid().kirchhoff_stress(&rest), Symmetric::default());
        assert!((solid().sound_speed_squared(&rest) - 3.5 / 3.0).abs() < 1e-15);
    }
}
