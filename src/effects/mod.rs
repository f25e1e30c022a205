//! Effects: optional physics beside the motion of fluids. Each file implements one effect, and one
//! line in the list below registers it; see [`crate::solver::effect`].

mod ledger;

pub use ledger::{EffectUse, ledger, ledger_lines, ledger_rest};

use crate::scene::{CheckedScene, EffectKey};
use crate::solver::Stepper;
use crate::solver::columns::Columns;
use crate::solver::declare::Declare;
use crate::solver::effect::{Effect, Package, Registry, Setup};
use crate::solver::parts::StepPart;

macro_rules! packages {
    ($($module:ident :: $package:ident),* $(,)?) => {
        $(mod $module;)*

        impl Registry for EffectRegistry {
            const NAMES: &'static [&'static str] = &[$(<$module::$package>::NAME),*];

            fn keys() -> Vec<EffectKey> {
                [$(<$module::$package>::key()),*].into_iter().flatten().collect()
            }

            fn is_active(effect: usize, scene: &CheckedScene) -> bool {
                let all: &[fn(&CheckedScene) -> bool] = &[$(<$module::$package>::is_active),*];
                all[effect](scene)
            }

            fn declare(scene: &CheckedScene, columns: &mut Declare<'_>) {
                let all: &[fn(&CheckedScene, &mut Declare<'_>)] = &[$(<$module::$package>::declare),*];
                let active = (0..all.len()).filter(|&k| Self::is_active(k, scene));
                active.for_each(|k| {
                    columns.set_owner(Some(StepPart::COUNT + k));
                    all[k](scene, columns);
                });
            }

            fn build<const D: usize>(
                setup: &mut Setup<'_, D>,
            ) -> Vec<(usize, Box<dyn Effect<D>>)> {
                let all: &[fn(&mut Setup<'_, D>) -> Box<dyn Effect<D>>] =
                    &[$(<$module::$package>::build::<D>),*];
                let active = (0..all.len()).filter(|&k| Self::is_active(k, setup.scene));
                let active: Vec<usize> = active.collect();
                active.into_iter().map(|k| (StepPart::COUNT + k, all[k](setup))).collect()
            }
        }
    };
}

/// Effects of this program.
pub struct EffectRegistry;

// In each phase, effects act in this order.
packages![
    heat_spreading::HeatSpreading,
    body_force::BodyForceEffect,
    accelerated_grid::Inertia,
    transmitting_sides::Transmitting,
    wall_friction::WallFriction,
    loaded_sides::LoadedSides,
    strength::StrengthEffect,
    failure::FailureEffect,
    burn::ProgrammedBurn,
    erosion::ErosionEffect,
    temperature::Temperature,
    conduction::Conduction,
    pores::Pores,
    heat_mixing::HeatMixing,
];

/// Keys of the effects at the top of a scene.
pub fn keys() -> Vec<EffectKey> {
    EffectRegistry::keys()
}

/// Particle columns that `scene` needs.
pub fn columns(scene: &CheckedScene) -> Columns {
    Columns::new::<EffectRegistry>(scene)
}

/// Stepper of `scene`.
pub fn stepper<const D: usize>(scene: &CheckedScene) -> Stepper<D> {
    Stepper::new::<EffectRegistry>(scene)
}
