//! Checkpoints and faults: restarts, kills, full disks, damaged files.

mod cost;
mod damage;
mod frames;
mod full;
mod kills;
#[path = "../../../effects/metal.rs"]
mod metal;
mod restarts;
mod runs;

use crate::section::{Section, quick, usual};

/// Subject of the group.
pub const TITLE: &str = "Checkpoints and faults: restarts, kills, full disks, damaged files";

/// Sections in the order in which they run.
pub const SECTIONS: [Section; 6] = [
    usual("restarts", restarts::check),
    usual("kills", kills::check),
    usual("full", full::check),
    quick("damage", damage::check),
    usual("cost", cost::check),
    usual("frames", frames::check),
];
