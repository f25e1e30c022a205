//! When a material fails: from then on it bears neither tension nor shear.

use crate::material::Symmetric;
use crate::material::strength::equivalent;

/// A criterion of failure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Criterion {
    /// At once where the greatest principal stress reaches this tension [Pa].
    PrincipalStress(f64),
    /// At once where the mean tension reaches this one [Pa].
    MeanTension(f64),
    /// As plastic strain grows; see [`Ductile`].
    Ductile(Ductile),
}

/// Johnson & Cook's damage D, the sum of plastic strain over the strain at fracture
///
/// ```text
/// ef = (D1 + D2 exp(D3 s*)) (1 + D4 ln max(1, rate/rate0)) (1 + D5 T*)
/// ```
///
/// s* the mean tension over the equivalent stress, at most 1.5. Source: Johnson & Cook (1985),
/// Fracture characteristics of three metals, eqs. 3 and 4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ductile {
    /// D1 to D5 [-].
    pub d: [f64; 5],
    /// Reference rate [1/s].
    pub reference_rate: f64,
    /// Temperatures between which T* goes from 0 to 1 [K]; none: T* = 0.
    pub temperatures: Option<[f64; 2]>,
}

/// A row that may fail.
#[derive(Clone, Copy, Debug)]
pub struct Loaded {
    /// Pressure [Pa].
    pub pressure: f64,
    /// Deviator of the stress [Pa].
    pub deviator: Symmetric,
    /// Plastic strain of the step [-].
    pub plastic_strain: f64,
    /// Length of the step [s].
    pub dt: f64,
    /// Temperature [K]; not a number without one.
    pub temperature: f64,
}

impl Ductile {
    /// Plastic strain at which the material fractures [-], never below a tiny one.
    pub fn fracture_strain(&self, triaxiality: f64, rate: f64, temperature: f64) -> f64 {
        let [d1, d2, d3, d4, d5] = self.d;
        let fast = (rate / self.reference_rate).max(1.0).ln();
        let warm = self
            .temperatures
            .map_or(0.0, |[room, melt]| ((temperature - room) / (melt - room)).clamp(0.0, 1.0));
        let strain =
            (d1 + d2 * (d3 * triaxiality.min(1.5)).exp()) * (1.0 + d4 * fast) * (1.0 + d5 * warm);
        strain.max(1e-6)
    }
}

impl Criterion {
    /// Damage of a row at the end of a step, 0 whole, 1 failed.
    pub fn damage(&self, before: f64, row: &Loaded) -> f64 {
        let all = |failed: bool| if failed { 1.0 } else { before };
        match self {
            Criterion::MeanTension(limit) => all(-row.pressure >= *limit),
            Criterion::PrincipalStress(limit) => {
                let s = &row.deviator;
                let [mean, half] = [0.5 * (s.xx + s.yy), 0.5 * (s.xx - s.yy)];
                let greatest = (mean + half.hypot(s.xy)).max(s.zz) - row.pressure;
                all(greatest >= *limit)
            }
            Criterion::Ductile(ductile) => {
                if row.plastic_strain <= 0.0 {
                    return before;
                }
                let size = equivalent(&row.deviator);
                let triaxiality = if size > 0.0 { -row.pressure / size } else { 1.5 };
                let rate = row.plastic_strain / row.dt;
                let fracture = ductile.fracture_strain(triaxiality, rate, row.temperature);
                (before + row.plastic_strain / fracture).min(1.0)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(pressure: f64, xx: f64, plastic_strain: f64) -> Loaded {
        let deviator = Symmetric { xx, yy: -0.5 * xx, xy: 0.0, zz: -0.5 * xx };
        Loaded { pressure, deviator, plastic_strain, dt: 1e-8, temperature: 300.0 }
    }

    #[test]
    fn limits_of_tension_fail_at_once() {
        let stress = Criterion::PrincipalStress(1e9);
        assert_eq!(stress.damage(0.0, &row(-0.9e9, 0.09e9, 0.0)), 0.0);
        assert_eq!(stress.damage(0.0, &row(-0.9e9, 0.11e9, 0.0)), 1.0);
        let mean = Criterion::MeanTension(1e9);
        assert_eq!(mean.damage(0.0, &row(-0.9e9, 0.2e9, 0.0)), 0.0);
        assert_eq!(mean.damage(0.0, &row(-1.1e9, -0.2e9, 0.0)), 1.0);
        assert_eq!(mean.damage(1.0, &row(5e9, 0.0, 0.0)), 1.0, "failed stays failed");
        // the greatest stress is that across: -0.5 xx
        assert_eq!(stress.damage(0.0, &row(-0.9e9, -0.19e9, 0.0)), 0.0);
        assert_eq!(stress.damage(0.0, &row(-0.9e9, -0.21e9, 0.0)), 1.0);
        let mut across = row(-0.9e9, -0.1e9, 0.0);
        (across.deviator.yy, across.deviator.zz) = (-0.1e9, 0.2e9);
        assert_eq!(stress.damage(0.0, &across), 1.0);
    }

    #[test]
    fn damage_is_plastic_strain_over_that_at_fracture() {
        // OFHC copper
        let ductile = Ductile {
            d: [0.54, 4.89, -3.03, 0.014, 1.12],
            reference_rate: 1.0,
            temperatures: Some([294.0, 1356.0]),
        };
        let law = Criterion::Ductile(ductile);
        let warm = (300.0 - 294.0) / (1356.0 - 294.0);
        let rate: f64 = 0.001 / 1e-8;
        let triaxial: f64 = 0.2e9 / 0.3e9;
        let fracture = (0.54 + 4.89 * (-3.03 * triaxial).exp())
            * (1.0 + 0.014 * rate.ln())
            * (1.0 + 1.12 * warm);
        let damage = law.damage(0.25, &row(-0.2e9, 0.2e9, 0.001));
        assert!((damage - (0.25 + 0.001 / fracture)).abs() < 1e-15, "{damage}");
        assert_eq!(law.damage(0.25, &row(-0.2e9, 0.2e9, 0.0)), 0.25);
        let most = ductile.fracture_strain(1.5, rate, 300.0);
        assert_eq!(ductile.fracture_strain(2.5, rate, 300.0), most, "triaxiality is bounded");
        assert_eq!(law.damage(0.9999999, &row(-0.2e9, 0.2e9, 0.1)), 1.0);
    }
}
