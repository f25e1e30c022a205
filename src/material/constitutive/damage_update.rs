//! Update of the damage of particles by the failure law of their material.

use super::Deviators;
use crate::material::Symmetric;
use crate::material::failure::{Carried, FailureLaw, StrengthBeside, StressState};

/// Arguments of [`FailureModel::advance`]; arrays have one entry per particle.
pub struct DamageUpdate<'a> {
    /// Time step [s].
    pub dt: f64,
    /// Pressure [Pa].
    pub pressure: &'a [f64],
    /// Deviator of the stress [Pa], if the material has strength.
    pub deviator: Option<Deviators<'a>>,
    /// Plastic strain of the step [-], if the material has strength.
    pub plastic_increment: Option<&'a [f64]>,
    /// Temperature [K], if the scene has one.
    pub temperature: Option<&'a [f64]>,
    /// Damage [-], updated in place.
    pub damage: &'a mut [f64],
}

/// Failure of a material, as called by the step.
pub trait FailureModel: Send + Sync {
    /// Updates the damage and calls `weakened` with the index of each particle that carries less
    /// than before, and its damage before.
    fn advance(&self, particles: DamageUpdate<'_>, weakened: &mut dyn FnMut(usize, f64));

    /// Whether damage below 1 reduces the stress.
    fn is_gradual(&self) -> bool;

    /// Part of the stress that material with `damage` carries.
    fn carried(&self, damage: f64) -> Carried;
}

/// Particle loop over one failure law.
pub(super) struct FailureKernel<L> {
    /// Law of failure.
    pub law: L,
    /// Strength of the same material.
    pub strength: StrengthBeside,
}

impl<L: FailureLaw> FailureModel for FailureKernel<L> {
    fn advance(&self, particles: DamageUpdate<'_>, weakened: &mut dyn FnMut(usize, f64)) {
        for (r, damage) in particles.damage.iter_mut().enumerate() {
            if *damage >= 1.0 {
                continue;
            }
            let state = StressState {
                pressure: particles.pressure[r],
                deviator: particles.deviator.map_or(Symmetric::default(), |s| s.at(r)),
                plastic_strain: particles.plastic_increment.map_or(0.0, |strain| strain[r]),
                dt: particles.dt,
                temperature: particles.temperature.map_or(f64::NAN, |t| t[r]),
            };
            let before = *damage;
            *damage = self.law.damage(before, &state, &self.strength);
            if *damage >= 1.0 || (L::GRADUAL && *damage > before) {
                weakened(r, before);
            }
        }
    }

    fn is_gradual(&self) -> bool {
        L::GRADUAL
    }

    fn carried(&self, damage: f64) -> Carried {
        if damage < 1.0 { self.law.carried(damage) } else { Carried::NOTHING }
    }
}
