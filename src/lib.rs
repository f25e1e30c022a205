//! flyer-mpm: impact and shock waves by the material point method.

pub mod accounts;
pub mod burn;
pub mod calibrate;
pub mod clock;
pub mod constitutive;
pub mod contact;
pub mod exact;
pub mod figures;
pub mod geometry;
pub mod grid;
pub mod material;
pub mod model;
pub mod motion;
pub mod output;
pub mod particles;
pub mod patch;
pub mod probes;
pub mod reference;
pub mod run;
pub mod scene;
pub mod shape;
pub mod simulation;
pub mod step;
pub mod threads;
pub mod transfer;
pub mod viscosity;
