//! Solids, body forces and first motions, in planes and on lines.

mod bodies;
mod disks;
mod forces;
mod gases;
mod refused;
mod solids;
mod tools;
mod vortex;
