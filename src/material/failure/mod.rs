//! Failure: when a material no longer carries tension and shear. One file per law.
//!
//! Damage is 0 in intact material and grows to 1, where the material has failed. By most laws the
//! material carries its whole stress until then. By a gradual law ([`FailureLaw::GRADUAL`]) damage
//! reduces tension and shear before ([`Carried`]).
//!
//! Independent of particles, grid and dimension.

pub use tension_limit::TensionMeasure;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::material::{ParameterError, Symmetric};

/// Name of the damage in tables of particles.
pub const DAMAGE: &str = "damage";

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
    CochranBanner: cochran_banner::CochranBanner,
    GradyKipp: grady_kipp::GradyKipp,
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

/// Properties of a material at rest, and the size of a cell, for failure laws that depend on them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestState {
    /// Density [kg/m3].
    pub density: f64,
    /// Bulk modulus K [Pa].
    pub bulk_modulus: f64,
    /// Shear modulus G [Pa]; 0 without strength.
    pub shear_modulus: f64,
    /// Edge of a cell [m]; of a square with its area where cells are no squares.
    pub cell: f64,
}

/// Part of its stress that a damaged material carries.
///
/// With p0(J) the pressure of intact material at the volume ratio J, the pressure is
///
/// ```text
/// p = min(0, tension p0(J - opening))    where p0(J) < 0;  p = p0(J) elsewhere
/// ```
///
/// Shear modulus and yield stress are multiplied by `shear`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carried {
    /// Share of the tension [-].
    pub tension: f64,
    /// Share of the shear modulus and of the yield stress [-].
    pub shear: f64,
    /// Volume of open cracks per initial volume [-]; the material between them is stretched by so
    /// much less. Cracks that close carry no pressure until the volume is that of intact material.
    pub opening: f64,
}

impl Carried {
    /// The whole stress, of intact material.
    pub const WHOLE: Carried = Carried { tension: 1.0, shear: 1.0, opening: 0.0 };

    /// No tension and no shear, of failed material.
    pub const NOTHING: Carried = Carried { tension: 0.0, shear: 0.0, opening: 0.0 };
}

/// State of a material point at the end of a step.
#[derive(Clone, Copy, Debug)]
pub struct StressState {
    /// Pressure that the material carries at its damage before the step [Pa].
    pub pressure: f64,
    /// Deviator of the stress that it carries likewise [Pa].
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

/// Tension, minus the pressure, that a law needs for any damage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressureLimit {
    /// Key of the parameter.
    pub key: &'static str,
    /// Its value [Pa].
    pub tension: f64,
}

/// Failure law at one material point.
pub trait FailureLaw: Copy + Send + Sync + 'static {
    /// Whether damage below 1 reduces the stress, as [`FailureLaw::carried`] says.
    const GRADUAL: bool = false;

    /// Checks the parameters against each other and against the strength of the material.
    ///
    /// # Errors
    ///
    /// The first parameter that does not fit.
    fn check(&self, strength: &StrengthBeside) -> Result<(), ParameterError> {
        let _ = strength;
        Ok(())
    }

    /// The same law for a material with the properties `rest`.
    fn with_rest_state(self, rest: &RestState) -> Self {
        let _ = rest;
        self
    }

    /// Damage [-] at the end of a step; `before` is the damage at its start, less than 1. It does
    /// not decrease.
    fn damage(&self, before: f64, state: &StressState, strength: &StrengthBeside) -> f64;

    /// Limit of the pressure below which there is no damage, if there is one.
    fn pressure_limit(&self, strength: &StrengthBeside) -> Option<PressureLimit> {
        let _ = strength;
        None
    }

    /// Part of the stress that material with a `damage` below 1 carries; its shares are above 0.
    fn carried(&self, damage: f64) -> Carried {
        let _ = damage;
        Carried::WHOLE
    }
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

    /// See [`FailureLaw::pressure_limit`].
    pub fn pressure_limit(&self, strength: &StrengthBeside) -> Option<PressureLimit> {
        struct Limit<'a>(&'a StrengthBeside);
        impl FailureVisitor for Limit<'_> {
            type Output = Option<PressureLimit>;

            fn visit<L: FailureLaw>(self, law: L) -> Self::Output {
                law.pressure_limit(self.0)
            }
        }
        self.visit(Limit(strength))
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
