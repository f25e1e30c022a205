//! The physics of whole runs: exact solutions, conservation, symmetries, the same bits for any
//! layout, and every option and scheme.
//!
//! Runs are made in process, through the library.

mod accuracy;
mod ahead;
mod bits;
mod conservation;
mod contact;
mod frame;
mod hard;
mod invariance;
mod options;
#[path = "../common/scenes.rs"]
mod scenes;
mod schemes;
mod sharing;
mod sides;
#[path = "../common/small_scenes.rs"]
mod small_scenes;
mod times;
mod tools;
mod units;
