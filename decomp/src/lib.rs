//! Patches and messages for particle-grid methods.
//!
//! The domain is a box of cells, cut into patches; patches are dealt to ranks. A patch owns the
//! particles in its cells and the nodes at their lower corners. What it needs beyond those comes
//! in two ways, both the same between two patches of one rank and between ranks:
//!
//! - [`RowExchange`] gives each patch copies ("ghosts") of the particle rows that reach its
//!   nodes, and hands over ("migrates") rows that have moved into another patch, in one message
//!   a neighbouring rank.
//! - [`NodeExchange`] gives each patch finished values of nodes that other patches own.
//!
//! Both let the caller compute while messages fly. [`assign_patches`] deals patches to ranks
//! along a space-filling curve by their weights, and [`patch_migration`] moves whole patches.
//! [`StoredRows`] holds the rows of all ranks, for a file, and [`deal_rows`] brings them back to any
//! layout.
//!
//! Rows stand in canonical order, by global cell and then by id, so every patch that sums
//! particle terms into a node adds the same terms in the same order: any layout and any number of
//! ranks or threads gives the same bits.
//!
//! This crate knows no physics: a row is an id, a cell and some declared columns of `f64`.
//! It does not interpolate, integrate, write files, or choose when anything is exchanged.

mod balance;
mod bytes;
pub mod comm;
mod gather_scatter;
mod ghost_exchange;
mod hilbert;
mod index_box;
mod layout;
mod nodes;
mod packing;
mod particle_block;
mod patch_migration;
mod reduce;

pub use balance::{assign_patches, busiest_share, choose_cuts, even_cuts};
pub use bytes::{bytes_of, words_of};
pub use comm::{Comm, Serial, Traffic};
pub use gather_scatter::{StoredRows, deal_rows, gather_rows};
pub use ghost_exchange::{RowError, RowExchange, RowReach};
pub use hilbert::curve_order;
pub use index_box::IndexBox;
pub use layout::{Image, Layout, Side};
pub use nodes::{NodeArrays, NodeExchange, Parity, fold_mirrors};
pub use particle_block::{Block, ColumnSpec, Mirror};
pub use patch_migration::{Census, Moved, relocate};
pub use reduce::{ExactSum, exact_sums};
