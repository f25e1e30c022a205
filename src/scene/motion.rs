//! Initial motions of bodies, and body forces: functions of position and time.
//!
//! Independent of particles and grid. Positions and velocities are pairs; in one dimension y is 0.

use crate::exact::plane::{Gresho, ShearLayer, ShearProfile, Vector, Vortex, rotation};
use crate::material::IdealGasParameters;
use crate::scene::{Eos, Material, RingVortex, ShearForm, VelocityField};

/// A velocity that varies in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// A rigid rotation about a point [m] at a rate [rad/s].
    Rotation(Vector, f64),
    /// A shear layer.
    ShearLayer(ShearLayer),
    /// The Gresho vortex.
    Gresho(Gresho),
    /// Uniform speed [m/s] away from a point [m].
    Radial(Vector, f64),
    /// The generalized vortex at time 0.
    Vortex(Vortex),
}

/// The generalized vortex of a solid of `material`; `None` unless this is a neo-Hookean solid.
pub fn vortex_of(ring: &RingVortex, material: &Material) -> Option<Vortex> {
    let Eos::NeoHookean(solid) = &material.eos else { return None };
    Some(Vortex {
        inner: ring.inner,
        outer: ring.outer,
        amplitude: ring.amplitude,
        period: ring.period,
        youngs_modulus: solid.youngs_modulus,
        poissons_ratio: solid.poissons_ratio,
        density: material.density,
    })
}

fn pair(numbers: &[f64]) -> Vector {
    std::array::from_fn(|a| numbers.get(a).copied().unwrap_or(0.0))
}

impl Motion {
    /// The motion of a velocity field of the scene, for a body of `material`. The error is the
    /// reason if the constants are invalid or the material does not support the motion.
    ///
    /// # Errors
    ///
    /// If a constant is out of range, or if the material does not support the motion.
    pub fn new(field: &VelocityField, material: &Material) -> Result<Motion, String> {
        let message = |error: crate::exact::ExactError| error.to_string();
        Ok(match field {
            VelocityField::Rotation(r) => Motion::Rotation(pair(&r.about), r.rate),
            VelocityField::Radial(r) => Motion::Radial(pair(&r.about), r.speed),
            VelocityField::ShearLayer(s) => {
                let profile = match s.profile {
                    ShearForm::Sine => ShearProfile::Sine,
                    ShearForm::Tanh => ShearProfile::Tanh,
                };
                let layer = ShearLayer::new(profile, s.speed, s.height, s.centre);
                Motion::ShearLayer(layer.map_err(message)?)
            }
            VelocityField::Gresho(g) => {
                let Eos::IdealGas(IdealGasParameters { gamma }) = material.eos else {
                    return Err("Gresho's vortex is one of an ideal gas".into());
                };
                let vortex = Gresho {
                    centre: pair(&g.centre),
                    radius: g.radius,
                    speed: g.speed,
                    density: material.density,
                    centre_pressure: g.centre_pressure,
                    gamma,
                };
                vortex.check().map_err(message)?;
                Motion::Gresho(vortex)
            }
            VelocityField::Vortex(ring) => {
                let vortex = vortex_of(ring, material)
                    .ok_or("the generalized vortex is one of a neo-Hookean solid")?;
                vortex.check().map_err(message)?;
                Motion::Vortex(vortex)
            }
        })
    }

    /// Velocity at the position `x` [m/s].
    pub fn velocity(&self, x: Vector) -> Vector {
        match self {
            Motion::Rotation(about, rate) => rotation::rigid_velocity(x, *about, *rate),
            Motion::ShearLayer(layer) => [layer.velocity(x[1]), 0.0],
            Motion::Gresho(vortex) => vortex.velocity(x),
            Motion::Radial(about, speed) => {
                let [dx, dy] = [x[0] - about[0], x[1] - about[1]];
                let r = dx.hypot(dy);
                if r > 0.0 { [speed * dx / r, speed * dy / r] } else { [0.0; 2] }
            }
            Motion::Vortex(vortex) => vortex.velocity(x, 0.0),
        }
    }

    /// Gradient of the velocity at `x` [1/s], by differences over `step` [m].
    pub fn gradient(&self, x: Vector, step: f64) -> [[f64; 2]; 2] {
        let along = |b: usize| {
            let at = |h: f64| {
                let mut place = x;
                place[b] += h;
                self.velocity(place)
            };
            let (above, below) = (at(0.5 * step), at(-0.5 * step));
            [0, 1].map(|a| (above[a] - below[a]) / step)
        };
        let columns = [along(0), along(1)];
        [0, 1].map(|a| [columns[0][a], columns[1][a]])
    }

    /// Pressure at `x` [Pa], if the motion defines one.
    pub fn pressure(&self, x: Vector) -> Option<f64> {
        match self {
            Motion::Gresho(vortex) => {
                let [dx, dy] = [x[0] - vortex.centre[0], x[1] - vortex.centre[1]];
                Some(vortex.pressure(dx.hypot(dy)))
            }
            _ => None,
        }
    }

    /// Largest pressure anywhere [Pa], if the motion defines one.
    pub fn top_pressure(&self) -> Option<f64> {
        match self {
            Motion::Gresho(vortex) => Some(vortex.pressure(2.0 * vortex.radius)),
            _ => None,
        }
    }

    /// Upper bound of the speed in the box from `lower` to `upper` [m/s].
    pub fn top_speed(&self, lower: &[f64], upper: &[f64]) -> f64 {
        match self {
            Motion::Rotation(about, rate) => {
                let (lower, upper) = (pair(lower), pair(upper));
                let far = |a: usize| (lower[a] - about[a]).abs().max((upper[a] - about[a]).abs());
                rate.abs() * far(0).hypot(far(1))
            }
            Motion::ShearLayer(layer) => layer.speed,
            Motion::Gresho(vortex) => vortex.speed,
            Motion::Radial(_, speed) => speed.abs(),
            Motion::Vortex(v) => v.amplitude.abs() * std::f64::consts::PI / v.period * v.outer,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motions() -> [Motion; 5] {
        let layer = ShearLayer::new(ShearProfile::Tanh, 2.0, 0.4, 0.1).unwrap();
        [
            Motion::Rotation([0.2, -0.1], 3.0),
            Motion::ShearLayer(layer),
            Motion::Gresho(Gresho { radius: 0.5, ..Gresho::default() }),
            Motion::Radial([0.1, 0.3], -2.0),
            Motion::Vortex(Vortex::default()),
        ]
    }

    #[test]
    fn no_speed_is_above_the_greatest() {
        for motion in motions() {
            let mut most = 0.0f64;
            for k in 0..60 {
                for l in 0..60 {
                    let at = |k: i32| -1.5 + 3.0 * f64::from(k) / 59.0;
                    let [u, v] = motion.velocity([at(k), at(l)]);
                    most = most.max(u.hypot(v));
                }
            }
            let top = motion.top_speed(&[-1.5, -1.5], &[1.5, 1.5]);
            assert!((0.7 * top..=top * (1.0 + 1e-14)).contains(&most), "{motion:?} {most} {top}");
        }
    }

    #[test]
    fn gradient_of_a_rotation_is_its_rate() {
        let [[xx, xy], [yx, yy]] = motions()[0].gradient([0.7, 0.4], 0.01);
        for (value, exact) in [(xx, 0.0), (xy, -3.0), (yx, 3.0), (yy, 0.0)] {
            assert!((value - exact).abs() < 1e-11, "{value} {exact}");
        }
    }

    #[test]
    fn a_line_closes_in_on_its_point() {
        let field = VelocityField::Radial(crate::scene::Radial { about: vec![0.5], speed: -2.0 });
        let material = Material {
            density: 1.0,
            eos: Eos::IdealGas(IdealGasParameters { gamma: 1.4 }),
            source: String::new(),
            strength: None,
            failure: None,
            erosion: None,
            thermal: None,
        };
        let motion = Motion::new(&field, &material).unwrap();
        assert_eq!(motion.velocity([0.9, 0.0]), [-2.0, 0.0]);
        assert_eq!(motion.velocity([0.1, 0.0])[0], 2.0);
        assert_eq!(motion.velocity([0.5, 0.0]), [0.0, 0.0]);
    }
}
