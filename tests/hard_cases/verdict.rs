//! Runs of scenes drawn at random: how each ends, and whether that may be.

use decomp::comm::local::run_ranks;
use flyer_mpm::input;
use flyer_mpm::scene::{CheckedScene, ShapeKind};
use flyer_mpm::simulation::monitor::keeps_energy;
use flyer_mpm::simulation::{Compiled, Simulation};
use flyer_mpm::solver::Stepper;
use serde_json::Value;

/// Growth of energy that no run may end with [-]: of a scheme that keeps it, of one that does not,
/// and of hat functions at particles' centres.
const GROWTH: [f64; 3] = [1e-3, 0.5, 10.0];

/// Steps beyond which a small scene hangs.
const MOST_STEPS: u64 = 100_000;

/// How a scene ends.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Its check refuses it.
    Refused(String),
    /// The monitor ends it.
    Alarm(String),
    /// It ends well: digest of the state.
    Well(String),
    /// It should not end as it does.
    Wrong(String),
}

/// The end of a scene on a line or in a plane, on so many ranks.
pub fn verdict(value: &Value, ranks: usize) -> Verdict {
    let scene = match input::parse(value.to_string().as_bytes(), "random.json", &[]) {
        Ok(scene) => scene,
        Err(error) => return Verdict::Refused(error.to_string()),
    };
    match scene.dimension {
        1 => end_of::<1>(&scene, ranks),
        _ => end_of::<2>(&scene, ranks),
    }
}

fn end_of<const D: usize>(scene: &CheckedScene, ranks: usize) -> Verdict
where
    Stepper<D>: Compiled<D>,
{
    let ends = run_ranks(ranks, |comm| {
        let mut simulation = match Simulation::<D>::new(scene, comm, 1) {
            Ok(simulation) => simulation,
            Err(error) => return Verdict::Alarm(error.to_string()),
        };
        let start = simulation.totals();
        let end = scene.scene.time.end;
        while simulation.time() < end {
            if let Err(error) = simulation.advance(end) {
                let error = error.to_string();
                let one_line = error.lines().count() == 1 && error.contains(char::is_alphabetic);
                return if one_line { Verdict::Alarm(error) } else { Verdict::Wrong(error) };
            }
            if simulation.steps() > MOST_STEPS {
                return Verdict::Wrong(format!("{MOST_STEPS} steps and no end"));
            }
        }
        let (now, left, given) = (simulation.totals(), simulation.left(), simulation.given());
        let Some((table, digest)) = simulation.gather() else {
            return Verdict::Well(String::new());
        };
        let finite = table.columns.iter().all(|c| c.values.iter().all(|v| v.is_finite()));
        if !finite {
            return Verdict::Wrong("a value that is no number".into());
        }
        if scene.accelerates() {
            // the work of such a piston is not a sum over walls
            return Verdict::Well(digest);
        }
        let grid = scene.grid_velocity::<D>();
        let impulse = |a: usize| {
            now.momentum[a] + left.momentum[a] - start.momentum[a] - now.body_force_impulse[a]
        };
        let piston: f64 = (0..D).filter(|&a| grid[a] != 0.0).map(|a| grid[a] * impulse(a)).sum();
        let outside = given.work + now.conducted + now.body_force_work;
        let work = piston + outside - left.kinetic - left.internal;
        let [e0, e1] = [start, now].map(|t| t.kinetic + t.internal);
        let growth = e1 - e0 - work;
        let exact = keeps_energy(&scene.scene);
        let bound = match exact {
            true => GROWTH[0],
            false => GROWTH[if scene.scene.method.shape == ShapeKind::Linear { 2 } else { 1 }],
        };
        // a body that starts cold or in tension has less than no energy, but energy to give
        let rounding = simulation.rounding_energy();
        let scale = start.kinetic + start.internal.abs() + work.abs() + rounding / bound;
        if growth > bound * scale || (exact && growth < -bound * scale) {
            return Verdict::Wrong(format!(
                "energy has changed from {e0:e} to {e1:e}, work {work:e}"
            ));
        }
        Verdict::Well(digest)
    });
    ends.into_iter().next().expect("rank 0")
}
