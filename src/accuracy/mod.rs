//! Accuracy of a run: comparison with exact solutions, estimates of the error of a run, and plans
//! of the cheapest run for a target error.

pub mod estimate;
pub mod plan;
pub mod reference;
