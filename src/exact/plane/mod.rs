//! Exact references for scenes in two dimensions.
//!
//! - [`vortex`]: the generalized vortex, a solid driven by a manufactured body force;
//! - [`rotation`]: quantities that a spinning body conserves;
//! - [`noh`]: a cold gas that implodes;
//! - [`gresho`]: a stationary vortex in a gas;
//! - [`shear_layer`]: layers that slide past each other;
//! - [`oblique`]: a one-dimensional solution as plane waves at an angle to the grid;
//! - [`edge`]: the time until which a plate of finite width behaves as an infinitely wide one;
//! - [`gap`] and [`separation`]: plates that come into contact, and plates that separate.
//!
//! These modules know no particles, grid, scene or files. SI units; positions and velocities are
//! pairs [x, y].

pub mod edge;
pub mod gap;
pub mod gresho;
pub mod noh;
pub mod oblique;
pub mod rotation;
pub mod separation;
pub mod shear_layer;
pub mod vortex;

pub use edge::EdgeRelease;
pub use gap::Gap;
pub use gresho::Gresho;
pub use noh::{Noh, Symmetry};
pub use oblique::{PlanePoint, PlaneWave};
pub use rotation::{MassPoint, Turned};
pub use separation::Separation;
pub use shear_layer::{ShearLayer, ShearProfile};
pub use vortex::{Displaced, Vortex};

/// A position [m], velocity [m/s] or other vector in the plane.
pub type Vector = [f64; 2];

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The component of a x b normal to the plane.
fn cross(a: Vector, b: Vector) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn difference(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1]]
}

fn square(a: Vector) -> f64 {
    dot(a, a)
}

fn length([x, y]: Vector) -> f64 {
    x.hypot(y)
}

/// `v` rotated counter-clockwise by `angle` [rad].
fn turn([x, y]: Vector, angle: f64) -> Vector {
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}
