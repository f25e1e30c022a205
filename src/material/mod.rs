//! Equations of state: one file a model, one line a model in [`build`].
//!
//! Knows neither particles, grid nor dimension: a model sees scalars alone.
//!
//! Most fluids here are linear in the specific internal energy,
//! p = f(J) + g(J) e, with J = V/V0 = rho0/rho the volume ratio. That is what lets the
//! mid-point rule for the energy be solved in closed form. Others are [`general`].
//! [`elastic`] solids bear shear.

mod bicubic;
pub mod constitutive;
pub mod definition;
pub mod elastic;
#[cfg(test)]
mod forwarding;
pub mod general;
mod hencky;
mod ideal_gas;
mod jwl;
mod mie_gruneisen;
mod neo_hookean;
mod porous;
mod quadratic_mie_gruneisen;
mod stiffened_gas;
pub mod strength;
mod tabular;
mod tait;
mod tension;
mod tillotson;

pub use bicubic::Bicubic;
pub use elastic::{Deformation, ElasticSolid, Lame, Symmetric};
pub use general::{EosPoint, GeneralEos, HistoryEos, energy_of_work};
pub use hencky::Hencky;
pub use ideal_gas::IdealGas;
pub use jwl::{Burning, Detonation, Jwl};
pub use mie_gruneisen::MieGruneisen;
pub use neo_hookean::NeoHookean;
pub use porous::Porous;
pub use quadratic_mie_gruneisen::QuadraticMieGruneisen;
pub use stiffened_gas::StiffenedGas;
pub use tabular::{Table, Tabular};
pub use tait::Tait;
pub use tension::{Cutoff, GeneralCutoff};
pub use tillotson::Tillotson;

/// What an equation of state tells of one state: p = cold + energy_factor * e.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    /// The part of the pressure that does not depend on the energy, f(J) [Pa].
    pub cold: f64,
    /// dp/de at fixed volume, g(J) = Gamma rho [kg/m3].
    pub energy_factor: f64,
}

/// An equation of state p(J, e), linear in the energy.
///
/// `jacobian` is J = V/V0 [-]; `energy` is per unit mass [J/kg]; pressure is positive in
/// compression [Pa].
pub trait EquationOfState: Copy + Send + Sync + 'static {
    /// Density at J = 1 [kg/m3].
    fn reference_density(&self) -> f64;

    /// The two parts of p = f(J) + g(J) e.
    fn linear(&self, jacobian: f64) -> Linear;

    /// Square of the isentropic sound speed, c^2 = (dp/drho)_s [m2/s2]; not positive where the
    /// model has ceased to hold.
    fn sound_speed_squared(&self, jacobian: f64, pressure: f64) -> f64;

    /// The least pressure that the material bears [Pa]: where f(J) + g(J) e is below, the pressure
    /// is this one.
    fn least_pressure(&self) -> f64 {
        f64::NEG_INFINITY
    }

    /// `pressure` of the linear form, as far as the material bears it [Pa].
    #[inline(always)]
    fn borne(&self, pressure: f64) -> f64 {
        // max() would pass over NaN
        if pressure < self.least_pressure() { self.least_pressure() } else { pressure }
    }

    /// Why a state lies outside of the model, if it does.
    fn fault(&self, jacobian: f64, pressure: f64) -> Option<&'static str>;

    /// Pressure [Pa].
    fn pressure(&self, jacobian: f64, energy: f64) -> f64 {
        let Linear { cold, energy_factor } = self.linear(jacobian);
        self.borne(cold + energy_factor * energy)
    }

    /// The specific internal energy at which the material is at `pressure` [J/kg].
    fn energy_at(&self, jacobian: f64, pressure: f64) -> f64 {
        let Linear { cold, energy_factor } = self.linear(jacobian);
        (pressure - cold) / energy_factor
    }
}
