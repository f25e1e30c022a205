//! Effects that a scene names: strength, failure, temperature.

mod failure;
mod layouts;
mod refused;
mod strength;
mod temperature;
#[path = "../solids/tools.rs"]
mod tools;
