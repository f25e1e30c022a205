//! Velocities that differ from place to place at the start, and body forces.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Velocity of a body at the start as a function of place: an object of one key.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum VelocityField {
    /// A rigid rotation.
    Rotation(Rotating),
    /// Straight streamlines along x that slide past each other.
    ShearLayer(Shearing),
    /// Gresho's vortex (Gresho & Chan 1990), with its pressure.
    Gresho(GreshoVortex),
    /// Away from a point at the same speed everywhere (Noh 1987 towards it).
    Radial(Radial),
    /// The generalized vortex (Kamojjala et al. 2015) at time 0.
    Vortex(RingVortex),
}

/// A rigid rotation.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rotating {
    /// Its centre [m].
    pub about: Vec<f64>,
    /// Counter-clockwise rate [rad/s].
    pub rate: f64,
}

/// A shear layer along x.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Shearing {
    /// The form of the profile.
    pub profile: ShearForm,
    /// Greatest velocity [m/s].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub speed: f64,
    /// Period of the sine, or half thickness of the tanh [m].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub height: f64,
    /// Where along y the velocity is 0 and the shear greatest [m].
    pub centre: f64,
}

/// Profiles of a shear layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ShearForm {
    /// speed sin(2 pi (y - centre)/height).
    Sine,
    /// speed tanh((y - centre)/height).
    Tanh,
}

/// Gresho's vortex.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GreshoVortex {
    /// Its centre [m].
    pub centre: Vec<f64>,
    /// Radius of the greatest velocity; the gas is at rest beyond twice that [m].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub radius: f64,
    /// Greatest velocity [m/s].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub speed: f64,
    /// Pressure in the centre [Pa].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub centre_pressure: f64,
}

/// The same speed away from a point.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Radial {
    /// The point [m]; on a line one number.
    pub about: Vec<f64>,
    /// Speed away from it; below 0 towards it [m/s].
    pub speed: f64,
}

/// The generalized vortex about the origin: the ring turns by
/// amplitude sin(pi t/period) (1 - xi^2)^2, xi from -1 at its inner to 1 at its outer radius.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RingVortex {
    /// Greatest angle [rad].
    pub amplitude: f64,
    /// Twice the time to the greatest angle [s].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub period: f64,
    /// Inner radius of the ring [m].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub inner: f64,
    /// Outer radius of the ring [m].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub outer: f64,
}

/// A force per mass on every particle: an object of one key.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum BodyForce {
    /// The same everywhere and always [m/s2].
    Gravity(Vec<f64>),
    /// What holds a neo-Hookean solid on the course of the generalized vortex (Kamojjala et al.
    /// 2015), at each particle's first place.
    Vortex(RingVortex),
}
