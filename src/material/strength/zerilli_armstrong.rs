//! Zerilli & Armstrong's yield stress, from the motion of dislocations.
//!
//! ```text
//! Y = c0 + (c1 + c2 ep^(1/2)) exp(-c3 T + c4 T ln max(1, rate/reference_rate)) + c5 ep^n
//! ```
//!
//! Source: Zerilli & Armstrong (1987), Dislocation-mechanics-based constitutive relations for
//! material dynamics calculations, eq. 7 (body-centred cubic metals: c2 = 0) and eq. 8
//! (face-centred: c1 = c5 = 0). Their constants take the rate in 1/s, so the reference rate is 1;
//! below it the rate has no influence.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{MaterialState, StrengthLaw, one};
use crate::material::ParameterError;

/// Zerilli & Armstrong (1987), Y = c0 + (c1 + c2 ep^(1/2)) exp(-c3 T + c4 T ln max(1,
/// rate/reference_rate)) + c5 ep^n; needs `thermal`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ZerilliArmstrong {
    /// Shear modulus G, the elastic shear stress over the shear strain [Pa]. It is constant.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub shear_modulus: f64,
    /// Part of the yield stress that depends on neither temperature nor rate [Pa].
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub c0: f64,
    /// Thermally activated stress at zero plastic strain, for body-centred cubic metals [Pa].
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub c1: f64,
    /// Thermally activated stress that grows with the root of the plastic strain, for face-centred
    /// cubic metals [Pa].
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub c2: f64,
    /// Coefficient c3 of the thermal softening exp(-c3 T) [1/K]. With a larger value the yield
    /// stress falls more with temperature.
    #[schemars(range(min = 0.0))]
    pub c3: f64,
    /// Coefficient c4 of temperature times the logarithm of the rate [1/K]. With a larger value the
    /// yield stress grows more with the rate.
    #[schemars(range(min = 0.0))]
    pub c4: f64,
    /// Coefficient c5 of the hardening c5 ep^n, for body-centred cubic metals [Pa]; default 0.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub c5: f64,
    /// Exponent n of the plastic strain in the hardening c5 ep^n [-]; default 1.
    #[serde(default = "one")]
    #[schemars(range(max = 5.0), extend("exclusiveMinimum" = 0.0))]
    pub n: f64,
    /// Strain rate below which the rate has no influence [1/s].
    #[serde(default = "one")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub reference_rate: f64,
}

impl StrengthLaw for ZerilliArmstrong {
    fn needs_temperature(&self) -> Option<&'static str> {
        Some("c3")
    }

    fn check(&self) -> Result<(), ParameterError> {
        if self.c0 + self.c1 + self.c2 + self.c5 <= 0.0 {
            let reason = "with c0, c1 and c2 = 0 there is no yield stress; allowed: one of them \
                          above 0";
            return Err(ParameterError::new("c5", self.c5, reason));
        }
        Ok(())
    }

    #[inline(always)]
    fn shear_modulus(&self, _: &MaterialState) -> f64 {
        self.shear_modulus
    }

    #[inline(always)]
    fn yield_stress(&self, strain: f64, rate: f64, at: &MaterialState) -> f64 {
        let fast = (rate / self.reference_rate).max(1.0).ln();
        let activated = (at.temperature * (self.c4 * fast - self.c3)).exp();
        let hardened = if strain > 0.0 { self.c5 * strain.powf(self.n) } else { 0.0 };
        self.c0 + (self.c1 + self.c2 * strain.sqrt()) * activated + hardened
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COPPER: ZerilliArmstrong = ZerilliArmstrong {
        shear_modulus: 46e9,
        c0: 65e6,
        c1: 0.0,
        c2: 890e6,
        c3: 2.8e-3,
        c4: 1.15e-4,
        c5: 0.0,
        n: 1.0,
        reference_rate: 1.0,
    };

    const IRON: ZerilliArmstrong = ZerilliArmstrong {
        shear_modulus: 80e9,
        c0: 0.0,
        c1: 1033e6,
        c2: 0.0,
        c3: 6.98e-3,
        c4: 4.15e-4,
        c5: 266e6,
        n: 0.289,
        reference_rate: 1.0,
    };

    /// Copper and iron of the paper, compared with values of the formula from an independent
    /// program.
    #[test]
    fn yield_stresses_are_those_of_the_paper() {
        for (law, strain, rate, temperature, want) in [
            (COPPER, 0.3, 6000.0, 294.0, 352196213.8748622),
            (COPPER, 0.3, 6000.0, 600.0, 230587801.73039648),
            (IRON, 0.1, 1e4, 300.0, 537314148.6287941),
            (IRON, 0.0, 1e4, 300.0, 400578537.3078687),
        ] {
            let at = MaterialState { compression: 1.0, pressure: 0.0, temperature };
            let y = law.yield_stress(strain, rate, &at);
            assert!((y / want - 1.0).abs() < 1e-12, "{y}");
        }
        let at = MaterialState { compression: 1.0, pressure: 0.0, temperature: 300.0 };
        assert_eq!(COPPER.yield_stress(0.2, 1e-3, &at), COPPER.yield_stress(0.2, 1.0, &at));
        assert_eq!(COPPER.yield_stress(0.0, 1e5, &at), 65e6);
    }

    #[test]
    fn parameters_must_fit() {
        assert_eq!(COPPER.check(), Ok(()));
        assert_eq!(COPPER.needs_temperature(), Some("c3"));
        let none = ZerilliArmstrong { c0: 0.0, c2: 0.0, ..COPPER };
        assert_eq!(none.check().unwrap_err().key, "c5");
    }
}
