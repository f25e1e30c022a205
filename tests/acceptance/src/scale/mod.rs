//! Many ranks, patches and particles: start-up, messages and balance.

mod balance;
mod bytes;
mod layout;
mod memory;
mod prediction;
mod ranks;
mod startup;

use crate::section::{Section, quick, usual};

/// Subject of the group.
pub const TITLE: &str = "Many ranks, patches and particles: start-up, messages and balance";

/// Sections in the order in which they run.
pub const SECTIONS: [Section; 7] = [
    usual("startup", startup::check),
    quick("layout", layout::check),
    usual("ranks", ranks::check),
    usual("memory", memory::check),
    quick("prediction", prediction::check),
    usual("bytes", bytes::check),
    usual("balance", balance::check),
];
