//! Domain decomposition for particle-grid methods: patches, ghost particles and messages.
//!
//! The domain is a box of cells, cut into patches; each patch is assigned to a rank. A patch owns
//! the particles in its cells and the nodes at the lower corners of its cells. Two exchanges
//! provide other data; they work in the same way within a rank and between ranks:
//!
//! - [`GhostExchange`] gives each patch copies ("ghosts") of the particles that reach its nodes. It
//!   also hands over ("migrates") particles that have moved into another patch. Each neighbouring
//!   rank gets one message, in which a ghost for several of its patches stands once.
//! - [`NodeExchange`] gives each patch finished values of nodes that other patches own; a node too
//!   travels once to a rank.
//!
//! Both let the caller compute while messages are on their way. [`assign_patches`] assigns patches
//! to ranks along a [`PatchOrder`], by weight, [`assign_with_short_borders`] chooses the order, and
//! [`relocate`] moves whole patches.
//! [`Shares`] distributes the particles over ranks for files and tables, [`StoredParticles`] holds a
//! share of them, and [`distribute_particles`] hands shares to the patches of any layout.
//!
//! Particles are kept in canonical order, by global cell and then by id. Every patch that sums
//! particle terms into a node thus adds the same terms in the same order: the result is bitwise the
//! same for any layout and any number of ranks or threads.
//!
//! This crate contains no physics: a particle is an id, a cell and a set of declared columns of
//! `f64`. It does not interpolate, integrate or write files, and the caller decides when to
//! exchange data.

pub mod array;
mod balance;
mod bottleneck;
mod bytes;
pub mod comm;
mod counting_sort;
mod ghost_bundle;
mod ghost_exchange;
mod ghost_merge;
mod hilbert;
mod index_box;
mod layout;
mod node_messages;
mod node_runs;
mod nodes;
mod owners;
mod packing;
mod particle_block;
mod particle_sort;
mod patch_migration;
mod patch_order;
mod planned_words;
mod reduce;
mod shares;
mod short_borders;
mod threads;

pub use balance::{PatchLoads, assign_patches, busiest_share, choose_cuts, even_cuts};
pub use bytes::{bytes_of, words_of};
pub use comm::{Comm, Serial, Traffic};
pub use ghost_bundle::GhostReach;
pub use ghost_exchange::{GhostExchange, ParticleError};
pub use index_box::IndexBox;
pub use layout::{Image, Layout, SideKind};
pub use nodes::{NodeArrays, NodeExchange, Parity, fold_mirrors};
pub use particle_block::{Block, ColumnSpec, Mirror};
pub use patch_migration::{Census, Moved, relocate};
pub use patch_order::PatchOrder;
pub use reduce::{ExactSum, exact_sums};
pub use shares::{Shares, StoredParticles, distribute_particles};
pub use short_borders::assign_with_short_borders;
