//! Vinet's isotherm as the cold curve of a Mie-Grueneisen solid.
//!
//! ```text
//! x = J^(1/3),  eta = 3/2 (K' - 1)
//! p_c = 3 K (1 - x)/x^2 exp(eta (1 - x))
//! e_c = 9 K/(rho0 eta^2) (1 + (eta (1 - x) - 1) exp(eta (1 - x)))
//! p = p_c + gamma0 rho0 (e - e_c)
//! ```
//!
//! Source: Vinet, Ferrante, Rose & Smith (1987), Compressibility of solids, J. Geophys. Res. 92,
//! 9319, eq. 3; e_c is the integral of -p_c dv. Gamma rho = gamma0 rho0 is constant. Valid in
//! compression to several times the density at rest, and in tension up to the point where the bulk
//! modulus vanishes.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{EosParameters, EquationOfState, LinearPressure, Made, PlainEosVisitor};
use crate::material::ParameterError;

/// Mie-Grueneisen solid about Vinet's isotherm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vinet {
    /// Density at rest rho0 [kg/m3].
    pub rho0: f64,
    /// Bulk modulus at rest K [Pa].
    pub bulk_modulus: f64,
    /// eta = 3/2 (K' - 1), K' the derivative of the bulk modulus by pressure [-].
    pub eta: f64,
    /// Grueneisen coefficient at rest gamma0 [-]; Gamma rho = gamma0 rho0.
    pub gamma0: f64,
}

impl Vinet {
    /// p_c and its derivative by J [Pa], and e_c [J/kg].
    #[inline(always)]
    fn cold(&self, jacobian: f64) -> [f64; 3] {
        let x = jacobian.cbrt();
        let compressed = 1.0 - x;
        let growth = (self.eta * compressed).exp();
        let pressure = 3.0 * self.bulk_modulus * compressed / (x * x) * growth;
        let slope = -self.bulk_modulus * growth / (x * x * x * x * x)
            * (2.0 - x + self.eta * x * compressed);
        // 1 + (z - 1) exp(z) loses its digits for small z
        let z = self.eta * compressed;
        let integral = if z.abs() < 1e-2 {
            z * z * (0.5 + z * (1.0 / 3.0 + z * (0.125 + z * (1.0 / 30.0 + z / 144.0))))
        } else {
            1.0 + (z - 1.0) * growth
        };
        let energy = 9.0 * self.bulk_modulus / (self.rho0 * self.eta * self.eta) * integral;
        [pressure, slope, energy]
    }
}

impl EquationOfState for Vinet {
    fn reference_density(&self) -> f64 {
        self.rho0
    }

    #[inline(always)]
    fn linear(&self, jacobian: f64) -> LinearPressure {
        let [pressure, _, energy] = self.cold(jacobian);
        let gruneisen_rho = self.gamma0 * self.rho0;
        LinearPressure { reference_pressure: pressure - gruneisen_rho * energy, gruneisen_rho }
    }

    #[inline(always)]
    fn sound_speed_squared(&self, jacobian: f64, pressure: f64) -> f64 {
        let [cold, slope, _] = self.cold(jacobian);
        jacobian * jacobian / self.rho0 * (self.gamma0 * (pressure - cold) - slope)
    }

    #[inline(always)]
    fn check_validity(&self, _jacobian: f64, _pressure: f64) -> Option<&'static str> {
        None
    }
}

/// Mie-Grueneisen solid about Vinet's isotherm, p = 3 K (1 - x)/x^2 exp(3/2 (K' - 1)(1 - x)) with
/// x = (rho0/rho)^(1/3).
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VinetParameters {
    /// Bulk modulus K of the isotherm at rest [Pa]. A larger value makes the material stiffer.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub bulk_modulus: f64,
    /// Derivative K' of the bulk modulus with respect to pressure [-]. With a larger value the
    /// stiffness grows faster with compression.
    #[schemars(extend("exclusiveMinimum" = 1.0), range(max = 20.0))]
    pub bulk_modulus_derivative: f64,
    /// Grueneisen coefficient at rest; Gamma rho is constant [-].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub gamma0: f64,
    /// Greatest tension that the material carries [Pa]; absent: up to where the bulk modulus
    /// vanishes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0.0))]
    pub tension_cutoff: Option<f64>,
}

impl EosParameters for VinetParameters {
    fn check(&self, _: &super::EosContext) -> Result<(), ParameterError> {
        // the formulas divide by K' - 1
        if self.bulk_modulus_derivative < 1.01 {
            let reason = "allowed: at least 1.01";
            let key = "bulk_modulus_derivative";
            return Err(ParameterError::new(key, self.bulk_modulus_derivative, reason));
        }
        Ok(())
    }

    fn check_initial_pressure(&self, _density: f64, pressure: f64) -> Result<(), String> {
        super::within_cutoff(pressure, self.tension_cutoff)
    }

    fn visit_plain<V: PlainEosVisitor>(&self, rho0: f64, visitor: V) -> Made<V> {
        let eta = 1.5 * (self.bulk_modulus_derivative - 1.0);
        let (bulk_modulus, gamma0) = (self.bulk_modulus, self.gamma0);
        let eos = Vinet { rho0, bulk_modulus, eta, gamma0 };
        Ok(Some(super::limited(visitor, eos, self.tension_cutoff)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::GeneralEos;
    use super::super::general::tests::check_derivatives;
    use super::*;

    const COPPER: Vinet =
        Vinet { rho0: 8930.0, bulk_modulus: 138.6e9, eta: 1.5 * (4.96 - 1.0), gamma0: 1.96 };

    #[test]
    fn derivatives() {
        let states = [[0.6, 4e6, 0.0], [0.95, 1e4, 0.0], [1.0, 0.0, 0.0], [1.05, 1e4, 0.0]];
        check_derivatives(&COPPER, &states, 1e-6);
    }

    #[test]
    fn the_cold_energy_is_the_work_of_the_cold_pressure() {
        for target in [0.6, 0.99, 1.1] {
            let (mut work, steps) = (0.0, 20_000);
            for k in 0..steps {
                let j = 1.0 + (target - 1.0) * (f64::from(k) + 0.5) / f64::from(steps);
                work -= COPPER.cold(j)[0] * (target - 1.0) / f64::from(steps) / COPPER.rho0;
            }
            let energy = COPPER.cold(target)[2];
            assert!((energy / work - 1.0).abs() < 1e-6, "{target}: {energy} {work}");
        }
        // both forms of the integral agree where they meet
        let z = 1e-2 / COPPER.eta;
        let [near, far] = [(1.0 - z * 0.999_999), (1.0 - z * 1.000_001)].map(|x: f64| x.powi(3));
        let jump = COPPER.cold(far)[2] / COPPER.cold(near)[2] - 1.0;
        // change of z^2/2 (1 + 2 z/3) by 2e-6 in z
        let want = 4e-6 + 4.0 / 3.0 * 1e-2 * 1e-6;
        assert!((jump - want).abs() < 1e-10, "{jump:e}");
    }

    #[test]
    fn the_modulus_at_rest_and_its_derivative_are_the_parameters() {
        let modulus = |j: f64| {
            let p = COPPER.cold(j)[0];
            (p, -j * COPPER.cold(j)[1])
        };
        let (below, above) = (modulus(1.0 - 1e-5), modulus(1.0 + 1e-5));
        assert!((modulus(1.0).1 / 138.6e9 - 1.0).abs() < 1e-14);
        let derivative = (below.1 - above.1) / (below.0 - above.0);
        assert!((derivative / 4.96 - 1.0).abs() < 1e-6, "{derivative}");
        let at_rest = GeneralEos::at(&COPPER, 1.0, 0.0);
        assert_eq!(at_rest.pressure, 0.0);
    }
}
