//! Accuracy of the shipped schemes and its cost, error estimates and plans.

mod estimate;
#[path = "../../../../examples/common/estimates.rs"]
mod estimates;
mod plan;
#[path = "../../../../examples/common/random_impacts.rs"]
pub mod random_impacts;
mod schemes;

use crate::section::{Section, usual};

pub const TITLE: &str = "Accuracy of the shipped schemes and its cost, error estimates and plans";

pub const SECTIONS: [Section; 8] = [
    usual("standard", schemes::standard),
    usual("order", schemes::order),
    usual("impacts", schemes::impacts),
    usual("noh", schemes::noh),
    usual("smooth", schemes::smooth),
    usual("cost", schemes::cost),
    usual("estimate", estimate::check),
    usual("plan", plan::check),
];
