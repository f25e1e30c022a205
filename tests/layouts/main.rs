//! Any layout, the same bits: ranks x patches x threads x balance x skipping x overlap x filter.
//!
//! Runs are made in process; ranks are threads. The acceptance program (`decomposition/bits`) does the
//! same by mpirun, files and printed lines included.

#[path = "../common/covering.rs"]
mod covering;
mod found;
#[path = "../common/in_process.rs"]
mod in_process;
#[path = "../common/layouts.rs"]
mod layouts;
mod plane;
mod random;
#[path = "../common/random_scenes.rs"]
mod random_scenes;
#[path = "../common/scenes.rs"]
mod scenes;
mod schemes;
#[path = "../common/small_scenes.rs"]
mod small_scenes;
