//! Materials: equations of state, strength and failure. Each model has its own file and one line in
//! the list of its kind.
//!
//! Independent of particles, grid and dimension: a model takes the state of one point only.

pub mod constitutive;
pub mod definition;
pub mod eos;
pub mod failure;
pub(crate) mod parameter_error;
pub mod strength;

pub use eos::*;
pub use parameter_error::ParameterError;
