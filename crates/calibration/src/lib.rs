//! Random plate impacts with their estimated and true errors. The program of this crate fits the
//! error models of `flyer-mpm` to them; the acceptance program compares the models with others, and
//! with random scenes of other kinds.

pub mod against_fine_runs;
pub mod estimates;
pub mod random;
pub mod random_impacts;
pub mod random_scenes;
pub mod random_schemes;
