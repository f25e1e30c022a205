//! Johnson & Cook's yield stress.
//!
//! ```text
//! Y = (A + B ep^n) (1 + C ln max(1, rate/rate0)) (1 - T*^m)
//! T* = (T - T0)/(Tm - T0), between 0 and 1
//! ```
//!
//! Source: Johnson & Cook (1983), A constitutive model and data for metals subjected to large
//! strains, high strain rates and high temperatures, eqs. 1 and 2. Below the reference rate, where
//! the logarithm would be negative, the rate has no influence.

use super::{Condition, Strength};

/// Johnson & Cook's model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JohnsonCook {
    /// Shear modulus G [Pa].
    pub shear_modulus: f64,
    /// Yield stress A at no plastic strain [Pa].
    pub a: f64,
    /// Hardening B [Pa].
    pub b: f64,
    /// Exponent n of the plastic strain [-].
    pub n: f64,
    /// Coefficient C of the rate's logarithm [-].
    pub c: f64,
    /// Rate from which on it counts [1/s].
    pub reference_rate: f64,
    /// Softening by temperature, if there is any.
    pub softening: Option<Softening>,
}

/// Softening by temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Softening {
    /// Exponent m [-].
    pub m: f64,
    /// Temperature T0 below which there is none [K].
    pub room: f64,
    /// Melting temperature Tm [K].
    pub melt: f64,
}

impl Strength for JohnsonCook {
    #[inline(always)]
    fn shear_modulus(&self, _: &Condition) -> f64 {
        self.shear_modulus
    }

    #[inline(always)]
    fn yield_stress(&self, strain: f64, rate: f64, at: &Condition) -> f64 {
        let hardened = if strain > 0.0 { self.b * strain.powf(self.n) } else { 0.0 };
        let fast = (rate / self.reference_rate).max(1.0).ln();
        let cold = match self.softening {
            None => 1.0,
            Some(Softening { m, room, melt }) => {
                let warm = ((at.temperature - room) / (melt - room)).clamp(0.0, 1.0);
                1.0 - if warm > 0.0 { warm.powf(m) } else { 0.0 }
            }
        };
        (self.a + hardened) * (1.0 + self.c * fast) * cold
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_factor_is_that_of_the_paper() {
        let model = JohnsonCook {
            shear_modulus: 46e9,
            a: 90e6,
            b: 292e6,
            n: 0.31,
            c: 0.025,
            reference_rate: 1.0,
            softening: Some(Softening { m: 1.09, room: 294.0, melt: 1356.0 }),
        };
        let at = |temperature: f64| Condition { compression: 1.0, pressure: 0.0, temperature };
        let y = |strain, rate, t| model.yield_stress(strain, rate, &at(t));
        assert_eq!(y(0.0, 0.0, 294.0), 90e6);
        assert!((y(0.3, 1.0, 294.0) - (90e6 + 292e6 * 0.3f64.powf(0.31))).abs() < 1e-3);
        assert!((y(0.0, 1e4, 294.0) / (90e6 * (1.0 + 0.025 * 1e4f64.ln())) - 1.0).abs() < 1e-14);
        let warm: f64 = (800.0 - 294.0) / (1356.0 - 294.0);
        assert!((y(0.0, 1.0, 800.0) / (90e6 * (1.0 - warm.powf(1.09))) - 1.0).abs() < 1e-14);
        assert_eq!(y(0.5, 1e6, 1400.0), 0.0);
        assert_eq!(y(0.5, 1e-9, 294.0), y(0.5, 1.0, 294.0));
    }
}
