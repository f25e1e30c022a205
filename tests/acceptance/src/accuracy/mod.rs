//! Accuracy of the shipped schemes and its cost, error estimates and plans.

mod estimate;
#[path = "../../../../examples/common/estimates.rs"]
mod estimates;
mod plan;
#[path = "../../../../examples/common/random.rs"]
pub mod random;
#[path = "../../../../examples/common/random_impacts.rs"]
mod random_impacts;
#[path = "../../../../examples/common/random_schemes.rs"]
mod random_schemes;
mod schemes;

use crate::section::{Section, quick, usual};

/// Subject of the group.
pub const TITLE: &str = "Accuracy of the shipped schemes and its cost, error estimates and plans";

/// Sections in the order in which they run.
pub const SECTIONS: [Section; 8] = [
    quick("standard", schemes::standard),
    usual("order", schemes::order),
    usual("impacts", schemes::impacts),
    quick("noh", schemes::noh),
    quick("smooth", schemes::smooth),
    quick("cost", schemes::cost),
    usual("estimate", estimate::check),
    usual("plan", plan::check),
];
