//! Effects that a scene names: strength, failure, erosion, temperature.

mod erosion;
mod failure;
mod heat;
mod heat_mixing;
mod layouts;
mod metal;
mod outside;
mod refused;
mod shares;
mod strength;
mod temperature;
#[expect(dead_code, reason = "each target uses a part")]
#[path = "../solids/tools.rs"]
mod tools;
