//! Equations of state and elastic solids: one file per model, with its parameters in a scene.
//!
//! Most fluids here are linear in the specific internal energy, p = f(J) + g(J) e, with the volume
//! ratio J = V/V0 = rho0/rho. For these the trapezoidal rule for the energy has a closed solution.
//! Fluids of other forms are in [`general`]. [`elastic`] solids carry shear.

mod bicubic;
mod bracket;
pub mod elastic;
#[cfg(test)]
mod forwarding;
pub mod general;
mod linear;
mod quadratic_mie_gruneisen;
mod tension;

pub use bicubic::Bicubic;
pub use elastic::{Deformation, ElasticSolid, Lame, Symmetric};
pub use general::{EosPoint, GeneralEos, HistoryEos, energy_of_work};
pub use hencky::Hencky;
pub use ideal_gas::IdealGas;
pub use jwl::{Burn, BurnFront, BurnPlane, BurnWhole, Burning, Detonation, Jwl};
pub use linear::{EquationOfState, LinearPressure};
pub use mie_gruneisen::{Gruneisen, MieGruneisen};
pub use neo_hookean::NeoHookean;
pub use porous::Porous;
pub use quadratic_mie_gruneisen::QuadraticMieGruneisen;
pub use stiffened_gas::StiffenedGas;
pub use tabular::{Table, TableSource, TableValues, Tabular};
pub use tait::Tait;
pub use tension::{Cutoff, GeneralCutoff};
pub use tillotson::Tillotson;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::material::parameter_error::{ParameterError, wrong_length};

macro_rules! eos_models {
    ($($type:ident: $module:ident::$parameters:ident),* $(,)?) => {
        $(mod $module;)*
        $(pub use $module::$parameters;)*

        /// Equations of state by type; each is documented by its parameters.
        #[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
        #[serde(tag = "type", rename_all = "snake_case")]
        pub enum Eos {
            // each is documented by its parameters
            $(#[expect(missing_docs)] $type($parameters),)*
        }

        impl Eos {
            fn parameters(&self) -> &dyn EosParameters {
                match self {
                    $(Eos::$type(parameters) => parameters,)*
                }
            }

            /// Calls a visitor with the fluid's model itself, so that the compiler knows its type;
            /// `None` for an elastic solid. `rho0` is the density at rest [kg/m3].
            ///
            /// # Errors
            ///
            /// The fault of a table.
            pub fn visit<V: EosVisitor>(&self, rho0: f64, visitor: V) -> Made<V> {
                match self {
                    $(Eos::$type(parameters) => parameters.visit(rho0, visitor),)*
                }
            }

            /// The same for a fluid of density `rho0` at rest [kg/m3] without a history; also
            /// `None` for a fluid with one.
            ///
            /// # Errors
            ///
            /// The fault of a table.
            pub fn visit_plain<V: PlainEosVisitor>(&self, rho0: f64, visitor: V) -> Made<V> {
                match self {
                    $(Eos::$type(parameters) => parameters.visit_plain(rho0, visitor),)*
                }
            }

            /// The same for an elastic solid of density `rho0` at rest [kg/m3]; `None` for a fluid.
            pub fn visit_solid<V: SolidVisitor>(&self, rho0: f64, visitor: V) -> Option<V::Output> {
                match self {
                    $(Eos::$type(parameters) => parameters.visit_solid(rho0, visitor),)*
                }
            }
        }
    };
}

eos_models![
    MieGruneisen: mie_gruneisen::MieGruneisenParameters,
    IdealGas: ideal_gas::IdealGasParameters,
    StiffenedGas: stiffened_gas::StiffenedGasParameters,
    Tait: tait::TaitParameters,
    Tillotson: tillotson::TillotsonParameters,
    Jwl: jwl::JwlParameters,
    PAlpha: porous::PAlphaParameters,
    Tabular: tabular::TabularParameters,
    LinearElastic: hencky::LinearElasticParameters,
    NeoHookean: neo_hookean::NeoHookeanParameters,
    NobleAbelStiffenedGas: noble_abel_stiffened_gas::NobleAbelStiffenedGasParameters,
    Vinet: vinet::VinetParameters,
    DavisReactants: davis_reactants::DavisReactantsParameters,
];

impl Eos {
    /// Checks the parameters against each other and against their scene.
    ///
    /// # Errors
    ///
    /// The first parameter that does not fit.
    pub fn check(&self, at: &EosContext) -> Result<(), ParameterError> {
        self.parameters().check(at)
    }

    /// Reason why a scene cannot choose the initial pressure of a body, if it cannot.
    pub fn no_initial_pressure(&self) -> Option<&'static str> {
        self.parameters().no_initial_pressure()
    }

    /// Checks that a body of the material at rest density [kg/m3] may start at a pressure [Pa].
    ///
    /// # Errors
    ///
    /// The reason why it may not, and the allowed values.
    pub fn check_initial_pressure(&self, density: f64, pressure: f64) -> Result<(), String> {
        self.parameters().check_initial_pressure(density, pressure)
    }

    /// Whether the material is a gas, which has no stiffness without pressure.
    pub fn is_gas(&self) -> bool {
        self.parameters().is_gas()
    }

    /// Ratio of specific heats of a gas, stiffened or not [-].
    pub fn gas_gamma(&self) -> Option<f64> {
        self.parameters().gas_gamma()
    }

    /// Whether the material is an elastic solid, which carries shear by itself.
    pub fn is_solid(&self) -> bool {
        self.parameters().is_solid()
    }

    /// Whether the material has a history variable.
    pub fn has_history(&self) -> bool {
        self.parameters().has_history()
    }
}

/// Scene data against which the parameters of an equation of state are checked.
#[derive(Clone, Copy, Debug)]
pub struct EosContext {
    /// Density at rest [kg/m3].
    pub density: f64,
    /// Number of dimensions of the scene.
    pub dimension: usize,
}

/// Result of a visitor for an equation of state.
///
/// # Errors
///
/// The fault of a table.
pub type Made<V> = Result<Option<<V as PlainEosVisitor>::Output>, String>;

/// Parameters of an equation of state in a scene.
pub trait EosParameters {
    /// See [`Eos::check`].
    ///
    /// # Errors
    ///
    /// The first parameter that does not fit.
    fn check(&self, at: &EosContext) -> Result<(), ParameterError> {
        let _ = at;
        Ok(())
    }

    /// See [`Eos::check_initial_pressure`].
    ///
    /// # Errors
    ///
    /// The reason why it may not, and the allowed values.
    fn check_initial_pressure(&self, density: f64, pressure: f64) -> Result<(), String> {
        let _ = (density, pressure);
        Ok(())
    }

    /// See [`Eos::is_gas`].
    fn is_gas(&self) -> bool {
        false
    }

    /// See [`Eos::no_initial_pressure`].
    fn no_initial_pressure(&self) -> Option<&'static str> {
        None
    }

    /// See [`Eos::gas_gamma`].
    fn gas_gamma(&self) -> Option<f64> {
        None
    }

    /// See [`Eos::is_solid`].
    fn is_solid(&self) -> bool {
        false
    }

    /// See [`Eos::has_history`].
    fn has_history(&self) -> bool {
        false
    }

    /// See [`Eos::visit`].
    ///
    /// # Errors
    ///
    /// The fault of a table.
    fn visit<V: EosVisitor>(&self, rho0: f64, visitor: V) -> Made<V>
    where
        Self: Sized,
    {
        self.visit_plain(rho0, visitor)
    }

    /// See [`Eos::visit_plain`].
    ///
    /// # Errors
    ///
    /// The fault of a table.
    fn visit_plain<V: PlainEosVisitor>(&self, rho0: f64, visitor: V) -> Made<V>
    where
        Self: Sized,
    {
        let _ = (rho0, visitor);
        Ok(None)
    }

    /// See [`Eos::visit_solid`].
    fn visit_solid<V: SolidVisitor>(&self, rho0: f64, visitor: V) -> Option<V::Output>
    where
        Self: Sized,
    {
        let _ = (rho0, visitor);
        None
    }
}

/// Visitor of an equation of state without a history.
pub trait PlainEosVisitor {
    /// Result of the visit.
    type Output;

    /// Visits an equation of state that is linear in the energy.
    fn linear<E: EquationOfState>(self, eos: E) -> Self::Output;

    /// Visits an equation of state of any form.
    fn general<E: GeneralEos>(self, eos: E) -> Self::Output;
}

/// Visitor of any equation of state.
pub trait EosVisitor: PlainEosVisitor {
    /// Visits an equation of state with a history.
    fn history<E: HistoryEos>(self, eos: E) -> Self::Output;
}

/// Visitor of an elastic solid.
pub trait SolidVisitor {
    /// Result of the visit.
    type Output;

    /// Visits an elastic solid.
    fn visit<S: ElasticSolid>(self, solid: S) -> Self::Output;
}

/// Passes an equation of state to a visitor, with its tension limited to `cutoff` [Pa] if given.
fn limited<V: PlainEosVisitor, E: EquationOfState>(
    visitor: V,
    eos: E,
    cutoff: Option<f64>,
) -> V::Output {
    match cutoff {
        None => visitor.linear(eos),
        Some(tension) => visitor.linear(Cutoff { eos, tension }),
    }
}

/// The same for an equation of state of any form.
fn limited_general<V: PlainEosVisitor, E: GeneralEos>(
    visitor: V,
    eos: E,
    cutoff: Option<f64>,
) -> V::Output {
    match cutoff {
        None => visitor.general(eos),
        Some(tension) => visitor.general(GeneralCutoff::new(eos, tension)),
    }
}

/// Refuses an initial pressure below `least` [Pa].
fn at_least(pressure: f64, least: f64, why: &str) -> Result<(), String> {
    match pressure < least {
        true => Err(format!("allowed: at least {}, {why}", json!(least))),
        false => Ok(()),
    }
}

/// Refuses an initial pressure below minus the tension cutoff [Pa].
fn within_cutoff(pressure: f64, cutoff: Option<f64>) -> Result<(), String> {
    let Some(cutoff) = cutoff else { return Ok(()) };
    at_least(pressure, -cutoff, "minus eos.tension_cutoff")
}

/// Refuses a vector whose length is not the dimension of the scene.
fn check_length(key: String, values: &[f64], dimension: usize) -> Result<(), ParameterError> {
    if values.len() == dimension {
        return Ok(());
    }
    Err(ParameterError::new(key, values, wrong_length(values.len(), dimension)))
}
