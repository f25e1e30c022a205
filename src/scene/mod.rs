//! The scene: the input of a run, read from JSON and checked as a whole once.
//!
//! [`read`] takes the bytes from a file. [`parse`] turns them into a [`CheckedScene`] or a
//! [`SceneError`] of one line: path of the key, its value, and what is allowed. Independent of MPI
//! and particles.

mod check;
mod errors;
pub mod input_file;
mod library;
mod load;
mod migrate;
mod model;
pub mod motion;
pub mod moving_frame;
mod overrides;
mod preset;
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
pub use migrate::migrate;
pub use model::*;
pub use preset::{MethodChoice, Preset};
pub use schema::schema;
