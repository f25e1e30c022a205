//! Work shared over ranks, patches and threads: the same bits, speed, balance and memory.

mod balance;
mod bits;
#[path = "../../../common/covering.rs"]
mod covering;
mod hang;
#[path = "../../../common/in_process.rs"]
mod in_process;
#[path = "../../../common/layouts.rs"]
mod layouts;
mod memory;
mod quiet;
mod received;
mod schemes;
#[path = "../../../common/small_scenes.rs"]
mod small_scenes;
mod speed;

use crate::hard_cases::scenes;
use crate::section::{Section, quick, usual};

/// Subject of the group.
pub const TITLE: &str =
    "Work shared over ranks, patches and threads: the same bits, speed, balance and memory";

/// Sections in the order in which they run.
pub const SECTIONS: [Section; 8] = [
    usual("bits", bits::check),
    usual("schemes", schemes::check),
    usual("speed", speed::check),
    usual("balance", balance::check),
    quick("quiet", quiet::check),
    usual("memory", memory::check),
    quick("received", received::check),
    quick("hang", hang::check),
];
