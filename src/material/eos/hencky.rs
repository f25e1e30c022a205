//! Linear elasticity in the logarithmic strain (Hencky 1928): `linear_elastic` in a scene.
//!
//! With b = F F^T and h = ln(b)/2,
//!
//! ```text
//! tau = lambda tr(h) 1 + 2 mu h,   sigma = tau/J,   tr(h) = ln J
//! W = lambda (ln J)^2/2 + mu h : h            (per volume at F = 1)
//! rho0 c^2 = max(lambda + 2 mu - tau_i,  2 mu (h_i - h_k) b_i/(b_i - b_k))
//! ```
//!
//! For small strains this is Hooke's law. The stress rotates with the body, the stored energy W
//! does not depend on the path, and compression to zero volume takes infinite stress. c is the
//! speed of the faster of the waves along and across each principal direction i of the plane (k is
//! the other one). In tension the solid softens: beyond tau_i = lambda + 2 mu, waves along i have
//! no speed, which is a fault. Metals fit up to strains of about 0.3 (Anand 1979, J. Appl. Mech.
//! 46, 78).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::elastic::{Deformation, ElasticSolid, Lame, Symmetric};
use super::{EosContext, EosParameters, SolidVisitor};
use crate::material::ParameterError;

/// Elastic solid that is linear in the logarithmic strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hencky {
    /// Density at rest [kg/m3].
    pub rho0: f64,
    /// Lame's constants.
    pub lame: Lame,
}

/// Logarithmic strain h and its parts in the plane.
struct LogStrain {
    /// Strain h.
    h: Symmetric,
    /// ln J.
    volume: f64,
    /// Greater and lesser principal value of b in the plane.
    squares: [f64; 2],
    /// Greater and lesser principal value of h in the plane.
    principal: [f64; 2],
}

impl Hencky {
    #[inline(always)]
    fn strain(f: &Deformation) -> LogStrain {
        let b = f.left_cauchy_green();
        let area = f.area_ratio();
        let squares = b.principal(area * area);
        let (mean, radius) = (b.mean(), b.radius());
        // half the sum and half the difference of the principal strains
        let (even, odd) = (0.5 * area.ln(), 0.25 * (2.0 * radius / squares[1]).ln_1p());
        // odd/radius tends to 1/(2 mean)
        let slope = if radius > 0.0 { odd / radius } else { 0.5 / mean };
        let across = f.across.ln();
        let h = Symmetric {
            xx: even + slope * (b.xx - mean),
            yy: even + slope * (b.yy - mean),
            xy: slope * b.xy,
            zz: across,
        };
        let volume = 2.0 * even + across;
        LogStrain { h, volume, squares, principal: [even + odd, even - odd] }
    }

    fn slowest(&self, s: &LogStrain) -> f64 {
        self.lame.longitudinal() - self.lame.lambda * s.volume - 2.0 * self.lame.mu * s.principal[0]
    }
}

impl ElasticSolid for Hencky {
    fn reference_density(&self) -> f64 {
        self.rho0
    }

    fn shear_modulus(&self) -> f64 {
        self.lame.mu
    }

    #[inline(always)]
    fn kirchhoff_stress(&self, f: &Deformation) -> Symmetric {
        let LogStrain { h, volume, .. } = Self::strain(f);
        let (even, twice) = (self.lame.lambda * volume, 2.0 * self.lame.mu);
        Symmetric {
            xx: even + twice * h.xx,
            yy: even + twice * h.yy,
            xy: twice * h.xy,
            zz: even + twice * h.zz,
        }
    }

    fn stored_energy(&self, f: &Deformation) -> f64 {
        let LogStrain { h, volume, .. } = Self::strain(f);
        let square = h.xx * h.xx + h.yy * h.yy + 2.0 * h.xy * h.xy + h.zz * h.zz;
        0.5 * self.lame.lambda * volume * volume + self.lame.mu * square
    }

    #[inline(always)]
    fn sound_speed_squared(&self, f: &Deformation) -> f64 {
        let s = Self::strain(f);
        let twice = 2.0 * self.lame.mu;
        // the smaller strain has the smaller stress
        let along = self.lame.longitudinal() - self.lame.lambda * s.volume - twice * s.principal[1];
        let apart = s.squares[0] - s.squares[1];
        let across = if apart > 0.0 {
            twice * (s.principal[0] - s.principal[1]) * s.squares[0] / apart
        } else {
            self.lame.mu
        };
        along.max(across) / self.rho0
    }

    #[inline(always)]
    fn check_validity(&self, f: &Deformation) -> Option<&'static str> {
        let softened = self.slowest(&Self::strain(f)) <= 0.0;
        softened.then_some("stretched past the stress lambda + 2 mu at which it has no stiffness")
    }
}

/// Elastic solid, linear in the logarithmic strain; Hooke's law for small strains.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LinearElasticParameters {
    /// Young's modulus E, the stress over the strain of a rod in tension [Pa].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub youngs_modulus: f64,
    /// Poisson's ratio nu, the lateral contraction over the extension of a rod in tension [-];
    /// towards 0.5 the material becomes incompressible.
    #[schemars(extend("exclusiveMinimum" = -1.0, "exclusiveMaximum" = 0.5))]
    pub poissons_ratio: f64,
}

impl EosParameters for LinearElasticParameters {
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
        Some(visitor.visit(Hencky { rho0, lame }))
    }
}

#[cfg(test)]
mod tests {
    use super::super::elastic::tests::{check_sound_speed, check_stress};
    use super::*;

    fn solid() -> Hencky {
        Hencky { rho0: 3.0, lame: Lame::new(2.6, 0.3) }
    }

    #[test]
    fn stress_is_the_derivative_of_energy_and_turns() {
        check_stress(solid(), 3.5);
    }

    #[test]
    fn no_wave_is_faster() {
        check_sound_speed(solid(), 0.02);
    }

    #[test]
    fn shear_is_faster_where_stretch_has_softened_the_solid() {
        let l = 0.6f64.exp();
        let f = Deformation { plane: [l, 0.0, 0.0, l], across: 1.0 };
        let even = Hencky { rho0: 3.0, lame: Lame { lambda: 2.0, mu: 2.0 } };
        // along: lambda (1 - 1.2) + 2 mu (1 - 0.6) = 0.6 mu
        assert_eq!(even.check_validity(&f), None);
        assert!((even.sound_speed_squared(&f) - 2.0 / 3.0).abs() < 1e-14);
    }

    #[test]
    fn small_strains_give_hookes_law() {
        let (e, g) = (1e-6, 3e-6);
        let f = Deformation { plane: [1.0 + e, g, 0.0, 1.0], across: 1.0 };
        let tau = solid().kirchhoff_stress(&f);
        for (value, exact) in [(tau.xx, 3.5 * e), (tau.yy, 1.5 * e), (tau.xy, g), (tau.zz, 1.5 * e)]
        {
            assert!((value - exact).abs() < 1e-11, "{value} {exact}");
        }
        let rest = Deformation { plane: [1.0, 0.0, 0.0, 1.0], across: 1.0 };
        assert_eq!(solid().kirchhoff_stress(&rest), Symmetric::default());
        assert!((solid().sound_speed_squared(&rest) - 3.5 / 3.0).abs() < 1e-15);
    }

    #[test]
    fn a_solid_without_stiffness_is_a_fault() {
        let stretched = |l| solid().check_validity(&Deformation::uniaxial(l));
        assert_eq!(stretched(2.7), None);
        assert!(stretched(2.72).unwrap().contains("no stiffness"));
    }
}
