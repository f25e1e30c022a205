//! Output of a run: tables, histories, pictures and a summary, in a folder that is put in place as
//! a whole. Called on one rank, but for files that [`shared_file`] writes; independent of MPI and of the
//! grid.

pub mod brief;
pub mod compare;
pub mod csv;
pub mod decomposition;
pub mod error;
pub mod field_arrays;
pub mod field_files;
mod file_names;
pub mod folder;
pub mod gauges;
pub mod histories;
pub mod labels;
pub mod lock;
pub mod origin;
mod paths;
pub mod report;
pub mod shared_file;
pub mod summary;
pub mod trace;
pub mod unfinished;
pub mod vtkhdf;
pub mod wrap;

pub use error::OutputError;
pub use file_names::SUMMARY_FILE;
