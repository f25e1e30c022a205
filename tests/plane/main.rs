//! Runs in a plane: a column is a line, any layout leaves the same bits, axes can be swapped and
//! mirrored, waves may run at any angle, bodies have any shape.
//!
//! Runs are made in process, through the library.

mod bodies;
mod column;
mod contact;
mod edges;
mod frame;
mod layouts;
mod loads;
mod pistons;
mod self_contact;
mod sides;
mod sphere;
mod spin;
mod symmetry;
mod tools;
mod waves;
