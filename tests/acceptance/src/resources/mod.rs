//! Cost of the program itself: time of builds and tests, instructions of a step.

mod build;
mod instructions;

use crate::section::{Section, named, usual};

/// Subject of the group.
pub const TITLE: &str =
    "Cost of the program itself: time of builds and tests, instructions of a step";

/// Sections in the order in which they run.
pub const SECTIONS: [Section; 2] = [
    // half an hour, and some GB in the target folder
    named("build", build::check),
    usual("instructions", instructions::check),
];
