//! Particles of a rank on many ranks: quiescent patches are assigned by memory.

use crate::bounds::{Unit, scale as bounds};
use crate::runs::Job;
use crate::table::Table;

/// The particles of the fullest of 16 ranks over the mean, at the end of a short run.
pub fn check(table: &mut Table) {
    let sets = [
        "reference=null",
        "time.end=1e-7",
        r#"output={"profiles":{"times":[1e-7]},"pictures":false}"#,
        "output.checkpoint.keep=0",
    ];
    let job = sets.into_iter().fold(Job::new("flyer_2d"), Job::set).ranks(16);
    let name = "flyer_2d.json, 16 ranks: particles of the fullest over the mean";
    let Some(run) = table.take(name, job.run()) else { return };
    let decomposition = &run.summary.decomposition;
    let most = decomposition.ranks.iter().map(|rank| rank.particles).max().unwrap_or(0) as f64;
    let mean = run.summary.particles as f64 / decomposition.ranks.len() as f64;
    table.check(name, Some(most / mean), bounds::balance::FULLEST);
    table.beside(
        "  particle-steps of the busiest over the mean",
        Some(decomposition.imbalance),
        "",
        Unit::One,
    );
    let patches = run.summary.patches.iter().product::<usize>() as f64;
    table.beside("  patches", Some(patches), "", Unit::Count);
}
