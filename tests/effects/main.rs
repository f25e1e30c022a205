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
// each target looks at figures of its own
#[allow(dead_code)]
#[path = "../solids/tools.rs"]
mod tools;
