//! Initial velocities that vary in space, and body forces.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Initial velocity of a body as a function of position: an object with one key.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum VelocityField {
    /// A rigid rotation.
    Rotation(Rotating),
    /// A shear layer: straight streamlines along x with a velocity that depends on y.
    ShearLayer(Shearing),
    /// The Gresho vortex (Gresho & Chan 1990), with its pressure.
    Gresho(GreshoVortex),
    /// Uniform speed away from a point, or towards it (Noh 1987).
    Radial(Radial),
    /// The generalized vortex (Kamojjala et al. 2015) at time 0.
    Vortex(RingVortex),
}

impl VelocityField {
    /// Whether it shears the body that moves with it.
    pub fn shears(&self) -> bool {
        match self {
            VelocityField::ShearLayer(_) | VelocityField::Gresho(_) | VelocityField::Vortex(_) => {
                true
            }
            VelocityField::Rotation(_) | VelocityField::Radial(_) => false,
        }
    }
}

/// A rigid rotation.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rotating {
    /// Coordinates of the centre of the rotation [m].
    pub about: Vec<f64>,
    /// Angular velocity, counter-clockwise [rad/s].
    pub rate: f64,
}

/// A shear layer along x.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Shearing {
    /// Shape of the velocity profile.
    pub profile: ShearForm,
    /// Largest velocity of the profile [m/s].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub speed: f64,
    /// Period of the sine, or half thickness of the tanh [m].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub height: f64,
    /// Position along y at which the velocity is 0 and the shear is largest [m].
    pub centre: f64,
}

/// Velocity profile of a shear layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ShearForm {
    /// speed sin(2 pi (y - centre)/height).
    Sine,
    /// speed tanh((y - centre)/height).
    Tanh,
}

/// The Gresho vortex.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GreshoVortex {
    /// Coordinates of the centre of the vortex [m].
    pub centre: Vec<f64>,
    /// Radius of the largest velocity; beyond twice this radius the gas is at rest [m].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub radius: f64,
    /// Largest velocity of the gas, at `radius` [m/s].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub speed: f64,
    /// Pressure at the centre [Pa]. With a larger value the Mach number is smaller.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub centre_pressure: f64,
}

/// Uniform speed away from a point.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Radial {
    /// Coordinates of the point [m]; in one dimension a list with one number.
    pub about: Vec<f64>,
    /// Speed away from the point; negative: towards it [m/s].
    pub speed: f64,
}

/// The generalized vortex about the origin: the ring rotates by the angle amplitude sin(pi
/// t/period) (1 - xi^2)^2, where xi is -1 at its inner and 1 at its outer radius.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RingVortex {
    /// Largest angle by which the middle of the ring rotates [rad]. With a larger value the ring is
    /// sheared more.
    pub amplitude: f64,
    /// Twice the time at which the angle is largest [s]; at this time the ring is back at its
    /// initial position.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub period: f64,
    /// Inner radius of the ring [m].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub inner: f64,
    /// Outer radius of the ring [m].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub outer: f64,
}

/// Body force per unit mass on every particle: an object with one key.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum BodyForce {
    /// Acceleration, constant in space and time [m/s2].
    Gravity(Vec<f64>),
    /// Body force that keeps a neo-Hookean solid in the motion of the generalized vortex (Kamojjala
    /// et al. 2015), evaluated at each particle's initial position.
    Vortex(RingVortex),
}
