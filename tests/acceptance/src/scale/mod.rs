//! Many ranks, patches and particles: start-up, messages and balance.

mod balance;
mod bytes;
mod memory;
mod ranks;
mod startup;

use crate::section::{Section, usual};

/// Subject of the group.
pub const TITLE: &str = "Many ranks, patches and particles: start-up, messages and balance";

/// Sections in the order in which they run.
pub const SECTIONS: [Section; 5] = [
    usual("startup", startup::check),
    usual("ranks", ranks::check),
    usual("memory", memory::check),
    usual("bytes", bytes::check),
    usual("balance", balance::check),
];
