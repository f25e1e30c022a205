//! flyer-mpm: impact and shock waves by the material point method.
//!
//! The rooms of the library, from the top down; each uses those below it:
//!
//! - [`study`]: many runs in processes of their own, error against time;
//! - [`driver`]: a run with its files;
//! - [`accuracy`]: comparison with exact solutions, error estimates, plans;
//! - [`perf_model`]: prediction of run time and scaling;
//! - [`simulation`]: a run in memory, where physics and messages meet;
//! - [`solver`]: particles, nodal fields and the time step;
//! - [`effects`]: effects that a scene may ask for;
//! - [`scene`]: the input and its check;
//! - [`geometry`]: bodies and how they are filled;
//! - [`exact`]: closed solutions; knows materials alone;
//! - [`material`]: equations of state, strength and failure;
//! - [`plot`]: pictures; knows none of the others.

pub mod accuracy;
pub mod driver;
pub mod effects;
pub mod exact;
pub mod geometry;
pub mod material;
pub mod perf_model;
pub mod plot;
pub mod scene;
pub mod simulation;
pub mod solver;
pub mod study;
