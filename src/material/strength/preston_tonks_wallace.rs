//! Preston, Tonks & Wallace's flow stress for rates up to 1e12/s.
//!
//! ```text
//! Y = 2 G t,   G = G0 (1 + A p/eta^(1/3)) (1 - alpha T*),   T* = T/Tm,   eta = rho/rho0
//! x = gamma/2 (4 pi rho/(3 M))^(1/3) (G/rho)^(1/2)
//! ts = max(s0 - (s0 - s_inf) erf(kappa T* ln(x/rate)), s0 (rate/x)^beta)
//! ty = max(y0 - (y0 - y_inf) erf(kappa T* ln(x/rate)), min(y1 (rate/x)^y2, s0 (rate/x)^beta))
//! t  = ts + (s0 - ty)/p ln(1 - (1 - 1/E) exp(-p theta ep/((s0 - ty)(E - 1)))),
//! E  = exp(p (ts - ty)/(s0 - ty));   p = 0: t = ts - (ts - ty) exp(-theta ep/(ts - ty))
//! ```
//!
//! Source: Preston, Tonks & Wallace (2003), Model of plastic deformation for extreme loading
//! conditions, J. Appl. Phys. 93, 211, eqs. 2, 4, 5, 15 and 16. The shear modulus grows with
//! pressure as in Steinberg & Guinan's model. The melting temperature is constant; above it there
//! is no strength.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{MaterialState, StrengthLaw};
use crate::material::ParameterError;

/// Preston, Tonks & Wallace (2003), for rates up to 1e12/s; needs `thermal`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PrestonTonksWallace {
    /// Shear modulus G0 at zero temperature and pressure [Pa].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub shear_modulus: f64,
    /// Fraction alpha by which the shear modulus falls from zero temperature to melting [-].
    #[schemars(range(min = 0.0, max = 1.0))]
    pub alpha: f64,
    /// Growth of the shear modulus with pressure, A = G'p/G0 [1/Pa].
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub pressure_hardening: f64,
    /// Melting temperature Tm, which does not change with pressure [K]; above it there is no
    /// strength.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub melt_temperature: f64,
    /// Mass M of one atom [kg], for the rate at which a shear wave crosses an atom, by which strain
    /// rates are scaled.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub atomic_mass: f64,
    /// Initial hardening theta, the slope of the flow stress over 2 G with the plastic strain at
    /// the yield stress [-].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub theta: f64,
    /// Constant p of the hardening [-]; 0: the flow stress approaches saturation exponentially
    /// (Voce).
    #[schemars(range(min = 0.0))]
    pub p: f64,
    /// Saturation stress, the flow stress at large strain, over 2 G at zero temperature [-]; at
    /// least `s_inf` and `y0`.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub s0: f64,
    /// Saturation stress, the flow stress at large strain, over 2 G near melting [-]; at least
    /// `y_inf`.
    #[schemars(range(min = 0.0))]
    pub s_inf: f64,
    /// Factor kappa of the temperature in the thermal activation [-]. With a larger value the flow
    /// stress falls faster with temperature.
    #[schemars(range(min = 0.0))]
    pub kappa: f64,
    /// Factor gamma of the rate by which strain rates are scaled [-]. With a larger value high
    /// rates raise the flow stress less.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub gamma: f64,
    /// Yield stress over 2 G at zero temperature [-]; at least `y_inf`.
    #[schemars(range(min = 0.0))]
    pub y0: f64,
    /// Yield stress over 2 G near melting, y_inf [-].
    #[schemars(range(min = 0.0))]
    pub y_inf: f64,
    /// Factor y1 of the yield stress over 2 G at medium strain rates, y1 (rate/x)^y2 [-].
    #[schemars(range(min = 0.0))]
    pub y1: f64,
    /// Exponent y2 of the strain rate in the yield stress at medium rates [-].
    #[schemars(range(min = 0.0))]
    pub y2: f64,
    /// Exponent beta of the strain rate in the flow stress of overdriven shocks [-]. With a larger
    /// value the flow stress grows more with the rate.
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 1.0))]
    pub beta: f64,
    /// Density of the material at rest [kg/m3].
    #[serde(skip)]
    pub density: f64,
}

impl StrengthLaw for PrestonTonksWallace {
    fn needs_temperature(&self) -> Option<&'static str> {
        Some("melt_temperature")
    }

    fn check(&self) -> Result<(), ParameterError> {
        let ordered = [
            ("s_inf", self.s_inf, "s0", self.s0),
            ("y0", self.y0, "s0", self.s0),
            ("y_inf", self.y_inf, "y0", self.y0),
            ("y_inf", self.y_inf, "s_inf", self.s_inf),
        ];
        for (key, value, above, limit) in ordered {
            if value > limit {
                let reason = format!("allowed: at most {above} = {limit}");
                return Err(ParameterError::new(key, value, reason));
            }
        }
        Ok(())
    }

    fn with_density(self, density: f64) -> Self {
        PrestonTonksWallace { density, ..self }
    }

    #[inline(always)]
    fn shear_modulus(&self, at: &MaterialState) -> f64 {
        let warm = at.temperature / self.melt_temperature;
        if warm >= 1.0 {
            return 0.0;
        }
        let pressed = self.pressure_hardening * at.pressure / at.compression.cbrt();
        self.shear_modulus * (1.0 + pressed).max(0.0) * (1.0 - self.alpha * warm)
    }

    fn yield_stress(&self, strain: f64, rate: f64, at: &MaterialState) -> f64 {
        let modulus = self.shear_modulus(at);
        if modulus <= 0.0 {
            return 0.0;
        }
        let density = self.density * at.compression;
        let number_density = density / self.atomic_mass;
        let spacing = (4.0 / 3.0 * std::f64::consts::PI * number_density).cbrt();
        let fastest = 0.5 * self.gamma * spacing * (modulus / density).sqrt();
        // a rate of 0 has no logarithm
        let slow = fastest.ln() - rate.max(f64::MIN_POSITIVE).ln();
        let warm = (at.temperature / self.melt_temperature).max(0.0);
        let activated = libm::erf(self.kappa * warm * slow);
        let overdriven = self.s0 * (-self.beta * slow).exp();
        let saturated = (self.s0 - (self.s0 - self.s_inf) * activated).max(overdriven);
        let medium = (self.y1 * (-self.y2 * slow).exp()).min(overdriven);
        let first = (self.y0 - (self.y0 - self.y_inf) * activated).max(medium);
        let (rise, reach) = (saturated - first, self.s0 - first);
        let stress = if rise <= 0.0 {
            saturated
        } else if self.p * rise < 1e-8 * reach.abs() || reach <= 0.0 {
            saturated - rise * (-self.theta * strain / rise).exp()
        } else {
            let grown = (self.p * rise / reach).exp_m1();
            let fallen = (-self.p * self.theta * strain / (reach * grown)).exp();
            saturated + reach / self.p * (-grown / (1.0 + grown) * fallen).ln_1p()
        };
        2.0 * modulus * stress
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Copper, table 1 of the paper, at 8930 kg/m3.
    const COPPER: PrestonTonksWallace = PrestonTonksWallace {
        shear_modulus: 51.8e9,
        alpha: 0.2,
        pressure_hardening: 0.0,
        melt_temperature: 1357.0,
        atomic_mass: 63.546 * 1.66053906660e-27,
        theta: 0.025,
        p: 2.0,
        s0: 0.0085,
        s_inf: 0.00055,
        kappa: 0.11,
        gamma: 1e-5,
        y0: 1e-4,
        y_inf: 1e-4,
        y1: 0.094,
        y2: 0.575,
        beta: 0.25,
        density: 8930.0,
    };

    fn at(temperature: f64) -> MaterialState {
        MaterialState { compression: 1.0, pressure: 0.0, temperature }
    }

    /// Compares with values of the formulas from an independent program.
    #[test]
    fn flow_stresses_are_those_of_the_paper() {
        for (strain, rate, temperature, want) in [
            (0.0, 1e3, 300.0, 13785184.265553197),
            (0.1, 1e3, 300.0, 193780116.54249334),
            (0.3, 1e5, 300.0, 491502825.29193234),
            (0.3, 1e9, 300.0, 1566569290.4086945),
            (0.5, 1e-3, 600.0, 114996073.45394231),
        ] {
            let y = COPPER.yield_stress(strain, rate, &at(temperature));
            assert!((y / want - 1.0).abs() < 1e-9, "{strain} {rate} {temperature}: {y}");
        }
    }

    #[test]
    fn it_grows_with_strain_and_rate_and_melts() {
        let y = |strain, rate| COPPER.yield_stress(strain, rate, &at(300.0));
        let mut last = 0.0;
        for k in 0..60 {
            let now = y(0.02 * f64::from(k), 1e4);
            assert!(now >= last && now.is_finite(), "{k}: {now}");
            last = now;
        }
        let mut last = 0.0;
        for power in -20..13 {
            let now = y(0.1, 10f64.powi(power));
            assert!(now >= last && now.is_finite(), "{power}: {now}");
            last = now;
        }
        assert!(y(0.1, 0.0) > 0.0);
        assert!(COPPER.yield_stress(0.1, 0.0, &at(0.0)) > y(0.1, 0.0), "cold and slow");
        assert_eq!(COPPER.yield_stress(0.1, 1e4, &at(1400.0)), 0.0);
        // Voce's law is the limit of small p
        let voce = PrestonTonksWallace { p: 0.0, ..COPPER };
        let near = PrestonTonksWallace { p: 1e-4, ..COPPER };
        let [a, b] = [voce, near].map(|law| law.yield_stress(0.1, 1e4, &at(300.0)));
        assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
    }

    #[test]
    fn parameters_must_fit() {
        assert_eq!(COPPER.check(), Ok(()));
        assert_eq!(COPPER.needs_temperature(), Some("melt_temperature"));
        let wrong = PrestonTonksWallace { s_inf: 0.02, ..COPPER };
        assert_eq!(wrong.check().unwrap_err().key, "s_inf");
    }
}
