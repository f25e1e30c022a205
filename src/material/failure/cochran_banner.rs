//! Spall by cracks that open: a tensile strength that falls as their volume grows
//!
//! ```text
//! -p <= Sigma0 (1 - D^x)               D = (volume of the cracks per area)/D0
//! -p = K (theta - D D0/h)              theta: volume strain,  h: edge of a cell
//! ```
//!
//! After Cochran & Banner (1977), Spall studies in uranium, J. Appl. Phys. 48, 2729: two constants
//! describe a spall, the tension Sigma0 at which cracks begin to open, and the volume D0 of cracks
//! per area at which nothing holds. Where the tension would exceed the strength, cracks open until
//! it does not. As D0 is a length, a spall takes the energy
//!
//! ```text
//! integral of the strength over the opening = Sigma0 D0 x/(1 + x)
//! ```
//!
//! per area, whatever the size of the cells. Cracks that open in the cells beside it take energy
//! too. The exponent x = 2/3 is that of cracks that grow alike in all directions: their area, the
//! share of the section that is lost, goes as their volume to the power 2/3. Shear modulus and yield
//! stress fall by the same function.
//!
//! The cracks close when the tension ends, and carry pressure when the volume is that of the intact
//! material again; the strength that is lost is not regained. The exponent and the closing have not
//! been compared with the text of the paper.
//!
//! In a run cracks open at the end of a step, so that the tension within it exceeds the strength. The
//! energy is then above the given one by a part that falls with the step: 32 % at a Courant number of
//! 0.4, 10 % at 0.1 in a spall of aluminium. In a cell of h >= K D0/Sigma0 more elastic energy is
//! stored than the cracks take: it fails at once, and releases that energy instead.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Carried, FailureLaw, PressureLimit, RestState, StrengthBeside, StressState};

/// Cochran & Banner (1977): cracks open where the tension exceeds a strength that falls with their
/// volume, `stress` (1 - D^exponent), and the material carries nothing when their volume per area
/// reaches `opening`. The energy per area of a spall does not depend on the cells.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CochranBanner {
    /// Tension (minus the pressure) at which cracks begin to open, Sigma0 [Pa].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub stress: f64,
    /// Volume D0 of the cracks per area at which the material carries nothing [m]. A spall takes
    /// the energy Sigma0 D0 x/(1 + x) per area, so that a larger value makes the material tougher.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub opening: f64,
    /// Exponent x of the damage D in the strength Sigma0 (1 - D^x) [-]; default 2/3. With a smaller
    /// value the strength falls faster when cracks begin to open.
    #[serde(default = "two_thirds")]
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 1.0))]
    pub exponent: f64,
    /// Volume strain of the cracks at failure, D0/h [-].
    #[serde(skip)]
    pub strain: f64,
    /// Bulk modulus of the material at rest, K [Pa].
    #[serde(skip)]
    pub bulk_modulus: f64,
}

fn two_thirds() -> f64 {
    2.0 / 3.0
}

/// Number of bisections, which find the damage to rounding.
const BISECTIONS: usize = 60;

impl CochranBanner {
    /// Share of the strength that is left at a `damage` [-].
    fn strength(&self, damage: f64) -> f64 {
        1.0 - damage.powf(self.exponent)
    }

    /// Tension at the damage `after` less the strength there [Pa], if the tension is `tension` at
    /// the damage `before` and the volume stays.
    fn excess(&self, tension: f64, before: f64, after: f64) -> f64 {
        let relieved = self.bulk_modulus * self.strain * (after - before);
        tension - relieved - self.stress * self.strength(after)
    }
}

impl FailureLaw for CochranBanner {
    const GRADUAL: bool = true;

    fn with_rest_state(self, rest: &RestState) -> Self {
        let strain = self.opening / rest.cell;
        CochranBanner { strain, bulk_modulus: rest.bulk_modulus, ..self }
    }

    fn pressure_limit(&self, _: &StrengthBeside) -> Option<PressureLimit> {
        Some(PressureLimit { key: "stress", tension: self.stress })
    }

    fn damage(&self, before: f64, state: &StressState, _: &StrengthBeside) -> f64 {
        let tension = -state.pressure;
        let excess = |after: f64| self.excess(tension, before, after);
        if tension <= 0.0 || excess(before) <= 0.0 {
            return before;
        }
        // there no tension is left, so that the excess is not above 0; as it is a concave function
        // of the damage, it changes its sign once
        let relieved = before + tension / (self.bulk_modulus * self.strain);
        if relieved >= 1.0 {
            return 1.0;
        }
        let [mut low, mut high] = [before, relieved];
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if excess(middle) > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }

    fn carried(&self, damage: f64) -> Carried {
        // rounding leaves no strength at a damage just below 1
        let shear = self.strength(damage).max(f64::EPSILON);
        Carried { tension: 1.0, shear, opening: damage * self.strain }
    }
}

#[cfg(test)]
mod tests {
    use super::super::stressed;
    use super::*;

    const BULK_MODULUS: f64 = 100e9;

    fn law(cell: f64, exponent: f64) -> CochranBanner {
        let rest =
            RestState { density: 8000.0, bulk_modulus: BULK_MODULUS, shear_modulus: 0.0, cell };
        let law =
            CochranBanner { stress: 2e9, opening: 20e-6, exponent, strain: 0.0, bulk_modulus: 0.0 };
        law.with_rest_state(&rest)
    }

    /// Pulls a cell from the volume strain `from` at the damage `before` to `to`; returns the work
    /// per area, the damage and the tension at the end.
    fn pull(law: &CochranBanner, cell: f64, [from, to]: [f64; 2], before: f64) -> [f64; 3] {
        const STEPS: usize = 40_000;
        let tension = |strain: f64, damage: f64| {
            let opening = if damage < 1.0 { law.carried(damage).opening } else { f64::INFINITY };
            (BULK_MODULUS * (strain - opening)).max(0.0)
        };
        let (mut work, mut damage, each) = (0.0, before, (to - from) / STEPS as f64);
        let mut last = tension(from, damage);
        for k in 1..=STEPS {
            let strain = from + each * k as f64;
            if damage < 1.0 {
                let state = stressed(-tension(strain, damage), 0.0, 0.0);
                damage = law.damage(damage, &state, &StrengthBeside::default());
            }
            let now = tension(strain, damage);
            work += 0.5 * (last + now) * each * cell;
            last = now;
        }
        [work, damage, last]
    }

    #[test]
    fn a_spall_takes_the_same_energy_in_cells_of_any_size() {
        for exponent in [2.0 / 3.0, 1.0] {
            let expected = 2e9 * 20e-6 * exponent / (1.0 + exponent);
            for cell in [5e-6, 20e-6, 80e-6] {
                let law = law(cell, exponent);
                let [work, damage, _] = pull(&law, cell, [0.0, 1.05 * law.strain], 0.0);
                assert_eq!(damage, 1.0);
                assert!((work / expected - 1.0).abs() < 2e-3, "{cell:e}: {work} {expected}");
            }
        }
        // a cell in which more energy is stored, sigma^2 h/2K, fails at once
        let cell = 2e-3;
        let [work, damage, _] = pull(&law(cell, 1.0), cell, [0.0, 0.021], 0.0);
        assert_eq!(damage, 1.0);
        assert!((work / (2e9 * 2e9 * cell / (2.0 * BULK_MODULUS)) - 1.0).abs() < 1e-3, "{work}");
    }

    #[test]
    fn the_tension_is_the_strength_at_the_volume_of_the_cracks() {
        let cell = 20e-6;
        let law = law(cell, 2.0 / 3.0);
        let [_, damage, tension] = pull(&law, cell, [0.0, 0.4], 0.0);
        // of a strain of 0.4 the cracks take all but the elastic one
        let opened = 0.4 - tension / BULK_MODULUS;
        assert!((damage * 20e-6 / cell - opened).abs() < 1e-9);
        let strength = 2e9 * (1.0 - opened.powf(2.0 / 3.0));
        assert!((tension / strength - 1.0).abs() < 1e-9, "{tension:e} {strength:e}");
        let carried = law.carried(damage);
        assert!((carried.shear * 2e9 / strength - 1.0).abs() < 1e-9);
        // unloading and loading again is elastic
        let [_, same, none] = pull(&law, cell, [0.4, 0.38], damage);
        assert_eq!((same, none), (damage, 0.0));
        let [_, same, again] = pull(&law, cell, [0.38, 0.4], damage);
        assert!(same == damage && (again / tension - 1.0).abs() < 1e-9);
    }
}
