//! Elastic solids: the stress depends on the deformation gradient only.
//!
//! A [`Deformation`] preserves a plane, as in plane strain, axisymmetry and uniaxial strain: F has
//! four components in the plane and one stretch across it. Stresses are positive in tension here;
//! the sums of the step are positive in compression.
//!
//! Elastic solids have no thermal part: the specific internal energy of a particle is the work done
//! on it, stored energy and heat together, and does not affect the stress.
//!
//! Independent of particles, grid and dimension.

use crate::material::ParameterError;

/// Deformation gradient F = dx/dX that preserves a plane [-].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deformation {
    /// F in the plane, by rows: xx, xy, yx, yy [-].
    pub plane: [f64; 4],
    /// Stretch across the plane [-]: 1 in plane strain, current over initial radius in axisymmetry.
    pub across: f64,
}

/// Symmetric tensor without components xz and yz; stress [Pa], strain [-] or rate [1/s], as the
/// holder says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Symmetric {
    /// Component xx, in the unit of the tensor.
    pub xx: f64,
    /// Component yy, in the unit of the tensor.
    pub yy: f64,
    /// Component xy, the same as yx, in the unit of the tensor.
    pub xy: f64,
    /// Component zz, across the plane, in the unit of the tensor.
    pub zz: f64,
}

impl Deformation {
    /// F of uniaxial strain in one dimension, with the volume ratio `jacobian` [-].
    #[inline(always)]
    pub fn uniaxial(jacobian: f64) -> Self {
        Deformation { plane: [jacobian, 0.0, 0.0, 1.0], across: 1.0 }
    }

    /// Area ratio in the plane, det F without the stretch across [-].
    #[inline(always)]
    pub fn area_ratio(&self) -> f64 {
        let [xx, xy, yx, yy] = self.plane;
        xx * yy - xy * yx
    }

    /// J = det F [-].
    #[inline(always)]
    pub fn jacobian(&self) -> f64 {
        self.area_ratio() * self.across
    }

    /// Mean of two deformation gradients.
    #[inline(always)]
    pub fn middle(&self, other: &Deformation) -> Deformation {
        Deformation {
            plane: std::array::from_fn(|k| 0.5 * (self.plane[k] + other.plane[k])),
            across: 0.5 * (self.across + other.across),
        }
    }

    /// Symmetric part of (F' - F) F_h^-1 [-], the strain from this F to `after` = F' referred to
    /// `at` = F_h.
    #[inline(always)]
    pub fn strain_to(&self, after: &Deformation, at: &Deformation) -> Symmetric {
        let d: [f64; 4] = std::array::from_fn(|k| after.plane[k] - self.plane[k]);
        let [xx, xy, yx, yy] = at.plane;
        let inverse = 1.0 / at.area_ratio();
        Symmetric {
            xx: (d[0] * yy - d[1] * yx) * inverse,
            yy: (d[3] * xx - d[2] * xy) * inverse,
            xy: 0.5 * (d[1] * xx - d[0] * xy + d[2] * yy - d[3] * yx) * inverse,
            zz: (after.across - self.across) / at.across,
        }
    }

    /// b = F F^T, the left Cauchy-Green tensor [-].
    #[inline(always)]
    pub fn left_cauchy_green(&self) -> Symmetric {
        let [xx, xy, yx, yy] = self.plane;
        Symmetric {
            xx: xx * xx + xy * xy,
            yy: yx * yx + yy * yy,
            xy: xx * yx + xy * yy,
            zz: self.across * self.across,
        }
    }
}

impl Symmetric {
    /// `value` times the unit tensor, in the unit of `value`.
    #[inline(always)]
    pub fn isotropic(value: f64) -> Self {
        Symmetric { xx: value, yy: value, xy: 0.0, zz: value }
    }

    /// Sum of the diagonal, in the unit of the tensor.
    #[inline(always)]
    pub fn trace(&self) -> f64 {
        self.xx + self.yy + self.zz
    }

    /// Double contraction a : b, in the product of both units.
    #[inline(always)]
    pub fn double_dot(&self, other: &Symmetric) -> f64 {
        self.xx * other.xx + self.yy * other.yy + 2.0 * self.xy * other.xy + self.zz * other.zz
    }

    /// Greater and lesser principal value in the plane of a positive definite tensor whose
    /// determinant in the plane is `determinant`.
    #[inline(always)]
    pub(super) fn principal(&self, determinant: f64) -> [f64; 2] {
        let greater = self.mean() + self.radius();
        // mean minus radius would lose digits
        [greater, determinant / greater]
    }

    /// Mean of the principal values in the plane.
    #[inline(always)]
    pub(super) fn mean(&self) -> f64 {
        0.5 * (self.xx + self.yy)
    }

    /// Half the difference of the principal values in the plane.
    #[inline(always)]
    pub(super) fn radius(&self) -> f64 {
        let half = 0.5 * (self.xx - self.yy);
        (half * half + self.xy * self.xy).sqrt()
    }
}

/// Lame's constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lame {
    /// lambda = E nu/((1 + nu)(1 - 2 nu)) [Pa].
    pub lambda: f64,
    /// Shear modulus mu = E/(2 (1 + nu)) [Pa].
    pub mu: f64,
}

impl Lame {
    /// Constants from Young's modulus E [Pa] and Poisson's ratio nu [-].
    pub fn new(youngs_modulus: f64, poissons_ratio: f64) -> Self {
        let (e, nu) = (youngs_modulus, poissons_ratio);
        Lame { lambda: e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), mu: 0.5 * e / (1.0 + nu) }
    }

    /// Checks that waves in a material of `density` [kg/m3] have a finite speed.
    ///
    /// # Errors
    ///
    /// If Young's modulus [Pa] does not fit.
    pub(super) fn check(&self, youngs_modulus: f64, density: f64) -> Result<(), ParameterError> {
        if (self.longitudinal() / density).is_normal() {
            return Ok(());
        }
        let density = serde_json::json!(density);
        let reason = format!(
            "no finite stiffness over density = {density}; allowed: SI units, Pa and kg/m3"
        );
        Err(ParameterError::new("youngs_modulus", youngs_modulus, reason))
    }

    /// lambda + 2 mu, the stiffness under uniaxial strain [Pa].
    #[inline(always)]
    pub fn longitudinal(&self) -> f64 {
        self.lambda + 2.0 * self.mu
    }
}

/// Constitutive law of an elastic solid.
pub trait ElasticSolid: Copy + Send + Sync + 'static {
    /// Density at F = 1 [kg/m3].
    fn reference_density(&self) -> f64;

    /// Shear modulus at F = 1 [Pa].
    fn shear_modulus(&self) -> f64;

    /// Kirchhoff stress tau = J sigma, sigma the Cauchy stress [Pa].
    fn kirchhoff_stress(&self, f: &Deformation) -> Symmetric;

    /// Stored energy per volume at F = 1 [J/m3]; its rate is tau : (dF/dt F^-1).
    fn stored_energy(&self, f: &Deformation) -> f64;

    /// Square of the fastest wave speed in the deformed solid, along its principal directions in
    /// the plane [m2/s2].
    fn sound_speed_squared(&self, f: &Deformation) -> f64;

    /// Reason why a state is outside the range of the model, if it is; J is positive.
    fn check_validity(&self, f: &Deformation) -> Option<&'static str>;
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Deformations of all kinds: none, compression, tension, shear, stretch across, and rotated
    /// ones.
    pub fn states() -> Vec<Deformation> {
        let mut all = Vec::new();
        for plane in [
            [1.0, 0.0, 0.0, 1.0],
            [0.8, 0.0, 0.0, 0.9],
            [1.4, 0.1, -0.2, 0.9],
            [1.0, 2.5, 0.0, 1.0],
            [1.0 + 1e-7, 2e-8, 0.0, 1.0],
        ] {
            for across in [1.0, 1.2] {
                for angle in [0.0f64, 0.7, 2.5] {
                    all.push(turned(&Deformation { plane, across }, angle));
                }
            }
        }
        all
    }

    /// Q F, with the rotation Q by `angle`.
    pub fn turned(f: &Deformation, angle: f64) -> Deformation {
        let (s, c) = angle.sin_cos();
        let [xx, xy, yx, yy] = f.plane;
        let plane = [c * xx - s * yx, c * xy - s * yy, s * xx + c * yx, s * xy + c * yy];
        Deformation { plane, ..*f }
    }

    /// (1 + h m (x) n) F; m and n are unit vectors at these angles.
    fn sheared(f: &Deformation, m: f64, n: f64, h: f64) -> Deformation {
        let [xx, xy, yx, yy] = f.plane;
        let n_f = [n.cos() * xx + n.sin() * yx, n.cos() * xy + n.sin() * yy];
        let (mx, my) = (h * m.cos(), h * m.sin());
        let plane = [xx + mx * n_f[0], xy + mx * n_f[1], yx + my * n_f[0], yy + my * n_f[1]];
        Deformation { plane, ..*f }
    }

    /// Checks that stress is the derivative of the stored energy, and rotates with the solid.
    pub fn check_stress(solid: impl ElasticSolid, stiffness: f64) {
        for f in states() {
            let tau = solid.kirchhoff_stress(&f);
            let h = 1e-5;
            let slope = |to: &dyn Fn(f64) -> Deformation| {
                (solid.stored_energy(&to(h)) - solid.stored_energy(&to(-h))) / (2.0 * h)
            };
            let (x, y) = (0.0, 0.5 * std::f64::consts::PI);
            for (component, slope) in [
                (tau.xx, slope(&|h| sheared(&f, x, x, h))),
                (tau.yy, slope(&|h| sheared(&f, y, y, h))),
                (tau.xy, slope(&|h| sheared(&f, x, y, h))),
                (tau.xy, slope(&|h| sheared(&f, y, x, h))),
                (tau.zz, slope(&|h| Deformation { across: f.across * (1.0 + h), ..f })),
            ] {
                assert!((component - slope).abs() < 1e-8 * stiffness, "{f:?}: {component} {slope}");
            }
            // s' = Q s Q^T
            let (sin, cos) = 0.3f64.sin_cos();
            let after = solid.kirchhoff_stress(&turned(&f, 0.3));
            let xx = cos * cos * tau.xx - 2.0 * sin * cos * tau.xy + sin * sin * tau.yy;
            let xy = sin * cos * (tau.xx - tau.yy) + (cos * cos - sin * sin) * tau.xy;
            for (a, b) in [(after.xx, xx), (after.xy, xy), (after.zz, tau.zz)] {
                assert!((a - b).abs() < 1e-13 * stiffness, "{f:?}: {a} {b}");
            }
        }
    }

    /// Checks that no wave of any direction and polarization exceeds the sound speed by more than
    /// the fraction `slack`, and that the fastest one comes close to it.
    pub fn check_sound_speed(solid: impl ElasticSolid, slack: f64) {
        for f in states() {
            let mut most = 0.0f64;
            let h = 1e-4;
            for i in 0..90 {
                for k in 0..90 {
                    let angle = |k: i32| f64::from(k) * std::f64::consts::PI / 90.0;
                    let energy = |h: f64| solid.stored_energy(&sheared(&f, angle(i), angle(k), h));
                    most = most.max((energy(h) - 2.0 * energy(0.0) + energy(-h)) / (h * h));
                }
            }
            let fastest = (most / solid.reference_density()).sqrt();
            let ratio = fastest / solid.sound_speed_squared(&f).sqrt();
            assert!((0.97..1.0 + slack).contains(&ratio), "{f:?}: {ratio}");
        }
    }

    #[test]
    fn moduli_are_the_textbooks() {
        let lame = Lame::new(2.6, 0.3);
        assert!((lame.mu - 1.0).abs() < 1e-15 && (lame.lambda - 1.5).abs() < 1e-15);
        assert_eq!(Lame::new(2.0, 0.0), Lame { lambda: 0.0, mu: 1.0 });
    }
}
