//! What is known of a run before it starts.

use decomp::Serial;

use super::{Compiled, RunError, Simulation};
use crate::effects;
use crate::scene::CheckedScene;
use crate::solver::Stepper;
use crate::solver::columns::Columns;

/// Memory of a run up to which its particles are created to find the first step \[bytes\].
const CREATED: u64 = 256 << 20;

/// Columns and first time step of a run.
#[derive(Debug)]
pub struct Preview {
    /// Particle columns.
    pub columns: Columns,
    /// Time step \[s\] at the start by the Courant condition; of a large scene an estimate from sound
    /// speeds and velocities.
    pub first_step: f64,
}

impl Preview {
    /// Preview of a run of `scene`. It depends on the dimension inside alone, so that a program
    /// that uses it compiles none of the solver.
    ///
    /// # Errors
    ///
    /// If the scene cannot be simulated.
    pub fn new(scene: &CheckedScene) -> Result<Preview, RunError> {
        match scene.dimension {
            1 => preview::<1>(scene),
            _ => preview::<2>(scene),
        }
    }
}

fn preview<const D: usize>(scene: &CheckedScene) -> Result<Preview, RunError>
where
    Stepper<D>: Compiled<D>,
{
    let stepper = effects::stepper::<D>(scene);
    let first_step = if scene.memory() <= CREATED {
        Simulation::<D>::new(scene, &Serial, 1)?.time_step()
    } else {
        let grid = scene.frame::<D>().velocity(0.0);
        let steps = (0..scene.bodies.len()).map(|body| stepper.starting_step(scene, body, grid));
        scene.scene.time.courant * steps.fold(f64::INFINITY, f64::min)
    };
    Ok(Preview { columns: stepper.columns.clone(), first_step })
}
