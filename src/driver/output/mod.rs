//! What a run writes: tables, histories, pictures, a summary, in a folder put in place as a
//! whole. Called on one rank; knows no MPI and no grid.

pub mod compare;
pub mod csv;
pub mod decomposition;
pub mod error;
pub mod folder;
pub mod histories;
pub mod lock;
pub mod origin;
pub mod report;
pub mod summary;
pub mod trace;
pub mod vtkhdf;

pub use error::OutputError;
