//! Output of a run: tables, histories, pictures and a summary, in a folder that is put in place as
//! a whole. Called on one rank; independent of MPI and of the grid.

pub mod brief;
pub mod compare;
pub mod csv;
pub mod decomposition;
pub mod error;
mod file_names;
pub mod folder;
pub mod histories;
pub mod labels;
pub mod lock;
pub mod origin;
mod paths;
pub mod report;
pub mod summary;
pub mod trace;
pub mod vtkhdf;
pub mod wrap;

pub use error::OutputError;
pub use file_names::SUMMARY_FILE;
