//! Accuracy of the shipped schemes and its cost, error estimates and plans.

mod companions;
mod estimate;
mod plan;
mod scenes;
mod schemes;

use crate::section::{Section, quick, usual};

/// Subject of the group.
pub const TITLE: &str = "Accuracy of the shipped schemes and its cost, error estimates and plans";

/// Sections in the order in which they run.
pub const SECTIONS: [Section; 11] = [
    quick("standard", schemes::standard),
    usual("order", schemes::order),
    usual("impacts", schemes::impacts),
    quick("noh", schemes::noh),
    quick("smooth", schemes::smooth),
    quick("cost", schemes::cost),
    usual("companions", companions::check),
    usual("estimate", estimate::check),
    usual("scenes", scenes::check),
    usual("plan", plan::check),
    usual("plan_schemes", plan::schemes),
];
