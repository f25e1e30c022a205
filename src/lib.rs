//! flyer-mpm: impact and shock waves by the material point method.
//!
//! The modules of the library, from the top down; each uses those below it:
//!
//! - [`study`]: parameter studies, each run in its own process; error against time;
//! - [`driver`]: a run with its files;
//! - [`accuracy`]: comparison with exact solutions, error estimates, plans;
//! - [`perf_model`]: prediction of run time and scaling;
//! - [`simulation`]: a run in memory, which joins physics and messages;
//! - [`input`]: reading and checking of a scene;
//! - [`effects`]: optional effects of a scene;
//! - [`solver`]: particles, nodal fields and the time step;
//! - [`scene`]: the data of a scene;
//! - [`geometry`]: bodies and how they are filled with particles;
//! - [`side`]: kinds of side of the domain;
//! - [`balance`]: measures of a patch's load;
//! - [`contact`]: contact laws between bodies;
//! - [`exact`]: closed solutions; depends on materials only;
//! - [`shape`]: shape functions: weights of particles on nodes;
//! - [`transfer`]: transfers of velocity from nodes to particles;
//! - [`material`]: equations of state, strength and failure;
//!
//! Beside them stand two crates: `decomp`, patches and messages, and [`plot`], pictures. They do not
//! depend on this library.

pub mod accuracy;
pub mod balance;
pub mod contact;
pub mod driver;
pub mod effects;
pub mod exact;
pub mod geometry;
pub mod input;
pub mod material;
pub mod perf_model;
pub mod scene;
pub mod shape;
pub mod side;
pub mod simulation;
pub mod solver;
pub mod study;
pub mod transfer;

pub use plot;
