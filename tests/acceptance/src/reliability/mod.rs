//! Checkpoints and faults: restarts, kills, full disks, damaged files.

mod cost;
mod damage;
mod full;
mod kills;
#[path = "../../../effects/metal.rs"]
mod metal;
mod restarts;
mod runs;

use crate::section::{Section, usual};

pub const TITLE: &str = "Checkpoints and faults: restarts, kills, full disks, damaged files";

pub const SECTIONS: [Section; 5] = [
    usual("restarts", restarts::check),
    usual("kills", kills::check),
    usual("full", full::check),
    usual("damage", damage::check),
    usual("cost", cost::check),
];
