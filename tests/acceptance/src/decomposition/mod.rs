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
mod schemes;
mod speed;

use crate::hard_cases::scenes;
use crate::section::{Section, usual};

pub const TITLE: &str =
    "Work shared over ranks, patches and threads: the same bits, speed, balance and memory";

pub const SECTIONS: [Section; 7] = [
    usual("bits", bits::check),
    usual("schemes", schemes::check),
    usual("speed", speed::check),
    usual("balance", balance::check),
    usual("quiet", quiet::check),
    usual("memory", memory::check),
    usual("hang", hang::check),
];
