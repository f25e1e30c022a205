//! Constitutive models defined outside of this library.

use super::deviatoric_update::StrengthKernel;
use super::deviatoric_update::StrengthModel;
use super::general::NonlinearEosKernel;
use super::linear::LinearEosKernel;
use super::model::ConstitutiveModel;
use crate::material::definition::Material;
use crate::material::strength::StrengthLaw;
use crate::material::{EquationOfState, GeneralEos};

/// Models that a program supplies in place of those that a scene names for a material; see the
/// [module](super).
#[derive(Default)]
pub struct CustomModel {
    /// Model without its strength, and its reference density [kg/m3].
    matter: Option<(ConstitutiveModel, f64)>,
    strength: Option<Box<dyn StrengthModel>>,
}

impl CustomModel {
    /// Custom equation of state, linear in the energy.
    pub fn fluid(eos: impl EquationOfState) -> Self {
        let density = eos.reference_density();
        CustomModel {
            matter: Some((ConstitutiveModel::Fluid(Box::new(LinearEosKernel(eos))), density)),
            strength: None,
        }
    }

    /// Custom equation of state of any form.
    pub fn general(eos: impl GeneralEos) -> Self {
        let density = eos.reference_density();
        CustomModel {
            matter: Some((ConstitutiveModel::Fluid(Box::new(NonlinearEosKernel(eos))), density)),
            strength: None,
        }
    }

    /// Custom strength, with the equation of state of the scene.
    pub fn strength(strength: impl StrengthLaw) -> Self {
        CustomModel::default().with_strength(strength)
    }

    /// Adds a custom strength.
    pub fn with_strength(self, strength: impl StrengthLaw) -> Self {
        CustomModel { strength: Some(Box::new(StrengthKernel(strength))), ..self }
    }

    /// Replaces `matter` and `strength`, built from the `material` of a scene, by the custom
    /// models.
    ///
    /// # Errors
    ///
    /// The reason why the material cannot take them.
    pub(crate) fn replace(
        self,
        material: &Material,
        matter: &mut ConstitutiveModel,
        strength: &mut Option<Box<dyn StrengthModel>>,
    ) -> Result<(), String> {
        if let Some((own, density)) = self.matter {
            let plain = match &*matter {
                ConstitutiveModel::Fluid(model) => model.first_history().is_none(),
                ConstitutiveModel::Solid(_) => false,
            };
            if !plain {
                return Err(
                    "its eos supports shear or has a history, so no equation of state from \
                            outside can take its place; allowed: a fluid without a history, such \
                            as \"ideal_gas\""
                        .into(),
                );
            }
            if density != material.density {
                return Err(format!(
                    "its density = {:?} [kg/m3], but the equation of state from outside is at \
                     {density:?}; allowed: the same",
                    material.density
                ));
            }
            *matter = own;
        }
        if let Some(own) = self.strength {
            if strength.is_none() {
                return Err(
                    "it names no strength, so a run has no columns for that from outside; \
                            allowed: any strength, whose place that one takes"
                        .into(),
                );
            }
            *strength = Some(own);
        }
        Ok(())
    }
}
