//! Models that stand outside of this library.

use super::deviatoric_update::Shearing;
use super::general::Implicit;
use super::{Flow, Matter, Point};
use crate::material::definition::Material;
use crate::material::strength::Strength;
use crate::material::{EquationOfState, GeneralEos};

/// Models of a program's own, in place of those that a scene names for a material; see the
/// [module](super).
#[derive(Default)]
pub struct Outside {
    /// The material without its strength, and its density [kg/m3].
    matter: Option<(Matter, f64)>,
    flow: Option<Box<dyn Flow>>,
}

impl Outside {
    /// With this equation of state, linear in the energy.
    pub fn fluid(eos: impl EquationOfState) -> Self {
        let density = eos.reference_density();
        Outside { matter: Some((Matter::Fluid(Box::new(Point(eos))), density)), flow: None }
    }

    /// With this equation of state, of any form.
    pub fn general(eos: impl GeneralEos) -> Self {
        let density = eos.reference_density();
        Outside { matter: Some((Matter::Fluid(Box::new(Implicit(eos))), density)), flow: None }
    }

    /// With the scene's equation of state and this strength.
    pub fn strength(strength: impl Strength) -> Self {
        Outside::default().with_strength(strength)
    }

    /// With this strength too.
    pub fn with_strength(self, strength: impl Strength) -> Self {
        Outside { flow: Some(Box::new(Shearing(strength))), ..self }
    }

    /// Puts the models in the place of `matter` and `flow`, those of a scene's `material`.
    ///
    /// # Errors
    ///
    /// Why the scene has no place for them.
    pub(crate) fn replace(
        self,
        material: &Material,
        matter: &mut Matter,
        flow: &mut Option<Box<dyn Flow>>,
    ) -> Result<(), String> {
        if let Some((own, density)) = self.matter {
            let plain = match &*matter {
                Matter::Fluid(model) => model.first_history().is_none(),
                Matter::Solid(_) => false,
            };
            if !plain {
                return Err("its eos bears shear or has a history, so no equation of state from \
                            outside can take its place; allowed: a fluid without a history, such \
                            as \"ideal_gas\""
                    .into());
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
        if let Some(own) = self.flow {
            if flow.is_none() {
                return Err(
                    "it names no strength, so a run has no columns for that from outside; \
                            allowed: any strength, whose place that one takes"
                        .into(),
                );
            }
            *flow = Some(own);
        }
        Ok(())
    }
}
