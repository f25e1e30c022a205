//! A shear layer: straight streamlines that slide past each other, steady in an inviscid fluid.
//!
//! ```text
//! v = (f(y), 0),  p constant;   x = X + f(Y) t,  y = Y;   F = I + f'(Y) t e_x (x) e_y
//! sine: f = U sin(2 pi (y - y0)/H)     tanh: f = U tanh((y - y0)/H)
//! ```
//!
//! Any f(y) solves the equations of an inviscid fluid: div v = 0 and v . grad v = 0, so there is no
//! pressure gradient. The sine has the period H in y and suits a box that is periodic in both
//! directions; the tanh suits a strip between slip walls. Both are periodic in x, with any length.
//! Both profiles are smooth over the cells, and their strain f'(y) t grows without limit: 8 at the
//! centre after [`ShearLayer::time_to_strain`]. (By linear theory the layer is unstable to long
//! waves along x; a perfectly uniform start does not excite them.)

use std::f64::consts::TAU;

use super::Vector;
use crate::exact::{ExactError, finite, positive};

/// Shape of the velocity profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShearProfile {
    /// U sin(2 pi (y - y0)/H).
    Sine,
    /// U tanh((y - y0)/H).
    Tanh,
}

/// A shear layer along x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShearLayer {
    /// Shape of the profile.
    pub profile: ShearProfile,
    /// Greatest velocity U [m/s].
    pub speed: f64,
    /// Period (sine) or half thickness (tanh) H [m].
    pub height: f64,
    /// y0, where the velocity is 0 and the shear is greatest [m].
    pub centre: f64,
}

impl ShearLayer {
    /// A shear layer with the largest velocity `speed` [m/s], the `height` [m] and the `centre`
    /// [m]. Refuses a speed or height that is not positive.
    ///
    /// # Errors
    ///
    /// The first constant that is out of range.
    pub fn new(
        profile: ShearProfile,
        speed: f64,
        height: f64,
        centre: f64,
    ) -> Result<ShearLayer, ExactError> {
        positive("the layer's speed", speed)?;
        positive("the layer's height", height)?;
        finite("the layer's centre", centre)?;
        Ok(ShearLayer { profile, speed, height, centre })
    }

    /// Velocity along x at `y` [m/s]; the velocity along y is 0.
    pub fn velocity(&self, y: f64) -> f64 {
        let eta = (y - self.centre) / self.height;
        self.speed
            * match self.profile {
                ShearProfile::Sine => (TAU * eta).sin(),
                ShearProfile::Tanh => eta.tanh(),
            }
    }

    /// Shear rate f'(y) [1/s].
    pub fn shear_rate(&self, y: f64) -> f64 {
        let eta = (y - self.centre) / self.height;
        let slope = match self.profile {
            ShearProfile::Sine => TAU * (TAU * eta).cos(),
            ShearProfile::Tanh => eta.cosh().powi(-2),
        };
        self.speed / self.height * slope
    }

    /// Position at `t` of the material point `reference` [m]; x is not wrapped into the period.
    pub fn position(&self, reference: Vector, t: f64) -> Vector {
        [reference[0] + self.velocity(reference[1]) * t, reference[1]]
    }

    /// Deformation gradient F at the material point `reference` [-].
    pub fn deformation_gradient(&self, reference: Vector, t: f64) -> [[f64; 2]; 2] {
        [[1.0, self.shear_rate(reference[1]) * t], [0.0, 1.0]]
    }

    /// Time at which the shear strain at the centre is `strain` [s].
    pub fn time_to_strain(&self, strain: f64) -> f64 {
        strain / self.shear_rate(self.centre)
    }

    /// Rms error of the velocity over U [-], both components together, from particles (y [m],
    /// velocity [m/s], volume). y is the current or the initial position of the particle: they are
    /// equal in the exact solution. `None` without particles.
    pub fn velocity_error(
        &self,
        particles: impl IntoIterator<Item = (f64, Vector, f64)>,
    ) -> Option<f64> {
        let (mut sum, mut total) = (0.0, 0.0);
        for (y, [vx, vy], volume) in particles {
            sum += volume * ((vx - self.velocity(y)).powi(2) + vy * vy);
            total += volume;
        }
        (total > 0.0).then(|| (sum / total).sqrt() / self.speed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64, by: f64) {
        assert!((a - b).abs() <= by, "{a} {b}");
    }

    fn both() -> [ShearLayer; 2] {
        [ShearProfile::Sine, ShearProfile::Tanh]
            .map(|profile| ShearLayer::new(profile, 3.0, 0.5, 0.1).unwrap())
    }

    #[test]
    fn rate_and_gradient_are_derivatives() {
        for layer in both() {
            let h = 1e-5;
            for k in 0..20 {
                let y = -0.9 + 0.1 * f64::from(k);
                let slope = (layer.velocity(y + h) - layer.velocity(y - h)) / (2.0 * h);
                close(layer.shear_rate(y), slope, 1e-6);
                let (x, t) = (0.3, 0.4);
                let to = |x, y| layer.position([x, y], t);
                let f = layer.deformation_gradient([x, y], t);
                for (n, row) in f.iter().enumerate() {
                    close((to(x + h, y)[n] - to(x - h, y)[n]) / (2.0 * h), row[0], 1e-6);
                    close((to(x, y + h)[n] - to(x, y - h)[n]) / (2.0 * h), row[1], 1e-6);
                }
                let rate = (layer.position([x, y], t + h)[0] - layer.position([x, y], t - h)[0])
                    / (2.0 * h);
                close(layer.velocity(y), rate, 1e-8);
            }
        }
    }

    #[test]
    fn the_greatest_strain_is_at_the_centre() {
        let [sine, tanh] = both();
        close(sine.time_to_strain(8.0), 8.0 * 0.5 / (TAU * 3.0), 1e-15);
        close(tanh.time_to_strain(8.0), 8.0 * 0.5 / 3.0, 1e-15);
        for layer in both() {
            let t = layer.time_to_strain(8.0);
            let strain = |k: i32| layer.deformation_gradient([0.0, 1e-3 * f64::from(k)], t)[0][1];
            let greatest = (-1000..1000).map(strain).fold(0.0, f64::max);
            close(greatest, 8.0, 1e-9);
        }
        // the sine is periodic and has no net momentum
        close(sine.velocity(0.33), sine.velocity(0.83), 1e-14);
        close(sine.velocity(0.33), -sine.velocity(-0.13), 1e-14);
        close(tanh.velocity(100.0), 3.0, 0.0);
    }

    #[test]
    fn error_of_a_known_fault() {
        for layer in both() {
            let particle = |k: i32| {
                let y = 0.01 * f64::from(k);
                (y, [layer.velocity(y) + 0.09, -0.12], 1.0 + y * y)
            };
            close(layer.velocity_error((0..100).map(particle)).unwrap(), 0.05, 1e-14);
            assert!(layer.velocity_error([]).is_none());
        }
        assert!(ShearLayer::new(ShearProfile::Sine, 0.0, 1.0, 0.0).is_err());
        assert!(ShearLayer::new(ShearProfile::Tanh, 1.0, 1.0, f64::NAN).is_err());
    }
}
