//! The performance model's counts against what real steps do.

mod counts;
mod layouts;
mod positions;
