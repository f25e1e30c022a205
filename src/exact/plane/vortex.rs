//! The generalized vortex: a ring of neo-Hookean solid in plane strain that rotates back and forth.
//! Each radius rotates by its own angle; a manufactured body force drives the motion.
//!
//! With R the distance from the centre, xi = (2 R - inner - outer)/(outer - inner):
//!
//! ```text
//! x = Q(alpha(R, t)) X,   alpha = A sin(pi t/T) h(R),   h = (1 - xi^2)^2
//! ```
//!
//! For the ring 0.75 to 1.25 m, h = 1 - 32 (R-1)^2 + 256 (R-1)^4. Source: Kamojjala, Brannon,
//! Sadeghirad & Guilkey (2015), Verification tests in solid mechanics, Eng. Comput. 31, 193.
//!
//! Material: sigma = (lambda ln J/J) I + (mu/J) (F F^T - I), tension positive. In polar
//! components F = I + k e_theta (x) E_R with k = R alpha', so J = 1, Div P = div sigma, and
//!
//! ```text
//! sigma_rr = 0,  sigma_rtheta = mu k,  sigma_thetatheta = mu k^2
//! b_r     = -R (d alpha/dt)^2 + mu R alpha'^2/rho0
//! b_theta = R d2alpha/dt2 - mu (3 alpha' + R alpha'')/rho0
//! ```
//!
//! in the basis at the current position. Both rims have alpha = alpha' = 0: neither displacement
//! nor traction. lambda does not enter the exact solution. A point that is off the ring by rounding
//! is treated as at rest.

use std::f64::consts::PI;

use super::{Vector, difference, length, square, turn};
use crate::exact::{ExactError, finite, positive};

/// A 2x2 tensor, stored by rows.
pub type Tensor = [[f64; 2]; 2];

/// The generalized vortex about the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vortex {
    /// Inner radius of the ring [m].
    pub inner: f64,
    /// Outer radius of the ring [m].
    pub outer: f64,
    /// Greatest angle A, at mid-radius and half period [rad].
    pub amplitude: f64,
    /// Time T after which the ring returns to its initial position [s].
    pub period: f64,
    /// Young's modulus E [Pa].
    pub youngs_modulus: f64,
    /// Poisson's ratio nu [-].
    pub poissons_ratio: f64,
    /// Density rho0 [kg/m3].
    pub density: f64,
}

impl Default for Vortex {
    /// The ring and the material of Kamojjala et al. (2015).
    fn default() -> Vortex {
        Vortex {
            inner: 0.75,
            outer: 1.25,
            amplitude: 1.0,
            period: 1.0,
            youngs_modulus: 1000.0,
            poissons_ratio: 0.3,
            density: 1000.0,
        }
    }
}

/// A material point of a run, for [`Vortex::l2_error`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Displaced {
    /// Reference position X [m].
    pub reference: Vector,
    /// Computed position x [m].
    pub position: Vector,
    /// Reference volume; in the plane an area [m2]. Only ratios matter.
    pub volume: f64,
}

/// alpha and its derivatives at one radius and time.
#[derive(Clone, Copy, Debug, Default)]
struct Angle {
    alpha: f64,
    /// d alpha/dR [1/m] and d2 alpha/dR2 [1/m2].
    slope: f64,
    curvature: f64,
    /// d alpha/dt [1/s] and d2 alpha/dt2 [1/s2].
    rate: f64,
    acceleration: f64,
}

impl Vortex {
    /// Refuses constants that do not describe a ring or a solid.
    ///
    /// # Errors
    ///
    /// The first constant that is out of range.
    pub fn check(&self) -> Result<(), ExactError> {
        positive("the ring's inner radius", self.inner)?;
        positive("the ring's width", self.outer - self.inner)?;
        positive("the vortex's period", self.period)?;
        positive("Young's modulus", self.youngs_modulus)?;
        positive("the density", self.density)?;
        finite("the vortex's amplitude", self.amplitude)?;
        let nu = self.poissons_ratio;
        if nu > -1.0 && nu < 0.5 {
            Ok(())
        } else {
            let allowed = "between -1 and 0.5";
            Err(ExactError::Number { name: "Poisson's ratio", value: nu, allowed })
        }
    }

    /// Shear modulus mu = E/(2 (1 + nu)) [Pa].
    pub fn shear_modulus(&self) -> f64 {
        0.5 * self.youngs_modulus / (1.0 + self.poissons_ratio)
    }

    /// Lame's first constant lambda = E nu/((1 + nu)(1 - 2 nu)) [Pa].
    pub fn lame_lambda(&self) -> f64 {
        let nu = self.poissons_ratio;
        self.youngs_modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    }

    fn angle(&self, radius: f64, t: f64) -> Angle {
        if !(self.inner..=self.outer).contains(&radius) {
            return Angle::default();
        }
        let per_metre = 2.0 / (self.outer - self.inner); // d xi/dR
        let xi = per_metre * (radius - 0.5 * (self.inner + self.outer));
        let rest = 1.0 - xi * xi;
        let h = rest * rest;
        let omega = PI / self.period;
        let (sin, cos) = (omega * t).sin_cos();
        let (now, a) = (self.amplitude * sin, self.amplitude);
        Angle {
            alpha: now * h,
            slope: now * per_metre * (-4.0 * xi * rest),
            curvature: now * per_metre * per_metre * (12.0 * xi * xi - 4.0),
            rate: a * omega * cos * h,
            acceleration: -omega * omega * now * h,
        }
    }

    /// Angle alpha(R, t) by which the ring is rotated at `radius` [rad].
    pub fn rotation(&self, radius: f64, t: f64) -> f64 {
        self.angle(radius, t).alpha
    }

    /// Current position x of the material point `reference` [m].
    pub fn position(&self, reference: Vector, t: f64) -> Vector {
        turn(reference, self.angle(length(reference), t).alpha)
    }

    /// Velocity of the material point `reference` [m/s].
    pub fn velocity(&self, reference: Vector, t: f64) -> Vector {
        let angle = self.angle(length(reference), t);
        let [x, y] = turn(reference, angle.alpha);
        [-angle.rate * y, angle.rate * x]
    }

    /// Acceleration of the material point `reference` [m/s2].
    pub fn acceleration(&self, reference: Vector, t: f64) -> Vector {
        let radius = length(reference);
        let angle = self.angle(radius, t);
        let (radial, hoop) = (-radius * angle.rate * angle.rate, radius * angle.acceleration);
        in_plane(reference, angle.alpha, radial, hoop)
    }

    /// Deformation gradient F = dx/dX at the material point `reference` [-].
    pub fn deformation_gradient(&self, reference: Vector, t: f64) -> Tensor {
        let radius = length(reference);
        let angle = self.angle(radius, t);
        let (sin, cos) = angle.alpha.sin_cos();
        // Q (I + k E_theta (x) E_R) = Q + k e_theta (x) E_R
        let [x, y] = turn(reference, angle.alpha);
        let k = angle.slope / radius.max(f64::MIN_POSITIVE);
        let [big_x, big_y] = reference;
        [[cos - k * y * big_x, -sin - k * y * big_y], [sin + k * x * big_x, cos + k * x * big_y]]
    }

    /// Cauchy stress of the neo-Hookean solid for the in-plane deformation gradient `f` (no strain
    /// normal to the plane), tension positive [Pa].
    pub fn cauchy_stress(&self, f: Tensor) -> Tensor {
        let j = f[0][0] * f[1][1] - f[0][1] * f[1][0];
        let (mu, pressure) = (self.shear_modulus() / j, self.lame_lambda() * j.ln() / j);
        let left = |a: usize, b: usize| f[a][0] * f[b][0] + f[a][1] * f[b][1];
        let diagonal = |a: usize| mu * (left(a, a) - 1.0) + pressure;
        let shear = mu * left(0, 1);
        [[diagonal(0), shear], [shear, diagonal(1)]]
    }

    /// Body force per unit mass that drives the material point `reference` along the exact motion
    /// [m/s2].
    pub fn body_force(&self, reference: Vector, t: f64) -> Vector {
        let radius = length(reference);
        let angle = self.angle(radius, t);
        let stiffness = self.shear_modulus() / self.density;
        let radial = radius * (stiffness * angle.slope * angle.slope - angle.rate * angle.rate);
        let hoop = radius * angle.acceleration
            - stiffness * (3.0 * angle.slope + radius * angle.curvature);
        in_plane(reference, angle.alpha, radial, hoop)
    }

    /// Relative L2 error of the displacement, sqrt(sum V |x - x_exact|^2/sum V |x_exact - X|^2)
    /// [-]; `None` without points, and if the exact displacement is 0 to rounding (t = 0, T, ...).
    pub fn l2_error(&self, points: &[Displaced], t: f64) -> Option<f64> {
        let (mut error, mut exact, mut size) = (0.0, 0.0, 0.0);
        for q in points {
            let place = self.position(q.reference, t);
            error += q.volume * square(difference(q.position, place));
            exact += q.volume * square(difference(place, q.reference));
            size += q.volume * square(q.reference);
        }
        (exact > 1e-28 * size).then(|| (error / exact).sqrt())
    }
}

/// The vector with the polar components `radial` and `hoop` at the current position of `reference`.
fn in_plane(reference: Vector, alpha: f64, radial: f64, hoop: f64) -> Vector {
    let radius = length(reference).max(f64::MIN_POSITIVE);
    let [c, s] = turn(reference, alpha).map(|v| v / radius);
    [radial * c - hoop * s, radial * s + hoop * c]
}

#[cfg(test)]
mod tests;
