//! Brittle damage by cracks that grow from flaws
//!
//! ```text
//! n = k eps^m                                            flaws per volume active below a strain eps
//! d(D^(1/3))/dt = (m + 3)/3 alpha^(1/3) eps^(m/3)        where eps > (k h^3)^(-1/m)
//! alpha = 8 pi cg^3 k/((m + 1)(m + 2)(m + 3)),           cg = 0.4 cl
//! ```
//!
//! Each flaw is a crack that grows at the speed cg in all directions once the strain exceeds the
//! value that activates it, and takes the stress off the sphere around it; D is the volume of the
//! spheres per volume. The material carries 1 - D of tension and shear. eps is the greatest
//! principal stress of the intact material over the modulus of uniaxial strain, M = K + 4G/3, and cl
//! = (M/rho)^(1/2); the least strain is that of the weakest flaw in a cube with the edge h of a
//! cell.
//!
//! At a constant rate of strain r, D = alpha r^-3 eps^(m + 3). The stress M (1 - D) eps is then
//! greatest at D = 1/(m + 4), and
//!
//! ```text
//! s_max = M (m + 3)/(m + 4) (r^3/(alpha (m + 4)))^(1/(m + 3))
//! ```
//!
//! Sources: Grady & Kipp (1980), Continuum modelling of explosive fracture in oil shale, Int. J.
//! Rock Mech. Min. Sci. 17, 147; the rate of a scalar D and the strain of a reduced stress: Melosh,
//! Ryan & Asphaug (1992), J. Geophys. Res. 97, 14735, and Benz & Asphaug (1994), Icarus 107, 98.
//! They differ in the modulus of eps. Benz & Asphaug give each particle flaws of its own; here all
//! particles of a material are equal.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Carried, FailureLaw, RestState, StrengthBeside, StressState};

/// Grady & Kipp (1980): cracks grow from Weibull flaws, `flaw_density` strain^exponent per volume;
/// tension and shear fall with the volume that they relieve, and the faster the strain, the higher
/// the stress that is reached.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GradyKipp {
    /// Coefficient k of the number of flaws per volume, k strain^m [1/m3]. With a larger value
    /// flaws are activated at smaller strains, and the material is weaker.
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 1e100))]
    pub flaw_density: f64,
    /// Exponent m of the strain in the number of flaws k strain^m [-]. With a larger value the
    /// flaws are activated in a narrower range of strains.
    #[schemars(range(min = 1.0, max = 50.0))]
    pub exponent: f64,
    /// Speed of the cracks over the speed of longitudinal waves, cg/cl [-]; default 0.4. With a
    /// larger value the damage grows faster.
    #[serde(default = "two_fifths")]
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 1.0))]
    pub crack_speed: f64,
    /// Modulus of uniaxial strain at rest, M [Pa].
    #[serde(skip)]
    pub modulus: f64,
    /// Rate of D^(1/3) at a strain of 1 [1/s].
    #[serde(skip)]
    pub growth: f64,
    /// Strain that activates the weakest flaw of a cell [-].
    #[serde(skip)]
    pub least_strain: f64,
}

fn two_fifths() -> f64 {
    0.4
}

impl FailureLaw for GradyKipp {
    const GRADUAL: bool = true;

    fn with_rest_state(self, rest: &RestState) -> Self {
        let (k, m) = (self.flaw_density, self.exponent);
        let modulus = rest.bulk_modulus + 4.0 / 3.0 * rest.shear_modulus;
        let speed = self.crack_speed * (modulus / rest.density).sqrt();
        let flaws = 8.0 * std::f64::consts::PI * k / ((m + 1.0) * (m + 2.0) * (m + 3.0));
        GradyKipp {
            modulus,
            growth: (m + 3.0) / 3.0 * flaws.cbrt() * speed,
            least_strain: (k * rest.cell.powi(3)).powf(-1.0 / m),
            ..self
        }
    }

    #[inline(always)]
    fn damage(&self, before: f64, state: &StressState, _: &StrengthBeside) -> f64 {
        // damage reduces tension and shear, not the pressure of a compressed state
        let compression = state.pressure.max(0.0);
        let reduced = state.greatest_principal_stress() + compression;
        let strain = (reduced / (1.0 - before) - compression) / self.modulus;
        if strain.is_nan() || strain <= self.least_strain {
            return before;
        }
        let rate = self.growth * strain.powf(self.exponent / 3.0);
        (before.cbrt() + state.dt * rate).powi(3).min(1.0)
    }

    fn carried(&self, damage: f64) -> Carried {
        Carried { tension: 1.0 - damage, shear: 1.0 - damage, opening: 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Symmetric;

    /// Basalt-like constants of Melosh, Ryan & Asphaug's order, in large cells, whose weakest flaw
    /// counts for nothing.
    const REST: RestState =
        RestState { density: 2700.0, bulk_modulus: 26.7e9, shear_modulus: 22.7e9, cell: 10.0 };
    const K: f64 = 1e30;
    const M: f64 = 8.0;

    fn law() -> GradyKipp {
        let law = GradyKipp {
            flaw_density: K,
            exponent: M,
            crack_speed: 0.4,
            modulus: 0.0,
            growth: 0.0,
            least_strain: 0.0,
        };
        law.with_rest_state(&REST)
    }

    fn modulus() -> f64 {
        26.7e9 + 4.0 / 3.0 * 22.7e9
    }

    fn crack_speed() -> f64 {
        0.4 * (modulus() / 2700.0).sqrt()
    }

    /// State of a damaged material under the uniaxial `strain`.
    fn stretched(strain: f64, damage: f64, dt: f64) -> StressState {
        let carried = (1.0 - damage) * strain;
        let xx = carried * 4.0 / 3.0 * 22.7e9;
        let deviator = Symmetric { xx, yy: -0.5 * xx, xy: 0.0, zz: -0.5 * xx };
        let pressure = -26.7e9 * carried;
        StressState { pressure, deviator, plastic_strain: 0.0, dt, temperature: f64::NAN }
    }

    /// Strain at the greatest stress, that stress and the strain at failure under a constant `rate`.
    fn peak(rate: f64) -> [f64; 3] {
        let (law, strength) = (law(), StrengthBeside::default());
        let each = 1e-7;
        let (mut damage, mut strain, mut most) = (0.0, 0.0, [0.0; 2]);
        while damage < 1.0 {
            strain += each;
            let state = stretched(strain, damage, each / rate);
            damage = law.damage(damage, &state, &strength);
            let stress = modulus() * strain * (1.0 - damage);
            if stress > most[1] {
                most = [strain, stress];
            }
        }
        [most[0], most[1], strain]
    }

    /// Volume of the spheres around the cracks at the time `t` under a constant `rate`: the sum over
    /// flaws by the time s of their activation, dn/ds 4/3 pi (cg (t - s))^3.
    fn relieved(rate: f64, t: f64) -> f64 {
        let steps = 20_000;
        let each = t / f64::from(steps);
        let of = |k: i32| {
            let s = (f64::from(k) + 0.5) * each;
            let activated = K * M * rate.powf(M) * s.powf(M - 1.0);
            activated * 4.0 / 3.0 * std::f64::consts::PI * (crack_speed() * (t - s)).powi(3)
        };
        (0..steps).map(of).sum::<f64>() * each
    }

    #[test]
    fn damage_is_the_volume_around_the_cracks() {
        let (law, strength) = (law(), StrengthBeside::default());
        let (rate, dt, steps) = (1e3, 1e-10, 18_000);
        let mut damage = 0.0;
        for k in 1..=steps {
            let state = stretched(rate * dt * f64::from(k), damage, dt);
            damage = law.damage(damage, &state, &strength);
        }
        let expected = relieved(rate, dt * f64::from(steps));
        assert!(expected > 0.02 && expected < 1.0, "{expected}");
        assert!((damage / expected - 1.0).abs() < 2e-3, "{damage} {expected}");
    }

    #[test]
    fn the_strength_grows_with_the_strain_rate() {
        let alpha = 8.0 * std::f64::consts::PI * crack_speed().powi(3) * K
            / ((M + 1.0) * (M + 2.0) * (M + 3.0));
        let strongest = |rate: f64| {
            let strain = (rate.powi(3) / (alpha * (M + 4.0))).powf(1.0 / (M + 3.0));
            [strain, modulus() * strain * (M + 3.0) / (M + 4.0)]
        };
        let [slow, fast] = [1e2, 1e4].map(peak);
        for (rate, found) in [(1e2, slow), (1e4, fast)] {
            let [strain, stress] = strongest(rate);
            assert!((found[0] / strain - 1.0).abs() < 1e-2, "{rate}: {found:?} {strain}");
            assert!((found[1] / stress - 1.0).abs() < 2e-3, "{rate}: {found:?} {stress:e}");
            // the most frequent fragments, 6 cg t/(m + 2) at the time t of failure
            let size = 6.0 * crack_speed() * found[2] / rate / (M + 2.0);
            let expected = 6.0 * crack_speed() / (M + 2.0)
                * alpha.powf(-1.0 / (M + 3.0))
                * rate.powf(-M / (M + 3.0));
            assert!((size / expected - 1.0).abs() < 2e-3, "{rate}: {size:e} {expected:e}");
        }
        let order = (fast[1] / slow[1]).log10() / 2.0;
        assert!((order - 3.0 / (M + 3.0)).abs() < 1e-3, "{order}");
    }

    #[test]
    fn nothing_grows_below_the_weakest_flaw_of_a_cell() {
        let law = law().with_rest_state(&RestState { cell: 1e-3, ..REST });
        // one flaw is expected in the cell
        assert!((K * 1e-9 * law.least_strain.powf(M) - 1.0).abs() < 1e-9);
        let strength = StrengthBeside::default();
        let damage = |strain| law.damage(0.2, &stretched(strain, 0.2, 1e-7), &strength);
        assert_eq!(damage(law.least_strain * 0.999), 0.2);
        assert!(damage(law.least_strain * 1.001) > 0.2);
    }
}
