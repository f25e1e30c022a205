//! Set-up and step of a run, compiled once in this crate for each dimension. Both call most of the
//! solver and of the effects, which every program that uses the library would compile again.

use decomp::Comm;

use super::error::RunError;
use super::run::Simulation;
use crate::material::constitutive::CustomModel;
use crate::scene::CheckedScene;
use crate::solver::Stepper;

/// Dimensions in which runs exist. A [`Stepper`] of the dimension has it.
pub trait Compiled<const D: usize> {
    /// Compiled form of [`Simulation::with_models`]. Collective.
    ///
    /// # Errors
    ///
    /// As [`Simulation::with_models`].
    fn create<'a>(
        scene: &'a CheckedScene,
        comm: &'a dyn Comm,
        threads: usize,
        outside: &dyn Fn(&str) -> Option<CustomModel>,
    ) -> Result<Simulation<'a, D>, RunError>;

    /// Compiled form of [`Simulation::advance`]. Collective.
    ///
    /// # Errors
    ///
    /// As [`Simulation::advance`].
    fn advance_run(run: &mut Simulation<'_, D>, until: f64) -> Result<(), RunError>;
}

macro_rules! compile_runs {
    ($($dimension:literal),*) => {$(
        impl Compiled<$dimension> for Stepper<$dimension> {
            fn create<'a>(
                scene: &'a CheckedScene,
                comm: &'a dyn Comm,
                threads: usize,
                outside: &dyn Fn(&str) -> Option<CustomModel>,
            ) -> Result<Simulation<'a, $dimension>, RunError> {
                Simulation::create(scene, comm, threads, outside)
            }

            fn advance_run(
                run: &mut Simulation<'_, $dimension>,
                until: f64,
            ) -> Result<(), RunError> {
                run.advance_by_step(until)
            }
        }
    )*};
}

compile_runs!(1, 2);
