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
    /// The deviator of particle `r`.
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
    /// Velocity gradient.
    pub rate: VelocityGradients<'a>,
    /// Volume ratio J.
    pub jacobian: &'a [f64],
    /// Pressure [Pa].
    pub pressure: &'a [f64],
    /// Temperature [K], if the scene has one.
    pub temperature: Option<&'a [f64]>,
    /// Deviator of the stress before the update.
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

    /// Shear modulus at the state `at` [Pa].
    fn shear_modulus(&self, at: &MaterialState) -> f64;

    /// Yield stress at zero strain rate [Pa].
    fn yield_stress(&self, strain: f64, at: &MaterialState) -> f64;
}

/// Particle loop over one strength law.
pub(super) struct StrengthKernel<L>(pub L);

impl<L: StrengthLaw> StrengthModel for StrengthKernel<L> {
    fn advance(&self, particles: StrengthUpdate<'_>) {
        let mut out = particles.deviator_after;
        for r in 0..particles.plastic_strain_after.len() {
            let at = MaterialState {
                compression: 1.0 / particles.jacobian[r],
                pressure: particles.pressure[r],
                temperature: particles.temperature.map_or(f64::NAN, |t| t[r]),
            };
            let (s, strain) = (particles.deviator.at(r), particles.plastic_strain[r]);
            let after =
                strength::advance(&self.0, &s, strain, &particles.rate.at(r), particles.dt, &at);
            out.set(r, &after.deviator, 1.0);
            particles.plastic_strain_after[r] = after.plastic_strain;
            particles.plastic_work[r] = after.plastic_work;
        }
    }

    fn shear_modulus(&self, at: &MaterialState) -> f64 {
        self.0.shear_modulus(at)
    }

    fn yield_stress(&self, strain: f64, at: &MaterialState) -> f64 {
        self.0.yield_stress(strain, 0.0, at)
    }
}
