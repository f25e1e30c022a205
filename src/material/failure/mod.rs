//! Failure: when a material no longer carries tension and shear. One file per law.
//!
//! Damage is 0 in intact material and grows to 1, where the material has failed.
//!
//! Independent of particles, grid and dimension.

pub use tension_limit::TensionMeasure;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::material::{ParameterError, Symmetric};

macro_rules! failure_laws {
    ($($type:ident: $module:ident::$law:ident),* $(,)?) => {
        $(mod $module;)*
        $(pub use $module::$law;)*

        /// Models of failure by type. Failed material carries neither tension nor shear; its
        /// elastic energy stays in it as heat.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(tag = "type", rename_all = "snake_case")]
        pub enum Failure {
            // each is documented by its parameters
            $(#[expect(missing_docs)] $type($law),)*
        }

        impl Failure {
            /// Calls a visitor with the law itself, so that the compiler knows its type.
            pub fn visit<V: FailureVisitor>(&self, visitor: V) -> V::Output {
                match *self {
                    $(Failure::$type(law) => visitor.visit(law),)*
                }
            }
        }
    };
}

failure_laws![
    TensionLimit: tension_limit::TensionLimit,
    JohnsonCook: johnson_cook::JohnsonCookFracture,
    TulerButcher: tuler_butcher::TulerButcher,
];

/// Visitor of a failure law of any type; see [`Failure::visit`].
pub trait FailureVisitor {
    /// Result of the visit.
    type Output;

    /// Visits a failure law.
    fn visit<L: FailureLaw>(self, law: L) -> Self::Output;
}

/// Properties of a material's strength that a failure law needs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StrengthBeside {
    /// Whether the material has strength.
    pub present: bool,
    /// Temperatures between which it softens and melts [K].
    pub softening_range: Option<[f64; 2]>,
}

/// State of a material point at the end of a step.
#[derive(Clone, Copy, Debug)]
pub struct StressState {
    /// Pressure [Pa].
    pub pressure: f64,
    /// Deviator of the stress [Pa].
    pub deviator: Symmetric,
    /// Plastic strain of the step [-].
    pub plastic_strain: f64,
    /// Time step [s].
    pub dt: f64,
    /// Temperature [K]; NaN if there is none.
    pub temperature: f64,
}

impl StressState {
    /// Greatest principal stress, positive in tension [Pa].
    #[inline(always)]
    pub fn greatest_principal_stress(&self) -> f64 {
        let s = &self.deviator;
        let [mean, half] = [0.5 * (s.xx + s.yy), 0.5 * (s.xx - s.yy)];
        (mean + half.hypot(s.xy)).max(s.zz) - self.pressure
    }
}

/// Failure law at one material point.
pub trait FailureLaw: Copy + Send + Sync + 'static {
    /// Checks the parameters against each other and against the strength of the material.
    ///
    /// # Errors
    ///
    /// The first parameter that does not fit.
    fn check(&self, strength: &StrengthBeside) -> Result<(), ParameterError> {
        let _ = strength;
        Ok(())
    }

    /// Damage [-] at the end of a step; `before` is the damage at its start, less than 1.
    fn damage(&self, before: f64, state: &StressState, strength: &StrengthBeside) -> f64;
}

impl Failure {
    /// Checks the parameters against each other and against the strength of the material.
    ///
    /// # Errors
    ///
    /// The first parameter that does not fit.
    pub fn check(&self, strength: &StrengthBeside) -> Result<(), ParameterError> {
        struct Check<'a>(&'a StrengthBeside);
        impl FailureVisitor for Check<'_> {
            type Output = Result<(), ParameterError>;

            fn visit<L: FailureLaw>(self, law: L) -> Self::Output {
                law.check(self.0)
            }
        }
        self.visit(Check(strength))
    }
}

fn one() -> f64 {
    1.0
}

/// Material point under uniaxial tension, for tests.
#[cfg(test)]
fn stressed(pressure: f64, xx: f64, plastic_strain: f64) -> StressState {
    let deviator = Symmetric { xx, yy: -0.5 * xx, xy: 0.0, zz: -0.5 * xx };
    StressState { pressure, deviator, plastic_strain, dt: 1e-8, temperature: 300.0 }
}
