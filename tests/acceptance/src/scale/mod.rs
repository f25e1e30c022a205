//! Many ranks, patches and particles: start-up, messages and balance.

mod balance;
mod bytes;
mod memory;
mod startup;

use crate::section::{Section, usual};

/// Subject of the group.
pub const TITLE: &str = "Many ranks, patches and particles: start-up, messages and balance";

/// Sections in the order in which they run.
pub const SECTIONS: [Section; 4] = [
    usual("startup", startup::check),
    usual("memory", memory::check),
    usual("bytes", bytes::check),
    usual("balance", balance::check),
];
