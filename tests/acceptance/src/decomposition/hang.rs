//! Ranks that own nothing, and more of them than cores, come to an end.

use crate::bounds::Unit;
use crate::runs::Job;
use crate::table::Table;

/// Seven ranks on one patch and on many.
pub fn check(table: &mut Table) {
    for patches in [1, 2, 61] {
        let name = format!("7 ranks, {patches} patches: seconds");
        let job = Job::new("crossing").ranks(7).set(format!("domain.patches=[{patches}]"));
        let Some(run) = table.take(&name, job.run()) else { continue };
        table.beside(&name, Some(run.summary.wall_seconds), "", Unit::One);
        let owning = run.summary.decomposition.ranks.iter().filter(|r| r.patches > 0).count();
        let expected = patches.min(7);
        let shown = format!("{owning}");
        table.holds("  ranks that own a patch", &shown, &format!("{expected}"), owning == expected);
    }
}
