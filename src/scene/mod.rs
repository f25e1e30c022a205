//! The scene: what a run is told, read from JSON and checked once, whole.
//!
//! [`read`] takes the bytes from a file, [`parse`] makes a [`CheckedScene`] of them or one
//! [`SceneError`] of one line: the key's path, its value, what is allowed. Knows no MPI and no
//! particles.

mod check;
mod errors;
pub mod input_file;
mod library;
mod load;
mod model;
pub mod motion;
pub mod moving_frame;
mod overrides;
mod schema;
mod table;
mod validate;

pub use check::{
    BYTES_PER_CELL, BYTES_PER_PARTICLE, BYTES_PER_PATCH, CheckedBody, CheckedScene, Piston, Wall,
    available_memory,
};
pub use errors::SceneError;
pub use library::LIBRARY;
pub use load::{LARGEST_FILE, check, check_size, parse, parse_changed, read};
pub use model::*;
pub use schema::schema;
