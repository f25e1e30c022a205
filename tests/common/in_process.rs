//! Runs on any layout within this process: ranks are threads, and nothing is written.

use std::panic::{AssertUnwindSafe, catch_unwind};

use decomp::comm::local::run_ranks;
use flyer_mpm::input;
use flyer_mpm::scene::CheckedScene;
use flyer_mpm::simulation::{RunError, Simulation};
use serde_json::Value;

use super::layouts::Layout;
use super::scenes::with;

/// Result that must not depend on the layout: digest of the final state, number of steps, and the
/// sums that a run prints; or its error message.
pub type End = Result<String, String>;

/// Result of a scene on a layout. A scene that is rejected is rejected by all layouts.
pub fn end_of(scene: &Value, layout: &Layout) -> End {
    let scene = with(scene, &layout.keys());
    let scene = input::parse(scene.to_string().as_bytes(), "scene.json", &[])
        .map_err(|error| error.to_string())?;
    let ranks = || run_ranks(layout.ranks, |comm| run(&scene, comm, layout.threads));
    let ends = catch_unwind(AssertUnwindSafe(ranks)).map_err(|fault| {
        let text = fault.downcast_ref::<String>().map(String::as_str);
        format!("panicked: {}", text.or(fault.downcast_ref().copied()).unwrap_or("?"))
    })?;
    let failed = ends.iter().filter(|end| end.is_err()).count();
    assert!(failed == 0 || failed == ends.len(), "all ranks end alike: {ends:?}");
    ends.into_iter().next().expect("rank 0").map_err(|error| error.to_string())
}

/// Run of one rank; rank 0 returns the digest. Collective.
fn run(scene: &CheckedScene, comm: &dyn decomp::Comm, threads: usize) -> Result<String, RunError> {
    // an error known to only one rank ends all ranks, as it ends the program
    let alone = |error| match error {
        RunError::Exchange(error) => panic!("{error}"),
        error => error,
    };
    let mut simulation = Simulation::<1>::new(scene, comm, threads).map_err(alone)?;
    let end = scene.scene.time.end;
    while simulation.time() < end {
        simulation.advance(end).map_err(alone)?;
    }
    let (totals, left, steps) = (simulation.totals(), simulation.left(), simulation.steps());
    let digest = simulation.gather().map(|(_, digest)| digest);
    Ok(format!("{}, {steps} steps, {totals:?}, {left:?}", digest.unwrap_or_default()))
}
