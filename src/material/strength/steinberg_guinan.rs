//! Steinberg & Guinan's strength at high rates, where the rate has no influence any more.
//!
//! ```text
//! g = 1 + A p/eta^(1/3) - B (T - 300),  eta = rho/rho0
//! G = G0 g
//! Y = min(Y0 (1 + beta (ep + ei))^n, Ymax) g
//! ```
//!
//! and neither below 0. Source: Steinberg, Cochran & Guinan (1980), A constitutive model for metals
//! applicable at high strain rate, eqs. 1 to 3; A = G'p/G0, B = -G'T/G0, the ratio Y'p/Y0 = A as
//! there.

use super::{Condition, Strength};

/// Steinberg & Guinan's model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteinbergGuinan {
    /// Shear modulus G0 at rest [Pa].
    pub shear_modulus: f64,
    /// Yield stress Y0 at rest [Pa].
    pub yield_stress: f64,
    /// Hardening beta [-].
    pub beta: f64,
    /// Its exponent n [-].
    pub n: f64,
    /// Plastic strain at the start ei [-].
    pub initial_strain: f64,
    /// Most that hardening reaches, Ymax [Pa].
    pub most: f64,
    /// Growth A with pressure [1/Pa].
    pub by_pressure: f64,
    /// Fall B with temperature [1/K]; none without a temperature.
    pub by_temperature: Option<f64>,
}

impl SteinbergGuinan {
    #[inline(always)]
    fn growth(&self, at: &Condition) -> f64 {
        let pressed = self.by_pressure * at.pressure / at.compression.cbrt();
        let warm = self.by_temperature.map_or(0.0, |b| b * (at.temperature - 300.0));
        (1.0 + pressed - warm).max(0.0)
    }
}

impl Strength for SteinbergGuinan {
    #[inline(always)]
    fn shear_modulus(&self, at: &Condition) -> f64 {
        self.shear_modulus * self.growth(at)
    }

    #[inline(always)]
    fn yield_stress(&self, strain: f64, _: f64, at: &Condition) -> f64 {
        let hardened = (1.0 + self.beta * (strain + self.initial_strain)).powf(self.n);
        (self.yield_stress * hardened).min(self.most) * self.growth(at)
    }
}

/// Copper, Steinberg (1996).
#[cfg(test)]
pub(super) const COPPER: SteinbergGuinan = SteinbergGuinan {
    shear_modulus: 47.7e9,
    yield_stress: 0.12e9,
    beta: 36.0,
    n: 0.45,
    initial_strain: 0.0,
    most: 0.64e9,
    by_pressure: 28.3e-12,
    by_temperature: Some(0.377e-3),
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_moduli_follow_the_paper() {
        let model = COPPER;
        let at = Condition { compression: 1.331, pressure: 30e9, temperature: 700.0 };
        let growth = 1.0 + 28.3e-12 * 30e9 / 1.1 - 0.377e-3 * 400.0;
        assert!((model.shear_modulus(&at) / (47.7e9 * growth) - 1.0).abs() < 1e-14);
        let y = |strain| model.yield_stress(strain, 0.0, &at);
        assert!((y(0.1) / (0.12e9 * 4.6f64.powf(0.45) * growth) - 1.0).abs() < 1e-14);
        assert!((y(9.0) / (0.64e9 * growth) - 1.0).abs() < 1e-14, "the most");
        let hot = Condition { temperature: 9000.0, ..at };
        assert_eq!((model.shear_modulus(&hot), model.yield_stress(0.1, 0.0, &hot)), (0.0, 0.0));
    }
}
