//! How accurate a run is: comparison with exact solutions, estimates of a run's own error, the
//! cheapest run for a target error.

pub mod estimate;
pub mod plan;
pub mod reference;
