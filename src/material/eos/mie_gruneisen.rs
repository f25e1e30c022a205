//! Mie-Grueneisen solid with a linear Us-up Hugoniot and constant Gamma rho.
//!
//! With chi = 1 - rho0/rho = 1 - J and f the pressure without its energy part,
//!
//! ```text
//! chi > 0:   f = rho0 c0^2 chi (1 - gamma0 chi/2) / (1 - s chi)^2
//! chi <= 0:  f = rho0 c0^2 chi
//! p = f + gamma0 rho0 e
//! c^2 = (1 - chi)^2 (f' + gamma0 p) / rho0
//! ```
//!
//! Source: Meyers (1994), Dynamic Behavior of Materials, eqs. 4.44 and 5.20; Uintah's shock EOS has
//! the same form. Valid for chi < 1/s. The form has no tension limit of its own, so a state with
//! c^2 < 0, or with p below -rho0 c0^2/(2 gamma0), is a fault.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    Eos, EosParameters, EquationOfState, LinearPressure, Made, PlainEosVisitor,
    QuadraticMieGruneisen,
};

/// Mie-Grueneisen equation of state about the Hugoniot Us = c0 + s up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MieGruneisen {
    /// Density at rest rho0 [kg/m3].
    pub rho0: f64,
    /// Bulk sound speed at rest c0 [m/s].
    pub c0: f64,
    /// Slope of the Us-up line s [-].
    pub s: f64,
    /// Grueneisen coefficient at rest gamma0 [-]; Gamma rho = gamma0 rho0.
    pub gamma0: f64,
}

impl MieGruneisen {
    /// Compression 1 - rho0/rho that no shock reaches: 1/s [-].
    pub fn limiting_compression(&self) -> f64 {
        1.0 / self.s
    }

    /// f'(chi), the derivative by compression of the pressure without its energy part [Pa].
    pub fn cold_slope(&self, chi: f64) -> f64 {
        let stiffness = self.rho0 * self.c0 * self.c0;
        if chi > 0.0 {
            let r = 1.0 / (1.0 - self.s * chi);
            // d/dchi of chi (1 - g chi/2) (1 - s chi)^-2
            stiffness * r * r * r * (1.0 + self.s * chi - self.gamma0 * chi)
        } else {
            stiffness
        }
    }
}

impl EquationOfState for MieGruneisen {
    fn reference_density(&self) -> f64 {
        self.rho0
    }

    #[inline(always)]
    fn linear(&self, jacobian: f64) -> LinearPressure {
        let chi = 1.0 - jacobian;
        let compressed = chi.max(0.0);
        let r = 1.0 / (1.0 - self.s * compressed);
        LinearPressure {
            reference_pressure: self.rho0
                * self.c0
                * self.c0
                * chi
                * (1.0 - 0.5 * self.gamma0 * compressed)
                * r
                * r,
            gruneisen_rho: self.gamma0 * self.rho0,
        }
    }

    #[inline(always)]
    fn sound_speed_squared(&self, jacobian: f64, pressure: f64) -> f64 {
        let chi = 1.0 - jacobian;
        let compressed = chi.max(0.0);
        let r = 1.0 / (1.0 - self.s * compressed);
        let slope = self.rho0
            * self.c0
            * self.c0
            * (r * r * r * (1.0 + (self.s - self.gamma0) * compressed));
        jacobian * jacobian * (slope + self.gamma0 * pressure) / self.rho0
    }

    #[inline(always)]
    fn check_validity(&self, jacobian: f64, pressure: f64) -> Option<&'static str> {
        if 1.0 - jacobian >= self.limiting_compression() {
            Some("compressed past the limit 1/s of its Hugoniot")
        } else if pressure < -self.rho0 * self.c0 * self.c0 / (2.0 * self.gamma0) {
            Some("stretched past the tension -rho0 c0^2/(2 gamma0) that Mie-Grueneisen can bear")
        } else {
            None
        }
    }
}

/// Mie-Grueneisen solid about the Hugoniot Us = c0 + s up + s2 up^2.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MieGruneisenParameters {
    /// Bulk sound speed c0 of the material at rest, the shock speed Us of a very weak shock [m/s].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub c0: f64,
    /// Slope s of the shock speed Us over the particle velocity up [-]. A larger value makes
    /// compressed material stiffer.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub s: f64,
    /// Curvature s2 of the shock speed Us over the particle velocity up [s/m]; absent: 0, a
    /// straight line.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub s2: f64,
    /// Grueneisen coefficient Gamma of the material at rest [-]. A larger value gives more pressure
    /// per internal energy.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub gamma0: f64,
    /// Form of the Grueneisen coefficient that does not change with density; absent:
    /// `gamma_rho_constant`.
    #[serde(default, skip_serializing_if = "Gruneisen::is_default")]
    pub gruneisen: Gruneisen,
    /// Greatest tension that the material carries [Pa]; absent: no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0.0))]
    pub tension_cutoff: Option<f64>,
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// Which form of the Grueneisen coefficient Gamma is constant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Gruneisen {
    /// The product of Gamma and the density is constant.
    #[default]
    GammaRhoConstant,
    /// Gamma is constant.
    GammaConstant,
}

impl Gruneisen {
    fn is_default(&self) -> bool {
        *self == Gruneisen::default()
    }
}

impl EosParameters for MieGruneisenParameters {
    fn check_initial_pressure(&self, density: f64, pressure: f64) -> Result<(), String> {
        let Some(cutoff) = self.tension_cutoff else {
            let least = -density * self.c0 * self.c0 / (2.0 * self.gamma0);
            let why = "the tension -density c0^2/(2 gamma0) that Mie-Grueneisen can bear";
            return super::at_least(pressure, least, why);
        };
        super::within_cutoff(pressure, Some(cutoff))
    }

    fn visit_plain<V: PlainEosVisitor>(&self, rho0: f64, visitor: V) -> Made<V> {
        let &MieGruneisenParameters { c0, s, s2, gamma0, gruneisen, tension_cutoff } = self;
        if s2 == 0.0 && gruneisen.is_default() {
            let eos = MieGruneisen { rho0, c0, s, gamma0 };
            return Ok(Some(super::limited(visitor, eos, tension_cutoff)));
        }
        let gamma_constant = gruneisen == Gruneisen::GammaConstant;
        let eos = QuadraticMieGruneisen { rho0, c0, s, s2, gamma0, gamma_constant };
        Ok(Some(super::limited(visitor, eos, tension_cutoff)))
    }
}

impl Eos {
    /// Mie-Grueneisen material of `density` [kg/m3] with a straight Us-up line, constant Gamma rho
    /// and unlimited tension, for which the exact solutions of impacts are made; `None` for all
    /// others.
    pub fn straight(&self, density: f64) -> Option<MieGruneisen> {
        let Eos::MieGruneisen(p) = self else { return None };
        let straight = p.s2 == 0.0 && p.gruneisen.is_default() && p.tension_cutoff.is_none();
        straight.then_some(MieGruneisen { rho0: density, c0: p.c0, s: p.s, gamma0: p.gamma0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALUMINIUM: MieGruneisen =
        MieGruneisen { rho0: 2785.0, c0: 5386.0, s: 1.339, gamma0: 2.1 };

    #[test]
    fn sound_speed_is_the_isentropic_derivative_of_pressure() {
        for (jacobian, energy) in [(0.7, 3e6), (0.89, 2.4e5), (0.999, 0.0), (1.05, 1e4)] {
            let p = ALUMINIUM.pressure(jacobian, energy);
            let h = 1e-5;
            // along the isentrope de = -p dv = -p dJ/rho0
            let at = |dj: f64| {
                let mid = ALUMINIUM.pressure(jacobian + 0.5 * dj, energy - 0.5 * p * dj / 2785.0);
                ALUMINIUM.pressure(jacobian + dj, energy - mid * dj / 2785.0)
            };
            let dp_drho = (at(-h) - at(h)) / (2785.0 / (jacobian - h) - 2785.0 / (jacobian + h));
            let c2 = ALUMINIUM.sound_speed_squared(jacobian, p);
            assert!((c2 / dp_drho - 1.0).abs() < 1e-7, "{jacobian}: {c2} {dp_drho}");
        }
    }

    #[test]
    fn cold_slope_is_the_derivative_of_the_cold_pressure() {
        for chi in [-0.1, 0.01, 0.2, 0.4] {
            let h = 1e-6;
            let f = |c: f64| ALUMINIUM.linear(1.0 - c).reference_pressure;
            let slope = (f(chi + h) - f(chi - h)) / (2.0 * h);
            assert!((ALUMINIUM.cold_slope(chi) / slope - 1.0).abs() < 1e-7);
        }
    }

    #[test]
    fn hugoniot_states_keep_the_jump_conditions() {
        let up = 690.935777;
        let us = ALUMINIUM.c0 + ALUMINIUM.s * up;
        let p = ALUMINIUM.rho0 * us * up;
        assert!((p / 12.144294e9 - 1.0).abs() < 1e-7);
        let state = ALUMINIUM.pressure(1.0 - up / us, 0.5 * up * up);
        assert!((state / p - 1.0).abs() < 1e-13);
    }
}
