//! Constitutive update of particles. The step calls a model once per run of particles of one body;
//! the particle loop inside is compiled for the equation of state.
//!
//! Independent of grid, communication and dimension.
//!
//! # Adding a model from outside
//!
//! A program that uses this library can supply its own models without changing the library: an
//! [`EquationOfState`] (linear in the energy) or [`GeneralEos`](crate::material::GeneralEos), and a
//! [`StrengthLaw`]. [`CustomModel`] wraps them, and
//! [`Simulation::with_models`](crate::simulation::Simulation::with_models) uses them in place of
//! those that the scene names for a material:
//!
//! ```ignore
//! let models = |material: &str| {
//!     (material == "metal").then(|| CustomModel::fluid(MY_EOS).with_strength(MY_STRENGTH))
//! };
//! let simulation = Simulation::<1>::with_models(&scene, &Serial, 1, &models)?;
//! ```
//!
//! The scene still determines the columns of a run. A material with a custom strength must
//! therefore name some strength in the scene, and a material with a custom equation of state must
//! name a fluid without a history. The particle loops are compiled for the custom model, as for the
//! models of the library. Files, scores and plots of `flyer-mpm SCENE.json` depend on the scene
//! only. `examples/custom_material.rs` is a complete program.

mod custom_model;
mod damage_update;
mod deviatoric_update;
mod erosion;
mod general;
mod heat;
mod least_energy;
mod linear;
mod model;
mod registry;
mod solid;

pub use custom_model::CustomModel;
pub use damage_update::{DamageUpdate, FailureModel};
pub use deviatoric_update::{Deviators, StrengthModel, StrengthUpdate, VelocityGradients};
pub use erosion::ErosionCriterion;
pub use heat::{RestIsentrope, ThermalModel};
pub use least_energy::least_energy;
pub use model::{ConstitutiveModel, FluidModel, MidStep, VolumeChange};
pub use registry::{build, equation};
pub use solid::{PlaneStrain, SolidModel, Strain, TensorColumns};

use crate::material::definition::{HeatSource, Material};
use crate::material::failure::{FailureLaw, FailureVisitor, RestState, StrengthBeside};
use crate::material::strength::{StrengthLaw, StrengthVisitor};

/// Strength model of a fluid material, if the scene names one.
pub fn strength_model(material: &Material) -> Option<Box<dyn StrengthModel>> {
    struct Build(f64);
    impl StrengthVisitor for Build {
        type Output = Box<dyn StrengthModel>;

        fn visit<L: StrengthLaw>(self, law: L) -> Self::Output {
            Box::new(deviatoric_update::StrengthKernel(law.with_density(self.0)))
        }
    }
    material.strength.map(|strength| strength.visit(Build(material.density)))
}

/// Failure model of a material with the properties `rest`, if the scene names one.
pub fn failure_model(material: &Material, rest: &RestState) -> Option<Box<dyn FailureModel>> {
    struct Build<'a>(StrengthBeside, &'a RestState);
    impl FailureVisitor for Build<'_> {
        type Output = Box<dyn FailureModel>;

        fn visit<L: FailureLaw>(self, law: L) -> Self::Output {
            let law = law.with_rest_state(self.1);
            Box::new(damage_update::FailureKernel { law, strength: self.0 })
        }
    }
    material.failure.map(|failure| failure.visit(Build(material.strength_beside(), rest)))
}

/// Erosion limits of a material, if the scene gives any.
pub fn erosion_of(material: &Material) -> Option<ErosionCriterion> {
    let named = material.erosion?;
    let limit = |named: Option<f64>| named.unwrap_or(f64::INFINITY);
    Some(ErosionCriterion {
        plastic_strain: limit(named.plastic_strain),
        volume_ratio: limit(named.volume_ratio),
    })
}

/// Temperature model of a material, if the scene gives one; `matter` is its constitutive model.
pub fn thermal_of(material: &Material, matter: &ConstitutiveModel) -> Option<ThermalModel> {
    let named = material.thermal?;
    let isentrope = match (named.source, matter) {
        (HeatSource::Energy, ConstitutiveModel::Fluid(model)) => {
            Some(RestIsentrope::new(model.as_ref(), material.density))
        }
        _ => None,
    };
    Some(ThermalModel {
        specific_heat: named.specific_heat,
        rest: named.reference_temperature,
        taylor_quinney: named.taylor_quinney,
        conductivity: named.conductivity,
        isentrope,
    })
}
