//! Closed and near-exact solutions, the references for computed results.
//!
//! - [`wave_interactions`]: the chain of impedance matches of Burghardt (2010), which treats
//!   rarefactions as shocks;
//! - [`impact`]: the true solution of a plate impact, with rarefaction fans, in laboratory
//!   coordinates (computed in `tracking`: front tracking in Lagrangian coordinates);
//! - [`release`]: states and times of that solution in closed form, by release isentropes;
//! - [`hugoniot`]: shocks and isentropes of any equation of state;
//! - [`simple_wave`]: a smooth wave that a piston sends into material at rest;
//! - [`riemann`]: two ideal gases separated by a diaphragm;
//! - [`wall`]: one body that strikes a wall, and [`elastic_plastic`]: one with strength;
//! - [`plane`]: references in two dimensions, and the plate impact in two dimensions;
//! - [`mod@score`]: the errors of a computed profile against one of these solutions.
//!
//! These modules know materials, but no particles, grid, scene or files. All except [`plane`] are
//! one-dimensional, in uniaxial strain. Only [`elastic_plastic`] and [`plane::vortex`] include
//! strength; none includes heat conduction. SI units; pressure is positive in compression.

#[cfg(test)]
mod checks;
pub mod elastic_plastic;
pub mod hugoniot;
pub mod impact;
mod isentrope;
pub mod plane;
pub mod profile;
pub mod release;
pub mod riemann;
pub mod score;
pub mod simple_wave;
mod smoothing;
mod tracking;
pub mod wall;
mod wave;
mod wave_collision;
pub mod wave_interactions;

pub use elastic_plastic::{Behind, ElasticPlastic, Plastic};
pub use hugoniot::{HugoniotState, ShockFront};
pub use impact::{Accuracy, Impact, ImpactBody, Snapshot, Solution, TracedPoint};
pub use plane::{
    Displaced, EdgeRelease, Gap, Gresho, MassPoint, Noh, PlanePoint, PlaneWave, Separation,
    ShearLayer, ShearProfile, Symmetry, Turned, Vortex,
};
pub use profile::{History, HistoryPoint, Landmarks, Path, PathKind, Plate, Profile, ProfilePoint};
pub use release::Release;
pub use riemann::{GasState, RiemannSolution};
pub use score::{
    Errors, ScoreSample, WaveErrors, cell_average, interface_errors, score, score_density,
};
pub use simple_wave::{Drive, SimpleWaveSolution};
pub use wall::{WallImpactSolution, WallMaterial};
pub use wave_interactions::{Chain, ChainState, ChainWave, WaveKind};

/// Reasons why an exact solution cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExactError {
    /// A number that is not positive and finite, or out of range.
    #[error("{name} is {value}, but must be {allowed}")]
    Number {
        /// Name of the number.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Allowed values.
        allowed: &'static str,
    },
    /// The bodies do not approach each other, or overlap.
    #[error("no impact: {0}")]
    NoImpact(&'static str),
    /// A state that the material cannot reach.
    #[error("{what}, at compression chi = {chi}")]
    State {
        /// Description of the fault.
        what: &'static str,
        /// Compression 1 - rho0/rho [-].
        chi: f64,
    },
    /// Two gases that separate so fast that a vacuum opens.
    #[error(
        "the gases part at {difference} m/s and leave a vacuum; less than {limit} m/s is needed"
    )]
    Vacuum {
        /// u_right - u_left [m/s].
        difference: f64,
        /// The speed at which a vacuum opens [m/s].
        limit: f64,
    },
    /// The search for a state between two waves did not converge.
    #[error(
        "no state found between two waves meeting at t = {time} s, X = {place} m: the equation of \
         state does not stretch so far"
    )]
    NoConvergence {
        /// Time [s].
        time: f64,
        /// Lagrangian position [m].
        place: f64,
    },
    /// The target's rear may not be a free surface, so the reflection of the waves there is not
    /// known.
    #[error(
        "the target's rear is not a free surface throughout: a body or a side of the domain lies \
         beyond it, or its material can fail"
    )]
    RearNotFree,
    /// The solution has more waves than can be followed.
    #[error("more than {limit} wave interactions before t = {time} s")]
    TooManyWaves {
        /// Greatest number of interactions.
        limit: usize,
        /// Time reached [s].
        time: f64,
    },
}

/// `value` if it is positive and finite.
fn positive(name: &'static str, value: f64) -> Result<f64, ExactError> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(ExactError::Number { name, value, allowed: "positive and finite" })
    }
}

/// `value` if it is finite.
fn finite(name: &'static str, value: f64) -> Result<f64, ExactError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(ExactError::Number { name, value, allowed: "finite" })
    }
}

/// The materials of `inputs/flyer.json`, for tests.
#[cfg(test)]
pub(crate) mod samples {
    use crate::material::MieGruneisen;

    pub const COPPER: MieGruneisen =
        MieGruneisen { rho0: 8930.0, c0: 3940.0, s: 1.489, gamma0: 1.96 };
    pub const ALUMINIUM: MieGruneisen =
        MieGruneisen { rho0: 2785.0, c0: 5386.0, s: 1.339, gamma0: 2.1 };
}
