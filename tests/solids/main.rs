//! Solids, body forces and first motions, in planes and on lines.

mod bodies;
mod forces;
mod refused;
mod solids;
mod tools;
mod vortex;
