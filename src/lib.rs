//! flyer-mpm: impact and shock waves by the material point method.

pub mod exact;
pub mod material;
pub mod output;
pub mod scene;
