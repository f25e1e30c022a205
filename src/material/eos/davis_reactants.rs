//! Davis' equation of state of an unreacted explosive.
//!
//! With y = 1 - J, P = rho0 A^2/(4 B):
//!
//! ```text
//! p_s = P (exp(4 B y) - 1)                                                       y < 0
//! p_s = P (4By + (4By)^2/2 + (4By)^3/6 + C (4By)^4/24 + y^2/(1 - y)^4)             y >= 0
//! e_s = 1/rho0 times the integral of p_s from 0 to y
//! Gamma = G0 for y < 0, G0 + Z y for y >= 0
//! p = p_s + Gamma rho (e - e_s)
//! ```
//!
//! Source: Wescott, Stewart & Davis (2005), Equation of state and reaction rate for condensed-phase
//! explosives, J. Appl. Phys. 98, 053514, eqs. 12 to 15. The explosive does not burn; for one that
//! does see [`Burning`](super::Burning).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{EosParameters, EquationOfState, LinearPressure, Made, PlainEosVisitor};

/// Davis' equation of state of reactants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DavisReactants {
    /// Density at rest rho0 [kg/m3].
    pub rho0: f64,
    /// Sound speed at rest A [m/s].
    pub a: f64,
    /// B [-].
    pub b: f64,
    /// C [-].
    pub c: f64,
    /// Grueneisen coefficient at rest G0 [-].
    pub gamma0: f64,
    /// Growth of the Grueneisen coefficient with compression Z [-].
    pub z: f64,
}

impl DavisReactants {
    /// p_s and its derivative by y [Pa], and e_s [J/kg].
    #[inline(always)]
    fn isentrope(&self, y: f64) -> [f64; 3] {
        let k = 4.0 * self.b;
        let scale = self.rho0 * self.a * self.a / k;
        let u = k * y;
        let [p, slope, energy] = if y < 0.0 {
            // exp(u) - 1 - u loses its digits for small u
            let rest = if u > -1e-3 { u * u * (0.5 + u / 6.0) } else { u.exp_m1() - u };
            [u.exp_m1(), k * u.exp(), rest / k]
        } else {
            let free = 1.0 / (1.0 - y);
            let (square, cube) = (free * free, free * free * free);
            [
                u * (1.0 + u * (0.5 + u * (1.0 / 6.0 + self.c * u / 24.0)))
                    + y * y * square * square,
                k * (1.0 + u * (1.0 + u * (0.5 + self.c * u / 6.0)))
                    + 2.0 * y * (1.0 + y) * square * cube,
                u * y * (0.5 + u * (1.0 / 6.0 + u * (1.0 / 24.0 + self.c * u / 120.0)))
                    + y * y * y * cube / 3.0,
            ]
        };
        [scale * p, scale * slope, scale * energy / self.rho0]
    }

    /// Gamma and its derivative by y [-].
    #[inline(always)]
    fn gamma(&self, y: f64) -> [f64; 2] {
        if y < 0.0 { [self.gamma0, 0.0] } else { [self.gamma0 + self.z * y, self.z] }
    }
}

impl EquationOfState for DavisReactants {
    fn reference_density(&self) -> f64 {
        self.rho0
    }

    #[inline(always)]
    fn linear(&self, jacobian: f64) -> LinearPressure {
        let y = 1.0 - jacobian;
        let [p, _, e] = self.isentrope(y);
        let gruneisen_rho = self.gamma(y)[0] * self.rho0 / jacobian;
        LinearPressure { reference_pressure: p - gruneisen_rho * e, gruneisen_rho }
    }

    #[inline(always)]
    fn sound_speed_squared(&self, jacobian: f64, pressure: f64) -> f64 {
        let (j, y) = (jacobian, 1.0 - jacobian);
        let [p, slope, _] = self.isentrope(y);
        let [gamma, growth] = self.gamma(y);
        let thermal = pressure - p;
        // -dp/dJ at fixed energy, with (e - e_s) = thermal/(Gamma rho)
        let by_volume = slope + thermal * (growth / gamma + 1.0 / j) - gamma * p / j;
        j * j / self.rho0 * (by_volume + gamma * pressure / j)
    }

    #[inline(always)]
    fn check_validity(&self, jacobian: f64, _pressure: f64) -> Option<&'static str> {
        let y = 1.0 - jacobian;
        (self.gamma(y)[0] <= 0.0)
            .then_some("compressed to where Davis' Grueneisen coefficient is 0")
    }
}

/// Unreacted explosive with the equation of state of Davis; it does not burn. With y = 1 - rho0/rho
/// >= 0 and u = 4 B y the isentrope from rest is p_s = rho0 A^2/(4 B) (u + u^2/2 + u^3/6 + C u^4/24
/// + y^2/(1 - y)^4), and the Grueneisen coefficient is G0 + Z y.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DavisReactantsParameters {
    /// Sound speed A of the material at rest [m/s]. A larger value makes the material stiffer.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub a: f64,
    /// Constant B of the isentrope [-]. With a larger value the stiffness grows faster with
    /// compression.
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 100.0))]
    pub b: f64,
    /// Constant C, the weight of the fourth-order term of the isentrope [-]. A larger value makes
    /// strongly compressed material stiffer.
    #[schemars(extend("minimum" = 0.0))]
    pub c: f64,
    /// Grueneisen coefficient G0 at rest and in expansion [-]. A larger value gives more pressure
    /// per energy.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub gamma0: f64,
    /// Increase Z of the Grueneisen coefficient with the compression y [-]; default 0: it is
    /// constant.
    #[serde(default)]
    pub z: f64,
    /// Greatest tension that the material carries [Pa]; absent: no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0.0))]
    pub tension_cutoff: Option<f64>,
}

impl EosParameters for DavisReactantsParameters {
    fn check_initial_pressure(&self, _density: f64, pressure: f64) -> Result<(), String> {
        super::within_cutoff(pressure, self.tension_cutoff)
    }

    fn visit_plain<V: PlainEosVisitor>(&self, rho0: f64, visitor: V) -> Made<V> {
        let &DavisReactantsParameters { a, b, c, gamma0, z, tension_cutoff } = self;
        let eos = DavisReactants { rho0, a, b, c, gamma0, z };
        Ok(Some(super::limited(visitor, eos, tension_cutoff)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::GeneralEos;
    use super::super::general::tests::check_derivatives;
    use super::*;

    /// PBX 9502, table 1 of the paper, but with a Grueneisen coefficient that grows.
    const PBX: DavisReactants =
        DavisReactants { rho0: 1895.0, a: 1800.0, b: 4.6, c: 0.34, gamma0: 0.56, z: 0.3 };

    #[test]
    fn derivatives() {
        let states = [[0.65, 4e6, 0.0], [0.95, 1e4, 0.0], [1.02, 1e4, 0.0], [1.2, 1e5, 0.0]];
        check_derivatives(&PBX, &states, 1e-6);
    }

    #[test]
    fn the_energy_of_the_isentrope_is_the_work_of_its_pressure() {
        for target in [0.6, 0.98, 1.00001, 1.1] {
            let (mut work, steps) = (0.0, 20_000);
            for k in 0..steps {
                let y = (1.0 - target) * (f64::from(k) + 0.5) / f64::from(steps);
                work += PBX.isentrope(y)[0] * (1.0 - target) / f64::from(steps) / PBX.rho0;
            }
            let energy = PBX.isentrope(1.0 - target)[2];
            assert!((energy / work - 1.0).abs() < 1e-6, "{target}: {energy} {work}");
        }
    }

    #[test]
    fn at_rest_the_sound_speed_is_a() {
        let point = GeneralEos::at(&PBX, 1.0, 0.0);
        assert_eq!(point.pressure, 0.0);
        assert!((point.sound_speed_squared.sqrt() / 1800.0 - 1.0).abs() < 1e-14);
        // along the isentrope through rest the pressure is p_s, in compression and expansion
        for j in [0.8, 1.1] {
            let [p, _, e] = PBX.isentrope(1.0 - j);
            assert!((GeneralEos::at(&PBX, j, e).pressure / p - 1.0).abs() < 1e-12);
        }
    }
}
