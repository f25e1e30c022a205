//! Mie-Grueneisen solid with a quadratic Us-up Hugoniot and a choice of Grueneisen coefficient.
//!
//! About the Hugoniot Us = c0 + s up + s2 up^2 (the quadratic fit of Marsh 1980, LASL Shock
//! Hugoniot Data), with chi = 1 - rho0/rho = up/Us:
//!
//! ```text
//! Us(chi) = 2 c0/(a + sqrt(a^2 - 4 s2 c0 chi^2)),  a = 1 - s chi
//! p_H = rho0 chi Us^2,  e_H = p_H chi/(2 rho0)
//! chi > 0:   p = p_H + Gamma rho (e - e_H)
//! chi <= 0:  p = rho0 c0^2 chi + Gamma rho e
//! Gamma rho = gamma0 rho0  or  Gamma = gamma0, Gamma rho = gamma0 rho0/J
//! ```
//!
//! Source: Meyers (1994), Dynamic Behavior of Materials, eqs. 4.9 and 5.20. With s2 = 0 and
//! constant Gamma rho it is [`MieGruneisen`](super::MieGruneisen). Valid up to
//! [`QuadraticMieGruneisen::limiting_compression`]; the tension limit is the same as there.

use super::{EquationOfState, LinearPressure};

/// Mie-Grueneisen equation of state about the Hugoniot Us = c0 + s up + s2 up^2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadraticMieGruneisen {
    /// Density at rest rho0 [kg/m3].
    pub rho0: f64,
    /// Bulk sound speed at rest c0 [m/s].
    pub c0: f64,
    /// Slope of the Us-up curve at up = 0, s [-].
    pub s: f64,
    /// Curvature s2 of the Us-up curve [s/m].
    pub s2: f64,
    /// Grueneisen coefficient at rest gamma0 [-].
    pub gamma0: f64,
    /// Whether Gamma is constant, instead of Gamma rho.
    pub gamma_constant: bool,
}

impl QuadraticMieGruneisen {
    /// Compression 1 - rho0/rho that no shock reaches [-]: 1/(s + 2 sqrt(s2 c0)), where Us(chi)
    /// ends; for a curve that bends down, the compression at its greatest Us.
    pub fn limiting_compression(&self) -> f64 {
        if self.s2 >= 0.0 {
            return 1.0 / (self.s + 2.0 * (self.s2 * self.c0).sqrt());
        }
        let up = -0.5 * self.s / self.s2;
        up / (self.c0 + self.s * up + self.s2 * up * up)
    }

    /// Us [m/s] and dUs/dchi at a compression.
    #[inline(always)]
    fn shock_speed(&self, chi: f64) -> [f64; 2] {
        let a = 1.0 - self.s * chi;
        let us = 2.0 * self.c0 / (a + (a * a - 4.0 * self.s2 * self.c0 * chi * chi).sqrt());
        // derivative of Us = c0 + s chi Us + s2 chi^2 Us^2
        let slope = us * (self.s + 2.0 * self.s2 * chi * us) / (a - 2.0 * self.s2 * chi * chi * us);
        [us, slope]
    }

    /// Gamma rho [kg/m3] and its derivative by J.
    #[inline(always)]
    fn gruneisen_rho(&self, jacobian: f64) -> [f64; 2] {
        let at_rest = self.gamma0 * self.rho0;
        if self.gamma_constant {
            [at_rest / jacobian, -at_rest / (jacobian * jacobian)]
        } else {
            [at_rest, 0.0]
        }
    }
}

impl EquationOfState for QuadraticMieGruneisen {
    fn reference_density(&self) -> f64 {
        self.rho0
    }

    #[inline(always)]
    fn linear(&self, jacobian: f64) -> LinearPressure {
        let chi = 1.0 - jacobian;
        let [gruneisen_rho, _] = self.gruneisen_rho(jacobian);
        let compressed = chi.max(0.0);
        let [us, _] = self.shock_speed(compressed);
        let share = 1.0 - 0.5 * gruneisen_rho * compressed / self.rho0;
        LinearPressure { reference_pressure: self.rho0 * chi * us * us * share, gruneisen_rho }
    }

    #[inline(always)]
    fn sound_speed_squared(&self, jacobian: f64, pressure: f64) -> f64 {
        let chi = 1.0 - jacobian;
        let [factor, factor_slope] = self.gruneisen_rho(jacobian);
        let compressed = chi.max(0.0);
        let [us, us_slope] = self.shock_speed(compressed);
        let share = 1.0 - 0.5 * factor * compressed / self.rho0;
        let energy = (pressure - self.rho0 * chi * us * us * share) / factor;
        let along = if chi > 0.0 {
            // d/dchi of rho0 chi Us^2 share, with dfactor/dchi = -dfactor/dJ
            us * (us + 2.0 * chi * us_slope) * share
                + chi * us * us * 0.5 * (factor_slope * chi - factor) / self.rho0
        } else {
            us * us
        };
        let slope = self.rho0 * along - factor_slope * energy;
        jacobian * jacobian * (slope + factor * pressure / self.rho0) / self.rho0
    }

    #[inline(always)]
    fn check_validity(&self, jacobian: f64, pressure: f64) -> Option<&'static str> {
        if 1.0 - jacobian >= self.limiting_compression() {
            Some("compressed past the limit of its Hugoniot")
        } else if pressure < -self.rho0 * self.c0 * self.c0 / (2.0 * self.gamma0) {
            Some("stretched past the tension -rho0 c0^2/(2 gamma0) that Mie-Grueneisen can bear")
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::MieGruneisen;
    use super::super::general::tests::check_derivatives;
    use super::*;

    const CURVED: QuadraticMieGruneisen = QuadraticMieGruneisen {
        rho0: 2785.0,
        c0: 5386.0,
        s: 1.339,
        s2: 2e-5,
        gamma0: 2.1,
        gamma_constant: true,
    };

    #[test]
    fn without_a_curvature_it_is_the_straight_one() {
        let eos = QuadraticMieGruneisen { s2: 0.0, gamma_constant: false, ..CURVED };
        let straight = MieGruneisen { rho0: 2785.0, c0: 5386.0, s: 1.339, gamma0: 2.1 };
        for (j, e) in [(0.7, 3e6), (0.9, 1e5), (1.0, 0.0), (1.02, 1e4)] {
            let (a, b) = (eos.pressure(j, e), straight.pressure(j, e));
            assert!((a - b).abs() <= 1e-13 * b.abs(), "{j}: {a} {b}");
            let (a, b) = (eos.sound_speed_squared(j, a), straight.sound_speed_squared(j, b));
            assert!((a / b - 1.0).abs() < 1e-13, "{j}: {a} {b}");
        }
        assert_eq!(eos.limiting_compression(), straight.limiting_compression());
    }

    #[test]
    fn derivatives() {
        let states = [[0.7, 3e6, 0.0], [0.89, 2.4e5, 0.0], [0.999, 1e2, 0.0], [1.03, 1e4, 0.0]];
        for s2 in [2e-5, -3e-5] {
            for gamma_constant in [true, false] {
                let eos = QuadraticMieGruneisen { s2, gamma_constant, ..CURVED };
                check_derivatives(&eos, &states, 1e-6);
            }
        }
    }

    #[test]
    fn hugoniot_states_keep_the_jump_conditions() {
        for s2 in [2e-5, -3e-5] {
            let eos = QuadraticMieGruneisen { s2, ..CURVED };
            for up in [10.0, 700.0, 2500.0] {
                let us = eos.c0 + eos.s * up + s2 * up * up;
                let state = eos.pressure(1.0 - up / us, 0.5 * up * up);
                assert!((state / (eos.rho0 * us * up) - 1.0).abs() < 1e-12, "{up}");
            }
        }
    }

    #[test]
    fn the_limit_is_where_the_hugoniot_ends() {
        let chi = CURVED.limiting_compression();
        assert!(CURVED.linear(1.0 - 0.999 * chi).reference_pressure.is_finite());
        assert!(CURVED.linear(1.0 - 1.001 * chi).reference_pressure.is_nan());
        assert!(CURVED.check_validity(1.0 - 1.001 * chi, f64::NAN).is_some());
    }
}
