//! A yield stress that grows with the plastic strain along a line, or not at all.
//!
//! ```text
//! Y = Y0 + H ep
//! ```
//!
//! Source: von Mises (1913).

use super::{Condition, Strength};

/// Von Mises' yield surface with linear isotropic hardening.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VonMises {
    /// Shear modulus G [Pa].
    pub shear_modulus: f64,
    /// Yield stress Y0 at no plastic strain [Pa].
    pub yield_stress: f64,
    /// Hardening H [Pa].
    pub hardening: f64,
}

impl Strength for VonMises {
    #[inline(always)]
    fn shear_modulus(&self, _: &Condition) -> f64 {
        self.shear_modulus
    }

    #[inline(always)]
    fn yield_stress(&self, strain: f64, _: f64, _: &Condition) -> f64 {
        self.yield_stress + self.hardening * strain
    }
}
