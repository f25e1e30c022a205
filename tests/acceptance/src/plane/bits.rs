//! The same bits for any layout, ranks and threads.

use std::collections::BTreeSet;

use crate::runs::Job;
use crate::table::Table;

const LAYOUTS: [[usize; 2]; 5] = [[1, 1], [4, 1], [1, 4], [3, 5], [8, 8]];

/// Ranks 1 to 4, five layouts, one and two threads.
pub fn check(table: &mut Table) {
    let plates = small("flyer_2d");
    one_digest(table, "flyer_2d.json", &plates);
    let axis = [
        "domain.geometry=axisymmetric",
        "boundary={\"x_lower\": \"symmetry\"}",
        "domain.lower=[0, -0.0012]",
        "domain.upper=[0.0024, 0.0024]",
        "bodies.flyer.box={\"lower\": [0, -0.0005], \"upper\": [0.0012, 0]}",
        "bodies.target.box={\"lower\": [0, 0], \"upper\": [0.002, 0.0012]}",
        "bodies.flyer.velocity=[0, 1000]",
        "reference=null",
    ];
    let turned = axis.iter().fold(small("flyer_2d"), |job, set| job.set(*set));
    one_digest(table, "the same about an axis", &turned);
    let rubbing = "contact={\"type\": \"friction\", \"coefficient\": 0.3}";
    one_digest(table, "flyer_2d.json with contact", &plates.set(rubbing));
    one_digest(table, "the same about an axis, with contact", &turned.set(rubbing));
}

/// Coarser and shorter, so that the layouts are many.
fn small(scene: &'static str) -> Job {
    Job::new(scene)
        .set("domain.cell_size=4e-5")
        .set("time.end=3e-8")
        .set("output.profiles.times=[3e-8]")
}

fn one_digest(table: &mut Table, what: &str, job: &Job) {
    let (mut digests, mut runs) = (BTreeSet::new(), 0);
    for layout in LAYOUTS {
        for ranks in 1..=4 {
            for threads in [1, 2] {
                let job = job.clone().ranks(ranks).threads(threads);
                let job = job.set(format!("domain.patches=[{}, {}]", layout[0], layout[1]));
                let name = format!("{what}: {layout:?}, {ranks} ranks x {threads} threads");
                let Some(run) = table.take(&name, job.run()) else { return };
                digests.extend(run.summary.profiles.iter().map(|p| p.state_sha256.clone()));
                runs += 1;
            }
        }
    }
    let name = format!("same bits: {what}, {runs} layouts");
    table.holds(&name, &format!("{} digests", digests.len()), "1 digest", digests.len() == 1);
}
