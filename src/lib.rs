//! flyer-mpm: impact and shock waves by the material point method.

//pub mod exact;
pub mod material;
pub mod output;
pub mod scene;
pub mod constitutive;
pub mod grid;
pub mod particles;
pub mod patch;
pub mod shape;
pub mod simulation;
pub mod step;
pub mod transfer;
pub mod viscosity;
