//! Exact references for scenes in two dimensions.
//!
//! - [`vortex`]: the generalized vortex, a solid held on its course by a body force;
//! - [`rotation`]: what a spinning body keeps;
//! - [`noh`]: a cold gas that implodes; [`gresho`]: a vortex in a gas that stands still;
//!   [`shear_layer`]: layers that slide past each other;
//! - [`oblique`]: a solution in one dimension as plane waves across the grid;
//! - [`edge`]: until when a plate of finite width looks infinitely wide;
//! - [`gap`] and [`separation`]: plates that meet, and plates that let go of each other.
//!
//! Knows no particles, grid, scene or files. SI units; places and velocities are pairs [x, y].

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

/// A place [m], velocity [m/s] or the like in the plane.
pub type Vector = [f64; 2];

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The component of a x b across the plane.
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

/// `v` turned by `angle` [rad], counter-clockwise.
fn turn([x, y]: Vector, angle: f64) -> Vector {
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}
