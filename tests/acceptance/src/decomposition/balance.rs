//! Patches move so that no rank waits for the busiest: a scene whose work is in one quarter of the
//! domain, and passes on.

use flyer_mpm::driver::output::decomposition::DecompositionSummary;

use crate::bounds::{Unit, decomposition as bounds};
use crate::runs::Job;
use crate::table::Table;

/// An even split's particle-steps over those of the busiest rank, on 2 to 4 ranks.
pub fn check(table: &mut Table) {
    for ranks in 2..=4 {
        let run = |every: u64, cost: &str| {
            let balance = format!(r#"decomposition.balance={{"every":{every},"cost":"{cost}"}}"#);
            let job = Job::new("quarter").ranks(ranks).set(balance);
            job.run().map(|run| run.summary.decomposition)
        };
        let even = |summary: &DecompositionSummary| Some(1.0 / summary.imbalance);
        let name = format!("quarter.json, {ranks} ranks: even split over busiest");
        if let Some(summary) = table.take(&name, run(20, "particles")) {
            table.check(&name, even(&summary), bounds::balance::EVEN_OVER_BUSIEST);
            let moved = Some(summary.patches_moved as f64);
            table.check("  patches moved", moved, bounds::balance::PATCHES_MOVED);
        }
        // times depend on the machine and on its other work
        for (what, every) in [("by measured time", 20), ("without balance", 0)] {
            if let Some(summary) = table.take(&name, run(every, "time")) {
                table.beside(&format!("  {what}"), even(&summary), "", Unit::One);
            }
        }
    }
}
