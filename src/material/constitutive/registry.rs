//! Builds the models of a material's equation of state: for the step, and for exact solutions.

use super::general::NonlinearEosKernel;
use super::linear::LinearEosKernel;
use super::model::ConstitutiveModel;
use super::solid::{SolidKernel, SolidModel};
use crate::material::definition::Material;
use crate::material::{
    ElasticSolid, EosVisitor, EquationOfState, GeneralEos, HistoryEos, PlainEosVisitor,
    SolidVisitor,
};

/// Builds the model that the step calls.
struct ForStep;

impl PlainEosVisitor for ForStep {
    type Output = ConstitutiveModel;

    fn linear<E: EquationOfState>(self, eos: E) -> ConstitutiveModel {
        ConstitutiveModel::Fluid(Box::new(LinearEosKernel(eos)))
    }

    fn general<E: GeneralEos>(self, eos: E) -> ConstitutiveModel {
        ConstitutiveModel::Fluid(Box::new(NonlinearEosKernel(eos)))
    }
}

impl EosVisitor for ForStep {
    fn history<E: HistoryEos>(self, eos: E) -> ConstitutiveModel {
        ConstitutiveModel::Fluid(Box::new(NonlinearEosKernel(eos)))
    }
}

impl SolidVisitor for ForStep {
    type Output = Box<dyn SolidModel>;

    fn visit<S: ElasticSolid>(self, solid: S) -> Box<dyn SolidModel> {
        Box::new(SolidKernel(solid))
    }
}

/// Builds the model that exact solutions use.
struct Boxed;

impl PlainEosVisitor for Boxed {
    type Output = Box<dyn HistoryEos>;

    fn linear<E: EquationOfState>(self, eos: E) -> Self::Output {
        Box::new(eos)
    }

    fn general<E: GeneralEos>(self, eos: E) -> Self::Output {
        Box::new(eos)
    }
}

impl EosVisitor for Boxed {
    fn history<E: HistoryEos>(self, eos: E) -> Self::Output {
        Box::new(eos)
    }
}

/// Equation of state of a material; `None` for an elastic solid, which has none, and for pores in a
/// solid whose equation of state is not plain (elastic, or with a history).
///
/// # Errors
///
/// The fault of a table.
pub fn equation(material: &Material) -> Result<Option<Box<dyn HistoryEos>>, String> {
    material.eos.visit(material.density, Boxed)
}

/// Constitutive model of a material of a scene that has passed its check.
///
/// # Panics
///
/// If the check of a scene refuses the material.
pub fn build(material: &Material) -> ConstitutiveModel {
    let (eos, rho0) = (&material.eos, material.density);
    match eos.visit_solid(rho0, ForStep) {
        Some(solid) => ConstitutiveModel::Solid(solid),
        None => eos
            .visit(rho0, ForStep)
            .ok()
            .flatten()
            .expect("the check has refused what makes no fluid"),
    }
}
