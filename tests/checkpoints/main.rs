//! Checkpoints: a run continued from one gives the bits of an uninterrupted run, on any layout;
//! damage is seen; faults leave what was good.

#[path = "../contract/home.rs"]
#[expect(dead_code, reason = "shared with other targets")]
mod home;
#[path = "../contract/program.rs"]
#[expect(dead_code, reason = "shared with other targets")]
mod program;
#[path = "../common/scenes.rs"]
#[expect(dead_code, reason = "shared with other targets")]
mod scenes;
#[path = "../common/small_scenes.rs"]
#[expect(dead_code, reason = "shared with other targets")]
mod small_scenes;

mod bits;
mod damage;
mod faults;
mod fields;
mod hostile;
mod restarts;
mod stops;
