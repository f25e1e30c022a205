//! Update of the deviatoric stress of particles by the strength of their material.

use super::TensorColumns;
use crate::material::Symmetric;
use crate::material::strength::{self, MaterialState, Rate, StrengthLaw};

/// Velocity gradients of particles.
#[derive(Clone, Copy)]
pub enum VelocityGradients<'a> {
    /// One dimension: the only component [1/s].
    Line(&'a [f64]),
    /// Plane strain: components by rows [1/s].
    Plane([&'a [f64]; 4]),
    /// Axisymmetry: components in the plane, and the divergence, which includes the hoop strain
    /// rate.
    Axis([&'a [f64]; 4], &'a [f64]),
}

impl VelocityGradients<'_> {
    /// Velocity gradient of particle `r`.
    #[inline(always)]
    pub fn at(&self, r: usize) -> Rate {
        match self {
            VelocityGradients::Line(l) => Rate { plane: [l[r], 0.0, 0.0, 0.0], across: 0.0 },
            VelocityGradients::Plane(l) => Rate { plane: l.map(|l| l[r]), across: 0.0 },
            VelocityGradients::Axis(l, divergence) => {
                let plane = l.map(|l| l[r]);
                Rate { plane, across: divergence[r] - (plane[0] + plane[3]) }
            }
        }
    }
}

/// Columns of a deviator: xx, and in a plane also yy and xy. The zz component follows from the zero
/// trace; in one dimension yy and zz are equal.
#[derive(Clone, Copy)]
pub struct Deviators<'a> {
    /// Components xx [Pa].
    pub xx: &'a [f64],
    /// Components yy and xy [Pa]; `None` in one dimension.
    pub plane: Option<[&'a [f64]; 2]>,
}

impl Deviators<'_> {
    /// The deviator of particle `r` [Pa].
    #[inline(always)]
    pub fn at(&self, r: usize) -> Symmetric {
        let xx = self.xx[r];
        match self.plane {
            None => Symmetric { xx, yy: -0.5 * xx, xy: 0.0, zz: -0.5 * xx },
            Some([yy, xy]) => Symmetric { xx, yy: yy[r], xy: xy[r], zz: -(xx + yy[r]) },
        }
    }
}

/// Arguments of [`StrengthModel::advance`]; arrays have one entry per particle.
pub struct StrengthUpdate<'a> {
    /// Time step [s].
    pub dt: f64,
    /// Velocity gradient [1/s].
    pub rate: VelocityGradients<'a>,
    /// Volume ratio J [-].
    pub jacobian: &'a [f64],
    /// Pressure [Pa].
    pub pressure: &'a [f64],
    /// Temperature [K], if the scene has one.
    pub temperature: Option<&'a [f64]>,
    /// Deviator of the stress before the update [Pa].
    pub deviator: Deviators<'a>,
    /// Equivalent plastic strain before the update [-].
    pub plastic_strain: &'a [f64],
    /// Output: deviator after the update [Pa].
    pub deviator_after: TensorColumns<'a>,
    /// Output: equivalent plastic strain after the update [-].
    pub plastic_strain_after: &'a mut [f64],
    /// Output: plastic work per volume [J/m3].
    pub plastic_work: &'a mut [f64],
}

/// Strength of a material, as called by the step.
pub trait StrengthModel: Send + Sync {
    /// Updates deviator and plastic strain, and sets the plastic work.
    fn advance(&self, particles: StrengthUpdate<'_>);

    /// As [`StrengthModel::advance`], with the share `share` of shear modulus and yield stress.
    fn advance_weakened(&self, share: f64, particles: StrengthUpdate<'_>);

    /// Shear modulus at the state `at` [Pa].
    fn shear_modulus(&self, at: &MaterialState) -> f64;

    /// Yield stress at zero strain rate [Pa].
    fn yield_stress(&self, strain: f64, at: &MaterialState) -> f64;
}

/// Particle loop over one strength law.
pub(super) struct StrengthKernel<L>(pub L);

impl<L: StrengthLaw> StrengthModel for StrengthKernel<L> {
    fn advance(&self, particles: StrengthUpdate<'_>) {
        advance_all(&self.0, particles);
    }

    fn advance_weakened(&self, share: f64, particles: StrengthUpdate<'_>) {
        advance_all(&Weakened { law: self.0, share }, particles);
    }

    fn shear_modulus(&self, at: &MaterialState) -> f64 {
        self.0.shear_modulus(at)
    }

    fn yield_stress(&self, strain: f64, at: &MaterialState) -> f64 {
        self.0.yield_stress(strain, 0.0, at)
    }
}

/// Strength law of damaged material: a share of the shear modulus and of the yield stress.
#[derive(Clone, Copy)]
struct Weakened<L> {
    law: L,
    /// Share of the intact material [-].
    share: f64,
}

impl<L: StrengthLaw> StrengthLaw for Weakened<L> {
    #[inline(always)]
    fn shear_modulus(&self, at: &MaterialState) -> f64 {
        self.share * self.law.shear_modulus(at)
    }

    #[inline(always)]
    fn yield_stress(&self, strain: f64, rate: f64, at: &MaterialState) -> f64 {
        self.share * self.law.yield_stress(strain, rate, at)
    }
}

/// Particle loop over one strength law.
#[inline(always)]
fn advance_all(law: &impl StrengthLaw, particles: StrengthUpdate<'_>) {
    let mut out = particles.deviator_after;
    for r in 0..particles.plastic_strain_after.len() {
        let at = MaterialState {
            compression: 1.0 / particles.jacobian[r],
            pressure: particles.pressure[r],
            temperature: particles.temperature.map_or(f64::NAN, |t| t[r]),
        };
        let (s, strain) = (particles.deviator.at(r), particles.plastic_strain[r]);
        let after = strength::advance(law, &s, strain, &particles.rate.at(r), particles.dt, &at);
        out.set(r, &after.deviator, 1.0);
        particles.plastic_strain_after[r] = after.plastic_strain;
        particles.plastic_work[r] = after.plastic_work;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::strength::VonMises;

    /// The deviator of damaged material is the share of that of intact material with the same
    /// strain.
    #[test]
    fn damaged_material_bears_its_share_of_the_shear() {
        let metal = VonMises { shear_modulus: 28e9, yield_stress: 0.3e9, hardening: 1e9 };
        let kernel = StrengthKernel(metal);
        // elastic, and beyond the yield stress
        for rate in [1e5, 4e6] {
            let advanced = |share: f64| {
                let [mut xx, mut strain, mut work] = [[0.0]; 3];
                let update = StrengthUpdate {
                    dt: 1e-8,
                    rate: VelocityGradients::Line(&[rate]),
                    jacobian: &[1.0],
                    pressure: &[0.0],
                    temperature: None,
                    deviator: Deviators { xx: &[share * 0.1e9], plane: None },
                    plastic_strain: &[0.0],
                    deviator_after: TensorColumns { xx: &mut xx, plane: None, across: None },
                    plastic_strain_after: &mut strain,
                    plastic_work: &mut work,
                };
                match share {
                    1.0 => kernel.advance(update),
                    _ => kernel.advance_weakened(share, update),
                }
                [xx[0], strain[0], work[0]]
            };
            let [intact, damaged] = [1.0, 0.25].map(advanced);
            assert!(intact[0] > 0.1e9 && (intact[1] > 0.0) == (rate > 1e6), "{intact:?}");
            let expected = [0.25 * intact[0], intact[1], 0.25 * intact[2]];
            for (found, expected) in damaged.iter().zip(expected) {
                assert!((found - expected).abs() <= 1e-12 * expected, "{damaged:?} {intact:?}");
            }
        }
    }
}
