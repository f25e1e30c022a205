//! Reading and checking of a scene: from the bytes of a file to a
//! [`CheckedScene`](crate::scene::CheckedScene), or to a [`SceneError`] of one line with the path of
//! the key, its value, and what is allowed.
//!
//! [`read`] takes the bytes from a file, [`parse`] turns them into a checked scene. Independent of MPI
//! and particles.

mod check;
mod comments;
mod errors;
mod failure_laws;
mod faults;
pub mod input_file;
mod library;
mod load;
mod migrate;
mod names;
mod overrides;
mod paths;
mod preset;
mod readable;
mod schema;
mod table;
mod units;
mod validate;

pub use check::{BYTES_PER_CELL, BYTES_PER_PARTICLE, BYTES_PER_PATCH, available_memory};
pub use errors::SceneError;
pub use failure_laws::failure_laws;
pub use library::LIBRARY;
pub use load::{LARGEST_FILE, check, check_size, parse, parse_changed, read};
pub use migrate::migrate;
pub use schema::schema;
