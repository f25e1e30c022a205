//! Temperature of a material from its energy.
//!
//! ```text
//! T = Ts(J) + (e - es(J) - s:s/(4 G rho) - stored)/cv
//! ```
//!
//! Ts and es are the temperature and the energy on the isentrope through the state at rest:
//! des/dJ = -p/rho0 and d(ln Ts)/dJ = -(dp/de)/rho0, which is the Grueneisen coefficient over -J
//! (Davison 2008, eqs. 5.127 and 5.135). s:s/(4 G rho) is the elastic energy of shear. `stored` is
//! the part of the plastic work that does not heat (Taylor & Quinney 1934).

use super::model::FluidModel;

/// Number of points of the isentrope on each side of rest for temperatures.
const POINTS: usize = 2000;

/// Smallest and greatest J of the isentrope.
const RANGE: [f64; 2] = [0.25, 1.5];

/// Energy and temperature on the isentrope through the state at rest, interpolated by cubics between
/// points.
#[derive(Clone, Debug)]
pub struct RestIsentrope {
    lower: f64,
    spacing: f64,
    /// es [J/kg] and its derivative by J, ln(Ts/T0) and its derivative by J.
    points: Vec<[f64; 4]>,
}

impl RestIsentrope {
    /// Isentrope of `model` with density `rho0` [kg/m3] at rest, as far as the model is valid, for
    /// temperatures.
    pub fn new(model: &dyn FluidModel, rho0: f64) -> Self {
        Self::with_points(model, rho0, POINTS)
    }

    /// The same with `count` points on each side of rest.
    pub fn with_points(model: &dyn FluidModel, rho0: f64, count: usize) -> Self {
        let state = |j: f64, e: f64| -> Option<[f64; 2]> {
            let at = |e: f64| {
                let (mut p, mut c) = ([0.0], [0.0]);
                model.refresh(&[j], &[e], None, &mut p, &mut c).is_none().then_some(p[0])
            };
            // dp/de does not depend on e in a model that is linear in the energy
            let step = 1e-3 * model.sound_speed_at(0.0).powi(2).max(f64::MIN_POSITIVE);
            Some([at(e)?, (at(e + step)? - at(e - step)?) / (2.0 * step)])
        };
        let slope = |j: f64, e: f64| state(j, e).map(|[p, factor]| [-p / rho0, -factor / rho0]);
        let walk = |to: f64| {
            let h = (to - 1.0) / count as f64;
            let (mut e, mut log) = (0.0, 0.0);
            let mut all = Vec::new();
            for k in 0..=count {
                let j = 1.0 + h * k as f64;
                let Some(first) = slope(j, e) else { break };
                all.push([e, first[0], log, first[1]]);
                // fourth-order Runge-Kutta method
                let mut sum = first;
                let mut last = first;
                let mut whole = true;
                for (share, weight) in [(0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
                    let Some(next) = slope(j + share * h, e + share * h * last[0]) else {
                        whole = false;
                        break;
                    };
                    last = next;
                    (0..2).for_each(|a| sum[a] += weight * last[a]);
                }
                if !whole {
                    break;
                }
                e += h * sum[0] / 6.0;
                log += h * sum[1] / 6.0;
            }
            (all, h)
        };
        // equal spacing on both sides, so that one division finds the interval
        let (below, spacing) = walk(RANGE[0]);
        let (above, _) = walk(2.0 - RANGE[0]);
        let upper = ((RANGE[1] - 1.0) / -spacing).ceil() as usize;
        let above = &above[..above.len().min(upper + 1)];
        let lower = 1.0 + spacing * (below.len().max(1) - 1) as f64;
        let mut points: Vec<_> =
            below.into_iter().rev().chain(above.iter().skip(1).copied()).collect();
        if points.is_empty() {
            // a model that is invalid at rest is reported with its first state
            points.push([0.0; 4]);
        }
        RestIsentrope { lower, spacing: -spacing, points }
    }

    /// es [J/kg] and Ts/T0 at `jacobian`; extrapolated along the tangents beyond the ends.
    pub fn at(&self, jacobian: f64) -> [f64; 2] {
        let place = (jacobian - self.lower) / self.spacing;
        let last = self.points.len() - 1;
        let nearest = (place.max(0.0) as usize).min(last);
        let near = &self.points[nearest];
        let apart = jacobian - (self.lower + self.spacing * nearest as f64);
        let [e, log] = if place < 0.0 || nearest == last {
            [near[0] + near[1] * apart, near[2] + near[3] * apart]
        } else {
            let next = &self.points[nearest + 1];
            let (t, h) = (apart / self.spacing, self.spacing);
            let cubic = |a: usize| {
                let (f0, d0, f1, d1) = (near[a], near[a + 1] * h, next[a], next[a + 1] * h);
                let rise = f1 - f0;
                f0 + t * (d0 + t * (3.0 * rise - 2.0 * d0 - d1 + t * (d0 + d1 - 2.0 * rise)))
            };
            [cubic(0), cubic(2)]
        };
        [e, log.exp()]
    }
}

/// Temperature model of a material.
#[derive(Clone, Debug)]
pub struct ThermalModel {
    /// Specific heat cv [J/(kg K)].
    pub specific_heat: f64,
    /// Temperature at rest T0 [K].
    pub rest: f64,
    /// Fraction of the plastic work that becomes heat [-].
    pub taylor_quinney: f64,
    /// Thermal conductivity [W/(m K)]; `None` if the scene leaves it out.
    pub conductivity: Option<f64>,
    /// Isentrope through the state at rest; `None` if only plastic work heats.
    pub isentrope: Option<RestIsentrope>,
}

impl ThermalModel {
    /// Temperature [K] at `jacobian`, where `energy` is the specific internal energy without its
    /// elastic shear and stored parts [J/kg]. `None` if only plastic work heats.
    pub fn temperature(&self, jacobian: f64, energy: f64) -> Option<f64> {
        let [reference_pressure, ratio] = self.isentrope.as_ref()?.at(jacobian);
        Some(self.rest * ratio + (energy - reference_pressure) / self.specific_heat)
    }

    /// Specific internal energy at rest density and `temperature` [J/kg].
    pub fn energy_at(&self, temperature: f64) -> f64 {
        self.specific_heat * (temperature - self.rest)
    }
}

#[cfg(test)]
mod tests {
    use super::super::linear::LinearEosKernel;
    use super::*;
    use crate::material::{EquationOfState, MieGruneisen};

    const COPPER: MieGruneisen = MieGruneisen { rho0: 8930.0, c0: 3940.0, s: 1.489, gamma0: 1.96 };

    #[test]
    fn the_isentrope_is_that_of_the_equation_of_state() {
        let isentrope = RestIsentrope::new(&LinearEosKernel(COPPER), 8930.0);
        for (j, ratio) in [(0.8f64, (1.96f64 * 0.2).exp()), (1.0, 1.0), (1.05, (-0.098f64).exp())] {
            let [e, t] = isentrope.at(j);
            assert!((t / ratio - 1.0).abs() < 1e-9, "{j}: {t} {ratio}");
            // mid-point rule in 20000 steps
            let (mut by_hand, h) = (0.0, (j - 1.0) / 20000.0);
            for k in 0..20000 {
                let at = 1.0 + h * k as f64;
                let half = by_hand - 0.5 * h * COPPER.pressure(at, by_hand) / 8930.0;
                by_hand -= h * COPPER.pressure(at + 0.5 * h, half) / 8930.0;
            }
            assert!((e - by_hand).abs() <= 1e-6 * by_hand.abs() + 1e-12, "{j}: {e} {by_hand}");
        }
        // beyond the limit of the Hugoniot there is no isentrope; it continues along its tangent
        assert!(isentrope.at(0.2)[0].is_finite() && isentrope.at(3.0)[1] > 0.0);
    }

    #[test]
    fn temperature_is_that_at_rest_and_grows_by_the_heat() {
        let isentrope = Some(RestIsentrope::new(&LinearEosKernel(COPPER), 8930.0));
        let copper = ThermalModel {
            specific_heat: 385.0,
            rest: 293.0,
            taylor_quinney: 1.0,
            conductivity: None,
            isentrope,
        };
        assert_eq!(copper.temperature(1.0, 0.0), Some(293.0));
        let warm = copper.temperature(1.0, copper.energy_at(400.0)).unwrap();
        assert!((warm - 400.0).abs() < 1e-9);
        // the standard problem's shock: p = 12.144 GPa, e = 47 760 J/kg
        let shocked = copper.temperature(8930.0 / 9604.616, 47_760.0).unwrap();
        assert!((shocked - 345.428491).abs() < 1e-4, "{shocked}");
    }
}
